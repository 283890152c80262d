// The levels that a page stops at, and what is between: from rung to rung the number of vertices grows by a quarter, and
// in between the vertices of the finer one travel from their ancestors' places to their own.
import {Levels} from './levels.js';

export class Ladder {
  constructor(mesh, growth = 1.25) {
    this.levels = new Levels(mesh);
    this.rungs = [];
    for (let want = mesh.baseVertices; want < mesh.vertexCount; want = Math.max(want + 1, Math.ceil(want * growth))) {
      const count = this.levels.verticesFor(want);
      if (count > (this.rungs.at(-1) ?? 0)) this.rungs.push(count);
    }
    this.rungs.push(mesh.vertexCount);
  }

  get top() { return this.rungs.length - 1; }

  // The place on the ladder, with a fraction, where an error (normalised) is met.
  placeForError(error) {
    const vertices = this.levels.verticesForError(error);
    const k = this.rungs.findIndex((count) => count >= vertices);
    if (k <= 0) return 0;
    const below = this.rungs[k - 1];
    return k - 1 + (vertices - below) / (this.rungs[k] - below);
  }

  // What is drawn at a place: the level of the rung above, and for each of its vertices where it comes from.
  between(place) {
    const coarse = Math.min(Math.floor(place), Math.max(this.top - 1, 0)), fine = Math.min(coarse + 1, this.top);
    return {coarse: this.rungs[coarse], fine: this.rungs[fine], share: fine === coarse ? 1 : place - coarse};
  }
}
