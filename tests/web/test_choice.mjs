// Tiles in memory on views of random trees, without a browser: the choice is the program's, and a camera at rest comes
// to rest whatever arrives when.
// usage: node test_choice.mjs PROGRAM PAGE MODULES PRINT_CHOICES
import {execFileSync} from 'node:child_process';
import {existsSync} from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';

const [page, , printChoices] = process.argv.slice(3, 6).map((p) => path.resolve(p)), bundle = path.join(page, 'library.mjs');
if (!existsSync(bundle)) {
  console.log('skipped: needs three and esbuild (scripts/setup)');
  process.exit(77);
}
const {ResidentTiles, Tally, chooseFamilies, excess, limitedBoxDistance, radiusOf} = await import(pathToFileURL(bundle));
const check = (holds, what) => {
  if (!holds) throw new Error(what);
};

// A generator of numbers in [0, 1) (a multiplicative congruential one, by Lehmer).
function numbers(seed) {
  let state = seed * 48271 % 2147483647 || 1;
  return () => (state = state * 48271 % 2147483647) / 2147483647;
}

// `textured`: some cells have textures that they share with others.
function treeOf({cells, radii}, random, textured) {
  const names = Array.from({length: 6}, (_, k) => [`texture ${k}`, Math.round(10 + 60 * random())]);
  const nodes = cells.map((cell, index) => ({...cell, index, children: [], url: `${index}`, vertices: 0, triangles: 0, textures: []}));
  for (const node of nodes) {
    node.parent = node.parent === null ? null : nodes[node.parent];
    node.parent?.children.push(node);
    if (textured) node.textures = names.filter(() => random() < 0.2);
  }
  return {root: nodes[0], cells: nodes, finest: radii.select.length - 1};
}

// A family's own bytes are all those of its first child.
function sizesOf({root}, rootBytes) {
  const bytes = new Map([[root, rootBytes]]);
  const visit = (cell) => cell.children.forEach((child, k) => {
    bytes.set(child, k === 0 ? cell.familyBytes : 0);
    visit(child);
  });
  visit(root);
  return bytes;
}

const sizeOf = (rootBytes, root) => (family) => {
  const cells = family?.children ?? [root];
  return {bytes: family?.familyBytes ?? rootBytes, textures: [...new Map(cells.flatMap(({textures}) => textures))]};
};

// The rule on a sorted list.
function chooseSlowly({cells, finest, root}, {radii, viewpoint, budget, rootBytes}) {
  const needed = cells.filter((c) => c.level < finest && excess(radii, viewpoint, c) > 0);
  const cost = (families) => {
    const all = [root, ...families.flatMap((f) => f.children)];
    return rootBytes + families.reduce((sum, f) => sum + f.familyBytes, 0) +
           [...new Map(all.flatMap(({textures}) => textures)).values()].reduce((sum, b) => sum + b, 0);
  };
  if (cost(needed) <= budget) return {chosen: needed, all: true, need: cost(needed)};
  const away = ({bounds: b}) => [0, 1, 2].reduce((sum, i) => sum + Math.max(Math.fround(b[i] - viewpoint[i]), Math.fround(viewpoint[i] - b[i + 3]), 0) ** 2, 0);
  needed.sort((a, b) => excess(radii, viewpoint, b) - excess(radii, viewpoint, a) || away(a) - away(b) || a.index - b.index);
  const chosen = [], limits = [];
  for (const cell of needed) {
    if (cell.parent !== null && !chosen.includes(cell.parent)) continue;
    if (limitedBoxDistance(cell.bounds, limits) >= radiusOf(radii, cell)) continue;
    if (cost([...chosen, cell]) <= budget) chosen.push(cell);
    else if (limits.push({box: cell.bounds, radius: radiusOf(radii, cell)}) === 32) break;
  }
  return {chosen, all: false, need: cost(needed), ended: limits.length === 32};
}

// What is left of the budget holds none of the families that would be drawn if they were there.
function checkRest({cells, finest}, {radii, viewpoint, budget}, sizes, chosen) {
  const tally = new Tally(sizes, [null, ...chosen]), has = new Set(chosen);
  const missing = cells.filter((c) => c.level < finest && excess(radii, viewpoint, c) > 0 && !has.has(c) && (c.parent === null || has.has(c.parent)));
  for (const cell of missing) {
    const limits = missing.filter((c) => c !== cell).map((c) => ({box: c.bounds, radius: radiusOf(radii, c)}));
    const hidden = limitedBoxDistance(cell.bounds, limits) >= radiusOf(radii, cell);
    check(hidden || tally.bytes + tally.cost(cell) > budget, `a family of ${tally.cost(cell)} bytes is missing, ${budget - tally.bytes} are left`);
  }
}

const indices = (cells) => [...cells].map((c) => c.index).sort((a, b) => a - b).join();

// Tiles of a view over a line that brings them in any order, each after a while.
class Trial {
  constructor(view, tree, random) {
    Object.assign(this, {view, random, waiting: [], loads: 0, released: 0});
    const bytes = sizesOf(tree, view.rootBytes), here = new Set();
    const load = (cell, signal) => new Promise((keep, fail) => {
      ++this.loads;
      const settle = () => {
        if (signal.aborted) return fail(new Error('called off'));
        here.add(cell);
        return keep({bytes: bytes.get(cell), textures: cell.textures});
      };
      if (cell.parent === null) settle();
      else this.waiting.push(settle);
    });
    const release = (cell) => { this.released += here.delete(cell) ? 1 : 0; };
    this.tiles = new ResidentTiles(tree, {load, release}, view.budget);
    this.tiles.sizeOf = sizeOf(view.rootBytes, tree.root);  // as a tileset tells them; the test's are not by vertices
    this.here = () => new Tally(this.tiles.sizeOf, [null, ...new Set([...here].map((c) => c.parent).filter((p) => p !== null))]).bytes;
  }

  // A frame; true if it differs from the one before or if anything is under way.
  async draw(viewpoint) {
    this.waiting = this.waiting.filter((settle) => {
      if (this.random() < 0.6) return true;
      settle();
      return false;
    });
    await new Promise((next) => setImmediate(next));
    const before = JSON.stringify(this.tiles.limits), {loads, released} = this;
    const moves = this.tiles.update(this.view.radii, viewpoint, 0.3);
    check(this.tiles.bytes <= this.view.budget && this.here() <= this.view.budget, `${this.here()} bytes, ${this.view.budget} are allowed`);
    const changed = JSON.stringify(this.tiles.limits) !== before || this.loads > loads || this.released > released || this.waiting.length > 0;
    check(moves || !changed, 'the page would not draw the next frame, which differs');
    return moves;
  }

  // Number of frames until the last that differs, at most so many.
  async rest(viewpoint, most) {
    let last = 0;
    for (let frame = 1; frame < last + 30 && frame < most; ++frame) if (await this.draw(viewpoint)) last = frame;
    return last;
  }
}

async function testView(view, seed, textured) {
  const random = numbers(seed), tree = treeOf(view, random, textured);
  if (textured) view = {...view, budget: Math.round(view.budget * (0.5 + random()) + 100)};
  const {radii, viewpoint, budget, rootBytes} = view, sizes = sizeOf(rootBytes, tree.root);
  if (new Tally(sizes, [null]).bytes > budget) return {scarce: 0, full: 0, last: 0};
  const slowly = chooseSlowly(tree, view), found = chooseFamilies(tree, radii, viewpoint, {sizeOf: sizes, budget});
  check(indices(found.chosen) === indices(slowly.chosen) && found.all === slowly.all, 'the choice is not that of a sorted list');
  if (!textured) check(indices(found.chosen) === [...view.chosen].sort((a, b) => a - b).join(), 'the choice is not that of the program');
  let limits = textured ? null : JSON.stringify(view.limits), latest = 0;
  for (let history = 0; history < 3; ++history) {
    const trial = new Trial(view, tree, numbers(seed + 1000 * history));
    await trial.tiles.start();
    for (let k = 0; k < 30 * history; ++k) await trial.draw([0, 1, 2].map(() => Math.fround(1.4 * random() - 0.2)));
    const most = 300 + 20 * tree.cells.length, last = await trial.rest(viewpoint, most);
    check(last < most - 30, `history ${history}: no rest in ${most} frames`);
    latest = Math.max(latest, last);
    check([...slowly.chosen].every((f) => trial.tiles.residency.has(f)), `history ${history}: a chosen family is not there`);
    const now = JSON.stringify(trial.tiles.limits.map(({box, radius}) => ({box, radius})));
    limits ??= now;
    check(now === limits, `history ${history}: other limits at rest`);
  }
  if (!slowly.all && !slowly.ended) checkRest(tree, view, sizes, slowly.chosen);
  const used = new Tally(sizes, [null, ...slowly.chosen]).bytes, largest = Math.max(...tree.cells.map((c) => (c.children.length > 0 ? new Tally(sizes, [c]).bytes : 0)));
  const full = !slowly.all && largest < budget / 10;
  check(!full || used > 0.9 * budget, `${used} of ${budget} bytes are used`);
  return {scarce: slowly.all ? 0 : 1, full: full ? 1 : 0, last: latest};
}

let status = 0, at = '';
try {
  for (const textured of [false, true]) {
    const sum = {scarce: 0, full: 0, last: 0}, count = 20;
    for (const seed of [1, 2]) {
      const views = JSON.parse(execFileSync(printChoices, [String(seed), String(count)], {encoding: 'utf8', maxBuffer: 1e9}));
      for (const [k, view] of views.entries()) {
        at = `seed ${seed}, view ${k}${textured ? ', with textures' : ''}`;
        const {scarce, full, last} = await testView(view, 100 * seed + k, textured);
        sum.scarce += scarce, sum.full += full, sum.last = Math.max(sum.last, last);
      }
    }
    at = 'all';
    check(sum.scarce > count && (textured || sum.full > 1), `${sum.scarce} scarce budgets, ${sum.full} filled`);
    console.log(`ok: ${2 * count} views ${textured ? 'with textures' : 'as the program has them'} come to rest, the last at frame ${sum.last}; ` +
                `${sum.scarce} budgets are scarce, ${sum.full} of them used to 90 %`);
  }
} catch (error) {
  console.error(`failed: ${at}: ${error.stack ?? error}`);
  status = 1;
}
process.exit(status);
