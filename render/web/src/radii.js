// From a tolerance to numbers, by the rules of render/lod/radii.h: a radius for every cell where the tileset has
// signatures, for every level elsewhere. Distances are in the unit cube of the model.

const GUARD = Math.fround(4e-6);  // relative, for the rounding of 32-bit floats

// Floats next to one that is not negative, and those on a side of a number.
const float = new Float32Array(1), bits = new Uint32Array(float.buffer);
function neighbour(x, step) {
  float[0] = x;
  bits[0] += step;
  return float[0];
}
const floatAbove = (x) => (x > 0 ? neighbour(x, 1) : 0);
const floatDown = (x) => (Math.fround(x) > x ? neighbour(x, -1) : Math.fround(x));

// {select, begin, end}: per level r_l, and the band in which its vertices travel. With signatures also byCell: R_C by cell,
// on the finest level where the travel begins; then r_l is the largest of the level, and the bands are the narrowest.
export const makeRadii = (tileset, view) => (tileset.signatures ? radiiByCell : radiiByLevel)(tileset, view);

// The same for one view after the other, made anew when it is another one than the last.
export function radiiOfViews(tileset) {
  let last = null;
  return (view) => {
    const key = JSON.stringify(view);
    if (last?.key !== key) last = {key, radii: makeRadii(tileset, view)};
    return last.radii;
  };
}

// The radius at which a cell is refined.
export const radiusOf = ({select, byCell}, {level, index}) => (byCell ? byCell[index] : select[level]);

export const sameRadii = (a, b) => a === b || ['select', 'begin', 'end', 'byCell'].every(
  (k) => a[k]?.length === b[k]?.length && (a[k] ?? []).every((r, i) => r === b[k][i]));

// The radius, over the error, that keeps an error below the tolerance anywhere in a picture, for every lens that has these
// figures in 32 bits.
function radiusOverError({pixels, height, fov, aspect}) {
  const wide = neighbour(aspect, 1);
  return Math.max(...[-1, 1].map((step) => {
    const half = Math.tan(neighbour(fov, step) / 2);
    return height / (2 * pixels * half) * (1 + half * half * (1 + wide * wide));
  }));
}

// Radii are 32-bit floats, as limits are made of them, rounded up so that the tolerance holds.
function radiiByLevel({sides, reach, error, finest}, {beta = 0.5, ...view}) {
  const perError = radiusOverError(view), wanted = (l) => sides[l] * error[l] * perError;
  const select = new Array(finest + 1).fill(0), begin = new Array(finest + 1).fill(0), end = new Array(finest + 1).fill(Infinity);
  for (let l = finest; l >= 1; --l) {
    const h = sides[l], last = l === finest, from = last ? 0 : (select[l] + reach[l] * h) * (1 + GUARD);
    select[l - 1] = Math.fround(Math.max(wanted(l - 1), (from + beta * h) / (1 - GUARD) * (1 + GUARD)) * (1 + 2 ** -23));
    end[l] = select[l - 1] * (1 - GUARD);
    begin[l] = last ? Math.max(0, Math.min(end[l] - beta * h, (select[l - 1] / 2 + reach[l] * h) * (1 + GUARD))) : from;
  }
  if (finest >= 1) select[finest] = 0;
  begin[0] = Infinity;
  return {select, begin, end};
}

// The largest distance of a point of one box from another.
function overhang(inner, outer) {
  let sum = 0;
  for (let i = 0; i < 3; ++i) sum += Math.max(outer[i] - inner[i], inner[i + 3] - outer[i + 3], 0) ** 2;
  return Math.sqrt(sum);
}

// Radii by cell need these, whatever the tolerance is: the error that each cell answers for, its own and those of the
// triangles around the vertices that it shares; and by level, from the finest up, the pairs of a cell and a parent that a
// signature has, with how far points of the first may be from the second.
const needs = new WeakMap();
function needsOf(tileset) {
  if (!needs.has(tileset)) needs.set(tileset, makeNeeds(tileset));
  return needs.get(tileset);
}

function makeNeeds({cells, signatures, finest}) {
  const errors = Float32Array.from(cells, ({error, level}) => (level < finest ? error : 0));
  for (const {cells: users, error} of signatures.slice(0, finest).flat())
    for (const {index} of users) errors[index] = Math.max(errors[index], error);
  const pairs = signatures.slice(1).reverse().map((sets) => {
    const list = sets.flatMap(({cells: users, parents}) => parents.flatMap((parent) => users.map((cell) => [cell, parent])));
    return {cells: Uint32Array.from(list, ([cell]) => cell.index), parents: Uint32Array.from(list, ([, parent]) => parent.index),
            apart: Float64Array.from(list, ([cell, parent]) => overhang(cell.bounds, parent.bounds))};
  });
  return {errors, pairs};
}

// The box rule (docs/decisions/0055), fine to coarse.
function radiiByCell(tileset, {beta = 0.5, ...view}) {
  const {cells, finest, sides} = tileset, {errors, pairs} = needsOf(tileset), perError = radiusOverError(view);
  const byCell = errors.map((error) => floatAbove(error * perError));
  pairs.forEach(({cells: users, parents, apart}, k) => {
    const band = beta * sides[finest - k];
    for (let i = 0; i < users.length; ++i)
      byCell[parents[i]] = Math.max(byCell[parents[i]], floatAbove((byCell[users[i]] + (apart[i] + band)) * (1 + GUARD)));
  });
  beginMorphs(byCell, tileset, pairs[0], beta * sides[finest]);
  return {...bandsOf(byCell, tileset, beta), byCell};
}

// On the finest level, where nothing is refined: half of the way, as far as the constraint leaves room.
function beginMorphs(byCell, {cells, finest}, pairs, band) {
  for (const {index, level} of cells) if (level === finest) byCell[index] = Infinity;
  pairs?.cells.forEach((cell, i) => {
    const radius = byCell[pairs.parents[i]], room = Math.max(radius / (1 + GUARD) - (pairs.apart[i] + band), 0);
    byCell[cell] = Math.min(byCell[cell], floatDown(Math.min(radius / 2, room)));
  });
}

function bandsOf(byCell, {cells, finest, sides}, beta) {
  const begin = new Array(finest + 1).fill(0);
  for (const {index, level} of cells) begin[level] = Math.max(begin[level], byCell[index]);
  const select = begin.map((r, l) => (l === finest ? 0 : r));
  const end = begin.map((r, l) => neighbour(r + beta * sides[l], -1));
  begin[0] = end[0] = Infinity;
  return {select, begin, end};
}
