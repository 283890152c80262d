"""Scores of a system that drew the flights of the benchmark: of its pictures, and of the meshes that it drew.

The truth is the full surface, drawn and measured by Lodestone. Nothing is asked of the system but files.
"""

import lodestone
import numpy


def whole(mesh):
    """A surface that render() draws with all of its triangles."""
    return lodestone.build(mesh, finest_level=0)


def draw(hierarchy, camera, size):
    place, aim, up, fov = camera
    lens = lodestone.Camera(tuple(place), tuple(aim), tuple(up), float(numpy.radians(fov)))
    return lodestone.render(hierarchy, lens, size=tuple(size), kappa0=1e9, effects="head-light,smooth-normals")


def background(size):
    """The colour where nothing is drawn: that of a picture which looks away."""
    speck = lodestone.Mesh(numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float), numpy.array([[0, 1, 2]]))
    return draw(whole(speck), (numpy.array([0, 0, 5.0]), numpy.array([0, 0, 9.0]), numpy.array([0, 1.0, 0]), 30), size)[0, 0]


def inside(mask):
    """The pixels all of whose neighbours are in the mask, too."""
    kept = mask.copy()
    for axis in (0, 1):
        for step in (1, -1):
            kept &= numpy.roll(mask, step, axis)
    kept[[0, -1], :] = kept[:, [0, -1]] = False
    return kept


def of_picture(reference, picture, empty):
    """FLIP and SSIM against the picture of the full surface; pixels within its outline that show the background."""
    compared = lodestone.compare_pictures(reference, picture)
    outline = inside((reference != empty).any(axis=2))
    return {"flip": compared["flip"]["mean"], "ssim": compared["ssim"],
            "hole_pixels": int((outline & (picture == empty).all(axis=2)).sum())}


def stands_still(before, now):
    """The eye moved by less than 1/200 of the way to what it looks at: differences of two pictures are at the same pixels."""
    return numpy.linalg.norm(now[0] - before[0]) + numpy.linalg.norm(now[1] - before[1]) < 0.005 * numpy.linalg.norm(now[0] - now[1])


def pop(references, pictures):
    """The mean change, in % of white, of the difference from the full surface between two frames: a difference that stays is
    no pop, and a change of the full surface is none either."""
    before, after = (p.astype(float) - r for r, p in zip(references, pictures))
    return float(numpy.abs(after - before).mean() / 2.55)


def open_edges(positions, triangles):
    """Edges of one triangle, vertices of equal coordinates being one."""
    _, number = numpy.unique(numpy.asarray(positions, numpy.float32), axis=0, return_inverse=True)
    corners = number.reshape(-1)[numpy.asarray(triangles)]
    corners = corners[(corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])]
    edges = numpy.sort(numpy.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    _, count = numpy.unique(edges, axis=0, return_counts=True)
    return int((count == 1).sum())


def of_mesh(full, mesh, camera, size):
    """Triangles, edges that are open, and the distance from the full surface: % of its diagonal, and at most so many pixels
    on the screen, as if it were at the vertex that is nearest to the eye."""
    compared = lodestone.compare(mesh, full)
    farthest = max(compared["forward"]["max"], compared["backward"]["max"])
    nearest = float(numpy.linalg.norm(numpy.asarray(mesh.positions) - camera[0], axis=1).min())
    pixels = size[1] / (2 * numpy.tan(numpy.radians(camera[3]) / 2))
    return {"triangles": len(mesh.triangles), "open_edges": open_edges(mesh.positions, mesh.triangles),
            "distance": 100 * farthest / compared["diagonal"], "distance_pixels": farthest / max(nearest, 1e-300) * pixels}


def summary(frames):
    """One line of the table: means of what is a mean, the worst of what must not be."""
    def values(name):
        return [frame[name] for frame in frames if frame.get(name) is not None]
    means = {name: float(numpy.mean(values(name))) for name in ("triangles", "flip", "ssim", "pop") if values(name)}
    worst = {name: max(values(name)) for name in ("hole_pixels", "new_open_edges", "distance", "distance_pixels") if values(name)}
    return {"frames": len(frames), **means, **worst, "largest_pop": max(values("pop"), default=0.0)}
