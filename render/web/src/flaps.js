// Parts that were cut off at edges of more than two triangles and are too small to collapse: core/progressive/mesh/flaps.h.

export function delayFlaps(mesh, groups, births) {
  const {baseVertices: base, vertexCount, positions: p, parents, triangles} = mesh;
  const root = Uint32Array.from({length: base}, (_, v) => v), whole = new Uint8Array(base).fill(1);
  const find = (v) => {
    while (root[v] !== v) v = root[v] = root[root[v]];
    return v;
  };
  const part = (v) => find(groups[v]);

  const splits = new Uint8Array(base);
  for (let v = base; v < vertexCount; ++v) if (parents[v] < base) splits[groups[parents[v]]] = 1;
  for (let t = 0; t < triangles.length; t += 3) {
    const corners = triangles.subarray(t, t + 3), inside = corners.every((v) => v < base);
    for (const v of corners) {
      if (v >= base) continue;
      if (!inside) splits[groups[v]] = 1;
      else {
        const a = part(v), b = part(corners[0]);
        root[Math.max(a, b)] = Math.min(a, b);
      }
    }
  }
  for (let v = 0; v < base; ++v) if (splits[v]) whole[part(v)] = 0;
  const isWhole = (v) => whole[part(v)] === 1, candidates = [];
  for (let v = 0; v < base; ++v) if (groups[v] === v && isWhole(v)) candidates.push(v);
  if (candidates.length === 0) return;

  const key = (v) => `${p[3 * v] + 0},${p[3 * v + 1] + 0},${p[3 * v + 2] + 0}`, found = new Map(candidates.map((v) => [key(v), false]));
  const touches = new Set(), loose = new Set();
  for (let v = 0; v < vertexCount; ++v) if (v >= base || !isWhole(v)) {
    const at = key(v);
    if (found.has(at)) found.set(at, true);
  }
  for (const v of candidates) (found.get(key(v)) ? touches : loose).add(part(v));
  for (const v of candidates) if (!touches.has(part(v))) whole[part(v)] = 0;

  const starts = startsOf(mesh, groups, part, isWhole, loose);
  for (let t = 0; t < births.length; ++t) {
    const v = triangles[3 * t];
    if (v < base && isWhole(v)) births[t] = Math.max(births[t], starts.get(part(v)));
  }
}

// By part: its triangles are in the levels of more vertices than this.
function startsOf({baseVertices, positions, errors}, groups, part, isWhole, loose) {
  const boxes = new Map(), starts = new Map();
  for (let v = 0; v < baseVertices; ++v) {
    if (!isWhole(v)) continue;
    if (!boxes.has(part(v))) boxes.set(part(v), {low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity]});
    const {low, high} = boxes.get(part(v));
    for (let i = 0; i < 3; ++i) {
      low[i] = Math.min(low[i], positions[3 * v + i]);
      high[i] = Math.max(high[i], positions[3 * v + i]);
    }
  }
  for (const [at, {low, high}] of boxes) {
    const sides = [0, 1, 2].map((i) => high[i] - low[i]), far = (loose.has(at) ? 1 : 0.5) * Math.sqrt(sides.reduce((sum, s) => sum + s * s, 0));
    let first = 0, end = errors.length;
    while (first < end) {
      const middle = (first + end) >> 1;
      if (errors[middle] >= far) first = middle + 1;
      else end = middle;
    }
    starts.set(at, first <= baseVertices ? 0 : groups[first - 1]);
  }
  return starts;
}
