// A tileset of `lodestone export --tiles --morph` as a tree of cells, and which of them are drawn (render/lod/selection.h).
// Distances are in the unit cube of the model.
import {limitedBoxDistance} from './limits.js';
import {Problem} from './problem.js';
import {radiusOf} from './radii.js';
import {addSignatures} from './signatures.js';

const single = Math.fround;

// Bytes of a texture with its mipmaps.
export const textureBytes = (texels) => Math.ceil(4 * texels * 4 / 3);

const MOST_CELLS = 4e6;
const isCount = (n) => Number.isInteger(n) && n >= 0 && n < 2 ** 32;
const isBox = (b) => Array.isArray(b) && b.length === 6 && b.every(Number.isFinite) && [0, 1, 2].every((i) => b[i] <= b[i + 3]);
const areFigures = ({sigma0, scale, reach, error}) => sigma0 > 0 && scale > 0 && Array.isArray(reach) && Array.isArray(error) && reach.length > 0 &&
  reach.length === error.length && reach.every((r) => Number.isFinite(r?.euclidean)) && error.every(Number.isFinite);

// The figures of the levels in a tileset's JSON.
function figuresOf(json, url) {
  const figures = json.extras?.lodestone;
  if (!figures) throw new Problem(`${url}: has no figures for morphing; export it with --morph`);
  if (!areFigures(figures)) throw new Problem(`${url}: the figures of its levels contradict each other; the file is damaged`);
  const {sigma0, scale, reach, error, half_levels: halves = false} = figures;
  const sides = reach.map((_, l) => 2 ** -(halves ? (l + 1) >> 1 : l));  // of the cells, by level
  return {sigma0, scale, sides, reach: reach.map((r) => r.euclidean), error, finest: reach.length - 1};
}

export async function loadTileset(url, fetchJson) {
  const json = await fetchJson(url), figures = figuresOf(json, url), {texels = {}, thumbnails: files = {}, signatures: table} = json.extras.lodestone;
  const cells = [];
  // Large trees are cut into tilesets of their own, one folder below.
  const visit = async (tile, base, parent, cut = false) => {
    const content = tile.content?.uri;
    if (content?.endsWith('.json') && !cut) {
      const at = new URL(content, base);
      return visit((await fetchJson(at.href)).root, at, parent, true);
    }
    const {level, bounds, error = 0, vertices = 0, triangles = 0, textures = []} = tile.extras ?? {};
    const holds = level === (parent === null ? 0 : parent.level + 1) && level < figures.reach.length && isBox(bounds) &&
      isCount(vertices) && isCount(triangles) && error >= 0 && error < Infinity && cells.length < MOST_CELLS;
    if (!holds) throw new Problem(`${base.href}: level, box, error or counts of a tile cannot be; the file is damaged`);
    const cell = {level, bounds, error, vertices, triangles, parent, children: [], url: content ? new URL(content, base).href : null,
                  textures: textures.map((uri) => [new URL(uri, url).href, textureBytes(texels[uri] ?? 0)])};
    cells.push(cell);
    for (const child of tile.children ?? []) cell.children.push(await visit(child, base, cell));
    return cell;
  };
  const root = await visit(json.root, new URL(url), null);
  cells.sort((a, b) => a.level - b.level);  // numbered as in the .lode file: level by level
  cells.forEach((cell, index) => Object.assign(cell, {index}));
  // Files of older programs have none: radii by level.
  const signatures = table ? addSignatures({cells, finest: figures.finest}, await fetchJson(new URL(table, url).href), url) : null;
  const thumbnails = new Map(Object.entries(files).map((pair) => pair.map((uri) => new URL(uri, url).href)));
  // The model's; older files have z up, and no turn in the transform.
  const {up = 'z', origin = json.root.transform?.slice(12, 15) ?? [0, 0, 0]} = json.extras.lodestone;
  return {...figures, root, cells, signatures, origin, up, thumbnails};
}

// The distance of a box and a viewpoint of 32-bit floats, by the operations of core/hierarchy/model/distance_metric.h.
export function boxDistance([x, y, z], box) {
  const beyond = (i, v) => Math.max(single(box[i] - v), single(v - box[i + 3]), 0), dx = beyond(0, x), dy = beyond(1, y), dz = beyond(2, z);
  return single(Math.sqrt(single(single(single(dx * dx) + single(dy * dy)) + single(dz * dz))));
}

// The limited distance d' of a cell, by which it is refined or not.
export const distanceIn = (viewpoint, limits) => ({bounds}) => Math.max(boxDistance(viewpoint, bounds), limitedBoxDistance(bounds, limits));

// The cells to draw, coarse to fine.
export function selectCells({root, finest}, radii, viewpoint, limits) {
  const drawn = [], distanceOf = distanceIn(viewpoint, limits);
  const visit = (cell) => {
    if (cell.level < finest && distanceOf(cell) < radiusOf(radii, cell)) cell.children.forEach(visit);
    else drawn.push(cell);
  };
  visit(root);
  return drawn;
}
