"""The package gives what the command gives: equal bytes of files, equal figures, equal pictures."""

import json

import lodestone
import numpy
import pytest
from conftest import SCAN, run

BUILDS = [
    ({}, []),
    ({"sigma0": 0.3, "cell_triangles": 700, "simplifier": "cluster", "half_levels": True},
     ["--sigma0", 0.3, "--cell-triangles", 700, "--simplifier", "cluster", "--half-levels"]),
    ({"finest_level": 3, "placement": "endpoint", "threads": 1}, ["--levels", 3, "--placement", "endpoint"]),
    ({"finest_level": 3, "refine": True, "refine_limit": 3.0, "measure_errors": True},
     ["--levels", 3, "--refine", "--refine-limit", 3, "--measure-error"]),
    ({"lattice_bits": 16, "strategy": "serial"}, ["--lattice", 16, "--strategy", "levels"]),
    ({"compress": True}, ["--compress"]),
]


@pytest.mark.parametrize("options, arguments", BUILDS)
def test_build(sphere_file, tmp_path, options, arguments):
    run("build", sphere_file, "-o", tmp_path / "a.lode", *arguments)
    built = lodestone.build(sphere_file, **options)
    size = built.save(tmp_path / "b.lode", compress=options.get("compress", False))
    assert (tmp_path / "a.lode").read_bytes() == (tmp_path / "b.lode").read_bytes()
    assert size == (tmp_path / "b.lode").stat().st_size
    lodestone.build(lodestone.read(sphere_file), **options).save(tmp_path / "b.lode", compress="compress" in options)
    assert (tmp_path / "a.lode").read_bytes() == (tmp_path / "b.lode").read_bytes()


def test_build_with_attributes(tmp_path):
    run("build", SCAN, "-o", tmp_path / "a.lode", "--texture-levels")
    lodestone.build(SCAN, texture_levels=True).save(tmp_path / "b.lode")
    assert (tmp_path / "a.lode").read_bytes() == (tmp_path / "b.lode").read_bytes()


def test_generate(sphere_file, tmp_path):
    lodestone.generate("sphere", triangles=12000).save(tmp_path / "a.ply")
    assert (tmp_path / "a.ply").read_bytes() == sphere_file.read_bytes()


def test_verify(hierarchy, sphere_file, tmp_path, command):
    hierarchy.save(tmp_path / "a.lode")
    expected = command("verify", tmp_path / "a.lode", "--input", sphere_file)
    report = lodestone.verify(lodestone.load(tmp_path / "a.lode"), input=sphere_file)
    assert report["valid"] and "input" in [check["name"] for check in report["checks"]]
    assert report == {key: expected[key] for key in report}
    # For another input the answer is no, with the check that fails.
    other = lodestone.verify(hierarchy, input=lodestone.generate("sphere", triangles=12000, seed=2))
    assert not other["valid"] and "input" in [check["name"] for check in other["checks"] if not check["passed"]]


def test_levels(hierarchy, tmp_path, command):
    hierarchy.save(tmp_path / "a.lode")
    for level in (0, hierarchy.finest):
        run("export", tmp_path / "a.lode", "--level", level, "-o", tmp_path / "a.ply")
        hierarchy.mesh(level).save(tmp_path / "b.ply")
        assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    assert hierarchy.levels == command("info", tmp_path / "a.lode")["level_table"]


def test_compare(sphere_file, hierarchy, tmp_path, command):
    hierarchy.save(tmp_path / "a.lode")
    expected = command("compare", sphere_file, f"{tmp_path / 'a.lode'}:1")
    found = lodestone.compare(sphere_file, hierarchy.mesh(1))
    assert found == {key: expected[key] for key in found}
    assert found["error_max"] > 0


@pytest.mark.parametrize("path", ["orbit", "fly-in", "walk", "wander"])
def test_render(hierarchy, tmp_path, command, path):
    image = pytest.importorskip("matplotlib.image")
    hierarchy.save(tmp_path / "a.lode")
    expected = command("render", tmp_path / "a.lode", "--camera", path, "--frames", 3, "--size", "160x120", "--pixel-error", 2,
                       "-o", tmp_path / "frames")
    pictures = []
    cameras = lodestone.camera_path(hierarchy, path, frames=3, size=(160, 120))
    options = {"size": (160, 120), "pixel_error": 2.0}
    flight = lodestone.fly(hierarchy, cameras, **options, on_frame=lambda index, picture: pictures.append(picture))
    files = sorted(file for file in (tmp_path / "frames").iterdir() if file.name != "contact.png")
    assert len(files) == len(pictures) == 3
    for file, picture, camera in zip(files, pictures, cameras):
        assert numpy.array_equal(numpy.round(image.imread(file)[..., :3] * 255).astype(numpy.uint8), picture)
        assert numpy.array_equal(lodestone.render(hierarchy, camera, **options), picture)
    for name in ("open_edges", "gap_max", "jump_max", "jump_over_bound", "jump_pixels", "triangles", "surface_triangles"):
        assert flight[name] == expected[name], name
    for mine, theirs in zip(flight["frames"], expected["frames"]):
        assert {k: v for k, v in mine.items() if k != "milliseconds"}.items() <= theirs.items()


def test_cracks_and_pops_are_those_of_a_flight(hierarchy):
    cameras = lodestone.camera_path(hierarchy, "fly-in", frames=9, size=(160, 120))[5:7]
    options = {"size": (160, 120), "pixel_error": 4.0}
    frames = lodestone.fly(hierarchy, cameras, **options)["frames"]
    before, after = (lodestone.select(hierarchy, camera, **options) for camera in cameras)
    assert lodestone.cracks(before).items() <= frames[0].items()
    pops = lodestone.pops(before, after)
    assert pops.items() <= frames[1].items() and 0 < pops["jump_max"] and pops["jump_over_bound"] <= 1


@pytest.mark.parametrize("name", ["a.lpm", "a.glb"])
def test_progressive(sphere_file, tmp_path, command, name):
    run("progressive", sphere_file, "-o", tmp_path / name)
    made = lodestone.progressive(sphere_file)
    size = made.save(tmp_path / f"b.{name}")
    assert (tmp_path / name).read_bytes() == (tmp_path / f"b.{name}").read_bytes() and len((tmp_path / name).read_bytes()) == size
    opened = lodestone.load_progressive(tmp_path / name)
    # Measuring errors takes seconds where the finest level has one, as in an .lpm.
    levels = [("triangles", 1000), ("vertices", 200)] + [("error", 0.02)] * (name == "a.glb")
    for option, value in levels:
        run("lod", tmp_path / name, f"--{option}", value, "-o", tmp_path / "a.ply")
        opened.level(**{option: value}).save(tmp_path / "b.ply")
        assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes(), option


@pytest.mark.parametrize("options, arguments", [
    ({"resolution": 48.0}, ["--resolution", 48]),
    ({"triangles": 2000}, ["--triangles", 2000]),
    ({"resolution": 32.0, "merge": "shell"}, ["--resolution", 32, "--outside-only"]),
])
def test_reconstruct(sphere_file, tmp_path, options, arguments):
    run("reconstruct", sphere_file, "-o", tmp_path / "a.ply", *arguments)
    lodestone.reconstruct(sphere_file, **options).save(tmp_path / "b.ply")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_experiment_and_sweep(sphere_file, tmp_path):
    (tmp_path / "sweep.toml").write_text(f"""
name = "trial"
title = "A trial"
question = "Are the figures the same?"
[data]
ball = {{ path = {json.dumps(str(sphere_file))} }}
[[sweep]]
name = "all"
experiment = "build"
data = ["ball"]
design = "list"
parameters = [{{ sigma0 = 0.3, cell_triangles = 700, threads = 1 }}]
""")
    run("sweep", tmp_path / "sweep.toml", "-o", tmp_path / "results")
    row, = lodestone.run_experiment("build", {"sigma0": 0.3, "cell_triangles": 700, "threads": 1}, input=sphere_file)
    stored, = (tmp_path / "results").glob("runs/*/rows.0.jsonl")
    expected = json.loads(stored.read_text())
    assert row.keys() == expected.keys()
    same = {name for name in row if row[name] == expected[name]}
    assert {"levels", "cells", "stored_triangles", "fingerprint", "file_bytes", "e"} <= same
    assert all("seconds" in name or "peak" in name or "per_core" in name or name in {"busy", "idle_tail"}
               for name in row.keys() - same)
    pytest.importorskip("pandas")
    rows = lodestone.load_sweep(tmp_path / "results")
    assert len(rows) == 1 and rows.iloc[0]["stored_triangles"] == row["stored_triangles"]
