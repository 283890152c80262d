// The page in headless Chromium, with real clicks, drags and touches; and its library against the program.
// usage: node test_page.mjs PROGRAM PAGE MODULES [SPEED]   exits with 77, which ctest shows as skipped, without a browser
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {serve} from './server.mjs';

const [program, pageFolder, modules] = process.argv.slice(2).map((p) => path.resolve(p));
const chromiumPath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
if (!existsSync(path.join(modules, 'playwright-core')) || !existsSync(path.join(pageFolder, 'page.js')) || !chromiumPath) {
  console.log('skipped: needs playwright-core, three and esbuild (scripts/setup) and Chromium');
  process.exit(77);
}
const {chromium} = createRequire(path.join(modules, 'x'))('playwright-core');
const here = path.dirname(fileURLToPath(import.meta.url)), folder = mkdtempSync(path.join(tmpdir(), 'lodestone-page-'));
const run = (...words) => execFileSync(program, [...words, '--quiet'], {cwd: folder, env: {...process.env, LODESTONE_PAGE: pageFolder}});
const check = (holds, what) => {
  if (!holds) throw new Error(what);
  console.log(`ok: ${what}`);
};

// A closed torus with texture coordinates, seams and charts of its own.
function torus(n, m) {
  const lines = [], id = (i, j) => (j % m) * n + (i % n) + 1, uv = (i, j) => j * (n + 1) + i + 1;
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i) {
      const a = 2 * Math.PI * i / n, b = 2 * Math.PI * j / m, r = 1 + (0.4 + 0.03 * Math.sin(9 * a)) * Math.cos(b);
      lines.push(`v ${r * Math.cos(a)} ${0.4 * Math.sin(b)} ${r * Math.sin(a)}`);
    }
  for (let j = 0; j <= m; ++j) for (let i = 0; i <= n; ++i) lines.push(`vt ${i / n} ${j / m}`);
  const corner = (i, j) => `${id(i, j)}/${uv(i, j)}`;
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i)
      lines.push(`f ${corner(i, j)} ${corner(i, j + 1)} ${corner(i + 1, j + 1)}`, `f ${corner(i, j)} ${corner(i + 1, j + 1)} ${corner(i + 1, j)}`);
  return lines.join('\n') + '\n';
}

function makeFiles() {
  run('generate', 'sphere', '--triangles', '20000', '-o', 'sphere.ply');
  writeFileSync(path.join(folder, 'torus.obj'), torus(80, 50));
  run('progressive', 'sphere.ply', '-o', 'sphere.lpm', '--position-bits', '16');
  run('progressive', 'sphere.ply', '-o', 'sphere.glb');
  run('progressive', 'torus.obj', '-o', 'torus.lpm', '--metric', 'attribute-quadric');
  run('progressive', 'torus.obj', '-o', 'packed.glb', '--compress');
  run('build', 'sphere.ply', '-o', 'sphere.lode', '--cell-triangles', '250');
  run('page', 'sphere.lpm', 'torus.obj', '-o', 'two');
  run('page', 'sphere.lpm', '-o', 'one');
  run('page', 'sphere.glb', '-o', 'glb');
  run('page', 'sphere.lode', '-o', 'tiles');
}

// A page of the browser that fails the test on any error in its console.
async function open(browser, name, {gate, viewport = {width: 480, height: 360}, ...more} = {}) {
  const server = await serve(path.join(folder, name), gate);
  const context = await browser.newContext({viewport, ...more}), page = await context.newPage(), errors = [];
  page.on('console', (m) => { if (['error', 'warning'].includes(m.type()) && !/GPU stall/.test(m.text())) errors.push(m.text()); });
  page.on('pageerror', (e) => errors.push(e.message));
  await page.goto(`http://127.0.0.1:${server.port}/`);
  const quiet = () => page.waitForFunction(() => window.lodestone?.ready && !window.lodestone.awake, null, {timeout: 120000});
  const close = async () => {
    await context.close();
    server.close();
    check(errors.length === 0, `${name}: nothing in the console ${errors.join('; ')}`);
  };
  const triangles = () => page.evaluate(() => window.lodestone.models.reduce((n, m) => n + m.triangleCount, 0));
  return {page, errors, quiet, close, triangles};
}

// Keeps the picture under a name; tells how many pixels of two pictures differ by more than a little.
const keep = (page, name) => page.evaluate((key) => {
  const gl = window.lodestone.renderer.getContext(), {width, height} = gl.canvas, out = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  (window.kept ??= {})[key] = out;
  return [...out.filter((_, k) => k % 997 === 0)];
}, name);
const differ = (page, a, b, by = 12) => page.evaluate(([x, y, least]) => {
  let count = 0;
  for (let k = 0; k < window.kept[x].length; k += 4)
    count += [0, 1, 2].some((i) => Math.abs(window.kept[x][k + i] - window.kept[y][k + i]) > least) ? 1 : 0;
  return count / (window.kept[x].length / 4);
}, [a, b, by]);

async function testControls(browser) {
  const {page, quiet, close, triangles} = await open(browser, 'two');
  await quiet();
  const all = await triangles();
  check(all > 27000 && (await page.textContent('#count')).startsWith(all.toLocaleString('en')), `all ${all} triangles are shown`);
  await keep(page, 'fine');
  const level = await page.locator('#level').boundingBox();
  await page.mouse.move(level.x + level.width - 8, level.y + level.height / 2);
  await page.mouse.down();
  await page.mouse.move(level.x + level.width / 2, level.y + level.height / 2, {steps: 8});
  await page.mouse.up();
  await quiet();
  const half = await triangles();
  check(half < all / 2, `dragging the slider leaves ${half}`);
  await page.locator('#view').focus();
  await page.keyboard.press('ArrowLeft');
  await quiet();
  check(await triangles() < half, 'the arrow key makes it coarser');
  await keep(page, 'coarse');
  check(await differ(page, 'fine', 'coarse') < 0.25, 'coarse and fine look alike');
  await page.click('#wireframe');
  await quiet();
  await keep(page, 'wires');
  check(await differ(page, 'coarse', 'wires') > 0.02, 'wireframe changes the picture');
  await page.locator('#view').focus();
  await page.keyboard.press('w');
  await quiet();
  await keep(page, 'before');
  await page.mouse.move(240, 150);
  await page.mouse.down();
  await page.mouse.move(330, 180, {steps: 6});
  await page.mouse.up();
  await quiet();
  await keep(page, 'turned');
  check(await differ(page, 'before', 'turned') > 0.02, 'dragging turns the models');
  await page.click('#automatic');
  await quiet();
  const near = await triangles();
  await page.mouse.move(240, 150);
  for (let k = 0; k < 12; ++k) await page.mouse.wheel(0, 400);
  await quiet();
  check(await triangles() < near, `automatic: ${await triangles()} triangles far away, ${near} near by`);
  await close();
}

async function testCracks(browser) {
  const {page, quiet, close} = await open(browser, 'two');
  await quiet();
  const counts = await page.evaluate(() => Array.from({length: 21}, (_, k) => {
    window.lodestone.setSlider(k / 20);
    return window.lodestone.cracks();
  }));
  check(counts.every((c) => c.covered > 5000), 'the models are in the picture');
  check(counts.every((c) => c.cracks === 0), `no crack at 21 levels: ${counts.map((c) => c.cracks)}`);
  // The count sees a triangle that is missing.
  const torn = await page.evaluate(() => {
    const {geometry} = window.lodestone.models[0].object;
    geometry.index.array.fill(0, 0, 900);
    geometry.index.needsUpdate = true;
    return window.lodestone.cracks().cracks;
  });
  check(torn > 0, `a hole is seen: ${torn} pixels`);
  await close();
}

async function testGeomorphs(browser) {
  const {page, quiet, close} = await open(browser, 'one');
  await quiet();
  const at = async (place, name) => {
    await page.evaluate((p) => {
      window.lodestone.models[0].show(p);
      window.lodestone.renderer.render(window.lodestone.scene, window.lodestone.camera);
    }, place);
    await keep(page, name);
  };
  await at(8 - 1e-5, 'below'), await at(8 + 1e-5, 'above'), await at(6, 'farther');
  const jump = await differ(page, 'below', 'above', 4), way = await differ(page, 'below', 'farther', 4);
  check(jump < 0.001 && jump < way / 20, `exchanging a level changes ${jump} of the picture, two levels ${way}`);
  await close();
}

async function testFormats(browser) {
  const pictures = [];
  for (const name of ['one', 'glb']) {
    const {page, quiet, close} = await open(browser, name);
    await quiet();
    pictures.push(await keep(page, name));
    await close();
  }
  const off = pictures[0].filter((x, k) => Math.abs(x - pictures[1][k]) > 24).length / pictures[0].length;
  check(off < 0.02, `.lpm and .glb give the same picture but for ${off}`);
}

async function testDropAndDamage(browser) {
  const {page, quiet, close, triangles} = await open(browser, 'one');
  await quiet();
  const before = await triangles();
  const drop = (file, bytes) => page.evaluate(([name, data]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], name));
    dispatchEvent(new DragEvent('drop', {dataTransfer: transfer, bubbles: true, cancelable: true}));
  }, [file, bytes.toString('base64')]);
  for (const [file, count] of [['torus.lpm', 2], ['packed.glb', 3]]) {
    await drop(file, readFileSync(path.join(folder, file)));
    await page.waitForFunction((n) => window.lodestone.models.length === n, count, {timeout: 60000});
    await quiet();
    check(await triangles() > before + 7000 * (count - 1), `${file} is dropped and shown`);
  }
  const bytes = Buffer.from(readFileSync(path.join(folder, 'torus.lpm')));
  bytes[bytes.length - 100] ^= 1;
  await drop('bad.lpm', bytes);
  await page.waitForSelector('#message:not([hidden])', {timeout: 60000});
  check((await page.textContent('#message')).includes('checksum'), 'a damaged file is named');
  await close();
}

async function testStreaming(browser) {
  let release;
  const rest = new Promise((keep) => { release = keep; });
  const {page, quiet, close, triangles} = await open(browser, 'one', {gate: (file) => (file.endsWith('.lpm') ? rest : null)});
  await page.waitForFunction(() => window.lodestone?.models.length === 1, null, {timeout: 60000});
  const [part, share] = await page.evaluate(() => [window.lodestone.models[0].triangleCount, window.lodestone.models[0].arrived]);
  check(part > 0 && share < 1, `${part} triangles are on the screen when ${share} of the file is there`);
  release();
  await quiet();
  check(await triangles() > 2 * part, 'the rest comes in');
  await close();
}

async function testTouch(browser) {
  const {page, quiet, close} = await open(browser, 'one', {viewport: {width: 360, height: 640}, hasTouch: true, isMobile: true});
  await quiet();
  await keep(page, 'before');
  const touch = await page.context().newCDPSession(page);
  const send = (type, points) => touch.send('Input.dispatchTouchEvent', {type, touchPoints: points.map(([x, y], id) => ({x, y, id}))});
  await send('touchStart', [[120, 250]]);
  for (let k = 1; k <= 6; ++k) await send('touchMove', [[120 + 20 * k, 250 + 5 * k]]);
  await send('touchEnd', []);
  await quiet();
  await keep(page, 'turned');
  check(await differ(page, 'before', 'turned', 4) > 0.01, 'a finger turns the model');
  const distance = () => page.evaluate(() => window.lodestone.camera.position.distanceTo(window.lodestone.controls.target));
  const far = await distance();
  await send('touchStart', [[150, 250], [210, 250]]);
  for (let k = 1; k <= 6; ++k) await send('touchMove', [[150 - 10 * k, 250], [210 + 10 * k, 250]]);
  await send('touchEnd', []);
  await quiet();
  check(await distance() < 0.9 * far, 'two fingers bring it closer');
  await page.locator('#wireframe').tap();
  check(await page.isChecked('#wireframe'), 'the panel can be tapped');
  await close();
}

async function testTiles(browser) {
  const {page, quiet, close} = await open(browser, 'tiles');
  await page.fill('#pixels', '6');
  let mixed = 0, cracks = 0, least = 1e9, most = 0;
  for (const [x, z] of [[0, 3], [0.2, 2], [0.3, 1.4], [0.4, 1.1], [0.5, 0.9], [0.2, 0.8], [-0.4, 0.75], [0, 0.7], [0.3, 1.2], [0, 6]]) {
    await page.evaluate(([px, pz]) => {
      window.lodestone.camera.position.set(px, 0.1, pz);
      window.lodestone.controls.update();
      window.lodestone.wake();
    }, [x, z]);
    await quiet();
    // Everything in the picture, for the count: the lens is widened, what is drawn stays.
    const found = await page.evaluate(() => {
      const {camera, models} = window.lodestone, fov = camera.fov;
      camera.fov = 120;
      const out = {...window.lodestone.cracks(), levels: new Set(models[0].drawn.map((c) => c.level)).size, triangles: models[0].triangleCount};
      camera.fov = fov;
      return out;
    });
    mixed += found.levels > 1 ? 1 : 0;
    cracks += found.cracks;
    least = Math.min(least, found.triangles), most = Math.max(most, found.triangles);
  }
  check(mixed >= 2, `${mixed} of 10 views mix levels`);
  check(cracks === 0, `no crack where tiles of several levels meet: ${cracks}`);
  check(most > 2 * least, `between ${least} and ${most} triangles`);
  // An exchange of cells is invisible: the pictures of two viewpoints on either side of it hardly differ.
  const worst = await page.evaluate(() => {
    const {lodestone} = window, {camera, models, renderer, scene} = lodestone, [m] = models;
    const gl = renderer.getContext(), {width, height} = gl.canvas;
    const shot = (z) => {
      camera.position.set(0, 0.1, z);
      camera.lookAt(0, 0, 0);
      camera.updateMatrixWorld(true);
      m.approach(camera, height, 6, 10);
      renderer.render(scene, camera);
      const out = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
      return {out, cells: m.drawn.map((c) => m.tileset.cells.indexOf(c)).join()};
    };
    let low = 0.7, high = 6, exchanges = 0, changed = 0;
    for (let k = 0; k < 5; ++k) {
      let a = low + (high - low) * k / 5, b = low + (high - low) * (k + 1) / 5;
      if (shot(a).cells === shot(b).cells) continue;
      while (b - a > 1e-6) {
        const middle = (a + b) / 2;
        if (shot(middle).cells === shot(a).cells) a = middle;
        else b = middle;
      }
      const x = shot(a).out, y = shot(b).out;
      let count = 0;
      for (let p = 0; p < x.length; p += 4) count += Math.abs(x[p] - y[p]) > 8 ? 1 : 0;
      changed = Math.max(changed, count / (x.length / 4));
      ++exchanges;
    }
    return {exchanges, changed};
  });
  check(worst.exchanges > 0 && worst.changed < 0.001, `${worst.exchanges} exchanges change at most ${worst.changed} of the picture`);
  await close();
}

function testSameResults() {
  const files = ['sphere.lpm', 'sphere.glb', 'torus.lpm', 'packed.glb'];
  const told = execFileSync('node', [path.join(here, 'same_levels.mjs'), program, folder, path.join(pageFolder, 'library.mjs'),
                                     ...files.map((f) => path.join(folder, f))], {encoding: 'utf8'});
  check(JSON.parse(told).levels === 28, `levels and geomorphs are those of the program: ${told.trim()}`);
}

let status = 0;
let browser = null;
try {
  makeFiles();
  testSameResults();
  browser = await chromium.launch({executablePath: chromiumPath, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader']});
  for (const test of [testControls, testCracks, testGeomorphs, testFormats, testDropAndDamage, testStreaming, testTouch, testTiles]) {
    console.log(test.name);
    await test(browser);
  }
} catch (error) {
  console.error(`failed: ${error.stack ?? error}`);
  status = 1;
} finally {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
}
process.exit(status);
