"""Arrays in and out, and what the drawn surface promises, computed again with numpy."""

import gc

import lodestone
import numpy
import pytest
from conftest import SCAN


def test_a_mesh_is_its_arrays():
    positions = numpy.array([[0, 0, 0], [1e7, 0, 0], [0, 2, 0], [0, 0, 3]], float)
    triangles = numpy.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    uv = [[0, 0], [1, 0], [0, 1], [1, 1]]
    colours = numpy.arange(16).reshape(4, 4)
    mesh = lodestone.Mesh(positions, triangles, uv=uv, normals=positions.astype("f4"), colours=colours, up="-y")
    assert mesh.positions.dtype == numpy.float64 and numpy.array_equal(mesh.positions, positions)
    assert mesh.triangles.dtype == numpy.uint32 and numpy.array_equal(mesh.triangles, triangles)
    assert mesh.uv.dtype == numpy.float32 and numpy.array_equal(mesh.uv, uv)
    assert mesh.colours.dtype == numpy.uint8 and numpy.array_equal(mesh.colours, colours)
    assert mesh.normals.shape == (4, 3) and mesh.corners is None and mesh.up == "-y" and mesh.warnings == []
    positions[0] = 5  # it was copied
    assert mesh.positions[0, 0] == 0


def test_attributes_are_kept(tmp_path):
    scan = lodestone.read(SCAN)
    assert scan.uv is not None and scan.corners.shape == scan.triangles.shape and scan.up == "y"
    assert scan.corners.max() < len(scan.uv)
    assert lodestone.read(SCAN, attributes=False).uv is None
    assert lodestone.read(SCAN, up="z").up == "z"
    scan.save(tmp_path / "scan.glb")
    again = lodestone.read(tmp_path / "scan.glb")
    assert len(again.triangles) == len(scan.triangles) and len(again.uv) == len(scan.uv)


def test_arrays_share_memory_and_keep_it():
    mesh = lodestone.generate("sphere", triangles=2000)
    first, second = mesh.positions, mesh.positions
    assert numpy.shares_memory(first, second) and not first.flags.writeable
    with pytest.raises(ValueError):
        first[0, 0] = 1
    with pytest.raises(AttributeError):
        mesh.positions = first
    expected = first.copy()
    cell = lodestone.build(mesh).cell(0)
    positions = cell.positions
    assert numpy.shares_memory(positions, cell.positions)
    kept = positions.copy()
    del mesh, second, cell
    gc.collect()
    lodestone.generate("sphere", triangles=4000)  # takes the memory, if it was given back
    assert numpy.array_equal(first, expected) and numpy.array_equal(positions, kept)


def test_a_pictures_memory_is_kept(hierarchy):
    camera = lodestone.camera_path(hierarchy, "orbit", frames=1)[0]
    picture = lodestone.render(hierarchy, camera, size=(64, 48))
    assert picture.shape == (48, 64, 3) and picture.dtype == numpy.uint8
    kept = picture.copy()
    gc.collect()
    lodestone.render(hierarchy, camera, size=(64, 48), tint=True)
    assert numpy.array_equal(picture, kept) and len(numpy.unique(picture.reshape(-1, 3), axis=0)) > 10


def test_cells_are_the_hierarchy(hierarchy):
    assert [level["level"] for level in hierarchy.levels] == list(range(hierarchy.finest + 1))
    assert sum(level["cells"] for level in hierarchy.levels) == hierarchy.cell_count
    triangles = numpy.zeros(hierarchy.finest + 1, int)
    for index in range(hierarchy.cell_count):
        cell = hierarchy.cell(index)
        triangles[cell.level] += len(cell.triangles)
        assert cell.triangles.max(initial=0) < len(cell.positions) == len(cell.normals)
        assert (cell.positions >= cell.bounds[0]).all() and (cell.positions <= cell.bounds[1]).all()
        assert numpy.allclose(numpy.linalg.norm(cell.normals, axis=1), 1, atol=1e-3)
        for child in cell.children:
            fine = hierarchy.cell(child)
            assert fine.parent == index and fine.level == cell.level + 1
            way = numpy.linalg.norm(fine.positions.astype(float) - cell.positions[fine.parents], axis=1)
            assert way.max() <= hierarchy.sigma0 * 0.5 ** fine.level / 2 * (1 + 1e-6)
    assert list(triangles) == [level["triangles"] for level in hierarchy.levels]
    assert len(hierarchy.mesh(hierarchy.finest).triangles) == triangles[-1]


def test_a_selection_is_a_partition_whose_vertices_are_on_their_way(hierarchy):
    camera = lodestone.camera_path(hierarchy, "fly-in", frames=9, size=(160, 120))[6]
    selection = lodestone.select(hierarchy, camera, size=(160, 120), pixel_error=4.0)
    assert selection.admissible and len(selection) == len(selection.cells) > 8
    assert len(set(selection.levels)) > 1 and not selection.visible.all()
    position = (numpy.array(camera.position) - hierarchy.origin) / hierarchy.scale
    assert numpy.allclose(selection.viewpoint, position, atol=1e-6)
    moved = 0
    for number, index in enumerate(selection.cells):
        cell, drawn = hierarchy.cell(index), selection.positions(number)
        if cell.parent is None or not selection.morphing[number]:
            assert numpy.array_equal(drawn, cell.positions)
            continue
        own, parent = cell.positions.astype(float), hierarchy.cell(cell.parent).positions[cell.parents].astype(float)
        way = numpy.linalg.norm(parent - own, axis=1)
        gone = numpy.linalg.norm(drawn - own, axis=1)
        assert numpy.allclose(gone + numpy.linalg.norm(parent - drawn, axis=1), way, atol=1e-6)
        moved += int((gone > 1e-6).sum())
    assert moved > 0
    surface = selection.mesh()
    assert len(surface.triangles) == lodestone.cracks(selection)["surface_triangles"]
    assert lodestone.compare(surface, hierarchy.mesh(hierarchy.finest))["error_max"] < 1
    with pytest.raises(IndexError):
        selection.positions(len(selection))


def test_cracks_and_pops_are_found(hierarchy):
    cameras = lodestone.camera_path(hierarchy, "fly-in", frames=9, size=(160, 120))[4:8]
    fine = {"size": (160, 120), "pixel_error": 4.0}
    torn = {"size": (160, 120), "radii": "uniform", "kappa0": 0.5}
    assert all(lodestone.cracks(lodestone.select(hierarchy, camera, **fine))["open_edges"] == 0 for camera in cameras)
    selections = [lodestone.select(hierarchy, camera, **torn) for camera in cameras]
    assert not selections[0].admissible
    assert max(lodestone.cracks(selection)["open_edges"] for selection in selections) > 0


def test_pictures_are_compared():
    black, white = numpy.zeros((20, 30, 3), numpy.uint8), numpy.full((20, 30, 3), 255, numpy.uint8)
    same = lodestone.compare_pictures(black, black)
    assert same["flip"]["max"] == 0 and same["ssim"] == 1 and same["psnr"] == numpy.inf
    other = lodestone.compare_pictures(black, white)
    assert other["mean_absolute"] == 1 and 0.9 < other["flip"]["mean"] <= 1
    with pytest.raises(lodestone.InputError, match="size"):
        lodestone.compare_pictures(black, white[:10])


def test_levels_of_progressive_meshes():
    made = lodestone.progressive(lodestone.generate("sphere", triangles=5000))
    vertices = numpy.arange(len(made.parents))
    assert (made.parents[made.base_vertices:] < vertices[made.base_vertices:]).all()
    assert (numpy.diff(made.errors[made.base_vertices:]) <= 0).all() and made.triangles.max() < len(made.positions)
    assert len(made.level(triangles=500).triangles) <= 500 and len(made.level(vertices=99).positions) <= 99
