// Tiles on the page: levels by distance, over a slow line and under a budget of memory.
// usage: node test_tiles.mjs PROGRAM PAGE MODULES
import {copyFileSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {check, differ, folder, keep, main, open, pageFolder, run, writeTorus} from './browser.mjs';
import {loadOracle} from './tile_oracle.mjs';

function makeFiles() {
  run('generate', 'sphere', '--triangles', '20000', '-o', 'sphere.ply');
  run('build', 'sphere.ply', '-o', 'sphere.lode', '--cell-triangles', '250', '--sigma0', '0.2');
  run('page', 'sphere.lode', '-o', 'tiles');
  run('page', 'sphere.lode', '-o', 'older');
  const older = path.join(folder, 'older/models/sphere/tileset.json'), json = JSON.parse(readFileSync(older));
  delete json.extras.lodestone.signatures;
  writeFileSync(older, JSON.stringify(json));
  run('build', 'sphere.ply', '-o', 'fine.lode', '--cell-triangles', '60', '--sigma0', '0.2');
  run('page', 'fine.lode', '-o', 'fine');
  writeTorus(80, 50);
  run('build', 'torus.obj', '-o', 'torus.lode', '--cell-triangles', '250', '--sigma0', '0.2');
  run('page', 'torus.lode', '-o', 'torus');
  writeTorus(160, 100);
  run('build', 'torus.obj', '-o', 'charts.lode', '--cell-triangles', '60', '--sigma0', '0.2');
  run('page', 'charts.lode', '-o', 'charts');
}

// Automatic levels of so many pixels.
async function allow(page, pixels) {
  await page.fill('#pixels', String(pixels));
  if (!await page.isChecked('#automatic')) await page.click('label:has(#automatic)');
}

// Also of a tileset of an older program, with radii by level.
async function testCracks(browser) {
  for (const name of ['tiles', 'older']) await testCracksOf(browser, name);
}

async function testCracksOf(browser, name) {
  const {page, quiet, close} = await open(browser, name);
  await quiet();
  await allow(page, 6);
  let mixed = 0, cracks = 0, least = 1e9, most = 0;
  for (const [x, z] of [[0, 3], [0.2, 2], [0.3, 1.4], [0.4, 1.1], [0.5, 0.9], [0.2, 0.8], [-0.4, 0.75], [0, 0.7], [0.3, 1.2], [0, 6]]) {
    await page.evaluate(([px, pz]) => {
      window.lodestone.camera.position.set(px, 0.1, pz);
      window.lodestone.controls.update();
      window.lodestone.wake();
    }, [x, z]);
    await quiet();
    // Everything in the picture, for the count: the lens is widened, the drawn cells are kept.
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
  check(most > 2 * least, `${name}: between ${least} and ${most} triangles`);
  await close();
}

// The pictures of two viewpoints on either side of an exchange of cells hardly differ, textures included.
async function testExchanges(browser) {
  for (const name of ['tiles', 'torus']) {
    const {page, quiet, close} = await open(browser, name);
    await quiet();
    const worst = await page.evaluate(() => {
      const {lodestone} = window, {camera, models, renderer, scene} = lodestone, [m] = models;
      const gl = renderer.getContext(), {width, height} = gl.canvas;
      const shot = (z) => {
        camera.position.set(0, 0.1, z);
        camera.lookAt(0, 0, 0);
        camera.updateMatrixWorld(true);
        for (let k = 0; k < 60 && m.approach(camera, height, 6, 10); ++k);  // until limits have sunk
        renderer.render(scene, camera);
        const out = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
        return {out, cells: m.drawn.map((c) => c.index).join()};
      };
      const low = 0.7, high = 6;
      let exchanges = 0, changed = 0;
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
        for (let p = 0; p < x.length; ++p) count += Math.abs(x[p] - y[p]) > 8 ? 1 : 0;
        changed = Math.max(changed, count / (x.length / 4));
        ++exchanges;
      }
      return {exchanges, changed};
    });
    check(worst.exchanges > 0 && worst.changed < 0.001, `${name}: ${worst.exchanges} exchanges change at most ${worst.changed} of the picture`);
    await close();
  }
}

// The camera comes near faster than tiles do, on a line where each takes a while, with memory for a part of them. Frames
// are recorded, and checked vertex by vertex against a twin that shares no code with the shader.
async function testSlowLine(browser) {
  const {page, quiet, close} = await open(browser, 'tiles', {query: '?megabytes=0.75', slow: (file) => (file.endsWith('.glb') ? 80 : 0)});
  await quiet();
  await allow(page, 6);
  await quiet();  // the tolerance is reached by steps, which the bound below does not count
  const flown = await page.evaluate(async () => {
    const {lodestone} = window, {camera, controls, models, renderer} = lodestone, [m] = models, frames = [];
    let cracks = 0, tiles = 0;
    controls.enabled = false;
    const record = () => {
      const {viewpoint, radii, limits, share, bytes, drawn} = m.state;
      frames.push({viewpoint, radii: {...radii, byCell: [...radii.byCell]}, limits, share, bytes, drawn: drawn.map((c) => c.index)});
    };
    for (let k = 0; k < 90; ++k) {
      const t = Math.min(k / 30, 1), a = 4 * Math.max(k / 30 - 1, 0), r = 3 - 2.42 * t;
      camera.position.set(r * Math.sin(a), 0.1, r * Math.cos(a));
      camera.lookAt(0, 0, 0);
      const drawn = new Promise((next) => { lodestone.onFrame = next; });
      lodestone.wake();
      await drawn;
      record();
      if (k % 10 === 5) cracks += lodestone.cracks().cracks;
      tiles = Math.max(tiles, renderer.info.memory.geometries);
    }
    const resident = m.tileset.cells.filter((c) => c.object).length;
    return {frames, cracks, tiles, most: m.residents.most, budget: m.residents.budget, resident, all: m.tileset.cells.length,
            geometries: renderer.info.memory.geometries};
  });
  const oracle = await loadOracle(path.join(folder, 'tiles/models/sphere'), await import(pathToFileURL(path.join(pageFolder, 'library.mjs'))));
  const {frames} = flown;
  let ratio = 0, cracks = 0;
  frames.forEach((frame, k) => {
    if (k % 3 === 0) cracks += oracle.cracks(frame);
    if (k > 0) ratio = Math.max(ratio, oracle.jump(frames[k - 1], frame, 4, k).ratio);
  });
  const limited = frames.filter((f) => f.limits.length > 0).length, mixed = frames.filter((f) => new Set(f.drawn.map((c) => oracle.tileset.cells[c].level)).size > 1).length;
  check(limited > 20, `${limited} of ${frames.length} frames lack tiles, ${mixed} mix levels`);
  check(cracks === 0 && flown.cracks === 0, `no crack, vertex by vertex ${cracks}, in the pictures ${flown.cracks}`);
  check(ratio > 0 && ratio <= 1, `the largest jump of a vertex is ${ratio.toFixed(2)} of the bound`);
  check(flown.most <= flown.budget, `at most ${flown.most} bytes, ${flown.budget} are allowed`);
  check(flown.geometries <= flown.resident && flown.resident < flown.all, `${flown.geometries} geometries on the device, ${flown.resident} of ${flown.all} tiles in memory`);
  await page.evaluate(() => { window.lodestone.onFrame = null; });
  await close();
}

// A camera at rest with memory for a part of what it needs, of which no family is a large part: the tiles in memory and
// the picture settle, to the same whatever order tiles arrive in, and then nothing is drawn, loaded or changed.
async function testRest(browser) {
  for (const [name, megabytes] of [['fine', 0.8], ['charts', 1.2]]) {
    const found = [];
    for (const order of [0, 1]) {
      let requests = 0;
      const slow = (file) => {
        if (!/\d\.(glb|png)$/.test(file)) return 0;
        return ++requests * (order ? 37 : 61) % 50;
      };
      const {page, quiet, close} = await open(browser, name, {query: `?megabytes=${megabytes}`, slow});
      await page.waitForFunction(() => window.lodestone);
      await page.evaluate(() => {
        const {lodestone} = window, seen = window.seen = {frames: 0, last: 0, state: '', bars: 0};
        lodestone.onFrame = () => {
          ++seen.frames;
          const {drawn, limits, bytes} = lodestone.models[0]?.state ?? {drawn: [], limits: []};
          const state = JSON.stringify([drawn.map((c) => c.index), limits.map((l) => l.radius), bytes]);
          const {bytes: come, all} = lodestone.models[0]?.arrived ?? {};
          if (come < all) ++seen.bars;
          if (state !== seen.state) seen.last = seen.frames;
          seen.state = state;
        };
        document.getElementById('pixels').value = '0.25';
        if (!lodestone.automatic) document.getElementById('automatic').click();
      });
      await quiet();
      await keep(page, 'settled');
      const [asked, settled] = [requests, await page.evaluate(() => ({...window.seen}))];
      await page.evaluate(async () => {
        const {lodestone} = window, note = lodestone.onFrame;
        for (let k = 0; k < 40; ++k) {
          const drawn = new Promise((next) => { lodestone.onFrame = () => next(note()); });
          lodestone.wake();
          await drawn;
        }
      });
      await keep(page, 'later');
      const {used, budget, all, texels} = await page.evaluate(() => {
        const {residents, tileset} = window.lodestone.models[0];
        const bytes = (c) => c.object && [c.object.geometry.index, ...Object.values(c.object.geometry.attributes)].reduce((sum, a) => sum + a.array.byteLength, 0);
        const there = tileset.cells.filter((c) => c.object), textures = new Map(there.flatMap((c) => c.taken.map((url, k) => [url, c.object.material[k].map.image])));
        const texels = [...textures.values()].reduce((sum, {width, height}) => sum + Math.ceil(16 / 3 * width * height), 0);
        const {residency: {all}, budget} = residents, used = there.reduce((sum, c) => sum + bytes(c), 0) + texels;
        if (used !== residents.bytes) throw new Error(`${used} bytes, ${residents.bytes} are counted`);
        return {used, budget, all, texels};
      });
      const after = await page.evaluate(() => window.seen);
      check(after.bars > 0 && await page.evaluate(() => window.lodestone.models[0].arrived) === null, `a bar shows in ${after.bars} frames how much is there`);
      check(!all && used <= budget && used > 0.9 * budget, `${name}: ${used} of ${budget} bytes are used${all ? ', more than needed' : ''}, ${texels} of them by textures`);
      check(requests === asked && after.last === settled.last && after.frames >= settled.frames + 40 && await differ(page, 'settled', 'later', 0) === 0,
            `the last change is at frame ${settled.last} of ${settled.frames}, then ${after.frames - settled.frames} frames are the same and load nothing`);
      found.push({state: after.state, picture: (await keep(page, 'last')).join()});
      await close();
    }
    check(found[0].state === found[1].state && found[0].picture === found[1].picture, 'the same for another order of arrivals');
  }
}

// The first picture has its texture, before the image has come; then the image takes its place.
async function testThumbnail(browser) {
  let release;
  const rest = new Promise((next) => { release = next; });
  const {page, quiet, close} = await open(browser, 'torus', {gate: (file) => (/textures.\d+(_\d+)?\.png$/.test(file) ? rest : null)});
  await page.waitForFunction(() => window.lodestone?.models.length === 1);
  const side = () => page.evaluate(() => window.lodestone.models[0].drawn[0].object.material[0].map.image.width);
  check(await side() === 64, 'the first tile has a texture of 64 pixels while the image is on its way');
  await page.waitForFunction(() => window.lodestone.models[0].drawn.length > 1);
  await keep(page, 'first');
  release();
  await quiet();
  await keep(page, 'last');
  check(await side() === 128, 'then the image comes');
  const off = await differ(page, 'first', 'last', 60);
  check(off < 0.02, `the pictures differ much in ${off} of the pixels`);
  await close();
}

async function testSlider(browser) {
  const {page, quiet, close, triangles} = await open(browser, 'tiles');
  await quiet();
  const all = await triangles();
  await page.locator('#view').focus();
  await page.keyboard.press('Home');
  await quiet();
  const coarse = await triangles();
  check(coarse < all / 4, `the slider coarsens tiles, too: ${all} triangles, ${coarse} at its begin`);
  await page.keyboard.press('End');
  await quiet();
  check(await triangles() === all, 'and refines them again');
  await close();
}

// A tile that is not to be had is told, and missed without a crack.
async function testMissing(browser) {
  run('page', 'sphere.lode', '-o', 'holes');
  const levels = path.join(folder, 'holes/models/sphere'), tiles = path.join(levels, readdirSync(levels).filter((f) => /^\d+$/.test(f)).sort().at(-1));
  const name = readdirSync(tiles).filter((f) => f.endsWith('.glb')).sort().at(-1);
  rmSync(path.join(tiles, name));
  const {page, quiet, close} = await open(browser, 'holes', {expected: /404/});
  await page.waitForSelector('#message:not([hidden])');
  await quiet();
  const text = await page.textContent('#text');
  check(text.includes(name) && text.includes('404') && !text.includes('\n'), text);
  check((await page.evaluate(() => window.lodestone.cracks())).cracks === 0, 'no crack around what is missing');
  await close();
}

// So are a tile whose numbers are none, and one that counts other vertices than it has.
async function testDamaged(browser) {
  const spoilPosition = (bytes) => {
    const length = bytes.readUInt32LE(12), json = JSON.parse(bytes.subarray(20, 20 + length).toString());
    const accessor = json.accessors[json.meshes[0].primitives[0].attributes.POSITION];
    bytes.writeFloatLE(NaN, 28 + length + (json.bufferViews[accessor.bufferView].byteOffset ?? 0) + (accessor.byteOffset ?? 0));
  };
  const spoilCount = (bytes) => {
    const at = bytes.indexOf('"signatures":[') + 14;
    bytes[at] = bytes[at] === 0x31 ? 0x32 : 0x31;
  };
  await testSpoilt(browser, spoilPosition, /\.glb: vertices or triangles of the tile cannot be; the file is damaged$/);
  await testSpoilt(browser, spoilCount, /\.glb: signatures of the vertices do not fit; the file is damaged$/);
}

async function testSpoilt(browser, spoil, reason) {
  rmSync(path.join(folder, 'numbers'), {recursive: true, force: true});
  run('page', 'sphere.lode', '-o', 'numbers');
  const finest = path.join(folder, 'numbers/models/sphere/2'), file = path.join(finest, readdirSync(finest).sort()[0]), bytes = readFileSync(file);
  spoil(bytes);
  writeFileSync(file, bytes);
  const {page, quiet, close} = await open(browser, 'numbers');
  await page.waitForSelector('#message:not([hidden])');
  await quiet();
  const text = await page.textContent('#text');
  check(reason.test(text) && !text.includes('\n'), text);
  check((await page.evaluate(() => window.lodestone.cracks())).cracks === 0, 'no crack around it');
  await close();
}

// Tilesets that cannot be shown at all.
async function testRefused(browser) {
  run('export', 'sphere.lode', '--tiles', 'plain');
  run('page', 'sphere.lode', '-o', 'bare');
  copyFileSync(path.join(folder, 'plain/tileset.json'), path.join(folder, 'bare/models/sphere/tileset.json'));
  for (const [name, query, reason] of [['bare', '', /export it with --morph$/], ['tiles', '?megabytes=0.01', /the coarsest tile takes \d+ bytes, and the memory budget is 10485/]]) {
    const {page, close} = await open(browser, name, {query});
    await page.waitForSelector('#message:not([hidden])');
    const text = await page.textContent('#text');
    check(reason.test(text) && !text.includes('\n'), text);
    await close();
  }
}

await main(makeFiles, [testCracks, testExchanges, testSlowLine, testRest, testThumbnail, testSlider, testMissing, testDamaged, testRefused]);
