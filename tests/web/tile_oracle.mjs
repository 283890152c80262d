// The tiles of a tileset in a frame, vertex by vertex, without the page's geometry: the slow twin of the vertex shader.
// A frame: {viewpoint, radii, limits, share, drawn (indices of cells)}, as TilesView.state has it.
import {readFileSync} from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';

const single = Math.fround;

// `byLevel`: as if the tileset had no signatures.
export async function loadOracle(folder, library, {byLevel = false} = {}) {
  const {Glb, loadTileset} = library;
  const root = pathToFileURL(path.join(folder, 'tileset.json')).href;
  const tileset = await loadTileset(root, async (url) => JSON.parse(readFileSync(new URL(url))));
  const tiles = tileset.cells.map((cell) => {
    if (cell.url === null) return null;
    const glb = new Glb(new Uint8Array(readFileSync(new URL(cell.url))), cell.url), {attributes} = glb.json.meshes[0].primitives[0];
    const at = glb.accessor(attributes.POSITION), parent = attributes._PARENT === undefined ? at : glb.accessor(attributes._PARENT);
    return {at, parent, counts: glb.json.meshes[0].extras?.signatures};
  });
  // Sets of cells by level, as the file has them.
  const sets = byLevel ? null : JSON.parse(readFileSync(new URL('signatures.json', root))).map(({cells}) => cells);
  return Object.assign(new Oracle(byLevel ? {...tileset, signatures: null} : tileset, tiles, library, sets), {folder});
}

const key = (a, k) => `${a[k]},${a[k + 1]},${a[k + 2]}`;

class Oracle {
  // `points`: for each vertex of a finest tile the way up, its place and those of its ancestors, finest first; those of one
  // place have one `id`.
  constructor(tileset, tiles, library, sets) {
    Object.assign(this, {tileset, library, points: []});
    this.users = sets && tiles.map((tile, index) => (tile?.counts ? usersOf(tileset, index, tile, sets) : null));
    const ids = new Map();
    const parents = tiles.map((tile) => {
      const to = new Map();
      if (tile) for (let k = 0; k < tile.at.length; k += 3) to.set(key(tile.at, k), [...tile.parent.subarray(k, k + 3)]);
      return to;
    });
    for (const leaf of tileset.cells) {
      if (leaf.level !== tileset.finest || !tiles[leaf.index]) continue;
      for (const [place] of parents[leaf.index]) {
        const way = [place.split(',').map(Number)];
        for (let cell = leaf; cell.parent !== null && way.at(-1); cell = cell.parent) way.push(parents[cell.index].get(way.at(-1).join()));
        // Ancestors that no triangle of their tile uses are in no file: such a vertex is followed as far as it goes.
        if (!ids.has(place)) ids.set(place, ids.size);
        this.points.push({leaf, id: ids.get(place), way: way.filter((p) => p !== undefined)});
      }
    }
  }

  // A function that returns the position of a point in the frame, and the level that draws it; null if its ancestor is
  // in no file.
  places(frame) {
    const drawn = new Map(), {limitsNear, boxDistance} = this.library;
    for (const index of frame.drawn) {
      const {bounds} = this.tileset.cells[index];
      drawn.set(index, limitsNear(bounds, boxDistance(frame.viewpoint, bounds), frame.limits));
    }
    return ({leaf, way}) => {
      let cell = leaf;
      while (!drawn.has(cell.index)) {
        cell = cell.parent;
        if (cell === null) throw new Error('a part of the model is not drawn');
      }
      const {level} = cell, up = leaf.level - level, own = way[up], parent = level === 0 ? own : way[up + 1];
      if (own === undefined || parent === undefined) return null;
      return {level, place: travelled(own, parent, this.users ? this.shareBy(cell, own, frame) : this.shareAt(own, level, frame, drawn.get(cell.index)))};
    };
  }

  // By signature: the cells that use the vertex, and their parents.
  shareBy(cell, own, {viewpoint, radii: {byCell}, limits}) {
    if (cell.level === 0) return 1;
    const within = ({index, bounds: b}) => {
      const a = [0, 1, 2].map((i) => Math.max(single(b[i] - viewpoint[i]), single(viewpoint[i] - b[i + 3]), 0)), squares = a.map((x) => single(x * x));
      const away = ({box, radius}) => single(radius - Math.max(...[0, 1, 2].map((i) => Math.max(single(box[i] - b[i]), single(b[i + 3] - box[i + 3]), 0))));
      return single(byCell[index] - Math.max(single(Math.sqrt(single(single(squares[0] + squares[1]) + squares[2]))), ...limits.map(away)));
    };
    const users = this.users[cell.index].get(own.join()), least = Math.min(...users.map((c) => within(c.parent))), most = Math.max(...users.map(within));
    if (least <= 0) return 0;
    return most >= 0 ? 1 : single(1 - single(-most / single(least - most)));
  }

  shareAt(own, level, {viewpoint, radii}, limits) {
    const a = own.map((x, i) => single(Math.abs(single(x - viewpoint[i]))));
    const squares = a.map((x) => single(x * x));
    const d = Math.max(single(Math.sqrt(single(single(squares[0] + squares[1]) + squares[2]))),
                       this.library.limitedPointDistance(own, limits));
    const begin = single(Math.min(radii.begin[level], 3e38)), end = single(Math.min(radii.end[level], 3e38));
    if (d < begin) return 1;
    if (d >= end) return 0;
    return single(1 - single(single(d - begin) / single(end - begin)));
  }

  // Vertices of the finest level that do not have one position wherever they are used.
  cracks(frame) {
    const stands = this.places(frame), first = [];
    let cracks = 0;
    for (const point of this.points) {
      const found = stands(point);
      if (found === null) continue;
      const before = first[point.id] ??= found.place;
      if (found.place.some((x, i) => x !== before[i])) ++cracks;
    }
    return cracks;
  }

  // The largest jump between two frames, over the bound from the way of the viewpoint and the share that limits changed
  // by (experiments/metrics/pops/pops.h, with the way of each vertex to its parent instead of its maximum). `every`:
  // one of this number of points is tested, another one in each frame.
  jump(before, after, every = 1, from = 0) {
    const was = this.places(before), is = this.places(after), shares = this.shares(before, after);
    let ratio = 0, largest = 0;
    for (let k = from % every; k < this.points.length; k += every) {
      const {leaf, way} = this.points[k], a = was(this.points[k]), b = is(this.points[k]);
      if (a === null || b === null) continue;
      const far = Math.hypot(...a.place.map((x, i) => x - b.place[i])) - 1.2e-6;
      if (far <= 0) continue;
      let bound = 0;
      for (let l = Math.min(a.level, b.level); l <= Math.max(a.level, b.level); ++l) {
        const [own, parent] = way.slice(leaf.level - l);
        if (l > 0) bound = Math.max(bound, shares[l] * Math.hypot(...own.map((x, i) => x - parent[i])));
      }
      largest = Math.max(largest, far);
      ratio = Math.max(ratio, far / bound);
    }
    return {ratio, largest};
  }

  // Maximum change of lambda at each level.
  shares(before, after) {
    const step = Math.hypot(...after.viewpoint.map((x, i) => x - before.viewpoint[i]));
    return before.radii.select.map((_, l) => {
      const width = ({radii}) => radii.end[l] - radii.begin[l];
      const moved = Math.max(...['begin', 'end'].map((k) => Math.abs(after.radii[k][l] - before.radii[k][l])));
      const end = Math.max(before.radii.end[l], after.radii.end[l]);
      return (step + moved + end * (4.8e-7 - 2 * Math.log(1 - after.share))) / Math.min(width(before), width(after));
    });
  }
}

// By place of a vertex, the cells of its signature: the cell alone first, then sets in the order of the file.
function usersOf({cells}, index, {at, counts}, sets) {
  const {level} = cells[index], first = cells.findIndex((c) => c.level === level), users = new Map();
  const own = [[index - first], ...sets[level].filter((set) => set.includes(index - first))].map((set) => set.map((n) => cells[first + n]));
  let k = 0;
  counts.forEach((count, place) => {
    for (const end = k + 3 * count; k < end; k += 3) users.set(key(at, k), own[place]);
  });
  return users;
}

function travelled(own, parent, share) {
  if (share >= 1) return own;
  if (share <= 0) return parent;
  const rest = single(1 - share);
  return own.map((x, i) => single(single(share * x) + single(rest * parent[i])));
}
