// Detail limits: drawing without a crack or a pop where finer cells are not there (render/lod/limits.h). Selection and
// morph take the distance
//
//     d'(x) = max(d(v_p, x), max over limits of R - d(x, Q)),
//
// Q a box and R a radius. The distance from boxes is Chebyshev's: no larger than Euclid's, so that d' is 1-Lipschitz all the
// same, and made of differences and maxima of 32-bit floats alone, which come out in the shader as they do here.

import {radiusOf} from './radii.js';

const single = Math.fround;

// Distances from the box `to`: of a point, and the largest and least of a box's points.
export function pointFrom([x, y, z], to) {
  return Math.max(single(to[0] - x), single(x - to[3]), single(to[1] - y), single(y - to[4]), single(to[2] - z),
                  single(z - to[5]), 0);
}
function farthestFrom(box, to) {
  let far = 0;
  for (let i = 0; i < 3; ++i) far = Math.max(far, single(to[i] - box[i]), single(box[i + 3] - to[i + 3]));
  return far;
}
function nearestTo(box, to) {
  let near = 0;
  for (let i = 0; i < 3; ++i) near = Math.max(near, single(to[i] - box[i + 3]), single(box[i] - to[i + 3]));
  return near;
}

// The limited distance: of a point, and a lower bound for the points of a box.
export const limitedPointDistance = (p, limits) =>
  limits.reduce((d, {box, radius}) => Math.max(d, single(radius - pointFrom(p, box))), 0);
export const limitedBoxDistance = (bounds, limits) =>
  limits.reduce((d, {box, radius}) => Math.max(d, single(radius - farthestFrom(bounds, box))), 0);

// The limits that may exceed a distance of at least `nearest` somewhere in the box, and any other limit as well; the others
// change no bit of d' there. Of many missing tiles around a box few remain, which its vertices are then compared with.
export function limitsNear(bounds, nearest, limits) {
  let least = nearest * (1 - 4e-6), holder = null;  // d' is nowhere less in the box, because of this limit
  for (const limit of limits) {
    const everywhere = single(limit.radius - farthestFrom(bounds, limit.box));
    if (everywhere > least) [least, holder] = [everywhere, limit];
  }
  return limits.filter((limit) => limit === holder || single(limit.radius - nearestTo(bounds, limit.box)) > least);
}

// A distance of which a share changes no vertex by more than its share of the way: no band of levels begins below that of
// the finest, or that has a width; all bands of cells are as wide as those of the finest level.
const nearBand = ({select, begin, end, byCell}, finest) =>
  byCell ? end[finest] - begin[finest] : Math.max(begin[finest], select[finest - 1] / 16);

// The limits of a sequence of frames. The excess R - d(v_p, Q) of a limit sinks and rises geometrically: if it is
// larger than d, d' is at least half of it.
export class LimitTracker {
  constructor() { this.radii = new Map(); }

  // `stateOf(cell)` returns the state of its children, 'there', 'missing', or 'unwanted' (to be removed), for the cells
  // that this view wants to refine. A limit loses or gains a share of its excess in this frame. Returns the limits, the
  // cells whose children are missing, and if any limit differs from those of the last frame.
  update({root, finest}, radii, viewpoint, stateOf, share) {
    const before = this.radii, limits = [], missing = [], least = share * nearBand(radii, finest);
    this.radii = new Map();
    const next = (cell, state, d, full) => {
      const excess = Math.max(Math.min(before.get(cell) ?? 0, full) - d, 0);
      if (state === 'missing') return full;
      if (state === 'unwanted') return Math.min(single(d + Math.max(excess / (1 - share), least)), full);
      return excess * (1 - share) > least ? single(d + excess * (1 - share)) : d;
    };
    const visit = (cell) => {
      if (cell.level === finest) return;
      const full = radiusOf(radii, cell), d = pointFrom(viewpoint, cell.bounds);
      if (d >= full) return;
      const state = stateOf(cell), radius = next(cell, state, d, full);
      if (state === 'missing') missing.push(cell);
      if (radius > d) {
        limits.push({box: cell.bounds, radius});
        this.radii.set(cell, radius);
      }
      if (radius >= full) return;
      cell.children.forEach(visit);
    };
    visit(root);
    const changed = this.radii.size !== before.size || [...this.radii].some(([cell, radius]) => before.get(cell) !== radius);
    return {limits, missing, changed};
  }
}
