// Files on the page: what other viewers and the program make of the same ones, what is dropped, and what is refused.
// usage: node test_files.mjs PROGRAM PAGE MODULES
import {execFileSync} from 'node:child_process';
import {copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import path from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {check, crc32, differ, folder, keep, main, modules, open, run, writeTorus} from './browser.mjs';

const here = path.dirname(fileURLToPath(import.meta.url)), at = (...names) => path.join(folder, ...names);

function makeFiles() {
  run('generate', 'sphere', '--triangles', '5000', '-o', 'sphere.ply');
  writeTorus(80, 50);
  run('progressive', 'sphere.ply', '-o', 'sphere.lpm');
  run('progressive', 'torus.obj', '-o', 'torus.glb', '--metric', 'attribute-quadric');
  run('progressive', 'torus.obj', '-o', 'packed.glb', '--metric', 'attribute-quadric', '--compress');
  run('page', 'sphere.lpm', '-o', 'one');
  run('page', 'torus.glb', '-o', 'torus');
  copyFileSync(at('packed.glb'), at('torus', 'packed.glb'));
  copyFileSync(at('torus.glb'), at('torus', 'plain.glb'));
  execFileSync(path.join(modules, '.bin/esbuild'), ['--bundle', '--format=iife', '--log-level=warning', `--outfile=${at('stock.js')}`, path.join(here, 'stock_viewer.js')],
               {env: {...process.env, NODE_PATH: modules}});
}

// Puts three.js as it comes beside the page.
async function addStock(page) {
  await page.evaluate(() => { delete window.__THREE__; });
  await page.addScriptTag({path: at('stock.js')});
}

async function testStockLoader(browser) {
  const {page, quiet, close} = await open(browser, 'torus');
  await quiet();
  await addStock(page);
  for (const file of ['plain.glb', 'packed.glb']) {
    const counts = await page.evaluate((f) => window.stockCounts(f), file);
    check(counts.triangles === 8000 && counts.vertices === 81 * 51 && counts.textures === 1, `GLTFLoader opens ${file} at full resolution: ${JSON.stringify(counts)}`);
  }
  await close();
}

// The page at a level, and the level that the program writes, drawn by three.js as it comes.
async function testSameLevel(browser) {
  const {page, quiet, close} = await open(browser, 'torus');
  await quiet();
  await addStock(page);
  for (const share of [0.3, 0.6, 1]) {
    await page.evaluate((s) => window.lodestone.setSlider(s), share);
    await quiet();  // the slider has a thousand steps, and the page would go on to the nearest
    await page.evaluate((s) => {
      const [m] = window.lodestone.models;
      m.show(Math.round(s * m.ladder.top));
      window.lodestone.renderer.render(window.lodestone.scene, window.lodestone.camera);
    }, share);
    await keep(page, 'page');
    const shown = await page.evaluate(() => {
      const {models: [m], camera: c, renderer} = window.lodestone, {width, height} = renderer.domElement;
      return {vertices: m.vertexCount, triangles: m.triangleCount,
              model: {scale: m.mesh.scale, origin: m.mesh.origin, place: m.node.position.toArray(), colour: m.object.material[0].color.toArray()},
              camera: {width, height, fov: c.fov, near: c.near, far: c.far, position: c.position.toArray(), quaternion: c.quaternion.toArray()}};
    });
    const told = JSON.parse(run('lod', 'torus.glb', '--vertices', shown.vertices, '-o', 'torus/level.glb', '--json', '-'));
    check(told.vertices === shown.vertices && told.triangles === shown.triangles, `both have ${told.triangles} triangles of ${told.vertices} vertices`);
    await page.evaluate(async ([model, camera]) => { window.kept.program = await window.stockPicture('level.glb', model, camera); }, [shown.model, shown.camera]);
    await page.evaluate(() => { window.kept.nothing = new Uint8Array(window.kept.page.length); });
    const off = await differ(page, 'page', 'program', 8), covered = await differ(page, 'page', 'nothing', 8);
    check(covered > 0.1 && off < 0.002, `the page's picture is that of the program's level but for ${off} of it, ${covered.toFixed(2)} covered`);
  }
  await close();
}

const drop = (page, name, bytes) => page.evaluate(([file, data]) => {
  const transfer = new DataTransfer();
  transfer.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], file));
  dispatchEvent(new DragEvent('drop', {dataTransfer: transfer, bubbles: true, cancelable: true}));
}, [name, Buffer.from(bytes).toString('base64')]);

async function testDrop(browser) {
  const {page, quiet, close, triangles} = await open(browser, 'one');
  await quiet();
  const before = await triangles();
  await drop(page, 'torus.glb', readFileSync(at('torus.glb')));
  await page.waitForFunction(() => window.lodestone.models.length === 2);
  await page.setInputFiles('#file', at('packed.glb'));
  await page.waitForFunction(() => window.lodestone.models.length === 3);
  await quiet();
  check(await triangles() === before + 16000, 'a file that is dropped and one that is chosen stand beside the first');
  await close();
}

// A progressive .glb with its JSON changed.
function withJson(bytes, change) {
  const length = bytes.readUInt32LE(12), json = JSON.parse(bytes.subarray(20, 20 + length).toString());
  change(json);
  let text = JSON.stringify(json);
  text += ' '.repeat((4 - text.length % 4) % 4);
  const head = Buffer.from(bytes.subarray(0, 20)), rest = bytes.subarray(20 + length);
  head.writeUInt32LE(text.length, 12);
  head.writeUInt32LE(20 + text.length + rest.length, 8);
  return Buffer.concat([head, Buffer.from(text), rest]);
}

// The file with another parent of the last vertex.
function withLastParent(bytes, parent) {
  const length = bytes.readUInt32LE(12), json = JSON.parse(bytes.subarray(20, 20 + length).toString());
  const accessor = json.accessors[json.meshes[0].primitives[0].attributes._PARENTINDEX], view = json.bufferViews[accessor.bufferView];
  const out = Buffer.from(bytes), step = view.byteStride ?? 2;
  out.writeUInt16LE(parent, 28 + length + (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0) + step * (accessor.count - 1));
  return out;
}

// The file with another header.
function withHeader(bytes, change) {
  const length = bytes.readUInt32LE(8), header = JSON.parse(bytes.subarray(16, 16 + length).toString());
  change(header);
  const text = Buffer.from(JSON.stringify(header)), head = Buffer.from(bytes.subarray(0, 16));
  head.writeUInt32LE(text.length, 8);
  head.writeUInt32LE(crc32(text), 12);
  return Buffer.concat([head, text, bytes.subarray(16 + length)]);
}

// The file with something else in place of the first coordinate.
function withFirstNumber(bytes, number) {
  const length = bytes.readUInt32LE(12), json = JSON.parse(bytes.subarray(20, 20 + length).toString()), out = Buffer.from(bytes);
  const accessor = json.accessors[json.meshes[0].primitives[0].attributes.POSITION];
  out.writeFloatLE(number, 28 + length + (json.bufferViews[accessor.bufferView].byteOffset ?? 0));
  return out;
}

async function testRefused(browser) {
  const {page, quiet, close} = await open(browser, 'one');
  await quiet();
  const lpm = readFileSync(at('sphere.lpm')), glb = readFileSync(at('torus.glb'));
  const flipped = Buffer.from(lpm), scrambled = Buffer.from(glb);
  flipped[flipped.length - 100] ^= 1;
  scrambled.fill(0x7b, 20, 60);
  run('lod', 'torus.glb', '--vertices', '500', '-o', 'plain.glb');
  const cases = [
    ['notes.txt', Buffer.from('These are notes, and not a mesh.'), /is not a progressive mesh/],
    ['nothing.lpm', Buffer.alloc(0), /ends early/],
    ['bent.lpm', flipped, /checksum is wrong; the file is damaged/],
    ['short.lpm', lpm.subarray(0, lpm.length / 2), /ends early/],
    ['plain.glb', readFileSync(at('plain.glb')), /is not progressive; make it so with `lodestone progressive`/],
    ['short.glb', glb.subarray(0, glb.length / 2), /ends early/],
    ['scrambled.glb', scrambled, /damaged/],
    ['header.lpm', withHeader(lpm, (h) => { h.groups = 1e12; }), /header contradicts itself/],
    ['materials.lpm', withHeader(lpm, (h) => { delete h.materials; }), /the file is damaged$/],
    ['version.lpm', withHeader(lpm, (h) => { h.version = 9; }), /version 9 is not known/],
    ['few.lpm', withHeader(lpm, (h) => { h.baseGroups = 3; }), /damaged/],
    ['number.glb', withFirstNumber(glb, NaN), /a number is not finite/],
    ['offset.glb', withJson(glb, (j) => { j.bufferViews[0].byteOffset = 1e9; }), /beyond its end/],
    ['count.glb', withJson(glb, (j) => { j.accessors[0].count = 4e9; }), /do not fit/],
    ['lost.glb', withJson(glb, (j) => { delete j.accessors; }), /the file is damaged$/],
    ['base.glb', withJson(glb, (j) => { j.meshes[0].extras.progressive.baseVertices = 1e6; }), /damaged/],
    ['parents.glb', withLastParent(glb, 5000), /a vertex comes before its parent; the file is damaged/],
    ['indices.glb', withJson(glb, (j) => { for (const k of Object.values(j.meshes[0].primitives[0].attributes)) j.accessors[k].count -= 100; }), /vertex that is not there/]];
  for (const [name, bytes, reason] of cases) {
    await drop(page, name, bytes);
    await page.waitForFunction((n) => document.getElementById('text').textContent.startsWith(n), name);
    const text = await page.textContent('#text');
    check(reason.test(text) && !text.includes('\n') && text.length < 160 && !/undefined|null|cannot read|invalid|JSON|Array/i.test(text), text);
  }
  check(await page.evaluate(() => window.lodestone.models.length) === 1, 'what was there is still there');
  await page.click('#dismiss');
  check(!await page.isVisible('#message'), 'the line can be dismissed');
  await close();
}

async function testMissing(browser) {
  run('page', 'sphere.lpm', 'torus.glb', '-o', 'gap');
  rmSync(at('gap/models/sphere.lpm'));
  const gap = await open(browser, 'gap', {expected: /404/});
  await gap.quiet();
  check(/^models\/sphere.lpm: cannot be loaded \(404/.test(await gap.page.textContent('#text')), await gap.page.textContent('#text'));
  check(await gap.triangles() === 8000, 'the other model is there');
  await gap.close();

  mkdirSync(at('bare'));
  for (const file of ['index.html', 'page.js', 'page.css']) copyFileSync(at('one', file), at('bare', file));
  const bare = await open(browser, 'bare', {expected: /404/});
  await bare.page.waitForSelector('#message:not([hidden])');
  check(/^models.json: cannot be loaded/.test(await bare.page.textContent('#text')), await bare.page.textContent('#text'));
  await bare.close();

  writeFileSync(at('bare', 'models.json'), '[]');
  const empty = await open(browser, 'bare');
  await empty.quiet();
  check(await empty.page.isVisible('#hint') && !await empty.page.isVisible('#message'), 'a page without models asks for some');
  await empty.close();
}

async function testFromDisk(browser) {
  const page = await browser.newPage();
  await page.goto(pathToFileURL(at('one/index.html')).href);
  await page.waitForSelector('#message:not([hidden])');
  const text = await page.textContent('#text');
  check(/^This page needs a web server: run `python3 -m http.server`/.test(text) && !text.includes('\n'), text);
  await page.setInputFiles('#file', at('packed.glb'));
  await page.waitForFunction(() => window.lodestone.models.length === 1);
  check(true, 'files are opened all the same');
  await page.close();
}

async function testNoWebGl(browser) {
  const {page, close} = await open(browser, 'one', {expected: /WebGL/, prepare: () => { HTMLCanvasElement.prototype.getContext = () => null; }});
  await page.waitForSelector('#message:not([hidden])');
  const text = await page.textContent('#text');
  check(/WebGL 2 is missing/.test(text) && !await page.isVisible('#panel'), text);
  await close();
}

await main(makeFiles, [testStockLoader, testSameLevel, testDrop, testRefused, testMissing, testFromDisk, testNoWebGl]);
