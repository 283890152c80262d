// Which families of tiles belong in memory: a function of the view and the budget alone (render/lod/family_choice.h, the
// same choice). A family, the children of one cell, is named by that cell. Distances are those of limits (limits.js).
import {limitedBoxDistance, pointFrom} from './limits.js';
import {radiusOf} from './radii.js';

const single = Math.fround;
const PASSED_OVER_AT_MOST = 32;

// By how much the viewpoint is nearer to the cell than its radius; above 0: its children are needed.
export const excess = (radii, viewpoint, cell) => single(radiusOf(radii, cell) - pointFrom(viewpoint, cell.bounds));

// A larger excess first, then the nearer cell, then the smaller index.
export function byExcess(radii, viewpoint) {
  const key = (cell) => ({cell, excess: excess(radii, viewpoint, cell)});
  const order = (a, b) => b.excess - a.excess || squareFrom(viewpoint, a.cell.bounds) - squareFrom(viewpoint, b.cell.bounds) ||
                          a.cell.index - b.cell.index;
  return {key, order, sort: (cells) => cells.map(key).sort(order).map(({cell}) => cell)};
}

function squareFrom(p, box) {
  let sum = 0;
  for (let i = 0; i < 3; ++i) sum += Math.max(single(box[i] - p[i]), single(p[i] - box[i + 3]), 0) ** 2;
  return sum;
}

// Bytes of a set of families; textures that several of them use count once. `sizeOf(family)` returns its own bytes and
// its textures, [[name, bytes]...]; null stands for the root, which is always there.
export class Tally {
  constructor(sizeOf, families = []) {
    Object.assign(this, {sizeOf, bytes: 0, held: new Map(), users: new Map()});
    for (const family of families) this.add(family);
  }

  has(family) { return this.held.has(family); }
  get families() { return [...this.held.keys()]; }
  copy() { return new Tally(this.sizeOf, this.held.keys()); }

  // Bytes that the family would add.
  cost(family) {
    const {bytes, textures} = this.sizeOf(family);
    return textures.reduce((sum, [name, size]) => sum + (this.users.has(name) ? 0 : size), bytes);
  }

  add(family) {
    const size = this.sizeOf(family);
    this.bytes += this.cost(family);
    this.held.set(family, size);
    for (const [name] of size.textures) this.users.set(name, (this.users.get(name) ?? 0) + 1);
  }

  remove(family) {
    const {bytes, textures} = this.held.get(family);
    this.held.delete(family);
    this.bytes -= bytes;
    for (const [name, size] of textures) {
      this.users.set(name, this.users.get(name) - 1);
      if (this.users.get(name) > 0) continue;
      this.users.delete(name);
      this.bytes -= size;
    }
  }
}

// A heap with the first by `order` on top.
class Heap {
  constructor(order) { Object.assign(this, {order, items: []}); }
  get size() { return this.items.length; }

  push(item) {
    const {items, order} = this;
    let at = items.push(item) - 1;
    for (let up; at > 0 && order(item, items[up = (at - 1) >> 1]) < 0; at = up) items[at] = items[up];
    items[at] = item;
  }

  pop() {
    const {items, order} = this, top = items[0], last = items.pop(), {length} = items;
    if (length === 0) return top;
    let at = 0;
    for (let next = 1; next < length; next = 2 * at + 1) {
      if (next + 1 < length && order(items[next + 1], items[next]) < 0) ++next;
      if (order(items[next], last) >= 0) break;
      items[at] = items[next];
      at = next;
    }
    items[at] = last;
    return top;
  }
}

// The families to have; `lost` ones cannot be loaded. `all` is true if these are all that can be had of those needed.
export function chooseFamilies(tileset, radii, viewpoint, {sizeOf, budget, lost = new Set()}) {
  const needed = (cell) => cell.level < tileset.finest && excess(radii, viewpoint, cell) > 0;
  return chooseAll(tileset, needed, {sizeOf, budget, lost}) ??
         chooseByExcess(tileset, needed, byExcess(radii, viewpoint), {radii, sizeOf, budget, lost});
}

// Null when they do not fit.
function chooseAll({root}, needed, {sizeOf, budget, lost}) {
  const tally = new Tally(sizeOf, [null]), chosen = new Set(), open = [root].filter(needed);
  for (const cell of open) {
    if (lost.has(cell)) continue;
    if (tally.bytes + tally.cost(cell) > budget) return null;
    tally.add(cell);
    chosen.add(cell);
    open.push(...cell.children.filter(needed));
  }
  return {chosen, all: true};
}

function chooseByExcess({root}, needed, {key, order}, {radii, sizeOf, budget, lost}) {
  const tally = new Tally(sizeOf, [null]), chosen = new Set(), limits = [], open = new Heap(order);
  if (needed(root)) open.push(key(root));
  for (let passedOver = 0; open.size > 0 && passedOver < PASSED_OVER_AT_MOST;) {
    const {cell} = open.pop();
    const radius = radiusOf(radii, cell);
    if (limitedBoxDistance(cell.bounds, limits) >= radius) continue;
    if (lost.has(cell) || tally.bytes + tally.cost(cell) > budget) {
      limits.push({box: cell.bounds, radius});
      passedOver += lost.has(cell) ? 0 : 1;
      continue;
    }
    tally.add(cell);
    chosen.add(cell);
    for (const child of cell.children) if (needed(child)) open.push(key(child));
  }
  return {chosen, all: false};
}
