// The code of a vertex split, read: core/progressive/lpm/split_codec.h. Predictions are the same operations on doubles in the
// same order, so that they are the same numbers.
import {NumberModel, SignedModel, TreeModel, bitModels} from './range_decoder.js';
import {BACK, FRONT, INSIDE, Star, contradiction} from './split_mesh.js';

const bitsFor = (count) => (count < 2 ? 0 : 32 - Math.clz32(count - 1));
const rounded = (x) => Math.floor(x + 0.5);
const many = (count, make) => Array.from({length: count}, make);

export class SplitCodec {
  constructor(settings, mesh, values) {
    Object.assign(this, {settings, mesh, values});
    this.numbers = many(2, () => new NumberModel());
    this.steps = new NumberModel();  // from one parent to the next
    this.lastParent = 0;
    this.side = bitModels(2);
    this.between = many(12, () => new NumberModel());
    this.at = many(16, () => new TreeModel(4));
    this.count = many(4, () => new NumberModel());
    this.single = bitModels(3);  // same sector, from, which
    this.besideA = bitModels(2);
    this.besideB = bitModels(2);
    this.error = new NumberModel();
    this.material = new NumberModel();
    this.position = many(2, () => many(16, () => new SignedModel()));
    this.uv = many(16, () => new SignedModel());
    this.colour = many(4, () => new SignedModel());
  }

  decode(coder) {
    const split = this.decodePlace(coder);
    if (!this.mesh.fits(split)) throw contradiction();
    const star = this.mesh.starOf(split);
    this.decodeWedges(coder, split, star);
    this.decodeValues(coder, split, star);
    this.mesh.apply(split, star);
  }

  decodeBase(coder, count) {
    const {mesh, values, settings} = this;
    for (let v = 0; v < count; ++v) {
      const wedges = this.numbers[0].decode(coder);
      if (wedges === 0 || wedges > 65536) throw contradiction();
      mesh.stars.push(new Star(false, mesh.wedgeCount, wedges));
      mesh.wedgeCount += wedges;
      const p = [];
      for (let i = 0; i < 3; ++i) p.push(coder.direct(settings.positionBits + 1));
      values.positions.push(p);
      this.decodeError(coder);
      for (let w = 0; w < wedges; ++w) this.decodeBaseWedge(coder);
    }
    for (let v = 0; v < count; ++v) this.decodeBaseStar(coder, v);
    for (let v = 0; v < count; ++v)
      for (const x of mesh.stars[v].vertices) {
        if (x === v) throw contradiction();
        mesh.stars[x].find(v);
      }
  }

  decodeBaseWedge(coder) {
    const {values, settings} = this;
    if (settings.materialIds) values.materials.push(this.material.decode(coder) - 1);
    if (settings.uv) values.uv.push([coder.direct(settings.uvBits + 1), coder.direct(settings.uvBits + 1)]);
    if (settings.colours) values.colours.push([0, 1, 2, 3].map(() => coder.direct(8)));
  }

  decodeBaseStar(coder, v) {
    const star = this.mesh.stars[v], count = this.mesh.stars.length;
    star.open = coder.direct(1) !== 0;
    const size = this.numbers[1].decode(coder);
    if (size < 2 || size > 1 << 20) throw contradiction();
    for (let k = 0; k < size; ++k) {
      const vertex = coder.direct(bitsFor(count));
      if (vertex >= count) throw contradiction();
      const wedge = coder.direct(bitsFor(star.wedgeCount));
      if (wedge >= star.wedgeCount) throw contradiction();
      star.vertices.push(vertex);
      star.wedges.push(star.firstWedge + wedge);
    }
  }

  decodePlace(coder) {
    const count = this.mesh.stars.length, steps = this.steps.decode(coder);
    if (steps >= count) throw contradiction();
    const s = {parent: (this.lastParent + steps) % count, side: INSIDE};
    this.lastParent = s.parent;
    const u = this.mesh.stars[s.parent], size = u.size;
    if (u.open && coder.bit(this.side, 0) !== 0) s.side = BACK + coder.bit(this.side, 1);
    s.between = this.between[Math.min(size, 11)].decode(coder);
    if (s.side === FRONT) {
      s.at = s.between;
    } else if (s.side === BACK) {
      s.at = size - Math.min(size, s.between + 1);
    } else {
      s.at = size <= 16 ? this.at[size - 1].decode(coder) : coder.direct(bitsFor(size));
    }
    return s;
  }

  decodeWedges(coder, s, star) {
    const {mesh} = this, u = mesh.stars[s.parent], sectors = star.sectors;
    const bAt = s.side === FRONT ? s.between : star.size - 1;
    const fill = () => {
      for (let k = 0; k < star.size; ++k) star.wedges.push(star.firstWedge + s.sectors[Math.min(k, sectors - 1)]);
    };
    if (!this.settings.wedges) {
      s.parents = [u.firstWedge];
      s.sectors = new Array(sectors).fill(0);
      fill();
      s.wedgeA = mesh.stars[star.vertices[Math.min(1, bAt)]].firstWedge;
      s.wedgeB = mesh.stars[star.vertices[bAt]].firstWedge;
      return;
    }
    const count = this.count[Math.min(u.wedgeCount, 3)].decode(coder);
    if (count === 0 || count > 65536) throw contradiction();
    s.parents = many(count, () => u.firstWedge + this.decodeLocal(coder, u.wedgeCount, 1));
    s.sectors = [];
    for (let k = 0, before = 0; k < sectors; ++k) {
      if (count > 1 && coder.bit(this.single, 0) === 0) before = this.decodeLocal(coder, count, 2);
      s.sectors.push(before);
    }
    fill();
    if (s.side !== FRONT) {
      const a = mesh.stars[star.vertices[1]];
      s.wedgeA = this.decodeBeside(coder, a, a.find(s.parent), this.besideA);
    }
    if (s.side !== BACK) {
      const b = mesh.stars[star.vertices[bAt]];
      s.wedgeB = this.decodeBeside(coder, b, b.find(s.parent), this.besideB);
    }
  }

  decodeLocal(coder, count, model) {
    if (count < 2 || coder.bit(this.single, model) === 0) return 0;
    const out = 1 + coder.direct(bitsFor(count - 1));
    if (out >= count) throw contradiction();
    return out;
  }

  decodeBeside(coder, star, at, models) {
    if (star.wedgeCount < 2) return star.firstWedge;
    const last = star.open && at + 1 === star.size, first = star.open && at === 0;
    if (coder.bit(models, 0) === 0) return star.wedges[last ? star.previous(at) : at];
    if (coder.bit(models, 1) === 0) return star.wedges[first ? at : star.previous(at)];
    const local = coder.direct(bitsFor(star.wedgeCount));
    if (local >= star.wedgeCount) throw contradiction();
    return star.firstWedge + local;
  }

  decodeError(coder) {
    const {errors} = this.values, before = errors.length > 0 ? errors[errors.length - 1] : 0x7f80;
    const drop = this.error.decode(coder);
    if (drop > before) throw contradiction();
    errors.push(before - drop);
  }

  fit(star) {
    const {positions} = this.values, points = star.vertices.map((x) => positions[x]), n = points.length;
    const middle = [0, 0, 0], normal = [0, 0, 0], first = points[0];
    let far = 0;
    for (let k = 0; k < n; ++k) {
      const p = points[k], q = points[(k + 1) % n];
      const d = [0, 0, 0], e = [0, 0, 0];
      for (let i = 0; i < 3; ++i) {
        middle[i] += p[i];
        d[i] = p[i] - first[i];
        e[i] = q[i] - first[i];
        far = Math.max(far, Math.abs(d[i]));
      }
      for (let i = 0; i < 3; ++i) {
        const j = (i + 1) % 3, l = (i + 2) % 3;
        normal[i] += d[j] * e[l] - d[l] * e[j];
      }
    }
    for (let i = 0; i < 3; ++i) middle[i] /= n;
    const bend = [0, 1, 2].map((i) => (star.open ? 0 : first[i] - 0.5 * (points[1][i] + points[n - 1][i])));
    const [x, y, z] = normal.map(Math.abs);
    const up = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    return {axis: [(up + 1) % 3, (up + 2) % 3, up], middle, normal, bend, scale: Math.min(32 - Math.clz32(far), 15)};
  }

  decodeValues(coder, s, star) {
    const {values, settings} = this;
    this.decodeError(coder);
    const f = this.fit(star), p = [0, 0, 0], most = 1 << settings.positionBits;
    for (let k = 0; k < 3; ++k) {
      const i = f.axis[k];
      let guess = f.middle[i] + (k === 2 ? 0.5 : 0.25) * f.bend[i];
      if (k === 2 && f.normal[i] !== 0) {
        let slope = 0;
        for (let m = 0; m < 2; ++m) slope += f.normal[f.axis[m]] * (p[f.axis[m]] - f.middle[f.axis[m]] - 0.5 * f.bend[f.axis[m]]);
        guess -= slope / f.normal[i];
      }
      const from = rounded(Math.min(Math.max(guess, 0), most));
      p[i] = from + this.position[k === 2 ? 1 : 0][f.scale].decode(coder);
      if (p[i] < 0 || p[i] > most) throw contradiction();
    }
    values.positions.push(p);
    for (let w = 0; w < s.parents.length; ++w) this.decodeWedgeValues(coder, s, star, f, p, w);
  }

  decodeWedgeValues(coder, s, star, f, p, w) {
    const {values, settings} = this;
    if (settings.materialIds) values.materials.push(values.materials[s.parents[w]]);
    if (settings.uv) {
      const corners = this.corners(s, star, star.firstWedge + w);
      const guess = this.guessUv(f, p, s.parents[w], corners, !star.open && corners.length === 2 * star.size);
      const most = 1 << settings.uvBits, uv = [0, 0];
      for (let i = 0; i < 2; ++i) {
        uv[i] = rounded(Math.min(Math.max(guess[i], 0), most)) + this.uv[f.scale].decode(coder);
        if (uv[i] < 0 || uv[i] > most) throw contradiction();
      }
      values.uv.push(uv);
    }
    if (settings.colours)
      values.colours.push(values.colours[s.parents[w]].map((x, i) => (x + this.colour[i].decode(coder)) & 255));
  }

  // Vertices and wedges of the neighbours in the sectors of a wedge.
  corners(s, star, wedge) {
    const {mesh} = this, out = [];
    const own = (k) => s.parents[star.wedges[k] - star.firstWedge];
    for (let k = 0; k < star.sectors; ++k) {
      if (star.wedges[k] !== wedge) continue;
      const x = star.vertices[k], y = star.vertices[star.next(k)];
      let wx, wy;
      if (x === s.parent) {
        wx = own(k), wy = s.wedgeA;
      } else if (y === s.parent) {
        wx = s.wedgeB, wy = own(k);
      } else {
        const sx = mesh.stars[x], sy = mesh.stars[y];
        wx = sx.wedges[sx.find(y)], wy = sy.wedges[sy.find(s.parent)];
      }
      out.push([x, wx], [y, wy]);
    }
    return out;
  }

  // `whole`: the corners are those of all sectors, beginning with the parent's.
  guessUv(f, p, parent, corners, whole) {
    const {positions, uv} = this.values;
    if (corners.length === 0) return uv[parent];
    const n = corners.length, [a, b] = f.axis;
    let mx = 0, my = 0, mu = 0, mv = 0;
    for (const [vertex, wedge] of corners) {
      mx += positions[vertex][a], my += positions[vertex][b];
      mu += uv[wedge][0], mv += uv[wedge][1];
    }
    mx /= n, my /= n, mu /= n, mv /= n;
    let xx = 0, xy = 0, yy = 0, xu = 0, yu = 0, xv = 0, yv = 0;
    for (const [vertex, wedge] of corners) {
      const x = positions[vertex][a] - mx, y = positions[vertex][b] - my, u = uv[wedge][0] - mu, v = uv[wedge][1] - mv;
      xx += x * x, xy += x * y, yy += y * y, xu += x * u, yu += y * u, xv += x * v, yv += y * v;
    }
    const det = xx * yy - xy * xy;
    if (!(det > 1e-3 * (xx * yy))) return [mu, mv];
    let x = p[a] - mx, y = p[b] - my;
    if (whole) {
      const way = (i) => 0.5 * (uv[corners[0][1]][i] - 0.5 * (uv[corners[1][1]][i] + uv[corners[n - 2][1]][i]));
      mu += way(0), mv += way(1);
      x -= 0.5 * f.bend[a], y -= 0.5 * f.bend[b];
    }
    return [mu + (x * (xu * yy - yu * xy) + y * (yu * xx - xu * xy)) / det,
            mv + (x * (xv * yy - yv * xy) + y * (yv * xx - xv * xy)) / det];
  }
}
