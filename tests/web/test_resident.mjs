// The rules of tiles without a browser: a camera flies over a tileset that a slow line brings, under budgets of memory.
// usage: node test_resident.mjs PROGRAM PAGE
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {loadOracle} from './tile_oracle.mjs';
import {runTests} from './run_tests.mjs';

const [program, page] = process.argv.slice(2, 4).map((p) => path.resolve(p)), bundle = path.join(page, 'library.mjs');
if (!existsSync(bundle)) {
  console.log('skipped: needs three and esbuild (scripts/setup)');
  process.exit(77);
}
const library = await import(pathToFileURL(bundle));
const folder = mkdtempSync(path.join(tmpdir(), 'lodestone-resident-'));
const check = (holds, what) => {
  if (!holds) throw new Error(what);
  console.log(`ok: ${what}`);
};

// From afar to the surface, along it, and away again, as fast as wished.
const flight = (count) => Array.from({length: count}, (_, k) => {
  const t = k / (count - 1), a = 5 * t, far = 0.53 + 3 * (2 * t - 1) ** 6;
  return [0.5 + far * Math.cos(a), 0.5 + far * Math.sin(a), 0.5 + 0.2 * Math.sin(9 * t)].map(Math.fround);
});

// A view's tiles over a connection that needs `latency` frames for a tile, one to three times that. Tiles take as many
// bytes as their vertices and triangles need.
class Line {
  constructor(latency, broken) {
    Object.assign(this, {latency, broken, now: 0, waiting: [], here: new Set(), failures: 0});
  }

  size(cell) { return 64 * cell.vertices + 12 * cell.triangles; }
  load(cell, signal) {
    return new Promise((keep, fail) => {
      signal.addEventListener('abort', () => fail(new Error('called off')));
      const arrive = () => {
        if (this.broken(cell)) return fail(new Error('broken'));
        this.here.add(cell);
        return keep({bytes: this.size(cell), textures: []});
      };
      if (cell.parent === null) arrive();
      else this.waiting.push({at: this.now + this.latency * (1 + cell.index % 3), arrive});
    });
  }

  async step() {
    ++this.now;
    const due = this.waiting.filter(({at}) => at <= this.now);
    this.waiting = this.waiting.filter(({at}) => at > this.now);
    due.forEach(({arrive}) => arrive());
    await new Promise((next) => setImmediate(next));
  }
}

async function fly(oracle, {budget = 1e12, latency = 0, frames = 240, rest = 0, until = 1, pixels = 10, broken = () => false, share = 0.12, told = share}) {
  const {tileset} = oracle, line = new Line(latency, broken);
  const tiles = new library.ResidentTiles(tileset, {load: (cell, signal) => line.load(cell, signal), release: (cell) => line.here.delete(cell),
                                                    failed: () => { ++line.failures; }}, budget);
  await tiles.start();
  const radii = library.makeRadii(tileset, {pixels, height: 700, fov: 0.7, aspect: 1.5});
  const out = {cracks: 0, ratio: 0, limited: 0, mixed: 0, released: 0, finest: 0, last: null};
  const way = flight(frames / until).slice(0, frames);
  for (const viewpoint of [...way, ...new Array(rest).fill(way.at(-1))]) {
    await line.step();
    const before = tiles.families;
    tiles.update(radii, viewpoint, share);
    out.released += before.filter((family) => !tiles.residency.has(family)).length;
    const frame = {viewpoint, radii, limits: tiles.limits, share: told, drawn: tiles.drawn.map((c) => c.index)};
    if (tiles.bytes > budget) throw new Error(`frame ${line.now}: ${tiles.bytes} bytes, ${budget} are allowed`);
    if (tiles.drawn.some((c) => !line.here.has(c) && c.url !== null)) throw new Error(`frame ${line.now}: draws what is not there`);
    if (line.now % 12 === 0) out.cracks += oracle.cracks(frame);
    if (out.last !== null) out.ratio = Math.max(out.ratio, oracle.jump(out.last, frame, 10, line.now).ratio);
    out.last = frame;
    out.limited += tiles.limits.length > 0 ? 1 : 0;
    out.mixed += new Set(tiles.drawn.map((c) => c.level)).size > 1 ? 1 : 0;
    out.finest = Math.max(out.finest, ...tiles.drawn.map((c) => c.level));
  }
  return {...out, tiles, line};
}

function makeOracle() {
  const run = (...words) => execFileSync(program, [...words, '--quiet'], {cwd: folder});
  run('generate', 'sphere', '--triangles', '20000', '-o', 'sphere.ply');
  run('build', 'sphere.ply', '-o', 'sphere.lode', '--cell-triangles', '80', '--sigma0', '0.2');
  run('export', 'sphere.lode', '--tiles', 'tiles', '--morph');
  return loadOracle(path.join(folder, 'tiles'), library);
}

// Every place is of one signature in all tiles of its level, which holds all of these tiles.
function testSignatures({tileset, users}) {
  let shared = 0;
  for (let level = 1; level <= tileset.finest; ++level) {
    const sets = new Map();
    for (const {index} of tileset.cells.filter((c) => c.level === level && users[c.index])) {
      for (const [place, set] of users[index]) {
        if (sets.has(place) && sets.get(place).map((c) => c.index).join() !== set.map((c) => c.index).join()) throw new Error(`${place} has two signatures`);
        if (!set.some((c) => c.index === index)) throw new Error(`tile ${index} has ${place}, its signature does not`);
        shared += set.length > 1 ? 1 : 0;
        sets.set(place, set);
      }
    }
  }
  check(shared > 1000, `the signatures of ${shared} shared vertices are the same in all of their tiles`);
}

async function testFlights(oracle) {
  const all = oracle.tileset.cells.reduce((sum, c) => sum + 64 * c.vertices + 12 * c.triangles, 0);
  console.log(`${oracle.tileset.cells.length} tiles, ${all} bytes, ${oracle.points.length} points`);
  const results = {};
  for (const [name, options] of Object.entries({free: {}, slow: {latency: 12}, half: {budget: all / 2, latency: 1, frames: 500},
                                                third: {budget: all / 3, latency: 8}, twentieth: {budget: all / 20, latency: 3}})) {
    const found = results[name] = await fly(oracle, options), {cracks, ratio, limited, mixed, released, finest} = found;
    check(cracks === 0 && ratio <= 1, `${name}: no crack, jumps ${ratio.toFixed(2)} of the bound, at most ${found.tiles.most} bytes; ${limited} frames ` +
      `limited, ${mixed} mix levels, ${released} families released; finest level ${finest}`);
  }
  const {free, half, third} = results;
  check(free.finest === oracle.tileset.finest && free.mixed > 50 && free.released === 0, 'without a limit all levels are seen');
  check(half.released > 2 && third.released > 2, 'budgets make families go');
}

// With radii by level, as tilesets of older programs have them.
async function testByLevel({folder: from}) {
  const {cracks, ratio, limited, mixed} = await fly(await loadOracle(from, library, {byLevel: true}), {latency: 8});
  check(cracks === 0 && ratio > 0 && ratio <= 1 && mixed > 50, `by level: no crack, jumps ${ratio.toFixed(2)} of the bound; ${limited} frames limited, ${mixed} mix levels`);
}

// Faster than the line brings tiles, and then at rest: detail comes in by and by, until nothing is missing.
async function testOutrun(oracle) {
  const found = await fly(oracle, {latency: 10, frames: 12, rest: 200, until: 0.5});
  check(found.cracks === 0 && found.ratio <= 1 && found.last.limits.length === 0 && found.finest === oracle.tileset.finest,
        `a camera that outruns the line sees no crack and no pop (${found.ratio.toFixed(2)} of the bound), and all detail in the end`);
}

// Results of the checks for other rules.
async function testChecks(oracle) {
  const hasty = await fly(oracle, {latency: 6, share: 0.3, told: 0.03, frames: 120});
  check(hasty.ratio > 1, `limits that sink faster than told pop: ${hasty.ratio.toFixed(1)} of the bound`);
  const {last} = await fly(oracle, {frames: 2}), near = [1.05, 0.5, 0.5], opposite = [-0.05, 0.5, 0.5];
  const mixed = {...last, drawn: library.selectCells(oracle.tileset, last.radii, near, []).map((c) => c.index), limits: []};
  check(oracle.cracks({...mixed, viewpoint: near}) === 0, 'a view and its cells fit');
  check(oracle.cracks({...mixed, viewpoint: opposite}) > 0, 'cells of another view crack');
}

// The limits that a tile is drawn with give its points the distance of all of them, to the last bit; around a box that
// lacks its own tiles a few are left.
function testLimits() {
  let seed = 1;
  const random = () => (seed = seed * 48271 % 2147483647) / 2147483647;
  const boxIn = ([a, b], size) => {
    const low = [0, 1, 2].map(() => Math.fround(a + (b - a) * random())), high = low.map((x) => Math.fround(x + size * random()));
    return [...low, ...high];
  };
  let kept = 0, all = 0;
  for (let trial = 0; trial < 400; ++trial) {
    const limits = Array.from({length: 30}, () => ({box: boxIn([0, 1], 0.1), radius: Math.fround(0.5 * random())})), bounds = boxIn([0, 1], 0.1);
    if (trial % 2 === 0) limits.push({box: bounds, radius: Math.fround(0.5 * random())});
    const nearest = trial % 4 < 2 ? 0 : 0.4 * random(), near = library.limitsNear(bounds, nearest, limits);
    kept += near.length, all += limits.length;
    for (let k = 0; k < 40; ++k) {
      const p = [0, 1, 2].map((i) => Math.fround(bounds[i] + (bounds[i + 3] - bounds[i]) * (k < 8 ? k >> i & 1 : random())));
      const [few, many] = [near, limits].map((list) => Math.max(nearest, library.limitedPointDistance(p, list)));
      if (few !== many) throw new Error(`${few} by ${near.length} limits, ${many} by all`);
    }
  }
  check(kept < all / 8, `${kept} of ${all} limits are near, and no bit differs`);
}

async function testBroken(oracle) {
  const bad = oracle.tileset.root.children[0].children[0];
  const found = await fly(oracle, {latency: 1, broken: (cell) => cell === bad, frames: 120});
  check(found.line.failures === 1 && found.cracks === 0 && found.ratio <= 1, 'a family that cannot be loaded is asked for once, and missed without a crack');
  let refused = '';
  await fly(oracle, {budget: 10}).catch((e) => { refused = e.message; });
  check(refused.includes('memory budget'), refused);
}

await runTests(folder, [testSignatures, testLimits, testFlights, testByLevel, testOutrun, testChecks, testBroken], makeOracle);
