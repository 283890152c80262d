// The best positions of the vertices of a level: core/progressive/mesh/placement.h, step by step.

const STIFFNESS = 1e-3, MIN_COSINE = 0.5, MAX_COST_RATIO = 2, PARABOLA_STEP = 1e-3;
const XX = 0, XY = 1, XZ = 2, YY = 3, YZ = 4, ZZ = 5, BX = 6, BY = 7, BZ = 8, C = 9, WEIGHT = 10, SIZE = 11;  // of a quadric

const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.sqrt(dot(a, a));
const along = (a, t, d) => [a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]];

function nearestOnSegment(p, a, b) {
  const ab = sub(b, a), share = dot(sub(p, a), ab), whole = dot(ab, ab);
  return !(share > 0) || !(whole > 0) ? a : share >= whole ? b : along(a, share / whole, ab);
}

function nearestOnTriangle(p, a, b, c) {
  const ab = sub(b, a), ac = sub(c, a), ap = sub(p, a), normal = cross(ab, ac), area2 = dot(normal, normal);
  const wb = dot(cross(ap, ac), normal), wc = dot(cross(ab, ap), normal), wa = area2 - wb - wc;
  const sliver = !(area2 > 1e-8 * dot(ab, ab) * dot(ac, ac));
  let best = a, least = dot(ap, ap);
  const consider = (q) => {
    const way = sub(p, q), square = dot(way, way);
    if (square < least) [best, least] = [q, square];
  };
  if (area2 > 0 && wa >= 0 && wb >= 0 && wc >= 0) {
    best = along(along(a, wb / area2, ab), wc / area2, ac);
    least = dot(sub(p, best), sub(p, best));
    if (!sliver) return {point: best, square: least};
  }
  if (sliver || wc < 0) consider(nearestOnSegment(p, a, b));
  if (sliver || wa < 0) consider(nearestOnSegment(p, b, c));
  if (sliver || wb < 0) consider(nearestOnSegment(p, c, a));
  return {point: best, square: least};
}

function barycentric(p, a, b, c) {
  const ab = sub(b, a), ac = sub(c, a), normal = cross(ab, ac), whole = dot(normal, normal);
  if (!(whole > 0)) return [1 / 3, 1 / 3, 1 / 3];
  const second = dot(cross(sub(p, a), ac), normal) / whole, third = dot(cross(ab, sub(p, a)), normal) / whole;
  return [1 - second - third, second, third];
}

class Placer {
  // `level`: {groups, ancestors, triangles, vertices}, as of Levels.
  constructor(mesh, level) {
    Object.assign(this, {mesh, ...level});
    this.positions = mesh.positions.slice(0, 3 * this.vertices);
    this.fixed = new Uint8Array(this.vertices);
    this.planes = new Float64Array(SIZE * this.vertices);
    this.areas = new Float32Array(mesh.vertexCount);
    this.alongNormals = Boolean(mesh.uv || mesh.colours || mesh.hasNormals);
  }

  run() {
    const {vertices, positions} = this;
    this.findSites();
    this.listStars();
    this.fixBorders();
    this.addPlanes();
    this.forFreeSites((v) => this.moveToPlanes(v));
    this.findPulls();
    this.forFreeSites((v) => this.followPull(v));
    for (let v = 0; v < vertices; ++v) positions.copyWithin(3 * v, 3 * this.sites[v], 3 * this.sites[v] + 3);
    return positions;
  }

  forFreeSites(body) {
    for (let v = 0; v < this.vertices; ++v) if (this.sites[v] === v && !this.fixed[v]) body(v);
  }
  at(v) { return this.positions.subarray(3 * v, 3 * v + 3); }

  findSites() {
    const {groups, vertices, positions: p, fixed} = this, sites = groups.slice(0, vertices), order = [];
    for (let v = 0; v < vertices; ++v) if (groups[v] === v) order.push(v);
    order.sort((a, b) => p[3 * a] - p[3 * b] || p[3 * a + 1] - p[3 * b + 1] || p[3 * a + 2] - p[3 * b + 2] || a - b);
    const same = (a, b) => p[3 * a] === p[3 * b] && p[3 * a + 1] === p[3 * b + 1] && p[3 * a + 2] === p[3 * b + 2];
    for (let k = 1; k < order.length; ++k) if (same(order[k - 1], order[k])) sites[order[k]] = sites[order[k - 1]];
    for (let v = 0; v < vertices; ++v) {
      sites[v] = sites[groups[v]];
      if (groups[v] !== v) fixed[sites[v]] = 1;
    }
    this.sites = sites;
  }

  listStars() {
    const {triangles, sites, vertices} = this, begin = new Uint32Array(vertices + 1);
    for (const v of triangles) ++begin[sites[v] + 1];
    for (let k = 1; k <= vertices; ++k) begin[k] += begin[k - 1];
    const fill = begin.slice(), stars = new Uint32Array(triangles.length);
    for (let k = 0; k < triangles.length; ++k) stars[fill[sites[triangles[k]]]++] = 3 * Math.floor(k / 3);
    Object.assign(this, {begin, stars});
  }

  // Calls body(a, b) with the other two corners of every triangle around a site.
  forStar(site, body) {
    const {triangles, sites, begin, stars} = this;
    for (let k = begin[site]; k < begin[site + 1]; ++k) {
      const t = stars[k], a = sites[triangles[t]], b = sites[triangles[t + 1]], c = sites[triangles[t + 2]];
      if (a === site) body(b, c);
      else if (b === site) body(c, a);
      else body(a, b);
    }
  }

  fixBorders() {
    this.forFreeSites((v) => {
      const times = new Map(), count = (x) => times.set(x, (times.get(x) ?? 0) + 1);
      this.forStar(v, (a, b) => { count(a), count(b); });
      if (times.size === 0 || [...times.values()].some((n) => n < 2)) this.fixed[v] = 1;
    });
  }

  addPlanes() {
    const {mesh, sites, ancestors, planes, areas} = this, {positions: p, triangles} = mesh;
    for (let t = 0; t < triangles.length; t += 3) {
      const [i, j, k] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
      const ax = p[j] - p[i], ay = p[j + 1] - p[i + 1], az = p[j + 2] - p[i + 2];
      const bx = p[k] - p[i], by = p[k + 1] - p[i + 1], bz = p[k + 2] - p[i + 2];
      let x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
      const size = Math.sqrt(x * x + y * y + z * z);
      if (!(size > 0)) continue;
      x *= 1 / size, y *= 1 / size, z *= 1 / size;
      const d = -(x * p[i] + y * p[i + 1] + z * p[i + 2]);
      for (let corner = 0; corner < 3; ++corner) {
        const v = triangles[t + corner], q = SIZE * sites[ancestors[v]];
        areas[v] += Math.fround(size);
        planes[q + XX] += size * x * x, planes[q + XY] += size * x * y, planes[q + XZ] += size * x * z;
        planes[q + YY] += size * y * y, planes[q + YZ] += size * y * z, planes[q + ZZ] += size * z * z;
        planes[q + BX] += size * d * x, planes[q + BY] += size * d * y, planes[q + BZ] += size * d * z;
        planes[q + C] += size * d * d, planes[q + WEIGHT] += size;
      }
    }
  }

  times(q, x) {
    const {planes: m} = this;
    return [m[q + XX] * x[0] + m[q + XY] * x[1] + m[q + XZ] * x[2], m[q + XY] * x[0] + m[q + YY] * x[1] + m[q + YZ] * x[2],
            m[q + XZ] * x[0] + m[q + YZ] * x[1] + m[q + ZZ] * x[2]];
  }
  // The mean squared distance from the planes.
  cost(v, x) {
    const q = SIZE * v, {planes: m} = this;
    if (!(m[q + WEIGHT] > 0)) return 0;
    const sum = dot(x, this.times(q, x)) + 2 * (m[q + BX] * x[0] + m[q + BY] * x[1] + m[q + BZ] * x[2]) + m[q + C];
    return sum > 0 ? sum / m[q + WEIGHT] : 0;
  }
  minimumNear(v, p) {
    const q = SIZE * v, {planes: m} = this, s = STIFFNESS * m[q + WEIGHT];
    if (!(m[q + WEIGHT] > 0)) return p;
    const xy = m[q + XY], xz = m[q + XZ], yz = m[q + YZ], a = m[q + XX] + s, d = m[q + YY] + s, f = m[q + ZZ] + s;
    const g = this.times(q, p).map((x, k) => x + m[q + BX + k]);
    const c00 = d * f - yz * yz, c01 = xz * yz - xy * f, c02 = xy * yz - xz * d;
    const c11 = a * f - xz * xz, c12 = xy * xz - a * yz, c22 = a * d - xy * xy;
    const determinant = a * c00 + xy * c01 + xz * c02;
    if (!(determinant > 0)) return p;
    const x = along(p, -1 / determinant, [dot([c00, c01, c02], g), dot([c01, c11, c12], g), dot([c02, c12, c22], g)]);
    return x.every(Number.isFinite) ? x : p;
  }

  normal(v) {
    const from = this.at(v), sum = [0, 0, 0];
    this.forStar(v, (a, b) => {
      const part = cross(sub(this.at(a), from), sub(this.at(b), from));
      for (let i = 0; i < 3; ++i) sum[i] += part[i];
    });
    const size = length(sum);
    return size > 0 ? sum.map((x) => x / size) : [0, 0, 0];
  }
  nearestToPlanes(v) {
    const from = this.at(v);
    if (!this.alongNormals) return this.minimumNear(v, from);
    const way = this.normal(v), here = this.cost(v, from);
    const above = this.cost(v, along(from, PARABOLA_STEP, way)), below = this.cost(v, along(from, -PARABOLA_STEP, way));
    const bend = above + below - 2 * here;
    return bend > 0 ? along(from, ((below - above) / (2 * bend)) * PARABOLA_STEP, way) : from;
  }

  moveToPlanes(v) {
    const from = this.at(v), to = this.nearestToPlanes(v);
    let longest = 0;
    this.forStar(v, (a, b) => {
      longest = Math.max(longest, length(sub(this.at(a), from)), length(sub(this.at(b), from)));
    });
    if (length(sub(to, from)) <= longest && !this.turns(v, to)) from.set(to);
  }

  findPulls() {
    const {mesh, sites, ancestors, triangles, begin, stars, areas} = this, pulls = new Float64Array(4 * this.vertices);
    for (let v = 0; v < mesh.vertexCount; ++v) {
      const p = mesh.positions.subarray(3 * v, 3 * v + 3), site = sites[ancestors[v]];
      let least = Infinity, point, corners;
      for (let k = begin[site]; k < begin[site + 1]; ++k) {
        const here = [0, 1, 2].map((i) => sites[triangles[stars[k] + i]]);
        const near = nearestOnTriangle(p, this.at(here[0]), this.at(here[1]), this.at(here[2]));
        if (near.square < least) [least, point, corners] = [near.square, near.point, here];
      }
      if (!corners) continue;
      const shares = barycentric(point, ...corners.map((x) => this.at(x)));
      corners.forEach((x, k) => {
        const weight = areas[v] * Math.max(shares[k], 0);
        for (let i = 0; i < 3; ++i) pulls[4 * x + i] += weight * (p[i] - point[i]);
        pulls[4 * x + 3] += weight;
      });
    }
    this.pulls = pulls;
  }

  followPull(v) {
    const [x, y, z, weight] = this.pulls.subarray(4 * v, 4 * v + 4), from = this.at(v);
    if (!(weight > 0)) return;
    let way = [x / weight, y / weight, z / weight];
    if (this.alongNormals) {
      const normal = this.normal(v), share = dot(way, normal);
      way = normal.map((c) => share * c);
    }
    const to = along(from, 1, way);
    if (this.cost(v, to) <= MAX_COST_RATIO * this.cost(v, from) && !this.turns(v, to)) from.set(to);
  }

  turns(v, to) {
    const from = this.at(v);
    let found = false;
    this.forStar(v, (first, second) => {
      const a = this.at(first), b = this.at(second);
      const before = cross(sub(a, from), sub(b, from)), after = cross(sub(a, to), sub(b, to)), size = length(before);
      if (size > 0 && !(dot(before, after) > MIN_COSINE * size * length(after))) found = true;
    });
    return found;
  }
}

export const placeLevel = (mesh, level) => new Placer(mesh, level).run();
