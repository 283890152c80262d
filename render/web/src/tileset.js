// A tileset of `lodestone export --tiles --morph` as a tree of cells, and the rules of drawing it: render/lod/radii.h and
// selection.h. Distances are in the unit cube of the model.
import {limitedBoxDistance} from './limits.js';
import {Problem} from './problem.js';

// Bytes of a texture with its mipmaps.
export const textureBytes = (texels) => Math.ceil(4 * texels * 4 / 3);

const GUARD = 4e-6;  // relative, for the rounding of 32-bit floats in the shader

const MOST_CELLS = 4e6;
const isCount = (n) => Number.isInteger(n) && n >= 0 && n < 2 ** 32;
const isBox = (b) => Array.isArray(b) && b.length === 6 && b.every(Number.isFinite) && [0, 1, 2].every((i) => b[i] <= b[i + 3]);
const areFigures = ({sigma0, scale, reach, error}) => sigma0 > 0 && scale > 0 && Array.isArray(reach) && Array.isArray(error) && reach.length > 0 &&
  reach.length === error.length && reach.every((r) => Number.isFinite(r?.euclidean)) && error.every(Number.isFinite);

// The figures of the levels in a tileset's JSON.
export function figuresOf(json, url) {
  const figures = json.extras?.lodestone;
  if (!figures) throw new Problem(`${url}: has no figures for morphing; export it with --morph`);
  if (!areFigures(figures)) throw new Problem(`${url}: the figures of its levels contradict each other; the file is damaged`);
  const {sigma0, scale, reach, error} = figures;
  return {sigma0, scale, reach: reach.map((r) => r.euclidean), error, finest: reach.length - 1};
}

export async function loadTileset(url, fetchJson) {
  const json = await fetchJson(url), figures = figuresOf(json, url), {texels = {}, thumbnails: files = {}} = json.extras.lodestone;
  const cells = [];
  // Large trees are cut into tilesets of their own, one folder below.
  const visit = async (tile, base, parent, cut = false) => {
    const content = tile.content?.uri;
    if (content?.endsWith('.json') && !cut) {
      const at = new URL(content, base);
      return visit((await fetchJson(at.href)).root, at, parent, true);
    }
    const {level, bounds, vertices = 0, triangles = 0, textures = []} = tile.extras ?? {};
    const holds = level === (parent === null ? 0 : parent.level + 1) && level < figures.reach.length && isBox(bounds) &&
      isCount(vertices) && isCount(triangles) && cells.length < MOST_CELLS;
    if (!holds) throw new Problem(`${base.href}: level, box or counts of a tile cannot be; the file is damaged`);
    const cell = {level, bounds, vertices, triangles, parent, children: [], url: content ? new URL(content, base).href : null,
                  textures: textures.map((uri) => [new URL(uri, url).href, textureBytes(texels[uri] ?? 0)])};
    cells.push(cell);
    for (const child of tile.children ?? []) cell.children.push(await visit(child, base, cell));
    return cell;
  };
  const root = await visit(json.root, new URL(url), null);
  cells.sort((a, b) => a.level - b.level);  // numbered as in the .lode file: level by level
  cells.forEach((cell, index) => Object.assign(cell, {index}));
  const thumbnails = new Map(Object.entries(files).map((pair) => pair.map((uri) => new URL(uri, url).href)));
  // The model's; older files have z up, and no turn in the transform.
  const {up = 'z', origin = json.root.transform?.slice(12, 15) ?? [0, 0, 0]} = json.extras.lodestone;
  return {...figures, root, cells, origin, up, thumbnails};
}

// Per level: r_l, and the band in which its vertices travel. Radii are 32-bit floats, as limits are made of them, rounded
// up so that the tolerance holds.
export function makeRadii({reach, error, finest}, {pixels, height, fov, aspect, beta = 0.5}) {
  const half = Math.tan(fov / 2), corner = 1 + half * half * (1 + aspect * aspect);
  const wanted = (l) => 2 ** -l * error[l] * height / (2 * pixels * half) * corner;
  const select = new Array(finest + 1).fill(0), begin = new Array(finest + 1).fill(0), end = new Array(finest + 1).fill(Infinity);
  for (let l = finest; l >= 1; --l) {
    const h = 2 ** -l, last = l === finest, from = last ? 0 : (select[l] + reach[l] * h) * (1 + GUARD);
    select[l - 1] = Math.fround(Math.max(wanted(l - 1), (from + beta * h) / (1 - GUARD) * (1 + GUARD)) * (1 + 2 ** -23));
    end[l] = select[l - 1] * (1 - GUARD);
    begin[l] = last ? Math.max(0, Math.min(end[l] - beta * h, (select[l - 1] / 2 + reach[l] * h) * (1 + GUARD))) : from;
  }
  if (finest >= 1) select[finest] = 0;
  begin[0] = Infinity;
  return {select, begin, end};
}

export function boxDistance(p, [x0, y0, z0, x1, y1, z1]) {
  const out = (lo, hi, v) => Math.max(lo - v, v - hi, 0);
  return Math.hypot(out(x0, x1, p[0]), out(y0, y1, p[1]), out(z0, z1, p[2]));
}

// The cells to draw: coarse to fine, those that the limited distance d' does not ask to refine.
export function selectCells({root, finest}, {select}, viewpoint, limits) {
  const drawn = [];
  const visit = (cell) => {
    const refined = cell.level < finest &&
      Math.max(boxDistance(viewpoint, cell.bounds), limitedBoxDistance(cell.bounds, limits)) < select[cell.level];
    if (refined) cell.children.forEach(visit);
    else drawn.push(cell);
  };
  visit(root);
  return drawn;
}
