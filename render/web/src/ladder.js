// The levels that a page stops at, and what is between: from rung to rung the number of vertices grows by a quarter, and
// in between the vertices of the finer one travel from their ancestors' places to their own.
import {Levels} from './levels.js';

const PLACED_VERTICES = 300000;  // some microseconds each, once for every rung

export class Ladder {
  // `rungs` may be those of a part of the mesh; they are kept, and further ones are added on top.
  constructor(mesh, rungs = [], growth = 1.25) {
    this.levels = new Levels(mesh);
    this.rungs = [...rungs];
    this.places = new Map();
    const next = (count) => Math.max(count + 1, Math.ceil(count * growth));
    for (let want = rungs.length > 0 ? next(rungs.at(-1)) : mesh.baseVertices; want < mesh.vertexCount; want = next(want)) {
      const count = this.levels.verticesFor(want);
      if (count > (this.rungs.at(-1) ?? 0)) this.rungs.push(count);
    }
    if (this.rungs.at(-1) !== mesh.vertexCount) this.rungs.push(mesh.vertexCount);
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

  // The positions of the vertices of a rung. While a mesh is on its way, and where it is large, they are those of the file.
  placesOf(count) {
    const {mesh} = this.levels;
    if (!mesh.whole || mesh.vertexCount > PLACED_VERTICES) return mesh.positions;
    if (!this.places.has(count)) this.places.set(count, this.levels.placeLevel(count));
    return this.places.get(count);
  }

  // The mesh drawn at a place: the level of the rung above, and for each of its vertices its origin.
  between(place) {
    const fine = Math.ceil(place), coarse = Math.max(fine - 1, 0);
    return {coarse: this.rungs[coarse], fine: this.rungs[fine], share: fine === coarse ? 1 : place - coarse};
  }
}
