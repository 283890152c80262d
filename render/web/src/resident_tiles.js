// Which tiles are in memory: what the view asks for, as far as a budget of bytes goes (render/lod/resident_cells.h). The
// unit is a family, the children of one cell, as they are drawn together or not at all.
import {LimitTracker} from './limits.js';
import {Problem} from './problem.js';
import {boxDistance, selectCells} from './tileset.js';

const CONTRAST = 1.25;    // by how much less urgent a drawn family must be than a missing one to make room for it
const UNSEEN = 1 / 16;    // urgency of what the camera does not see
const AHEAD = 1.5;        // from how many radii away families are loaded before they are needed
const AT_ONCE = 4;        // families on their way

export class ResidentTiles {
  // `load(cell, signal)` resolves to the bytes that the cell takes, `release(cell)` frees it, `shared()` returns the
  // bytes besides those of cells (textures). A family whose loading fails is not tried again; `failed` receives the
  // reason.
  constructor(tileset, {load, release, shared = () => 0, failed = () => {}}, budget) {
    Object.assign(this, {tileset, load, release, shared, failed, budget});
    this.families = new Map();  // resident, by parent
    this.loading = new Map();
    this.sizes = new Map();     // of families that have been here
    this.lost = new Set();
    this.arrived = [];
    this.tracker = new LimitTracker();
    this.vertexBytes = 64;
    Object.assign(this, {limits: [], drawn: [], cellBytes: 0, lacking: 0, frame: 0, most: 0});
  }

  get bytes() { return this.cellBytes + this.shared(); }
  get busy() { return this.loading.size > 0 || this.arrived.length > 0; }

  async start() {
    this.cellBytes = await this.load(this.tileset.root, new AbortController().signal);
    const {root} = this.tileset;
    this.drawn = [root];
    if (root.vertices > 0) this.vertexBytes = (this.cellBytes - 12 * root.triangles) / root.vertices;
    if (this.bytes > this.budget)
      throw new Problem(`${root.url}: the coarsest tile takes ${this.bytes} bytes, and the memory budget is ${this.budget}`);
  }

  // To be called before each frame is drawn. `share` is the share that limits lose or gain; `seen(cell)` is true if the
  // camera sees it.
  update(radii, viewpoint, share, seen = () => true) {
    ++this.frame;
    if (this.lacking > 0) this.makeRoom();
    this.takeIn();
    Object.assign(this, {radii, viewpoint, seen});
    const {limits, missing} = this.tracker.update(
      this.tileset, radii, viewpoint, (cell) => this.stateOf(cell), share,
      (cell) => { this.families.get(cell).needed = this.frame; });
    this.limits = limits;
    this.drawn = selectCells(this.tileset, radii, viewpoint, limits);
    this.ask(missing.filter((cell) => !this.lost.has(cell)));
    this.most = Math.max(this.most, this.bytes);
  }

  stateOf(cell) {
    const family = this.families.get(cell);
    return family === undefined ? 'missing' : family.unwanted ? 'unwanted' : 'there';
  }

  urgency(cell) {
    const d = Math.max(boxDistance(this.viewpoint, cell.bounds), 2 ** -this.tileset.finest / 2);
    return this.radii.select[cell.level] / d * (this.seen(cell) ? 1 : UNSEEN);
  }

  // Bytes of a family: known once it has been here, until then from the numbers of its vertices and triangles.
  sizeOf(parent) {
    return this.sizes.get(parent) ?? parent.children.reduce((sum, c) => sum + this.vertexBytes * c.vertices + 12 * c.triangles, 0);
  }

  takeIn() {
    for (const {parent, bytes} of this.arrived.splice(0)) {
      this.sizes.set(parent, bytes);
      const above = parent.parent === null || this.families.has(parent.parent);
      if (!above || this.bytes + bytes > this.budget) {
        parent.children.forEach(this.release);
        continue;
      }
      this.families.set(parent, {bytes, unwanted: false, needed: this.frame});
      this.cellBytes += bytes;
    }
  }

  letGo(parent) {
    this.cellBytes -= this.families.get(parent).bytes;
    this.families.delete(parent);
    parent.children.forEach(this.release);
  }

  hasResidentChildren(parent) { return parent.children.some((c) => this.families.has(c)); }

  // Removes families that the last frame did not need, until there is room for those it lacked: least recently needed
  // first. A family that is not needed is not refined, and a limit in its place changes no distance.
  makeRoom() {
    while (this.lacking > 0) {
      const idle = [...this.families].filter(([parent, f]) => f.needed < this.frame - 1 && !this.hasResidentChildren(parent));
      if (idle.length === 0) return;
      idle.sort(([a, f], [b, g]) => f.needed - g.needed || this.urgency(a) - this.urgency(b));
      for (const [parent, family] of idle) {
        if (this.lacking <= 0) return;
        this.lacking -= family.bytes;
        this.letGo(parent);
      }
    }
  }

  // Families that are drawn but less urgent than what is missing and has no room: their limits rise from the next frame on.
  chooseUnwanted(open, room) {
    for (const family of this.families.values()) family.unwanted = false;
    if (this.lacking <= 0) return;
    const drawn = [...this.families].filter(([parent]) => !this.hasResidentChildren(parent))
      .map(([parent, family]) => ({urgency: this.urgency(parent), family})).sort((a, b) => b.urgency - a.urgency);
    const wants = [[Infinity, 0], ...open.map((cell) => [this.urgency(cell), this.sizeOf(cell)])];  // first, what is too much
    let need = -room;
    for (const [urgency, bytes] of wants) {
      need += bytes;
      for (; need > 0 && drawn.length > 0 && drawn.at(-1).urgency * CONTRAST < urgency; drawn.pop()) {
        drawn.at(-1).family.unwanted = true;
        need -= drawn.at(-1).family.bytes;
      }
      if (need > 0) return;
    }
  }

  // True if the budget can hold the family with its ancestors, when all others are removed.
  fits(parent) {
    let bytes = this.shared();
    for (let p = parent; p !== null; p = p.parent) bytes += this.sizeOf(p);
    return bytes <= this.budget;
  }

  // Families that will be needed when the camera comes a little closer.
  ahead() {
    const out = [], {select} = this.radii;
    const visit = (cell) => {
      if (cell.level === this.tileset.finest || boxDistance(this.viewpoint, cell.bounds) >= AHEAD * select[cell.level]) return;
      if (this.families.has(cell)) cell.children.forEach(visit);
      else if (!this.lost.has(cell)) out.push(cell);
    };
    visit(this.tileset.root);
    return out;
  }

  ask(missing) {
    const byUrgency = (cells) => cells.map((cell) => [this.urgency(cell), cell]).sort(([a], [b]) => b - a).map(([, c]) => c);
    const wanted = byUrgency(missing.filter((cell) => this.fits(cell))), later = byUrgency(this.ahead());
    const stillWanted = new Set([...wanted, ...later]);
    for (const [parent, {controller}] of this.loading) if (!stillWanted.has(parent)) controller.abort();
    let room = this.budget - this.bytes - [...this.loading.values()].reduce((sum, l) => sum + l.bytes, 0) -
               this.arrived.reduce((sum, a) => sum + a.bytes, 0);
    const open = wanted.filter((cell) => !this.isComing(cell));
    this.lacking = Math.max(open.reduce((sum, cell) => sum + this.sizeOf(cell), 0) - room, 0);
    this.chooseUnwanted(open, room);
    for (const cell of [...open, ...(this.lacking > 0 ? [] : later)]) {
      if (this.loading.size >= AT_ONCE) return;
      const bytes = this.sizeOf(cell);
      if (this.isComing(cell) || bytes > room) continue;
      // A family that would have to make room for a larger, more urgent one is not loaded in the first place.
      if (this.lacking > 0 && this.urgency(cell) * CONTRAST < this.urgency(open[0])) return;
      room -= bytes;
      this.request(cell, bytes);
    }
  }

  isComing(cell) { return this.loading.has(cell) || this.arrived.some((a) => a.parent === cell); }

  async request(parent, expected) {
    const controller = new AbortController();
    this.loading.set(parent, {bytes: expected, controller});
    const results = await Promise.allSettled(parent.children.map((cell) => this.load(cell, controller.signal)));
    this.loading.delete(parent);
    const bad = results.find((r) => r.status === 'rejected');
    if (!bad) {
      this.arrived.push({parent, bytes: results.reduce((sum, r) => sum + r.value, 0)});
      return;
    }
    parent.children.forEach(this.release);
    if (controller.signal.aborted) return;
    this.lost.add(parent);
    this.failed(bad.reason);
  }
}
