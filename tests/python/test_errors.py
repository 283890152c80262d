"""Every kind of error is raised as what it is, with the exit status that the command has for it."""

import re
import subprocess

import lodestone
import numpy
import pytest
from conftest import SOURCE

POSITIONS = numpy.eye(3)
TRIANGLES = [[0, 1, 2]]
MESH = lodestone.Mesh(POSITIONS, TRIANGLES)


def raises(kind, text):
    return pytest.raises(kind, match=text)


def test_kinds_have_the_statuses_of_the_command():
    text = (SOURCE / "experiments/command_line/exit_status.h").read_text()
    statuses = {name: int(number) for name, number in re.findall(r"^  (\w+) = (\d)", text, re.MULTILINE)}
    kinds = {"negative": lodestone.NegativeResult, "usage": lodestone.UsageError, "input": lodestone.InputError,
             "file": lodestone.FileError, "unsupported": lodestone.UnsupportedError, "resource": lodestone.ResourceError,
             "internal": lodestone.Error}
    assert {name: kind.exit_status for name, kind in kinds.items()} | {"success": 0} == statuses
    assert all(issubclass(kind, lodestone.Error) for kind in kinds.values())
    assert issubclass(lodestone.UsageError, lodestone.InputError)


def test_usage():
    with raises(lodestone.UsageError, "build: unknown option 'sigma'; the options are sigma0, "):
        lodestone.build(MESH, sigma=1)
    with raises(lodestone.UsageError, "build: sigma0: 'x' is not a value of its kind"):
        lodestone.build(MESH, sigma0="x")
    with raises(lodestone.UsageError, "3 is neither a Mesh nor the name of a file"):
        lodestone.build(3)
    with raises(lodestone.UsageError, "threads: -1 is less than 0"):
        lodestone.build(MESH, threads=-1)
    with raises(lodestone.UsageError, "lattice_bits: 25 is not between 1 and 24"):
        lodestone.build(MESH, lattice_bits=25)
    with raises(lodestone.UsageError, "give one of vertices, triangles and error"):
        lodestone.progressive(MESH).level()
    hierarchy = lodestone.build(MESH)
    camera = lodestone.camera_path(hierarchy, "orbit", frames=1)[0]
    with raises(lodestone.UsageError, "kappa0 and pixel_error exclude each other"):
        lodestone.select(hierarchy, camera, kappa0=3.0, pixel_error=1.0)
    with raises(lodestone.UsageError, "of different hierarchies"):
        lodestone.pops(lodestone.select(hierarchy, camera), lodestone.select(lodestone.build(MESH), camera))
    with raises(lodestone.UsageError, "frames: there is at least one"):
        lodestone.camera_path(hierarchy, "orbit", frames=0)
    with raises(lodestone.UsageError, "flight: give the mesh as input"):
        lodestone.run_experiment("flight")


def test_input(tmp_path):
    with raises(lodestone.InputError, "sigma0 must lie in"):
        lodestone.build(MESH, sigma0=-1.0)
    with raises(lodestone.InputError, r"positions: not an array of shape \(n, 3\)"):
        lodestone.Mesh(numpy.zeros((3, 2)), TRIANGLES)
    with raises(lodestone.InputError, "triangles: there is no vertex 3; there are 3"):
        lodestone.Mesh(POSITIONS, [[0, 1, 3]])
    with raises(lodestone.InputError, "Mesh: "):
        lodestone.Mesh(POSITIONS, numpy.zeros((0, 3), numpy.uint32))
    with raises(lodestone.InputError, "uv: 2 values for 3 vertices"):
        lodestone.Mesh(POSITIONS, TRIANGLES, uv=[[0, 0], [1, 1]])
    with raises(lodestone.InputError, "unknown shape 'ball'"):
        lodestone.generate("ball")
    (tmp_path / "a.lode").write_bytes(b"nonsense")
    with raises(lodestone.InputError, "not a .lode file"):
        lodestone.load(tmp_path / "a.lode")
    with raises(lodestone.InputError, "lattice"):
        lodestone.build(MESH).save(tmp_path / "b.lode", compress=True)
    with raises(lodestone.InputError, "picture: not an array of shape"):
        lodestone.compare_pictures(numpy.zeros((2, 2, 3), numpy.uint8), numpy.zeros((2, 2), numpy.uint8))
    with raises(lodestone.InputError, "unknown parameter|sigma"):
        lodestone.run_experiment("build", {"sigma": 1}, input="a.ply")
    with raises(lodestone.InputError, "sweep.json"):
        lodestone.load_sweep(tmp_path)


def test_others(tmp_path):
    with raises(lodestone.FileError, "cannot open"):
        lodestone.read(tmp_path / "missing.ply")
    with raises(lodestone.FileError, "."):
        lodestone.build(MESH).save(tmp_path / "missing/a.lode")
    with raises(lodestone.UnsupportedError, "."):
        MESH.save(tmp_path / "a.xyz")
    with raises(lodestone.NegativeResult, "probe: "):
        lodestone.run_experiment("probe", {"failure": "verify"}, input=__file__)
    with pytest.raises(IndexError, match="there is no cell 9; there are 1"):
        lodestone.build(MESH).cell(9)


def test_memory_that_runs_out():
    # In a process of its own, whose address space is small.
    script = ("import resource, lodestone; resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))\n"
              "try: lodestone.generate('sphere', triangles=200000000)\n"
              "except lodestone.ResourceError as error: print(error)\n")
    done = subprocess.run([__import__("sys").executable, "-B", "-c", script], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == "out of memory", done.stderr
