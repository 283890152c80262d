// Levels of a progressive mesh and what moves between them: core/progressive/mesh/level.h and activation.h.
//
// A mesh here: {vertexCount, baseVertices, positions (Float32Array, normalised), parents (Uint32Array), errors
// (Float32Array, normalised), triangles (Uint32Array), whole (all of it has come), origin, scale, and, where it has them, normals, uv, colours,
// materialIds, materials, textures}.

import {delayFlaps} from './flaps.js';
import {placeLevel} from './placement.js';

function groupStarts({vertexCount, baseVertices, positions, parents}) {
  const bits = new Int32Array(positions.buffer, positions.byteOffset, positions.length);
  const groups = new Uint32Array(vertexCount);
  for (let v = 0; v < vertexCount; ++v) {
    groups[v] = v;
    if (v === 0 || v === baseVertices) continue;
    const a = 3 * v;
    if (bits[a] !== bits[a - 3] || bits[a + 1] !== bits[a - 2] || bits[a + 2] !== bits[a - 1]) continue;
    if (v < baseVertices || groups[parents[v]] === groups[parents[v - 1]]) groups[v] = groups[v - 1];
  }
  return groups;
}

// Brings the triangles into the order in which they come in; returns when each does.
function sortByBirth(mesh, groups) {
  const {vertexCount, baseVertices, parents, triangles} = mesh, count = triangles.length / 3;
  const births = new Uint32Array(count), place = new Uint32Array(vertexCount + 2);
  for (let t = 0; t < count; ++t) {
    let a = groups[triangles[3 * t]], b = groups[triangles[3 * t + 1]], c = groups[triangles[3 * t + 2]];
    let born = vertexCount;
    if (a !== b && b !== c && c !== a) {
      while (true) {
        if (a < b) [a, b] = [b, a];
        if (a < c) [a, c] = [c, a];
        if (a < baseVertices) {
          born = 0;
          break;
        }
        const next = groups[parents[a]];
        if (next === b || next === c) {
          born = a;
          break;
        }
        a = next;
      }
    }
    births[t] = born;
  }
  delayFlaps(mesh, groups, births);
  for (const born of births) ++place[born + 1];
  for (let v = 1; v < place.length; ++v) place[v] += place[v - 1];
  const sorted = new Uint32Array(triangles.length), sortedBirths = new Uint32Array(count);
  for (let t = 0; t < count; ++t) {
    const to = place[births[t]]++;
    sorted[3 * to] = triangles[3 * t];
    sorted[3 * to + 1] = triangles[3 * t + 1];
    sorted[3 * to + 2] = triangles[3 * t + 2];
    sortedBirths[to] = births[t];
  }
  mesh.triangles = sorted;
  return sortedBirths;
}

// The first index whose value is not below the limit.
function lowerBound(values, limit) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

export class Levels {
  constructor(mesh) {
    this.mesh = mesh;
    this.groups = groupStarts(mesh);
    this.births = sortByBirth(mesh, this.groups);
  }

  // The finest level with at most this number of vertices, whole groups of wedges.
  verticesFor(most) {
    const {vertexCount, baseVertices} = this.mesh;
    return most >= vertexCount ? vertexCount : Math.max(this.groups[most], baseVertices);
  }
  verticesForTriangles(most) {
    const {vertexCount, baseVertices} = this.mesh;
    return most >= this.trianglesOf(vertexCount) ? vertexCount : Math.max(this.births[most], baseVertices);
  }
  // The coarsest level whose error is at most this (normalised).
  verticesForError(error) {
    const {errors, vertexCount, baseVertices} = this.mesh;
    let low = 0, high = errors.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (errors[middle] > error) low = middle + 1;
      else high = middle;
    }
    return low >= errors.length ? vertexCount : Math.max(low, baseVertices);
  }
  trianglesOf(vertices) { return lowerBound(this.births, vertices); }
  errorOf(vertices) { return vertices < this.mesh.vertexCount ? this.mesh.errors[vertices] : 0; }

  computeLevel(vertices) {
    const {triangles, vertexCount} = this.mesh, out = triangles.slice(0, 3 * this.trianglesOf(vertices));
    if (vertices >= vertexCount) return out;
    const ancestor = this.computeGeomorph(vertices, vertexCount);
    for (let k = 0; k < out.length; ++k) out[k] = ancestor[out[k]];
    return out;
  }

  // The positions of the vertices of a level, best for that level alone; those of the finest level are as they are.
  placeLevel(vertices) {
    const {mesh, groups} = this;
    if (vertices >= mesh.vertexCount) return mesh.positions;
    const ancestors = this.computeGeomorph(vertices, mesh.vertexCount);
    return placeLevel(mesh, {groups, ancestors, triangles: this.computeLevel(vertices), vertices});
  }

  // For every vertex of the finer level, its ancestor in the coarser one.
  computeGeomorph(coarse, fine) {
    const {parents} = this.mesh, ancestor = new Uint32Array(fine), known = Math.min(coarse, fine);
    for (let v = 0; v < known; ++v) ancestor[v] = v;
    for (let v = coarse; v < fine; ++v) ancestor[v] = ancestor[parents[v]];
    return ancestor;
  }
}
