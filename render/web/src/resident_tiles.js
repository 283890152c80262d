// The tiles in memory: those that the view needs, within a budget of bytes (render/lod/resident_cells.h). Residency
// decides; this loads, holds and releases. A family, the children of one cell, is drawn together or not at all.
import {Tally, byExcess} from './family_choice.js';
import {Problem} from './problem.js';
import {radiusOf} from './radii.js';
import {Residency} from './residency.js';
import {boxDistance, selectCells} from './tileset.js';

const AHEAD = 1.5;   // from how many radii away families are loaded before they are needed
const AT_ONCE = 4;   // families on their way

export class ResidentTiles {
  // `load(cell, signal)` resolves to {bytes, textures} as a Tally has them, `release(cell)` frees the cell. A family
  // whose loading fails is not tried again; `failed` receives the reason.
  constructor(tileset, {load, release, failed = () => {}}, budget) {
    Object.assign(this, {tileset, load, release, failed, budget});
    this.sizes = new Map();     // of families, by parent: expected, or found when they were here
    this.loading = new Map();
    this.arrived = [];
    this.vertexBytes = 64;
    this.residency = new Residency(tileset, (family) => this.sizeOf(family), budget);
    Object.assign(this, {drawn: [], ended: false, disposed: false, most: 0});
  }

  get limits() { return this.residency.limits; }
  get bytes() { return this.residency.resident.bytes; }
  get families() { return this.residency.resident.families; }  // by their parents; null for the root

  // While tiles that belong in memory are on their way: bytes that are there, and of all of them. Null otherwise.
  get progress() {
    const {chosen, resident} = this.residency;
    if (![...this.loading.keys()].some((family) => chosen.has(family))) return null;
    const bytes = (families) => new Tally((family) => this.sizeOf(family), [null, ...families]).bytes;
    return {bytes: bytes([...chosen].filter((family) => resident.has(family))), all: bytes(chosen)};
  }

  async start() {
    const {root} = this.tileset, size = await this.load(root, new AbortController().signal);
    this.drawn = [root];
    if (root.vertices > 0) this.vertexBytes = (size.bytes - 12 * root.triangles) / root.vertices;
    this.sizes.set(null, size);
    this.residency.resized();
    if (this.bytes > this.budget)
      throw new Problem(`${root.url}: the coarsest tile takes ${this.bytes} bytes, and the memory budget is ${this.budget}`);
  }

  // Everything goes, also what is on its way.
  dispose() {
    this.disposed = true;
    for (const controller of this.loading.values()) controller.abort();
    this.tileset.cells.forEach(this.release);
    this.drawn = [];
  }

  // To be called before each frame is drawn. `share` is the share that limits lose or gain. Returns true if the next
  // frame may differ though the camera rests.
  update(radii, viewpoint, share) {
    const {residency} = this;
    for (const parent of residency.makeRoom()) parent.children.forEach(this.release);
    this.takeIn();
    const ended = this.ended;
    this.ended = false;
    const changed = residency.update(radii, viewpoint, share);
    if (changed) this.drawn = selectCells(this.tileset, radii, viewpoint, this.limits);
    if (changed || ended) this.ask();
    this.most = Math.max(this.most, this.bytes);
    return changed || ended || this.loading.size > 0;
  }

  // All vertices of a tileset have the same attributes; files without word of textures are learnt.
  sizeOf(parent) {
    if (!this.sizes.has(parent)) this.sizes.set(parent, this.sumOf((parent?.children ?? []).map((c) => ({
      bytes: this.vertexBytes * c.vertices + 12 * c.triangles, textures: c.textures ?? []}))));
    return this.sizes.get(parent);
  }

  sumOf(sizes) {
    return {bytes: sizes.reduce((sum, {bytes}) => sum + bytes, 0), textures: [...new Map(sizes.flatMap(({textures}) => textures))]};
  }

  takeIn() {
    for (const {parent, size} of this.arrived.splice(0)) {
      if (!sameSize(size, this.sizeOf(parent))) {
        this.sizes.set(parent, size);
        this.residency.resized();
      }
      if (!this.residency.takeIn(parent)) parent.children.forEach(this.release);
    }
  }

  // Families that will be needed when the camera comes a little closer.
  ahead() {
    const out = [], {lost, radii, viewpoint} = this.residency;
    const visit = (cell) => {
      if (cell.level === this.tileset.finest || boxDistance(viewpoint, cell.bounds) >= AHEAD * radiusOf(radii, cell)) return;
      if (this.residency.has(cell)) cell.children.forEach(visit);
      else if (!lost.has(cell)) out.push(cell);
    };
    visit(this.tileset.root);
    return byExcess(radii, viewpoint).sort(out);
  }

  // Requests families, those ahead only if all that the view needs have room.
  ask() {
    const {all, chosen, resident, wanted} = this.residency;
    const later = all ? this.ahead().filter((cell) => !chosen.has(cell)) : [], stillWanted = new Set([...wanted, ...later]);
    for (const [parent, controller] of this.loading) if (!stillWanted.has(parent)) controller.abort();
    const tally = resident.copy();
    for (const parent of this.loading.keys()) tally.add(parent);
    for (const cell of stillWanted) {
      if (this.loading.has(cell)) continue;
      if (this.loading.size >= AT_ONCE || tally.bytes + tally.cost(cell) > this.budget) return;
      tally.add(cell);
      this.request(cell);
    }
  }

  async request(parent) {
    const controller = new AbortController();
    this.loading.set(parent, controller);
    const results = await Promise.allSettled(parent.children.map((cell) => this.load(cell, controller.signal)));
    this.loading.delete(parent);
    this.ended = true;
    const bad = results.find((r) => r.status === 'rejected');
    if (!bad && !this.disposed) {
      this.arrived.push({parent, size: this.sumOf(results.map((r) => r.value))});
      return;
    }
    parent.children.forEach(this.release);
    if (controller.signal.aborted) return;
    this.residency.lose(parent);
    this.failed(bad.reason);
  }
}

const sameSize = (a, b) => a.bytes === b.bytes && JSON.stringify(a.textures) === JSON.stringify(b.textures);
