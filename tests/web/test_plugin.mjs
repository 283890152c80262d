// The plugin for 3DTilesRendererJS in its example: no crack and no pop where the renderer by itself has both.
// usage: node test_plugin.mjs PROGRAM PAGE MODULES
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, symlinkSync, writeFileSync} from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {gzipSync} from 'node:zlib';
import {check, folder, main, modules, open, run, writeTorus} from './browser.mjs';

const source = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../../render/web');
const example = (name, more = '') => `node_modules/lodestone-web/example/3d-tiles.html?url=/${name}/tileset.json${more}`;
const expected = /1\.1 or higher have limited support/;

function makeFiles() {
  if (!existsSync(path.join(modules, '3d-tiles-renderer'))) return false;
  mkdirSync(path.join(folder, 'home/node_modules'), {recursive: true});
  symlinkSync(source, path.join(folder, 'home/node_modules/lodestone-web'));
  for (const name of ['three', '3d-tiles-renderer']) symlinkSync(path.join(modules, name), path.join(folder, 'home/node_modules', name));
  run('generate', 'sphere', '--triangles', '20000', '-o', 'sphere.ply');
  run('build', 'sphere.ply', '-o', 'sphere.lode', '--cell-triangles', '250', '--sigma0', '0.2');
  run('export', 'sphere.lode', '--tiles', 'home/sphere', '--morph');
  run('export', 'sphere.lode', '--tiles', 'home/bare');
  writeTorus(80, 50);
  run('build', 'torus.obj', '-o', 'torus.lode', '--cell-triangles', '250', '--sigma0', '0.2');
  for (const name of ['torus', 'old']) run('export', 'torus.lode', '--tiles', `home/${name}`, '--morph');
  dropSignatures('old');
  writeRough(100, 60);
  run('build', 'rough.obj', '-o', 'rough.lode', '--cell-triangles', '100', '--sigma0', '0.2');
  run('export', 'rough.lode', '--tiles', 'home/rough', '--morph');
  cutTree('rough');
}

// A closed torus as rough as gravel, whose levels are far from each other.
function writeRough(n, m) {
  const lines = [], id = (i, j) => (j % m) * n + (i % n) + 1;
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i) {
      const a = 2 * Math.PI * i / n, b = 2 * Math.PI * j / m, small = 0.4 + 0.06 * Math.sin(1e4 * (i + 1.7 * j) ** 2), r = 1 + small * Math.cos(b);
      lines.push(`v ${r * Math.cos(a)} ${small * Math.sin(b)} ${r * Math.sin(a)}`);
    }
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i) lines.push(`f ${id(i, j)} ${id(i, j + 1)} ${id(i + 1, j + 1)}`, `f ${id(i, j)} ${id(i + 1, j + 1)} ${id(i + 1, j)}`);
  writeFileSync(path.join(folder, 'rough.obj'), lines.join('\n') + '\n');
}

// Tilesets of older programs have no signatures, and radii by level.
function dropSignatures(name) {
  const file = path.join(folder, 'home', name, 'tileset.json'), json = JSON.parse(readFileSync(file));
  if (!json.extras.lodestone.signatures) throw new Error('there are none');
  delete json.extras.lodestone.signatures;
  writeFileSync(file, JSON.stringify(json));
}

// The tiles of level 2 in tilesets of their own, as `export` cuts trees of many thousands.
function cutTree(name) {
  const root = path.join(folder, 'home', name), json = JSON.parse(readFileSync(path.join(root, 'tileset.json')));
  const move = (tile) => {
    if (tile.content) tile.content.uri = `../${tile.content.uri}`;
    tile.children?.forEach(move);
    return tile;
  };
  let count = 0;
  const cut = (tile) => {
    const {boundingVolume, geometricError} = tile, uri = `2/${++count}.json`;
    writeFileSync(path.join(root, uri), JSON.stringify({asset: {version: '1.1'}, geometricError, root: {...move(tile), refine: 'REPLACE'}}));
    return {boundingVolume, geometricError, content: {uri}};
  };
  for (const tile of json.root.children) tile.children = tile.children.map(cut);
  writeFileSync(path.join(root, 'tileset.json'), JSON.stringify(json));
}

function testSize() {
  const file = path.join(folder, 'plugin.js');
  execFileSync(path.join(modules, '.bin/esbuild'), ['--bundle', '--minify', '--format=esm', '--external:three', '--log-level=warning',
                                                   `--outfile=${file}`, path.join(source, 'src/tiles_plugin.js')]);
  const bytes = readFileSync(file);
  check(bytes.length <= 30000, `the plugin and all that it imports but three: ${bytes.length} bytes minified, ${gzipSync(bytes).length} by gzip`);
}

// In the page: a camera at so many radii, frames until nothing changes, cracks in the picture.
const helpers = async () => {
  const from = (name) => import(`/node_modules/lodestone-web/src/${name}.js`);
  const [{countCracks}, {countingTileMaterial}, THREE] = await Promise.all([from('cracks'), from('tile_material'), import('three')]);
  const {example} = window, {tiles, camera, controls, scene, renderer, plugin} = example;
  const frame = () => new Promise((next) => requestAnimationFrame(next));
  controls.enabled = false;
  const meshes = () => {
    const found = [];
    tiles.group.traverseVisible((o) => { if (o.isMesh) found.push(o); });
    return found;
  };
  const still = {viewpoint: {value: new THREE.Vector3()}, limitBoxes: {value: null}, limitRange: {value: new THREE.Vector2()},
                 bandBegin: {value: 3e38}, bandEnd: {value: 3e38}};
  Object.assign(window, {
    place(x, y, z) {
      camera.position.set(x, y, z);
      camera.lookAt(0, 0, 0);
      example.draw();
    },
    async settle() {
      let last = '', same = 0;
      for (let k = 0; k < 400 && same < 8; ++k) {
        example.draw();
        await frame();
        const {queued, downloading, parsing} = tiles.stats, busy = queued + downloading + parsing > 0;
        const now = [...tiles.visibleTiles].map((t) => t.content.uri).sort().join() + JSON.stringify([...(plugin.tracker?.radii.values() ?? [])]) + plugin.pixels;
        same = !busy && now === last ? same + 1 : 0;
        last = now;
      }
      return {tiles: tiles.visibleTiles.size, levels: new Set([...tiles.visibleTiles].map((t) => t.extras.level)).size};
    },
    cracks(size) {
      for (const o of meshes()) o.userData.counting ??= countingTileMaterial(o.userData.morph ?? still);
      return countCracks(renderer, scene, camera, meshes(), size);
    },
    picture() {
      const gl = renderer.getContext(), {width, height} = gl.canvas, out = new Uint8Array(4 * width * height);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
      return out;
    }});
};

// Views near and far, settled, with everything in the picture: the levels of tiles mix, and their borders fit. They do not
// where vertices remain at their places.
async function testCracks(browser) {
  const {page, close} = await open(browser, 'home', {query: example('rough', '&pixels=10'), expected});
  await page.waitForFunction(() => window.example?.tiles.visibleTiles.size > 0);
  await page.evaluate(helpers);
  const {mixed, cracks, still, covered, same, least, most} = await page.evaluate(async () => {
    const {camera, plugin, tiles} = window.example, sum = {mixed: 0, cracks: 0, still: 0, covered: 0, same: true, least: 1e9, most: 0};
    for (const [x, z] of [[0, 9], [0.5, 3.2], [2, 1], [1.9, 0.3], [1.8, 0], [0, -1.8]]) {
      window.place(x, 0.2, z);
      const seen = await window.settle();
      camera.fov = 120;
      const {cracks, covered} = window.cracks(1536);
      plugin.motion.lambdas.data.fill(1);
      plugin.motion.lambdas.uniform.value.needsUpdate = true;
      sum.still += window.cracks(1536).cracks;
      camera.fov = 40;
      sum.mixed += seen.levels > 1 ? 1 : 0;
      sum.cracks += cracks;
      sum.covered += covered;
      sum.least = Math.min(sum.least, seen.tiles), sum.most = Math.max(sum.most, seen.tiles);
      const drawn = plugin.drawn.filter((c) => c.tile.content);
      sum.same &&= drawn.length === seen.tiles && drawn.every((c) => tiles.visibleTiles.has(c.tile));
    }
    return sum;
  });
  check(cracks === 0 && mixed >= 3 && most > 20 * least, `${cracks} of ${covered} pixels are cracked, ${mixed} of 6 views mix levels, ${least} to ${most} tiles`);
  check(same && still > 0, `tiles drawn are those that the plugin chose; without the motion ${still} pixels are cracked`);
  await close();
}

// The camera comes near faster than tiles do.
async function testSlowLine(browser) {
  const {page, close} = await open(browser, 'home', {query: example('sphere', '&pixels=6'), expected, slow: (file) => (file.endsWith('.glb') ? 80 : 0)});
  await page.waitForFunction(() => window.example?.tiles.visibleTiles.size > 0);
  await page.evaluate(helpers);
  const {cracks, limited, moving} = await page.evaluate(async () => {
    const {camera, plugin} = window.example;
    let cracks = 0, limited = 0, moving = 0;
    for (let k = 0; k < 90; ++k) {
      const t = Math.min(k / 30, 1), a = 4 * Math.max(k / 30 - 1, 0), r = 6 - 4.84 * t;
      window.place(r * Math.sin(a), 0.2, r * Math.cos(a));
      await new Promise((next) => requestAnimationFrame(next));
      limited += plugin.tracker.radii.size > 0 ? 1 : 0;
      moving += new Set(plugin.drawn.map((c) => c.level)).size > 1 ? 1 : 0;
      camera.fov = 120;
      if (k % 10 === 0) cracks += window.cracks(512).cracks;
      camera.fov = 40;
    }
    return {cracks, limited, moving};
  });
  check(limited > 20 && moving > 4 && cracks === 0, `${limited} of 90 frames lack tiles, ${moving} mix levels, ${cracks} pixels are cracked`);
  await close();
}

// Two pictures on either side of an exchange hardly differ.
async function testExchanges(browser) {
  const worst = {};
  for (const [kind, name, query] of [['cells', 'torus', '&pixels=6'], ['levels', 'old', '&pixels=6'], ['plain', 'torus', '&pixels=6&plain']]) {
    const {page, close} = await open(browser, 'home', {query: example(name, query), expected});
    await page.waitForFunction(() => window.example?.tiles.visibleTiles.size > 0);
    await page.evaluate(helpers);
    const found = await page.evaluate(async () => {
      const shot = async (z) => {
        window.place(0, 0.3, z);
        await window.settle();
        return {out: window.picture(), cells: [...window.example.tiles.visibleTiles].map((t) => t.content.uri).sort().join()};
      };
      let exchanges = 0, changed = 0;
      for (const [from, to] of [[2, 4], [4, 6], [6, 9]]) {
        let a = from, b = to, first = await shot(a), last = await shot(b);
        if (first.cells === last.cells) continue;
        while (b - a > 1e-4) {
          const middle = (a + b) / 2, seen = await shot(middle);
          if (seen.cells === first.cells) [a, first] = [middle, seen];
          else [b, last] = [middle, seen];
        }
        let count = 0;
        for (let p = 0; p < first.out.length; ++p) count += Math.abs(first.out[p] - last.out[p]) > 8 ? 1 : 0;
        changed = Math.max(changed, count / (first.out.length / 4));
        ++exchanges;
      }
      return {exchanges, changed};
    });
    worst[kind] = found.changed;
    check(found.exchanges > 0, `${kind}: ${found.exchanges} exchanges change at most ${found.changed} of the picture`);
    await close();
  }
  const morph = Math.max(worst.cells, worst.levels);
  check(morph < 0.001 && worst.plain > 10 * morph, 'with the plugin hardly any of it');
}

// A tileset without figures for morphing is refused in one line; what was drawn leaves nothing.
async function testEnds(browser) {
  const prepare = () => { console.error = (error) => { window.told = error.message; }; };
  const bare = await open(browser, 'home', {query: example('bare'), expected, prepare});
  await bare.page.waitForFunction(() => window.told);
  const text = await bare.page.evaluate(() => window.told);
  check(/bare\/tileset\.json: has no figures for morphing; export it with --morph$/.test(text), text);
  await bare.close();
  const {page, close} = await open(browser, 'home', {query: example('torus'), expected});
  await page.waitForFunction(() => window.example?.tiles.visibleTiles.size > 0);
  await page.evaluate(helpers);
  const {before, after, programs} = await page.evaluate(async () => {
    await window.settle();
    const {tiles, renderer, scene, camera} = window.example, before = renderer.info.memory.geometries;
    tiles.dispose();
    renderer.render(scene, camera);
    return {before, after: renderer.info.memory.geometries, programs: renderer.info.programs.length};
  });
  check(before > 0 && after === 0 && programs === 0, `of ${before} geometries ${after} remain, and ${programs} programs`);
  await close();
}

await main(makeFiles, [testSize, testCracks, testSlowLine, testExchanges, testEnds], {bundle: false});
