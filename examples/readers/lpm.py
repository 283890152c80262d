"""Reads an .lpm file in Python alone: a progressive mesh, any level of which is a prefix. usage: lpm.py FILE [VERTICES]

The bytes are those of docs/format.md. An adaptive range coder (as in LZMA) codes a base mesh, and then vertex splits: each
brings a vertex in beside its parent, with its place as a difference from a prediction. Every vertex has a star: its
neighbours in order, each with the wedge that the vertex has in the triangle after it. Checksums are checked.
"""

import json
import math
import struct
import sys
import zlib
from dataclasses import dataclass, field

INSIDE, BACK, FRONT = range(3)  # of an open star: where the new vertex goes


class Coder:
    """The range decoder of a frame. A model is a list of probabilities of a 0, in 1/2048."""

    def __init__(self, data):
        self.data, self.at, self.range = data, 4, 0xFFFFFFFF
        self.code = int.from_bytes(data[:4].ljust(4, b"\0"), "big")

    def _normalise(self):
        while self.range < 1 << 24:
            byte = self.data[self.at] if self.at < len(self.data) else 0
            self.at, self.range, self.code = self.at + 1, self.range << 8, self.code << 8 | byte

    def bit(self, model, k=0):
        bound = (self.range >> 11) * model[k]
        if one := self.code >= bound:
            self.code, self.range = self.code - bound, self.range - bound
            model[k] -= model[k] >> 5
        else:
            self.range = bound
            model[k] += (2048 - model[k]) >> 5
        self._normalise()
        return int(one)

    def direct(self, bits):
        value = 0
        for _ in range(bits):
            self.range >>= 1
            one = self.code >= self.range
            self.code -= self.range * one
            value = value << 1 | one
            self._normalise()
        return value

    def tree(self, model, bits):
        at = 1
        for _ in range(bits):
            at = at << 1 | self.bit(model, at)
        return at - (1 << bits)

    def number(self, model):
        """Its length by a tree, its second bit by a model, the rest directly."""
        n = self.tree(model[0], 5)
        if n < 2:
            return n
        return (2 | self.bit(model[1], n)) << (n - 2) | self.direct(n - 2)

    def signed(self, model):
        n = self.number(model)
        return -n if n and self.direct(1) else n

    def local(self, count, first):
        """One of `count`, of which the first is likely."""
        return 1 + self.direct(bits_for(count - 1)) if count > 1 and self.bit(first) else 0


def bits_for(count):
    return (count - 1).bit_length() if count > 1 else 0


def models(count, kind=lambda: [[1024] * 32, [1024] * 33]):  # of numbers
    return [kind() for _ in range(count)]


@dataclass
class Star:
    first: int  # wedge
    wedges: int = 1
    open: bool = False
    spokes: list = field(default_factory=list)  # [neighbour, wedge in the triangle between it and the next]

    def find(self, vertex):
        return next(k for k, spoke in enumerate(self.spokes) if spoke[0] == vertex)

    def sectors(self):
        """(number of a spoke, number of the next one) of each triangle."""
        n = len(self.spokes)
        return [(k, (k + 1) % n) for k in range(n - self.open)]


class Lpm:
    """positions (model space), errors (normalised), parents, uv, colours and materials by wedge; triangles of wedges."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()
        if self.bytes[:8] != b"LODELPM1":
            raise ValueError(f"{path}: not an .lpm file")
        length, crc = struct.unpack_from("<II", self.bytes, 8)
        self.at = 16
        self.header = h = json.loads(self._take(length, crc))
        self.stars, self.split_parents, self.wedge_count, self.last = [], [], 0, 0
        self.places, self.drops, self.uv_steps, self.colours, self.materials = [], [], [], [], []
        self._make_models()
        for texture in h["textures"]:
            if texture.get("thumbnail"):
                self._frame()
        self._base(Coder(self._frame()))
        self.base_vertices = self.wedge_count
        while (now := len(self.stars)) < h["groups"]:
            coder = Coder(self._frame())
            for _ in range(min(max(now // 2, 256), 16384, h["groups"] - now)):
                self._split(coder)
        self.images = [self._frame() for _ in h["textures"]]  # an empty one: the thumbnail is the image
        self._assemble()

    def _take(self, length, crc):
        part = self.bytes[self.at:self.at + length]
        self.at += length
        if len(part) < length or zlib.crc32(part) != crc:
            raise ValueError(f"byte {self.at}: the file is damaged")
        return part

    def _frame(self):
        length, crc, _ = struct.unpack_from("<III", self.bytes, self.at)
        self.at += 12
        return self._take(length, crc)

    def _make_models(self):
        self.m_base, self.m_steps, self.m_between, self.m_count = models(2), models(1)[0], models(12), models(4)
        self.m_at = models(16, lambda: [1024] * 16)
        self.m_side, self.m_same, self.m_from, self.m_which = [1024] * 2, [1024], [1024], [1024]
        self.m_a, self.m_b = [1024] * 2, [1024] * 2
        self.m_error, self.m_material = models(2)
        self.m_position, self.m_uv, self.m_colour = [models(16), models(16)], models(16), models(4)

    def _base(self, c):
        h = self.header
        for _ in range(h["baseGroups"]):
            self.stars.append(Star(self.wedge_count, c.number(self.m_base[0])))
            self.wedge_count += self.stars[-1].wedges
            self.places.append([c.direct(h["positionBits"] + 1) for _ in range(3)])
            self._error(c)
            for _ in range(self.stars[-1].wedges):
                if h["materialIds"]:
                    self.materials.append(c.number(self.m_material) - 1)
                if h["uv"]:
                    self.uv_steps.append([c.direct(h["uvBits"] + 1) for _ in range(2)])
                if h["colours"]:
                    self.colours.append([c.direct(8) for _ in range(4)])
        for star in self.stars:
            star.open = bool(c.direct(1))
            for _ in range(c.number(self.m_base[1])):
                star.spokes.append([c.direct(bits_for(len(self.stars))), star.first + c.direct(bits_for(star.wedges))])

    def _error(self, c):
        self.drops.append((self.drops[-1] if self.drops else 0x7F80) - c.number(self.m_error))

    def _split(self, c):
        count = len(self.stars)
        self.last = p = (self.last + c.number(self.m_steps)) % count
        u = self.stars[p]
        size, side = len(u.spokes), INSIDE
        if u.open and c.bit(self.m_side, 0):
            side = BACK + c.bit(self.m_side, 1)
        between = c.number(self.m_between[min(size, 11)])
        if side == FRONT:
            at = between
        elif side == BACK:
            at = size - between - 1
        else:
            at = c.tree(self.m_at[size - 1], 4) if size <= 16 else c.direct(bits_for(size))
        # The star of the new vertex v: (parent, a, ..., b) inside, (parent, a, ...) at the back, (..., b, parent) at the front.
        if side == FRONT:
            ring = [u.spokes[k][0] for k in range(between + 1)] + [p]
        else:
            ring = [p] + [u.spokes[(at + k) % size][0] for k in range(between + 2 - side)]
        v = Star(self.wedge_count, 1, side != INSIDE, [[x, 0] for x in ring])
        with_a, with_b = side != FRONT, side != BACK
        a = ring[1] if with_a else None
        b = (ring[between] if side == FRONT else ring[-1]) if with_b else None
        parents, wedge_a, wedge_b = self._wedges(c, p, v, a, b)
        self._values(c, p, v, parents, wedge_a, wedge_b)
        self._apply(p, v, side, at, between, parents, (a, wedge_a), (b, wedge_b))

    def _wedges(self, c, p, v, a, b):
        """The parents of the wedges of v, its wedge in each sector, and those of a and b in the triangle with v and p."""
        u = self.stars[p]
        if not self.header["wedges"]:
            for spoke in v.spokes:
                spoke[1] = v.first
            return [u.first], a is not None and self.stars[a].first, b is not None and self.stars[b].first
        v.wedges = c.number(self.m_count[min(u.wedges, 3)])
        parents = [u.first + c.local(u.wedges, self.m_from) for _ in range(v.wedges)]
        sector = 0
        for spoke in v.spokes[:len(v.sectors())]:
            if v.wedges > 1 and not c.bit(self.m_same):
                sector = c.local(v.wedges, self.m_which)
            spoke[1] = v.first + sector
        v.spokes[-1][1] = v.first + sector
        return (parents, a is not None and self._beside(c, self.stars[a], p, self.m_a),
                b is not None and self._beside(c, self.stars[b], p, self.m_b))

    def _beside(self, c, star, p, model):
        """Mostly the wedge on either side of the edge to the parent."""
        if star.wedges < 2:
            return star.first
        at = star.find(p)
        behind = star.spokes[at - 1 if star.open and at + 1 == len(star.spokes) else at][1]
        if not c.bit(model, 0):
            return behind
        if not c.bit(model, 1):
            return star.spokes[0 if star.open and at == 0 else at - 1][1]
        return star.first + c.direct(bits_for(star.wedges))

    def _values(self, c, p, v, parents, wedge_a, wedge_b):
        self._error(c)
        fit = Fit(v, self.places)
        most, place = 1 << self.header["positionBits"], [0, 0, 0]
        for k, i in enumerate(fit.axis):
            guess = fit.middle[i] + (0.5 if k == 2 else 0.25) * fit.bend[i]
            if k == 2 and fit.normal[i] != 0:
                slope = 0.0
                for m in fit.axis[:2]:
                    slope += fit.normal[m] * (place[m] - fit.middle[m] - 0.5 * fit.bend[m])
                guess -= slope / fit.normal[i]
            place[i] = nearest(guess, most) + c.signed(self.m_position[k == 2][min(fit.scale, 15)])
        self.places.append(place)
        for w, parent in enumerate(parents):
            if self.header["materialIds"]:
                self.materials.append(self.materials[parent])
            if self.header["uv"]:
                corners = self._corners(p, v, v.first + w, parents, wedge_a, wedge_b)
                whole = not v.open and len(corners) == 2 * len(v.spokes)
                guess = fit.guess_uv(corners, self.places, self.uv_steps, parent, place, whole)
                model = self.m_uv[min(fit.scale, 15)]
                self.uv_steps.append([nearest(x, 1 << self.header["uvBits"]) + c.signed(model) for x in guess])
            if self.header["colours"]:
                self.colours.append([x + c.signed(m) & 255 for x, m in zip(self.colours[parent], self.m_colour)])

    def _corners(self, p, v, wedge, parents, wedge_a, wedge_b):
        """(vertex, wedge) of the neighbours in the sectors of a wedge of v: of triangles that p has so far, or will have."""
        def corner(k, m, first):
            x, y = v.spokes[k][0], v.spokes[m][0]
            if x == p:
                return parents[v.spokes[k][1] - v.first] if first else wedge_a
            if y == p:
                return wedge_b if first else parents[v.spokes[k][1] - v.first]
            star = self.stars[x if first else y]
            return star.spokes[star.find(y if first else p)][1]

        return [(v.spokes[s][0], corner(k, m, s == k)) for k, m in v.sectors() if v.spokes[k][1] == wedge for s in (k, m)]

    def _apply(self, p, v, side, at, between, parents, beside_a, beside_b):
        new, u, size = len(self.stars), self.stars[p], len(self.stars[p].spokes)
        after = parents[v.spokes[0][1] - v.first]  # of the parent's wedges, before and after the edge to v
        before = parents[v.spokes[len(v.sectors()) - 1][1] - v.first]
        begin = 2 if side != FRONT else 0
        for x, _ in v.spokes[begin:begin + between]:
            self.stars[x].spokes[self.stars[x].find(p)][0] = new
        if side != FRONT:
            star = self.stars[beside_a[0]]
            star.spokes.insert(star.find(p), [new, beside_a[1]])
        if side != BACK:
            star = self.stars[beside_b[0]]
            k = star.find(p)
            star.spokes.insert(k + 1, [new, star.spokes[k][1]])
            star.spokes[k][1] = beside_b[1]
        if side == FRONT:
            u.spokes = [[new, before]] + u.spokes[at:]
        else:
            end = at + between + 1  # the spoke of b
            head = u.spokes[end - size if side == INSIDE and end >= size else 0:at + 1]
            head[-1][1] = after
            tail = u.spokes[end:] if side == INSIDE and end < size else []
            u.spokes = head + [[new, before if side == INSIDE else after]] + tail
        self.stars.append(v)
        self.wedge_count += v.wedges
        self.split_parents += parents

    def _assemble(self):
        h = self.header
        step = h["scale"] / (1 << h["positionBits"])
        groups = [g for g, star in enumerate(self.stars) for _ in range(star.wedges)]
        self.positions = [[o + step * x for o, x in zip(h["origin"], self.places[g])] for g in groups]
        self.errors = [struct.unpack("<f", struct.pack("<I", self.drops[g] << 16))[0] for g in groups]
        self.parents = [0] * self.base_vertices + self.split_parents
        self.uv = [[low + x * s for low, x, s in zip(h["uvLow"], uv, h["uvStep"])] for uv in self.uv_steps]
        wedge = {(v, s.spokes[k][0], s.spokes[m][0]): s.spokes[k][1] for v, s in enumerate(self.stars) for k, m in s.sectors()}
        self.triangles = [(w, wedge[a, b, v], wedge[b, v, a]) for (v, a, b), w in wedge.items() if v < a and v < b]

    def level(self, vertices):
        """The triangles of the level of so many vertices: corners follow their parents until they are among these."""
        at = list(range(len(self.parents)))
        for v in range(max(vertices, self.base_vertices), len(at)):
            at[v] = at[self.parents[v]]
        mapped = ((at[a], at[b], at[c]) for a, b, c in self.triangles)
        return [t for t in mapped if len(set(t)) == 3]


def nearest(guess, most):
    return math.floor(min(max(guess, 0.0), float(most)) + 0.5)


class Fit:
    """The neighbours of a new vertex: their middle, their normal, two axes along them and then the one nearest to it."""

    def __init__(self, star, places):
        at = [places[x] for x, _ in star.spokes]
        n, first = len(at), at[0]
        self.middle = [sum(p[i] for p in at) / n for i in range(3)]
        self.normal = [0.0] * 3
        for d, e in zip(at, at[1:] + at[:1]):
            d, e = [x - f for x, f in zip(d, first)], [x - f for x, f in zip(e, first)]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                self.normal[i] += d[j] * e[k] - d[k] * e[j]
        self.bend = [0.0 if star.open else first[i] - 0.5 * (at[1][i] + at[-1][i]) for i in range(3)]
        last = max(range(3), key=lambda i: (abs(self.normal[i]), -i))
        self.axis = [(last + 1) % 3, (last + 2) % 3, last]
        self.scale = max(abs(p[i] - first[i]) for p in at for i in range(3)).bit_length()

    def guess_uv(self, corners, places, uv, parent, place, whole):
        """By the linear map from the two axes to the texture that fits the corners best."""
        if not corners:
            return [float(x) for x in uv[parent]]
        a, b, n = *self.axis[:2], len(corners)
        mx, my = sum(places[v][a] for v, _ in corners) / n, sum(places[v][b] for v, _ in corners) / n
        mean = [sum(uv[w][i] for _, w in corners) / n for i in range(2)]
        xx = xy = yy = 0.0
        xt, yt = [0.0, 0.0], [0.0, 0.0]
        for v, w in corners:
            x, y = places[v][a] - mx, places[v][b] - my
            xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
            for i in range(2):
                xt[i] += x * (uv[w][i] - mean[i])
                yt[i] += y * (uv[w][i] - mean[i])
        det = xx * yy - xy * xy
        if not det > 1e-3 * (xx * yy):
            return mean
        x, y = place[a] - mx, place[b] - my
        if whole:
            end = [uv[corners[k][1]] for k in (0, 1, -2)]
            mean = [m + 0.5 * (end[0][i] - 0.5 * (end[1][i] + end[2][i])) for i, m in enumerate(mean)]
            x, y = x - 0.5 * self.bend[a], y - 0.5 * self.bend[b]
        return [mean[i] + (x * (xt[i] * yy - yt[i] * xy) + y * (yt[i] * xx - xt[i] * xy)) / det for i in range(2)]


if __name__ == "__main__":
    lpm = Lpm(sys.argv[1])
    count = int(sys.argv[2]) if sys.argv[2:] else len(lpm.parents)
    print(f"{len(lpm.level(count))} triangles at {count} of {len(lpm.parents)} vertices, base of {lpm.base_vertices}")
