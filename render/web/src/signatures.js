// Signatures: for every vertex, the set of cells of its level that use it (core/hierarchy/model/signatures.h). With radii by
// cell the vertices of one signature travel alike.
import {Problem} from './problem.js';

const single = Math.fround;
const MOST = 255;  // signatures of a cell: a byte tells its vertices theirs

// Gives every cell its `signatures`, first that of the vertices that no other cell uses, and returns those of all levels.
// Each: {cells, parents, error, index}. `levels`: sets of two cells and more, numbered within their level, and errors.
export function addSignatures({cells, finest}, levels, url) {
  const fail = () => { throw new Problem(`${url}: signatures contradict the tiles; the file is damaged`); };
  if (!Array.isArray(levels) || levels.length !== finest + 1 || cells.at(-1).level !== finest) fail();
  const byLevel = levels.map(() => []);
  let count = 0;
  const add = (users, error) => {
    const set = {cells: users, parents: [...new Set(users.map((c) => c.parent))].filter((p) => p !== null), error, index: count++};
    for (const cell of users) if (cell.signatures.push(set) > MOST) fail();
    byLevel[users[0].level].push(set);
  };
  levels.forEach((table, level) => {
    const {cells: sets, errors} = table ?? {}, here = cells.filter((c) => c.level === level);
    for (const cell of here) {
      cell.signatures = [];
      add([cell], 0);
    }
    if (!Array.isArray(sets) || !Array.isArray(errors) || sets.length !== errors.length) fail();
    sets.forEach((numbers, k) => {
      const ascend = Array.isArray(numbers) && numbers.length > 1 && numbers.every((n, i) => here[n]?.level === level && (i === 0 || n > numbers[i - 1]));
      if (!ascend || !(errors[k] >= 0 && errors[k] < Infinity)) fail();
      add(numbers.map((n) => here[n]), errors[k]);
    });
  });
  return byLevel;
}

// By vertex of a tile: the place of its signature among those of the cell, whose vertices are in this order. `counts`: the
// number of each; the vertices of the root do not travel.
export function placesOf({level, signatures, url}, counts, vertices) {
  const places = new Uint8Array(vertices);
  if (level === 0) return places;
  const holds = counts?.length === signatures.length && counts.every((n) => n >= 0) && counts.reduce((sum, n) => sum + n, 0) === vertices;
  if (!holds) throw new Problem(`${url}: signatures of the vertices do not fit; the file is damaged`);
  counts.reduce((at, n, place) => (places.fill(place, at, at + n), at + n), 0);
  return places;
}

// The lambdas of a frame (render/lod/morph.h): how far vertices have come from their parents' places, 0, to their own, 1.
// The same for all of a signature: 0 where a cell of their parents is not refined, 1 where one of their own is, and in
// between by what is missing to either. The ends are the comparisons of selectCells.
export class FrameLambdas {
  // `distanceOf(cell)` is what cells were selected by.
  constructor({signatures, cells}, {byCell}, distanceOf) {
    const last = signatures.at(-1).at(-1);
    Object.assign(this, {byCell, distanceOf, found: new Float32Array(last.index + 1).fill(-1), distances: new Float32Array(cells.length).fill(-1)});
  }

  // In the order of the cell's signatures.
  of({level, signatures}) {
    if (level === 0) return [1];
    const {found} = this;
    return signatures.map((set) => {
      if (found[set.index] < 0) found[set.index] = this.lambda(set);
      return found[set.index];
    });
  }

  lambda({cells, parents}) {
    const nearest = parents.reduce((least, cell) => Math.min(least, this.within(cell)), Infinity);
    if (nearest <= 0) return 0;
    const own = cells.reduce((most, cell) => Math.max(most, this.within(cell)), -Infinity);
    return own >= 0 ? 1 : single(1 - single(-own / single(nearest - own)));
  }

  // By how much the viewpoint is nearer than the radius.
  within(cell) {
    const {distances, byCell} = this, {index} = cell;
    if (distances[index] < 0) distances[index] = this.distanceOf(cell);
    return single(byCell[index] - distances[index]);
  }
}
