"""Reads an .lpm file: a progressive mesh, any level of which is a prefix. usage: lpm.py FILE [VERTICES]

The bytes are those of docs/format.md. A range coder as in LZMA codes a base mesh and then vertex splits: each brings a
vertex in beside its parent, with differences from what its ring, its neighbours in order, predicts. A vertex is one or
more wedges, vertices of the file; its corners are the wedges that it has between one neighbour and the next.
"""

import json
import struct
import sys
import zlib
from collections import defaultdict

import numpy

BACK, FRONT = 1, 2  # of an open ring: the new vertex is added after its end or before its beginning


class Coder:
    """A model, named by words and numbers, is the probability of a 0 in 1/2048, learnt from the bits so far."""

    def __init__(self):
        self.models = defaultdict(lambda: 1024)

    def start(self, data):
        self.data, self.range, self.code = iter(data[4:]), 0xFFFFFFFF, int.from_bytes(data[:4].ljust(4, b"\0"), "big")

    def bit(self, *model):  # without a model both values are equally likely
        zero = self.models[model] if model else 0
        bound = (self.range >> 11) * zero if model else self.range >> 1
        one = int(self.code >= bound)
        self.code, self.range = self.code - bound * one, self.range - bound if model and one else bound
        if model:
            self.models[model] += -(zero >> 5) if one else (2048 - zero) >> 5
        while self.range < 1 << 24:
            self.range, self.code = self.range << 8, self.code << 8 | next(self.data, 0)
        return one

    def direct(self, bits):
        return sum(self.bit() << k for k in reversed(range(bits)))

    def one_of(self, values):
        return values[self.direct((len(values) - 1).bit_length())]

    def mostly_first(self, values, *model):
        return self.one_of(values[1:]) if len(values) > 1 and self.bit(*model) else values[0]

    def tree(self, bits, *model):
        at = 1
        for _ in range(bits):
            at = at << 1 | self.bit(*model, at)
        return at - (1 << bits)

    def number(self, *model):  # its length by a tree, its second bit by a model, the rest directly
        n = self.tree(5, *model)
        return n if n < 2 else (2 | self.bit(*model, -n)) << n - 2 | self.direct(n - 2)

    def near(self, guess, bits, *model):  # a guess, clamped and rounded, and a difference from it
        n = self.number(*model)
        return int(numpy.floor(min(max(guess, 0), 1 << bits) + 0.5)) + (-n if n and self.bit() else n)


class Lpm:
    """positions (of the model), errors (normalised), parents, uv, colours, materials by wedge; triangles of wedges."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes, self.at = file.read(), 8
        if self.bytes[:8] != b"LODELPM1":
            raise ValueError(f"{path}: not an .lpm file")
        self.header = h = json.loads(self._part("<II"))
        self.coder, self.places = Coder(), numpy.zeros((h["groups"], 3), int)  # places and the like are in steps
        self.uv_steps, self.colours = numpy.zeros((h["vertices"], 2), int), numpy.zeros((h["vertices"], 4), int)
        self.rings, self.corners, self.open, self.wedges = [], [], [], []  # by vertex; the last corner of an open ring
        self.halves, self.parents, self.materials, self.last = [0x7F80], [], [], 0  # of a vertex means nothing
        self.thumbnails = [self._part("<III") for texture in h["textures"] if texture.get("thumbnail")]
        self.coder.start(self._part("<III"))
        self._base(h["baseGroups"])
        self.base_vertices = len(self.parents)
        while (now := len(self.rings)) < h["groups"]:
            self.coder.start(self._part("<III"))
            for _ in range(min(max(now // 2, 256), 16384, h["groups"] - now)):
                self._split()
        self.images = [self._part("<III") for _ in h["textures"]]  # an empty one: the thumbnail is the image
        self._assemble()

    def _part(self, head):  # length, checksum, and of frames the number of vertices so far
        length, crc = struct.unpack_from(head, self.bytes, self.at)[:2]
        part = self.bytes[self.at + struct.calcsize(head):][:length]
        self.at += struct.calcsize(head) + length
        if len(part) < length or zlib.crc32(part) != crc:
            raise ValueError(f"byte {self.at}: the file is damaged")
        return part

    def _add(self, parents):
        self.wedges.append(range(len(self.parents), len(self.parents) + len(parents)))
        self.parents += parents

    def _base(self, count):
        c, h = self.coder, self.header
        for v in range(count):
            self._add([0] * c.number("wedges"))
            self.places[v] = [c.direct(h["positionBits"] + 1) for _ in range(3)]
            self.halves.append(self.halves[-1] - c.number("error"))
            for w in self.wedges[v]:
                self.materials += [c.number("material") - 1] if h["materialIds"] else []
                self.uv_steps[w] = [c.direct(h["uvBits"] + 1) if h["uv"] else 0 for _ in range(2)]
                self.colours[w] = [c.direct(8) if h["colours"] else 0 for _ in range(4)]
        for wedges in self.wedges:
            self.open.append(c.bit())
            spokes = [(c.one_of(range(count)), c.one_of(wedges)) for _ in range(c.number("spokes"))]
            self.rings.append([x for x, _ in spokes])
            self.corners.append([w for _, w in spokes])

    def _split(self):
        c, v = self.coder, len(self.rings)
        self.last = p = (self.last + c.number("steps")) % v
        ring, corners, size = self.rings[p], self.corners[p], len(self.rings[p])
        side = 1 + c.bit("side", 1) if self.open[p] and c.bit("side", 0) else 0
        between = c.number("between", min(size, 11))
        at = size - between - 1 if side == BACK else -1
        if not side:
            at = c.tree(4, "at", size) if size <= 16 else c.one_of(range(size))
        # From a over those between to b; a is missing at the front, b at the back.
        arc = [ring[(at + k) % size] for k in range(side == FRONT, between + 2 - (side == BACK))]
        count = c.number("count", min(len(self.wedges[p]), 3)) if self.header["wedges"] else 1
        parents = [c.mostly_first(self.wedges[p], "from") for _ in range(count)]
        self._add(parents)
        own = self.wedges[v]
        sectors = [own[0]]  # and one more before the first
        for _ in range(len(arc) + (not side)):
            same = count == 1 or c.bit("same")
            sectors.append(sectors[-1] if same else c.mostly_first(own, "which"))
        ends = [(arc[0], 0)] * (side != FRONT) + [(arc[-1], 1)] * (side != BACK)
        wedges = [self._beside(x, p, end) for x, end in ends]
        for x in arc[side != FRONT:len(arc) - (side != BACK)]:
            self.rings[x][self.rings[x].index(p)] = v
        for (x, end), wedge in zip(ends, wedges):
            k = self.rings[x].index(p)
            self.rings[x].insert(k + end, v)
            self.corners[x].insert(k, wedge)
        after, before = (parents[sectors[k] - own[0]] for k in (1, -1))
        end = at + between + 1
        corners[at] = after
        ring[:] = ring[max(end - size, 0):at + 1] + [v] + ring[end:]
        corners[:] = corners[max(end - size, 0):at + 1] + [before] + corners[end:]
        self.rings.append(arc + [p] if side == FRONT else [p] + arc)
        self.corners.append(sectors[1:] + sectors[-1:] * bool(side))
        self.open.append(bool(side))
        self._values(v, parents)

    def _beside(self, x, p, end):
        """The wedge in the new triangle of a vertex that both meet: mostly on either side of its edge to the parent."""
        c, k, corners, own = self.coder, self.rings[x].index(p), self.corners[x], self.wedges[x]
        if len(own) < 2 or not c.bit("beside", end, 0):
            return corners[min(k, len(corners) - 1 - self.open[x])]
        return c.one_of(own) if c.bit("beside", end, 1) else corners[max(k - 1, self.open[x] - 1)]

    def _values(self, v, parents):
        c, h, near = self.coder, self.header, self.places[self.rings[v]]
        self.halves.append(self.halves[-1] - c.number("error"))
        spread, middle = near - near[0], near.mean(axis=0)
        normal = numpy.cross(spread, numpy.roll(spread, -1, axis=0)).sum(axis=0)
        bend = 0 * middle if self.open[v] else near[0] - 0.5 * (near[1] + near[-1])
        scale, up, place = min(int(abs(spread).max()).bit_length(), 15), int(abs(normal).argmax()), self.places[v]
        along = [(up + 1) % 3, (up + 2) % 3]
        for i in along:
            place[i] = c.near(middle[i] + 0.25 * bend[i], h["positionBits"], "place", 0, scale)
        slope = (normal * (place - middle - 0.5 * bend))[along]
        guess = middle[up] + 0.5 * bend[up] - (slope[0] + slope[1]) / (normal[up] or numpy.inf)
        place[up] = c.near(guess, h["positionBits"], "place", 1, scale)
        for w, parent in zip(self.wedges[v], parents):
            self.materials += [self.materials[parent]] if h["materialIds"] else []
            if h["uv"]:
                guess = self._guess_uv(v, w, parent, along, bend)
                self.uv_steps[w] = [c.near(x, h["uvBits"], "uv", scale) for x in guess]
            if h["colours"]:
                self.colours[w] = [x + c.near(0, 0, "colour", k) & 255 for k, x in enumerate(self.colours[parent])]

    def _guess_uv(self, v, wedge, parent, along, bend):
        """By the linear map from the two axes along the surface to the texture that fits the corners best."""
        ring, sectors = self.rings[v], len(self.rings[v]) - self.open[v]
        pairs = [(x, y) for x, y, w in list(zip(ring, ring[1:] + ring[:1], self.corners[v]))[:sectors] if w == wedge]
        spokes = [spoke for x, y in pairs for spoke in ((x, y), (y, v))]
        if not spokes:
            return self.uv_steps[parent]
        at = self.places[[x for x, _ in spokes]][:, along]
        uv = self.uv_steps[[self.corners[x][self.rings[x].index(y)] for x, y in spokes]]
        middle, mean, way = at.mean(axis=0), uv.mean(axis=0), self.places[v][along] - at.mean(axis=0)
        d = numpy.hstack([at - middle, uv - mean])  # The sums are rounded one by one, as they were when it was written.
        (xx, xy, *xt), (_, yy, *yt) = (d[:, :2, None] * d[:, None]).cumsum(axis=0)[-1]
        det = xx * yy - xy * xy
        if not det > 1e-3 * (xx * yy):
            return mean
        if len(pairs) == len(ring):
            mean, way = mean + 0.5 * (uv[0] - 0.5 * (uv[1] + uv[-2])), way - 0.5 * bend[along]
        x, y, xt, yt = *way, numpy.array(xt), numpy.array(yt)
        return mean + (x * (xt * yy - yt * xy) + y * (yt * xx - xt * xy)) / det

    def _assemble(self):
        h, groups = self.header, [v for v, wedges in enumerate(self.wedges) for _ in wedges]
        self.positions = h["origin"] + h["scale"] / (1 << h["positionBits"]) * self.places[groups]
        self.errors = (numpy.array(self.halves[1:], "<u4") << 16).view("<f4")[groups]
        self.uv = h["uvLow"] + self.uv_steps * h["uvStep"]
        wedge = {(v, x, y): w for v, ring in enumerate(self.rings) for x, y, w in
                 list(zip(ring, ring[1:] + ring[:1], self.corners[v]))[:len(ring) - self.open[v]]}
        self.triangles = [(w, wedge[a, b, v], wedge[b, v, a]) for (v, a, b), w in wedge.items() if v < a and v < b]

    def level(self, vertices):
        """The triangles of the level of so many vertices: corners follow their parents until they are among these."""
        at = numpy.arange(len(self.parents))
        for v in range(max(vertices, self.base_vertices), len(at)):
            at[v] = at[self.parents[v]]
        return [t for t in at[numpy.array(self.triangles)].tolist() if len(set(t)) == 3]


if __name__ == "__main__":
    lpm = Lpm(sys.argv[1])
    count = int(sys.argv[2]) if sys.argv[2:] else len(lpm.parents)
    print(f"{len(lpm.level(count))} triangles at {count} of {len(lpm.parents)} vertices, base of {lpm.base_vertices}")
