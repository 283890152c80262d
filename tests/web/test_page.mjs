// Progressive meshes on the page, with real clicks, drags, keys and touches.
// usage: node test_page.mjs PROGRAM PAGE MODULES
import {check, differ, keep, main, open, run, writeTorus} from './browser.mjs';

function makeFiles() {
  run('generate', 'sphere', '--triangles', '20000', '-o', 'sphere.ply');
  writeTorus(80, 50);
  run('progressive', 'sphere.ply', '-o', 'sphere.lpm', '--position-bits', '16');
  run('progressive', 'sphere.ply', '-o', 'sphere.glb');
  run('page', 'sphere.lpm', 'torus.obj', '-o', 'two');
  run('page', 'sphere.lpm', '-o', 'one');
  for (const up of ['y', 'z']) {
    run('build', 'torus.obj', '-o', `${up}.lode`, '--up', up);
    run('progressive', 'torus.obj', '-o', `${up}.glb`, '--up', up);
    run('page', 'torus.obj', `${up}.lode`, `${up}.glb`, '--up', up, '-o', `up_${up}`);
  }
  run('page', 'sphere.glb', '-o', 'glb');
  run('progressive', 'torus.obj', '-o', 'torus.glb', '--metric', 'attribute-quadric');
  run('page', 'torus.glb', '-o', 'torus');
  for (const [name, quality, maps] of [['stacked', 90, 'normal'], ['whole', 100, 'normal'], ['smooth', 90, 'colour']]) {
    run('spherical', 'torus.obj', '-o', `${name}.lpm`, '--texture', '256', '--triangles', '900', '--quality', String(quality), '--maps', maps);
    run('page', `${name}.lpm`, '-o', name);
  }
}

// Three grey images below one another are shown as the colours that they are; normals of few vertices are not.
async function testStackedNormals(browser) {
  const pictures = {};
  for (const name of ['stacked', 'whole', 'smooth']) {
    const {page, quiet, close} = await open(browser, name);
    await quiet();
    pictures[name] = await keep(page, name);
    await close();
  }
  const distance = (a, b) => pictures[a].reduce((sum, x, k) => sum + Math.abs(x - pictures[b][k]), 0) / pictures[a].length;
  const near = distance('stacked', 'whole'), far = distance('smooth', 'whole');
  check(near < 1 && far > 2 * near, `stacked normals are those of a whole image: ${near}, without them ${far}`);
}

async function drag(page, [x0, y0], [x1, y1]) {
  await page.mouse.move(x0, y0);
  await page.mouse.down();
  await page.mouse.move(x1, y1, {steps: 8});
  await page.mouse.up();
}

async function testControls(browser) {
  const {page, quiet, close, triangles} = await open(browser, 'two');
  await quiet();
  const all = await triangles();
  check(all > 27000 && (await page.textContent('#count')).startsWith(all.toLocaleString('en')), `all ${all} triangles are shown`);
  await keep(page, 'fine');
  const level = await page.locator('#level').boundingBox(), y = level.y + level.height / 2;
  await drag(page, [level.x + level.width - 8, y], [level.x + level.width / 2, y]);
  await quiet();
  const half = await triangles();
  check(half < all / 2, `dragging the slider leaves ${half}`);
  await keep(page, 'coarse');
  check(await differ(page, 'fine', 'coarse') < 0.25, 'coarse and fine look alike');
  await page.click('label:has(#edges)');
  await quiet();
  await keep(page, 'wires');
  check(await differ(page, 'coarse', 'wires') > 0.02, 'edges change the picture');
  await page.click('label:has(#edges)');
  await quiet();
  await keep(page, 'before');
  check(await differ(page, 'coarse', 'before', 0) === 0, 'the same state gives the same picture, to the last bit');
  await drag(page, [240, 100], [330, 130]);
  await quiet();
  await keep(page, 'turned');
  check(await differ(page, 'before', 'turned') > 0.02, 'dragging turns the models');
  await page.click('#home');
  await quiet();
  await keep(page, 'home');
  check(await differ(page, 'before', 'home', 2) < 0.001, 'a button brings the first view back');
  await page.click('label:has(#automatic)');
  await quiet();
  const near = await triangles();
  await page.mouse.move(240, 120);
  for (let k = 0; k < 12; ++k) await page.mouse.wheel(0, 400);
  await quiet();
  check(await triangles() < near, `automatic: ${await triangles()} triangles far away, ${near} near by`);
  const loose = await triangles();
  await page.fill('#pixels', '0.2');
  await quiet();
  check(await triangles() > loose, 'fewer pixels of error ask for more of them');
  await close();
}

async function testKeys(browser) {
  const {page, quiet, close, triangles} = await open(browser, 'two');
  await quiet();
  await page.locator('#view').focus();
  const press = async (key) => {
    await page.keyboard.press(key);
    await quiet();
    return triangles();
  };
  const all = await triangles(), one = (await press('ArrowLeft'), await press('ArrowLeft'), await press('ArrowLeft')), ten = await press('PageDown'), none = await press('Home');
  check(all > one && one > ten && ten > none, `arrow, page and home keys make it coarser: ${[all, one, ten, none]}`);
  check(await press('ArrowRight') > none && await press('End') === all, 'and finer again');
  const places = [], look = () => page.evaluate(() => window.lodestone.camera.position.toArray().map((x) => x.toFixed(4)).join());
  for (const key of ['Shift+ArrowLeft', 'Shift+ArrowUp', '+', '-', 'h']) await press(key), places.push(await look());
  check(new Set(places.slice(0, 3)).size === 3 && places[3] === places[1] && places[4] !== places[3], 'Shift and arrows turn, + and - come closer and go, h goes home');
  const far = () => page.evaluate(() => window.lodestone.camera.position.distanceTo(window.lodestone.controls.target));
  const home = await far();
  for (const [key, wheel, least, most] of [['-', 400, 7.9, 8.1], ['+', -400, 2e-5, 5e-5]]) {
    for (let k = 0; k < 150; ++k) await page.keyboard.press(key);
    await quiet();
    const byKeys = await far() / home;
    await page.mouse.move(240, 120);
    for (let k = 0; k < 30; ++k) await page.mouse.wheel(0, wheel);
    await quiet();
    const byWheel = await far() / home;
    check([byKeys, byWheel].every((d) => d > least && d < most), `${key} and the wheel end at ${byKeys} and ${byWheel} of the distance`);
  }
  await press('h');
  await press('e');
  check(await page.isChecked('#edges'), 'e shows edges');
  await press('a');
  check(await page.isChecked('#automatic') && await triangles() < all, 'a takes automatic levels');
  await close();
}

// Labels name the models and turn them upright.
async function testSideBySide(browser) {
  const {page, quiet, close} = await open(browser, 'two', {smooth: true});
  await quiet();
  const samples = await page.evaluate(() => { const gl = window.lodestone.renderer.getContext(); return gl.getParameter(gl.SAMPLES); });
  check(samples > 1, `edges are smooth: ${samples} samples a pixel`);
  const labels = page.locator('#labels button'), boxes = [await labels.nth(0).boundingBox(), await labels.nth(1).boundingBox()];
  const texts = await labels.allTextContents();
  check(texts[0].includes('sphere') && texts[1].includes('torus') && texts.every((t) => /[\d,]+ triangles/.test(t)), texts.join(' | '));
  check(boxes[0].x + boxes[0].width < boxes[1].x, 'labels stand side by side');
  const heights = () => page.evaluate(() => window.lodestone.models.map((m) => {
    const {min, max} = m.box;
    return (max.y - min.y).toFixed(2);
  }));
  const [, flat] = await heights();
  await labels.nth(1).click();
  await quiet();
  const [sphere, high] = await heights();
  check(high > 2 * flat && sphere > 0.99, `a click on the label turns the torus upright: ${flat} high, then ${high}`);
  check((await page.evaluate(() => window.lodestone.cracks())).cracks === 0, 'all of it in the picture');
  await close();
}

// Meshes, hierarchies and glTF stand as their files say.
async function testUp(browser) {
  const heights = [];
  for (const up of ['y', 'z']) {
    const {page, quiet, close} = await open(browser, `up_${up}`);
    await quiet();
    heights.push(await page.evaluate(() => window.lodestone.models.map(({box: {min, max}}) => max.y - min.y)));
    await close();
  }
  const [flat, high] = heights, all = flat.length === 3 && high.length === 3;
  check(all && Math.min(...high) > 2 * Math.max(...flat), `up is y: ${flat.map((h) => h.toFixed(2))} high, z: ${high.map((h) => h.toFixed(2))}`);
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

// Places, normals and texture coordinates travel: at a rung of the ladder two levels give one picture.
async function testGeomorphs(browser) {
  for (const name of ['one', 'torus']) {
    const {page, quiet, close} = await open(browser, name);
    await quiet();
    const at = async (place, key) => {
      await page.evaluate((p) => {
        window.lodestone.models[0].show(p);
        window.lodestone.renderer.render(window.lodestone.scene, window.lodestone.camera);
      }, place);
      await keep(page, key);
    };
    let jump = 0, way = 1;
    for (const rung of [2, 5, 8]) {
      await at(rung - 1e-5, 'below'), await at(rung + 1e-5, 'above'), await at(rung - 1, 'farther');
      jump = Math.max(jump, await differ(page, 'below', 'above', 4)), way = Math.min(way, await differ(page, 'below', 'farther', 4));
    }
    check(jump < 0.001 && jump < way / 20, `${name}: exchanging a level changes ${jump} of the picture, a level at least ${way}`);
    await close();
  }
}

async function testTexture(browser) {
  const {page, quiet, close} = await open(browser, 'torus');
  await quiet();
  const [anisotropy, most, size] = await page.evaluate(() => {
    const {map} = window.lodestone.models[0].object.material[0];
    return [map.anisotropy, window.lodestone.renderer.capabilities.getMaxAnisotropy(), map.image.width];
  });
  check(anisotropy === most && most > 1 && size === 128, `the texture is filtered with an anisotropy of ${anisotropy}`);
  const colours = new Set(await page.evaluate(() => {
    const gl = window.lodestone.renderer.getContext(), {width, height} = gl.canvas, out = new Uint8Array(4 * width * height), seen = [];
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
    for (let k = 0; k < out.length; k += 4) if (out[k + 3] === 255) seen.push(out[k] > 1.5 * out[k + 1] ? 'red' : out[k + 1] > 1.2 * out[k + 2] ? 'yellow' : 'other');
    return seen;
  }));
  check(colours.has('red') && colours.has('yellow'), 'its colours are on the screen');
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

// The base is on the screen before the file is complete, and what comes later flows in.
async function testStreaming(browser) {
  let release;
  const rest = new Promise((next) => { release = next; });
  const {page, quiet, close, triangles} = await open(browser, 'one', {gate: (file) => (file.endsWith('.lpm') ? rest : null)});
  await page.waitForFunction(() => window.lodestone?.models.length === 1 && !window.lodestone.awake);
  const [part, {bytes, all}] = await page.evaluate(() => [window.lodestone.models[0].triangleCount, window.lodestone.models[0].arrived]);
  const bar = await page.locator('#labels progress').evaluate((b) => b.value / b.max), share = bytes / all;
  check(part > 0 && share < 0.4 && Math.abs(bar - share) < 1e-6, `${part} triangles are on the screen when ${share.toFixed(2)} of the bytes are there, as the bar says`);
  check((await page.evaluate(() => window.lodestone.cracks())).cracks === 0, 'they are a closed surface');
  await page.evaluate(() => {
    window.places = [];
    window.lodestone.onFrame = () => { window.places.push(window.lodestone.models[0].vertexCount); };
  });
  release();
  await quiet();
  const counts = await page.evaluate(() => window.places);
  check(await triangles() > 2 * part && counts.length > 3 && counts.every((n, k) => k === 0 || n >= counts[k - 1]),
        `the rest flows in: ${[...new Set(counts)]} vertices`);
  check(!await page.isVisible('#labels progress'), 'then no bar is left');
  await keep(page, 'streamed');
  await page.click('#home');
  await quiet();
  await keep(page, 'home');
  check(await differ(page, 'streamed', 'home', 0) === 0, 'and the view is that of the whole model');
  await close();
}

async function testPhone(browser) {
  const {page, quiet, close, triangles} = await open(browser, 'two', {viewport: {width: 390, height: 844}, hasTouch: true, isMobile: true, deviceScaleFactor: 2});
  await quiet();
  for (const id of ['#level', 'label:has(#automatic)', 'label:has(#pixels)', 'label:has(#edges)', '#home', 'label:has(#file)']) {
    const {x, y, width, height} = await page.locator(id).boundingBox();
    check(x >= 0 && y >= 0 && x + width <= 390 && y + height <= 844 && height >= 32, `${id} is in reach, ${Math.round(width)} x ${Math.round(height)}`);
  }
  check(await page.isChecked('#automatic'), 'a phone begins with automatic levels');
  await keep(page, 'before');
  const touch = await page.context().newCDPSession(page);
  const send = (type, points) => touch.send('Input.dispatchTouchEvent', {type, touchPoints: points.map(([x, y], id) => ({x, y, id}))});
  const swipe = async (from, to) => {
    await send('touchStart', from);
    for (let k = 1; k <= 6; ++k) await send('touchMove', from.map(([x, y], id) => [x + (to[id][0] - x) * k / 6, y + (to[id][1] - y) * k / 6]));
    await send('touchEnd', []);
    await quiet();
  };
  await swipe([[120, 250]], [[240, 280]]);
  await keep(page, 'turned');
  check(await differ(page, 'before', 'turned', 4) > 0.01, 'a finger turns the models');
  const distance = () => page.evaluate(() => window.lodestone.camera.position.distanceTo(window.lodestone.controls.target));
  const far = await distance();
  await swipe([[150, 250], [210, 250]], [[90, 250], [270, 250]]);
  check(await distance() < 0.9 * far, 'two fingers bring them closer');
  await page.evaluate(() => window.lodestone.setSlider(1));
  await quiet();
  const all = await triangles(), {x, y, width, height} = await page.locator('#level').boundingBox();
  await swipe([[x + width - 8, y + height / 2]], [[x + width / 3, y + height / 2]]);
  check(await triangles() < all / 2, `a finger on the slider leaves ${await triangles()} of ${all} triangles`);
  await page.locator('label:has(#edges)').tap();
  check(await page.isChecked('#edges'), 'the panel can be tapped');
  await close();
}

await main(makeFiles, [testControls, testKeys, testSideBySide, testUp, testCracks, testGeomorphs, testTexture, testStackedNormals, testFormats, testStreaming, testPhone]);
