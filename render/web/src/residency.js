// Decides, frame by frame, which families to load and to remove and which limits to draw with (render/lod/residency.h, the
// same rules): families in memory move towards those that belong there and to nothing else, so that a camera at rest
// comes to rest. Loads nothing itself.
import {Tally, byExcess, chooseFamilies, excess} from './family_choice.js';
import {LimitTracker, limitedBoxDistance} from './limits.js';
import {radiusOf, sameRadii} from './radii.js';

export class Residency {
  // `sizeOf` as for a Tally. Its values may change as long as resized() is called afterwards.
  constructor(tileset, sizeOf, budget) {
    Object.assign(this, {tileset, sizeOf, budget});
    this.resident = new Tally(sizeOf, [null]);
    this.tracker = new LimitTracker();
    this.lost = new Set();
    Object.assign(this, {limits: [], wanted: [], chosen: new Set(), all: true, radii: null, stale: true, changed: true});
  }

  has(family) { return this.resident.has(family); }
  // To be called when sizes have changed: the next update chooses again.
  resized() {
    this.resident = this.resident.copy();
    this.stale = true;
  }

  // The family cannot be loaded.
  lose(family) {
    this.lost.add(family);
    this.stale = true;
  }

  isRefined(cell) {
    return excess(this.radii, this.viewpoint, cell) > 0 && limitedBoxDistance(cell.bounds, this.limits) < radiusOf(this.radii, cell);
  }

  // The steps of a frame, in this order.
  // 1. Families that the last frame did not draw and whose room is wanted, children before their parents; they are no
  //    longer resident.
  makeRoom() {
    if (this.wanted.length === 0 && this.resident.bytes <= this.budget) return [];
    const plan = new Tally(this.sizeOf, [...this.resident.families, ...this.wanted]), gone = [];
    if (plan.bytes <= this.budget) return gone;
    const idle = this.resident.families.filter((f) => f !== null && !this.chosen.has(f) && !this.isRefined(f));
    for (const family of byExcess(this.radii, this.viewpoint).sort(idle).reverse()) {
      if (plan.bytes <= this.budget) break;
      plan.remove(family);
      this.resident.remove(family);
      gone.push(family);
    }
    this.changed ||= gone.length > 0;
    return gone;
  }

  // 2. For each that has been loaded: true if it is resident from now on, false if the one above it has gone meanwhile
  //    or it is larger than expected.
  takeIn(family) {
    if (!this.resident.has(family.parent)) return false;
    if (this.resident.bytes + this.resident.cost(family) > this.budget) return false;
    this.resident.add(family);
    return this.changed = true;
  }

  // 3. Limits and wishes for this view. Limits lose or gain a `share` of their excess. Returns true unless everything is
  //    as it was in the last frame.
  update(radii, viewpoint, share) {
    const rests = !this.stale && sameRadii(radii, this.radii) && viewpoint.every((x, i) => x === this.viewpoint[i]);
    if (rests && !this.changed) return false;
    Object.assign(this, {radii, viewpoint: [...viewpoint], stale: false});
    if (!rests) {
      const {tileset, sizeOf, budget, lost} = this;
      Object.assign(this, chooseFamilies(tileset, radii, viewpoint, {sizeOf, budget, lost}));
    }
    const {limits, missing, changed} = this.tracker.update(this.tileset, radii, viewpoint, (cell) => this.stateOf(cell), share);
    const wanted = byExcess(radii, viewpoint).sort(missing.filter((cell) => this.chosen.has(cell)));
    Object.assign(this, {limits, wanted, changed});
    return true;
  }

  stateOf(cell) {
    if (!this.resident.has(cell)) return 'missing';
    return this.chosen.has(cell) ? 'there' : 'unwanted';
  }
}
