// Radii by cell without a browser: radii, selections and lambdas are the program's, bit by bit, and where roughness differs
// from place to place fewer triangles are drawn than with radii by level.
// usage: node test_radii.mjs PROGRAM PAGE MODULES PRINT_RADII
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {runTests} from './run_tests.mjs';

const [program, page, , printRadii] = process.argv.slice(2, 6).map((p) => path.resolve(p)), bundle = path.join(page, 'library.mjs');
if (!existsSync(bundle)) {
  console.log('skipped: needs three and esbuild (scripts/setup)');
  process.exit(77);
}
const {FrameLambdas, distanceIn, loadTileset, makeRadii, selectCells} = await import(pathToFileURL(bundle));
const folder = mkdtempSync(path.join(tmpdir(), 'lodestone-radii-'));
const check = (holds, what) => {
  if (!holds) throw new Error(what);
  console.log(`ok: ${what}`);
};
const run = (...words) => execFileSync(program, [...words, '--quiet'], {cwd: folder});
const load = (tiles = 'tiles', change = (json) => json) => loadTileset(pathToFileURL(path.join(folder, tiles, 'tileset.json')).href,
                                                                       async (file) => change(JSON.parse(readFileSync(new URL(file)))));

// A closed torus that is smooth but for a stretch as rough as gravel.
function writeTorus(n, m) {
  const lines = [], id = (i, j) => (j % m) * n + (i % n) + 1;
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i) {
      const a = 2 * Math.PI * i / n, b = 2 * Math.PI * j / m, bump = a < 1 ? 0.05 * Math.sin(1e4 * (i + 1.7 * j) ** 2) : 0;
      const small = 0.4 + bump, r = 1 + small * Math.cos(b);
      lines.push(`v ${r * Math.cos(a)} ${small * Math.sin(b)} ${r * Math.sin(a)}`);
    }
  for (let j = 0; j < m; ++j)
    for (let i = 0; i < n; ++i) lines.push(`f ${id(i, j)} ${id(i, j + 1)} ${id(i + 1, j + 1)}`, `f ${id(i, j)} ${id(i + 1, j + 1)} ${id(i + 1, j)}`);
  writeFileSync(path.join(folder, 'torus.obj'), lines.join('\n') + '\n');
}

const testProgram = () => testModel('torus.lode', 'tiles');
const testHalfLevels = () => testModel('half-levels.lode', 'half-levels');

async function testModel(file, tiles) {
  const tileset = await load(tiles);
  for (const pixels of [0.5, 2, 16]) {
    const there = JSON.parse(execFileSync(printRadii, [file, String(pixels)], {cwd: folder, encoding: 'utf8', maxBuffer: 1e9}));
    const radii = makeRadii(tileset, {pixels, height: there.height, fov: there.fov, aspect: there.aspect});
    check(String(radii.byCell) === String(Float32Array.from(there.byCell)) && String(radii.select) === String(there.select.map(Math.fround)),
          `${pixels} pixels: ${radii.byCell.length} radii are the program's`);
    let between = 0, count = 0;
    for (const {viewpoint, cells, lambdas} of there.views) {
      const drawn = selectCells(tileset, radii, viewpoint, []), frame = new FrameLambdas(tileset, radii, distanceIn(viewpoint, []));
      const same = drawn.map((c) => c.index).join() === cells.join() &&
        drawn.every((c, k) => String([...frame.of(c)]) === String(lambdas[k].map(Math.fround)));
      if (!same) throw new Error(`another selection or lambda at ${viewpoint}`);
      between += lambdas.flat().filter((x) => x > 0 && x < 1).length, count += lambdas.flat().length;
    }
    check(between > count / 50 && between < count, `${there.views.length} selections and ${count} lambdas are, too, ${between} of them between the ends`);
  }
}

// As old tilesets are drawn.
async function testByLevel() {
  const tileset = await load(), old = await load('tiles', (json) => {
    if (json.extras) delete json.extras.lodestone.signatures;
    return json;
  });
  check(old.signatures === null, 'a tileset without signatures is read');
  const count = (t, viewpoint) => {
    const radii = makeRadii(t, {pixels: 2, height: 720, fov: 0.785, aspect: 16 / 9});
    return selectCells(t, radii, viewpoint, []).reduce((sum, c) => sum + c.triangles, 0);
  };
  let few = 0, many = 0, worse = 0;
  for (let k = 0; k < 40; ++k) {
    const a = 0.3 * k, far = 0.7 + k / 20, viewpoint = [0.5 + far * Math.cos(a), 0.5 + far * Math.sin(a), 0.6].map(Math.fround);
    const [by, level] = [tileset, old].map((t) => count(t, viewpoint));
    few += by, many += level, worse += by > level ? 1 : 0;
  }
  check(few < 0.7 * many && worse === 0, `${few} triangles in 40 views, ${many} with radii by level; in ${worse} views more`);
}

await runTests(folder, [testProgram, testHalfLevels, testByLevel], () => {
  writeTorus(240, 120);
  run('build', 'torus.obj', '-o', 'torus.lode', '--cell-triangles', '150');
  run('export', 'torus.lode', '--tiles', 'tiles', '--morph');
  run('build', 'torus.obj', '-o', 'half-levels.lode', '--half-levels', '--cell-triangles', '100');
  run('export', 'half-levels.lode', '--tiles', 'half-levels', '--morph');
});
