// A tileset of `lodestone export --tiles --morph` as a tree of cells, and the rules of drawing it: render/lod/radii.h and
// selection.h. Distances are in the unit cube of the model.

const GUARD = 4e-6;  // relative, for the rounding of 32-bit floats in the shader

export async function loadTileset(url, fetchJson) {
  const json = await fetchJson(url), figures = json.extras?.lodestone;
  if (!figures) throw new Error(`${url}: has no figures for morphing; export it with --morph`);
  const cells = [];
  // Large trees are cut into tilesets of their own, one folder below.
  const visit = async (tile, base) => {
    const content = tile.content?.uri;
    if (content?.endsWith('.json')) {
      const at = new URL(content, base);
      return visit((await fetchJson(at.href)).root, at);
    }
    const {level, bounds} = tile.extras;
    const cell = {level, bounds, url: content ? new URL(content, base).href : null, children: [], state: 'absent'};
    cells.push(cell);
    for (const child of tile.children ?? []) cell.children.push(await visit(child, base));
    return cell;
  };
  const root = await visit(json.root, new URL(url));
  return {root, cells, reach: figures.reach.map((r) => r.euclidean), error: figures.error, finest: figures.reach.length - 1};
}

// Per level: r_l, and the band in which its vertices travel.
export function makeRadii({reach, error, finest}, {pixels, height, fov, aspect, beta = 0.5}) {
  const half = Math.tan(fov / 2), corner = 1 + half * half * (1 + aspect * aspect);
  const wanted = (l) => 2 ** -l * error[l] * height / (2 * pixels * half) * corner;
  const select = new Array(finest + 1).fill(0), begin = new Array(finest + 1).fill(0), end = new Array(finest + 1).fill(Infinity);
  for (let l = finest; l >= 1; --l) {
    const h = 2 ** -l, last = l === finest, from = last ? 0 : (select[l] + reach[l] * h) * (1 + GUARD);
    select[l - 1] = Math.max(wanted(l - 1), (from + beta * h) / (1 - GUARD) * (1 + GUARD));
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

// The cells to draw, of those that are there; `floor`: no distance counts as less, so that what is missing is not asked
// for. `missing` are cells whose children are wanted, nearest first; `least` the floor that would do without them.
export function selectCells({root, finest}, {select}, viewpoint, floor) {
  const drawn = [], missing = [];
  let least = 0;
  const visit = (cell) => {
    const d = boxDistance(viewpoint, cell.bounds), l = cell.level;
    const there = cell.children.every((c) => c.state === 'there' || c.url === null);
    if (l < finest && d < 1.5 * select[l] && !there) {
      missing.push({cell, urgency: d / select[l]});
      if (d < select[l]) least = Math.max(least, select[l]);
    }
    if (l === finest || Math.max(d, floor) >= select[l] || !there) drawn.push(cell);
    else cell.children.forEach(visit);
  };
  visit(root);
  missing.sort((a, b) => a.urgency - b.urgency);
  return {drawn, missing: missing.map((m) => m.cell), least};
}
