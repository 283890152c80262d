"""The readers of examples/readers, which know the bytes alone, read what the package reads: every level of six files."""

import importlib.util

import lodestone
import numpy
import pytest
from conftest import SCAN, SOURCE

MODELS = {
    "sphere": lambda: lodestone.generate("sphere", triangles=6000),
    "torus": lambda: lodestone.generate("torus", triangles=3000),
    "terrain": lambda: lodestone.generate("terrain", triangles=3000),
    "box": lambda: lodestone.generate("box", triangles=1200),
    "pile": lambda: lodestone.generate("pile", triangles=600),
    "scan": lambda: lodestone.read(SCAN),
}


def reader(name):
    spec = importlib.util.spec_from_file_location(name, SOURCE / f"examples/readers/{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


LODE, LPM = reader("lode"), reader("lpm")


@pytest.mark.parametrize("name", MODELS)
def test_lode(name, tmp_path):
    hierarchy = lodestone.build(MODELS[name](), cell_triangles=100)
    hierarchy.save(tmp_path / "a.lode")
    lode = LODE.Lode(tmp_path / "a.lode")
    assert len(lode.levels) == hierarchy.finest + 1 > 1 and len(lode.cells) == hierarchy.cell_count
    for level in range(hierarchy.finest + 1):
        points, corners = lode.level(level)
        expected = hierarchy.mesh(level)
        assert len(points) == len(expected.positions)
        assert numpy.array_equal(points[corners], expected.positions[expected.triangles])
    for index in range(hierarchy.cell_count):
        mine, theirs = lode.cell(index), hierarchy.cell(index)
        for array in ("positions", "parents", "shared_ids", "triangles"):
            assert numpy.array_equal(mine[array], getattr(theirs, array)), array
        assert numpy.allclose(mine["normals"], theirs.normals, atol=1e-6)
    if name == "scan":
        uv = numpy.concatenate([lode.cell(index)["uv"] for index in range(hierarchy.cell_count)])
        assert len(uv) == sum(level["vertices"] for level in hierarchy.levels) and numpy.ptp(uv) > 0.1


def rotated(triangles):
    """As a sorted list of triangles that begin with their smallest corner."""
    triangles = numpy.asarray(triangles, int)
    first = triangles.argmin(axis=1)[:, None]
    return sorted(map(tuple, numpy.take_along_axis(triangles, (first + numpy.arange(3)) % 3, axis=1)))


@pytest.mark.parametrize("name", MODELS)
def test_lpm(name, tmp_path):
    lodestone.progressive(MODELS[name](), normals=False).save(tmp_path / "a.lpm")
    expected, lpm = lodestone.load_progressive(tmp_path / "a.lpm"), LPM.Lpm(tmp_path / "a.lpm")
    origin, scale = numpy.array(lpm.header["origin"]), lpm.header["scale"]
    assert numpy.allclose(lpm.positions, origin + scale * expected.positions.astype(float), rtol=0, atol=1e-12 * scale)
    assert numpy.array_equal(lpm.parents, expected.parents) and lpm.base_vertices == expected.base_vertices
    assert numpy.array_equal(numpy.array(lpm.errors, numpy.float32), expected.errors)
    assert rotated(lpm.triangles) == rotated(expected.triangles)
    for share in (0.1, 0.3, 0.6, 1):
        mesh = expected.level(vertices=int(share * len(lpm.parents)) + lpm.base_vertices)
        # A level of the package leaves out folds of two triangles that are smaller than its error, too.
        assert len(lpm.level(len(mesh.positions))) >= len(mesh.triangles)
    if name == "scan":
        assert numpy.allclose(lpm.uv, mesh.uv, atol=1e-6) and len(lpm.images[0]) > 1000
        assert rotated(lpm.level(len(mesh.positions))) == rotated(mesh.triangles)


def test_faults_are_refused(tmp_path):
    mesh = MODELS["box"]()
    lodestone.build(mesh, compress=True).save(tmp_path / "a.lode", compress=True)
    with pytest.raises(ValueError, match="compressed"):
        LODE.Lode(tmp_path / "a.lode")
    lodestone.progressive(mesh).save(tmp_path / "a.lpm")
    data = bytearray((tmp_path / "a.lpm").read_bytes())
    data[-20] ^= 1
    (tmp_path / "a.lpm").write_bytes(data)
    with pytest.raises(ValueError, match="damaged"):
        LPM.Lpm(tmp_path / "a.lpm")
    for kind, name in ((LPM.Lpm, "a.lode"), (LODE.Lode, "a.lpm")):
        with pytest.raises(ValueError, match="not an? .l"):
            kind(tmp_path / name)
