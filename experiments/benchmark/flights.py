"""Flights of the benchmark: lists of cameras that depend on the surface alone, and on no system of level of detail.

A camera is (position, target, up, fov_degrees), in the units of the model; the field of view is the vertical one.
"""

import json
import math
import re

import numpy

SEED = 2023


class Surface:
    """What flights ask of a surface: its vertices, a sphere around them, and which way is up."""

    def __init__(self, positions, up):
        self.positions = numpy.asarray(positions)
        low, high = self.positions.min(axis=0), self.positions.max(axis=0)
        self.middle = (low + high) / 2
        self.radius = float(numpy.linalg.norm(self.positions - self.middle, axis=1).max())
        axis = "xyz".find(up[-1])
        self.up = numpy.eye(3)[axis if axis >= 0 else 2] * (-1 if up.startswith("-") else 1)
        self.across = numpy.roll(self.up, 1)
        self.along = numpy.cross(self.up, self.across)

    def direction(self, turn, tilt=0.0):
        level = math.cos(turn) * self.across + math.sin(turn) * self.along
        return math.cos(tilt) * level + math.sin(tilt) * self.up

    def outermost(self, direction):
        """The vertex that is farthest in a direction."""
        return self.positions[int(numpy.argmax(self.positions @ direction))]


def fly_in(surface, frames):
    """From four radii away to a fiftieth of one, each step the same share nearer."""
    direction = surface.direction(0.7, 0.35)
    aim = surface.outermost(direction)
    return [(aim + surface.radius * 4 * (1 / 200) ** share * direction, aim) for share in shares(frames)]


def orbit(surface, frames):
    return [(surface.middle + 2.2 * surface.radius * surface.direction(2 * math.pi * share, 0.3), surface.middle)
            for share in shares(frames)]


def walk(surface, frames):
    """Around the surface, a twelfth of its radius above, looking ahead."""
    def place(share, above):
        direction = surface.direction(math.pi * share, 0.25 + 0.15 * math.sin(7 * share))
        return surface.outermost(direction) + surface.radius * above * direction
    return [(place(share, 1 / 12), place(share + 0.12, -0.2)) for share in shares(frames)]


def random(surface, frames):
    """Between ten places that are drawn, on a smooth curve through them."""
    drawn = numpy.random.default_rng(SEED)
    turns, tilts = drawn.uniform(0, 2 * math.pi, 10), drawn.uniform(-0.2, 1.1, 10)
    reach = drawn.uniform(1.05, 3, 10)
    places = [surface.middle + r * surface.radius * surface.direction(a, b) for a, b, r in zip(turns, tilts, reach)]
    aims = [surface.middle + surface.radius * drawn.uniform(-0.3, 0.3, 3) for _ in places]
    return list(zip(along(places, shares(frames)), along(aims, shares(frames))))


def adversarial(surface, frames):
    """As fly_in, but every other step goes back by a thousandth: what is exchanged there shows, as the surface stands still."""
    steps = fly_in(surface, (frames + 1) // 2)
    pairs = [(place, aim + 1.001 * (place - aim), aim) for place, aim in steps]
    return [camera for near, far, aim in pairs for camera in ((near, aim), (far, aim))][:frames]


FLIGHTS = {"fly-in": fly_in, "orbit": orbit, "walk": walk, "random": random, "adversarial": adversarial}


def shares(frames):
    return [i / max(frames - 1, 1) for i in range(frames)]


def along(points, at):
    """A Catmull-Rom curve (catmull1974) through points, at shares of its way in [0, 1]."""
    points = numpy.asarray(points, float)
    found = []
    for share in at:
        first = min(int(share * (len(points) - 1)), len(points) - 2)
        t = share * (len(points) - 1) - first
        a, b, c, d = (points[min(max(first + i, 0), len(points) - 1)] for i in (-1, 0, 1, 2))
        found.append(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3))
    return found


def cameras(surface, name, frames, fov_degrees):
    return [(place, aim, surface.up, fov_degrees) for place, aim in FLIGHTS[name](surface, frames)]


def to_json(flight):
    """A path file of `lodestone render --camera`."""
    keys = ("position", "target", "up")
    return json.dumps({"frames": [{**{k: [float(x) for x in v] for k, v in zip(keys, camera)}, "fov_degrees": camera[3]}
                                  for camera in flight]}, indent=1) + "\n"


def from_json(text):
    return [(*(numpy.array(frame[k], float) for k in ("position", "target", "up")), frame.get("fov_degrees", 45.0))
            for frame in json.loads(text)["frames"]]


def from_keyframes(text, frames):
    """The first path of a text file of vk_lod_clusters' camera paths (nvpro-samples): an optional header `smooth 0|1 loop 0|1
    dur S`, then keys `{eye}, {centre}, {up}[, {fov}]`, separated by semicolons. Raises ValueError."""
    text = re.sub(r"#.*", "", text).strip()
    start = re.match(r"smooth\b", text)
    following = re.search(r"\bsmooth\b", text[6:]) if start else None
    chunks = [chunk.strip() for chunk in (text[:following.start() + 6] if following else text).split(";")]
    header = chunks.pop(0) if chunks and "{" not in chunks[0] else ""
    smooth = re.search(r"smooth\s+([01])", header)
    keys = []
    for chunk in filter(None, chunks):
        groups = [[float(x) for x in group.split(",")] for group in re.findall(r"\{([^}]*)\}", chunk)]
        if len(groups) not in (3, 4) or any(len(group) != 3 for group in groups[:3]):
            raise ValueError(f"not a key of a camera path: {chunk!r}; it takes {{eye}}, {{centre}}, {{up}} and maybe {{fov}}")
        keys.append((*map(numpy.array, groups[:3]), groups[3][0] if len(groups) == 4 else 60.0))
    if len(keys) < 2:
        raise ValueError("a camera path needs two keys")
    def through(k):
        values = [numpy.atleast_1d(key[k]) for key in keys]
        if smooth and smooth[1] == "1":
            return along(values, shares(frames))
        places = [share * (len(values) - 1) for share in shares(frames)]
        return [numpy.array([numpy.interp(p, range(len(values)), [v[i] for v in values]) for i in range(len(values[0]))])
                for p in places]
    return [(eye, aim, up, float(fov[0])) for eye, aim, up, fov in zip(*(through(k) for k in range(4)))]
