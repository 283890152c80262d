// A mesh that grows by vertex splits: core/progressive/mesh/split_mesh.h, step by step.

export const contradiction = () => new Error('the splits contradict each other');
export const INSIDE = 0, BACK = 1, FRONT = 2;

export class Star {
  constructor(open, firstWedge, wedges) {
    this.vertices = [];  // of the spokes
    this.wedges = [];    // of the vertex in the middle, in the sector behind each spoke
    this.open = open;
    this.firstWedge = firstWedge;
    this.wedgeCount = wedges;
  }
  get size() { return this.vertices.length; }
  get sectors() { return this.vertices.length - (this.open ? 1 : 0); }
  next(k) { return k + 1 < this.vertices.length ? k + 1 : 0; }
  previous(k) { return k > 0 ? k - 1 : this.vertices.length - 1; }
  find(vertex) {
    const k = this.vertices.indexOf(vertex);
    if (k < 0) throw contradiction();
    return k;
  }
}

export class SplitMesh {
  constructor() {
    this.stars = [];
    this.parents = [];  // of the wedges that came in by splits
    this.wedgeCount = 0;
  }

  fits(s) {
    if (s.parent >= this.stars.length) return false;
    const u = this.stars[s.parent], size = u.size;
    if (s.side === INSIDE)
      return size >= 2 && s.at < size && (u.open ? s.at + s.between + 1 < size : s.between + 2 <= size);
    if (!u.open || s.between + 1 > size) return false;
    return s.side === FRONT ? s.at === s.between : s.at + s.between + 1 === size;
  }

  starOf(s) {
    const u = this.stars[s.parent], v = new Star(s.side !== INSIDE, this.wedgeCount, 1);
    if (s.side === FRONT) {
      v.vertices = u.vertices.slice(0, s.between + 1);
      v.vertices.push(s.parent);
      return v;
    }
    v.vertices.push(s.parent);
    let k = s.at;
    for (let n = 0; n < s.between + (s.side === INSIDE ? 2 : 1); ++n, k = u.next(k)) v.vertices.push(u.vertices[k]);
    return v;
  }

  apply(s, v) {
    const id = this.stars.length, u = this.stars[s.parent];
    const parentWedge = (sector) => s.parents[v.wedges[sector] - v.firstWedge];
    const withA = s.side !== FRONT, withB = s.side !== BACK, first = withA ? 2 : 0;
    for (let k = first; k < first + s.between; ++k) {
      const x = this.stars[v.vertices[k]];
      x.vertices[x.find(s.parent)] = id;
    }
    if (withA) {
      const a = this.stars[v.vertices[1]], at = a.find(s.parent);
      a.vertices.splice(at, 0, id);
      a.wedges.splice(at, 0, s.wedgeA);
    }
    if (withB) {
      const b = this.stars[v.vertices[s.side === FRONT ? s.between : v.size - 1]], at = b.find(s.parent);
      b.vertices.splice(at + 1, 0, id);
      b.wedges.splice(at + 1, 0, b.wedges[at]);
      b.wedges[at] = s.wedgeB;
    }
    this.replaceSpokes(s, u, v, id, parentWedge);
    v.wedgeCount = s.parents.length;
    this.wedgeCount += v.wedgeCount;
    this.parents.push(...s.parents);
    this.stars.push(v);
  }

  // The parent's star: a, the new vertex, b.
  replaceSpokes(s, u, v, id, parentWedge) {
    const last = v.sectors - 1, keep = (from, to) => [u.vertices.slice(from, to), u.wedges.slice(from, to)];
    let vertices, wedges;
    if (s.side === FRONT) {
      [vertices, wedges] = keep(s.at);
      vertices.unshift(id);
      wedges.unshift(parentWedge(last));
    } else if (s.side === BACK) {
      [vertices, wedges] = keep(0, s.at + 1);
      wedges[wedges.length - 1] = parentWedge(0);
      vertices.push(id);
      wedges.push(parentWedge(0));
    } else {
      const wraps = s.at + s.between + 1 >= u.size, b = (s.at + s.between + 1) % u.size;
      [vertices, wedges] = keep(wraps ? b : 0, s.at + 1);
      wedges[wedges.length - 1] = parentWedge(0);
      vertices.push(id);
      wedges.push(parentWedge(last));
      if (!wraps) {
        const [moreVertices, moreWedges] = keep(b);
        vertices.push(...moreVertices);
        wedges.push(...moreWedges);
      }
    }
    u.vertices = vertices;
    u.wedges = wedges;
  }

  // Three wedges each, one after the other.
  triangles() {
    const out = [];
    const wedgeAt = (vertex, spoke, behind) => {
      const star = this.stars[vertex];
      for (let k = 0; k < star.sectors; ++k)
        if (star.vertices[k] === spoke && star.vertices[star.next(k)] === behind) return star.wedges[k];
      throw contradiction();
    };
    for (let v = 0; v < this.stars.length; ++v) {
      const star = this.stars[v];
      for (let k = 0; k < star.sectors; ++k) {
        const a = star.vertices[k], b = star.vertices[star.next(k)];
        if (v < a && v < b) out.push(star.wedges[k], wedgeAt(a, b, v), wedgeAt(b, v, a));
      }
    }
    return Uint32Array.from(out);
  }
}
