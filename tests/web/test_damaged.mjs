// Damaged files, without a browser: each gives a mesh or one line that begins with its name and speaks of no JavaScript.
// usage: node test_damaged.mjs PROGRAM PAGE
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, readdirSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {runTests} from './run_tests.mjs';

const [program, page] = process.argv.slice(2, 4).map((p) => path.resolve(p)), bundle = path.join(page, 'library.mjs');
if (!existsSync(bundle)) {
  console.log('skipped: needs three and esbuild (scripts/setup)');
  process.exit(77);
}
const {crc32, loadTileset, readMesh, reading} = await import(pathToFileURL(bundle));
const folder = mkdtempSync(path.join(tmpdir(), 'lodestone-damaged-'));
const JAVASCRIPT = /undefined|null|NaN|cannot read|is not (a function|iterable|defined|valid JSON)|JSON|Array|\bproperty|Invalid|RangeError|TypeError|typed array|DataView|\[object/i;

let state = 20261123;
const random = (below) => (state = state * 48271 % 2147483647) % below;
const pick = (list) => list[random(list.length)];
const strange = () => pick([-1, 0, 0.5, 1e9, 4294967295, 1e300, null, '', 'x', [], {}, true, [[]]]);

// Some value anywhere in the JSON, or one that is gone.
function bend(json) {
  const places = [];
  const visit = (node) => {
    for (const key of Object.keys(node)) {
      places.push([node, key]);
      if (node[key] && typeof node[key] === 'object') visit(node[key]);
    }
  };
  visit(json);
  const [node, key] = pick(places);
  if (random(4) === 0) delete node[key];
  else node[key] = strange();
}

const withGlbJson = (bytes) => {
  const length = bytes.readUInt32LE(12), json = JSON.parse(bytes.subarray(20, 20 + length).toString());
  bend(json);
  const text = Buffer.from(JSON.stringify(json).padEnd(length, ' ')), head = Buffer.from(bytes.subarray(0, 20));
  head.writeUInt32LE(text.length, 12);
  head.writeUInt32LE(20 + text.length + bytes.length - 20 - length, 8);
  return Buffer.concat([head, text, bytes.subarray(20 + length)]);
};
const withLpmHeader = (bytes) => {
  const length = bytes.readUInt32LE(8), header = JSON.parse(bytes.subarray(16, 16 + length).toString());
  bend(header);
  const text = Buffer.from(JSON.stringify(header)), head = Buffer.from(bytes.subarray(0, 16));
  head.writeUInt32LE(text.length, 8);
  head.writeUInt32LE(crc32(text), 12);
  return Buffer.concat([head, text, bytes.subarray(16 + length)]);
};
function scramble(bytes) {
  const out = Buffer.from(bytes);
  for (let k = random(4); k >= 0; --k) out[random(out.length)] = random(256);
  return random(3) === 0 ? out.subarray(0, random(out.length)) : out;
}

// The line about a file, '' where it can be read.
async function lineAbout(name, work) {
  const begin = performance.now();
  let line = '', told = null;
  await reading(name, work).catch((error) => { line = error.message, told = error; });
  if (performance.now() - begin > 5000) throw new Error(`${name}: took ${performance.now() - begin} ms`);
  if (line !== '' && (!line.startsWith(name) || line.includes('\n') || line.length > 200 || JAVASCRIPT.test(line.slice(name.length)))) throw new Error(`told badly: ${line}`, {cause: told});
  return line;
}

async function testMeshes(run) {
  run('generate', 'sphere', '--triangles', '800', '-o', 'sphere.ply');
  const lines = new Set();
  for (const [name, bendHeader, ...more] of [['sphere.lpm', withLpmHeader], ['sphere.glb', withGlbJson], ['packed.glb', withGlbJson, '--compress']]) {
    run('progressive', 'sphere.ply', '-o', name, ...more);
    const bytes = readFileSync(path.join(folder, name));
    let refused = 0;
    for (let k = 0; k < 150; ++k) {
      const bad = random(2) === 0 ? bendHeader(bytes) : scramble(bytes), line = await lineAbout(name, () => readMesh(new Uint8Array(bad), name));
      refused += line === '' ? 0 : 1;
      lines.add(line);
    }
    if (refused < 30) throw new Error(`${name}: ${refused} of 150 damaged files are refused`);
    console.log(`ok: ${name}: ${refused} of 150 damaged files are refused`);
  }
  console.log([...lines].filter((line) => line !== '').sort().join('\n'));
}

async function testTilesets(run) {
  run('build', 'sphere.ply', '-o', 'sphere.lode', '--cell-triangles', '40');
  run('export', 'sphere.lode', '--tiles', 'tiles', '--morph');
  const text = readFileSync(path.join(folder, 'tiles/tileset.json'), 'utf8'), url = 'http://x/tileset.json';
  const table = JSON.parse(readFileSync(path.join(folder, 'tiles/signatures.json'), 'utf8'));
  const load = (json, signatures) => () => loadTileset(url, async (file) => structuredClone(file.endsWith('signatures.json') ? signatures : json));
  if (await lineAbout(url, load(JSON.parse(text), table)) !== '') throw new Error('a whole tileset is refused');
  let refused = 0, refusedTables = 0;
  for (let k = 0; k < 300; ++k) {
    const json = JSON.parse(text);
    bend(random(2) === 0 ? json : pick([json.root, json.extras, json.root.children[0]]));
    const line = await lineAbout(url, load(json, table));
    refused += line === '' ? 0 : 1;
  }
  if (refused < 50) throw new Error(`${refused} of 300 tilesets are refused`);
  console.log(`ok: ${refused} of 300 tilesets that are bent are refused`);
  for (let k = 0; k < 100; ++k) {
    const bent = structuredClone(table);
    bend(bent);
    const line = await lineAbout(url, load(JSON.parse(text), JSON.parse(JSON.stringify(bent))));  // as a file could hold it
    if (line !== '' && !line.endsWith(': signatures contradict the tiles; the file is damaged')) throw new Error(line);
    refusedTables += line === '' ? 0 : 1;
  }
  if (refusedTables < 30) throw new Error(`${refusedTables} of 100 tables of signatures are refused`);
  console.log(`ok: ${refusedTables} of 100 tables of signatures that are bent are refused`);
  const endless = JSON.parse(text);
  endless.root.children[0] = {content: {uri: 'tileset.json'}};
  const line = await lineAbout(url, () => loadTileset(url, async () => structuredClone(endless)));
  if (line === '') throw new Error('a tileset in itself is accepted');
  console.log(`ok: a tileset in itself: ${line}`);
}

// The corpus of the readers in C++: each file, and some mutations of it.
async function testCorpus() {
  const corpus = new URL('../fuzz/corpus/', import.meta.url), counts = {};
  const read = {
    progressive: (bytes, name) => lineAbout(name, () => readMesh(new Uint8Array(bytes), name)),
    gltf: (bytes, name) => lineAbout(name, () => readMesh(new Uint8Array(bytes), name)),
    // A folder's tileset.json, 1.json and 2.json, cut at zeros.
    tileset: (bytes) => {
      const parts = bytes.toString().split('\0'), names = ['tileset.json', '1.json', '2.json'];
      const load = async (url) => {
        try {
          return JSON.parse(parts[names.indexOf(url.split('/').pop())] ?? '{}');
        } catch {
          throw new Error('cannot be parsed');
        }
      };
      return lineAbout('http://x/tileset.json', () => loadTileset('http://x/tileset.json', load));
    },
  };
  for (const kind of Object.keys(read))
    for (const file of readdirSync(new URL(kind, corpus))) {
      const bytes = readFileSync(new URL(`${kind}/${file}`, corpus));
      for (let k = 0; k <= 100; ++k) {
        const line = await read[kind](k === 0 ? bytes : scramble(bytes), file);
        counts[kind] ??= [0, 0];
        ++counts[kind][line === '' ? 0 : 1];
      }
    }
  for (const [kind, [taken, refused]] of Object.entries(counts)) {
    if (refused === 0 || (kind === 'progressive' && taken === 0)) throw new Error(`corpus ${kind}: ${taken} read, ${refused} refused`);
    console.log(`ok: corpus ${kind}: ${taken} read, ${refused} refused`);
  }
}

const run = (...words) => execFileSync(program, [...words, '--quiet'], {cwd: folder});
await runTests(folder, [testMeshes, testTilesets, testCorpus], () => run);
