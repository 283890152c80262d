"""experiments/benchmark: what is right scores as right, and each fault in its own column."""

import argparse
import sys

import numpy
import pytest

pytest.importorskip("matplotlib")
import lodestone
from conftest import SOURCE

sys.path.insert(0, str(SOURCE / "experiments/benchmark"))
import benchmark
import flights
import scores

KEYS = """# a comment
smooth 0 loop 0 dur 10 ;
  {0, 2, 5}, {0, 0, 0}, {0, 1, 0}, {60} ;
  {5, 2, 0}, {0, 0, 0}, {0, 1, 0}, {40} ;
smooth 1 loop 0 dur 3 ; {9, 9, 9}, {0, 0, 0}, {0, 1, 0} ; {8, 8, 8}, {0, 0, 0}, {0, 1, 0}
"""


@pytest.fixture(scope="module")
def tests(tmp_path_factory):
    folder = tmp_path_factory.mktemp("benchmark")
    (folder / "keys.txt").write_text(KEYS)
    benchmark.make(argparse.Namespace(folder=folder / "tests", small=True, model=["sphere"], flight=["fly-in", "adversarial"],
                                      keyframes=folder / "keys.txt"))
    return folder / "tests"


def submit(tests, folder, mesh_of, flight="adversarial"):
    """A submission of meshes alone."""
    out = folder / "sphere" / flight
    out.mkdir(parents=True)
    for number in range(8):
        mesh_of(number).save(out / f"{number:04}.ply")
    benchmark.score(argparse.Namespace(folder=tests, submission=folder))
    row, = benchmark.json.loads((folder / "scores.json").read_text())["rows"]
    return row


def test_the_full_surface_is_without_fault(tests, tmp_path, capsys):
    row = submit(tests, tmp_path, lambda number: lodestone.read(tests / "sphere/model.ply"))
    assert row["frames"] == 8 and row["ssim"] == 1
    for column in ("flip", "pop", "largest_pop", "hole_pixels", "new_open_edges", "distance", "distance_pixels"):
        assert row[column] == pytest.approx(0, abs=1e-9), column
    assert f"| sphere | adversarial | {row['triangles']:,.0f} |" in capsys.readouterr().out


def test_holes_and_open_edges_are_found(tests, tmp_path):
    full = lodestone.read(tests / "sphere/model.ply")
    eye, aim, *_ = flights.from_json((tests / "sphere/adversarial/path.json").read_text())[5]
    sight = (aim - eye) / numpy.linalg.norm(aim - eye)
    middle = full.positions[full.triangles].mean(axis=1) - aim
    beside = numpy.linalg.norm(middle - (middle @ sight)[:, None] * sight, axis=1)
    cut = lodestone.Mesh(full.positions, full.triangles[beside > 0.3])  # through front and back
    row = submit(tests, tmp_path, lambda number: cut if number == 5 else full)
    assert row["new_open_edges"] > 10 and row["hole_pixels"] > 50 and row["distance"] > 1
    assert [frame["frame"] for frame in row["by_frame"] if frame["hole_pixels"]] == [5]


def test_what_is_exchanged_pops_and_what_stays_does_not(tests, tmp_path):
    hierarchy = lodestone.build(tests / "sphere/model.ply")
    coarse, finer = hierarchy.mesh(0), hierarchy.mesh(hierarchy.finest)
    steady = submit(tests, tmp_path / "steady", lambda number: coarse)
    popping = submit(tests, tmp_path / "popping", lambda number: (coarse, finer)[number % 2])
    assert popping["pop"] > 10 * steady["pop"] > 0
    assert popping["flip"] < steady["flip"]


def test_ours_has_no_crack(tests, tmp_path):
    benchmark.draw(argparse.Namespace(folder=tests, submission=tmp_path, pixel_error=2.0))
    benchmark.score(argparse.Namespace(folder=tests, submission=tmp_path))
    rows = benchmark.json.loads((tmp_path / "scores.json").read_text())["rows"]
    assert [row["flight"] for row in rows] == ["adversarial", "fly-in", "imported"]
    for row in rows:
        assert row["new_open_edges"] == 0 and row["hole_pixels"] == 0
    assert rows[0]["triangles"] < 20000


def test_refusals_name_the_file(tests, tmp_path):
    def refused(words, folder=tests):
        with pytest.raises(SystemExit, match=words):
            benchmark.score(argparse.Namespace(folder=folder, submission=tmp_path))
    refused("holds no flight", tmp_path)
    refused("holds none of the flights")
    out = tmp_path / "sphere/fly-in"
    out.mkdir(parents=True)
    refused("0000.png nor .*0000.ply is there")
    benchmark.write_picture(out / "0000.png", numpy.zeros((9, 16, 3), numpy.uint8))
    refused("is 16x9, not 320x180")
    with pytest.raises(SystemExit, match="no model ball; known are gutenberg"):
        benchmark.make(argparse.Namespace(folder=tmp_path, small=True, model=["ball"], flight=None, keyframes=None))


def test_flights_are_those_of_the_program(tests):
    path = (tests / "sphere/fly-in/path.json").read_text()
    assert flights.to_json(flights.from_json(path)) == path
    surface = flights.Surface(numpy.array([[0, 0, 0], [2, 0, 0], [0, 4, 0], [0, 0, 6.0]]), "-y")
    assert numpy.array_equal(surface.up, [0, -1, 0]) and surface.direction(0) @ surface.up == 0
    for name in flights.FLIGHTS:
        cameras = flights.cameras(surface, name, 7, 60)
        assert len(cameras) == 7 and all(numpy.linalg.norm(c[0] - c[1]) > 0 for c in cameras), name


def test_keyframes_of_others():
    cameras = flights.from_keyframes(KEYS, 5)
    assert numpy.allclose(cameras[0][0], [0, 2, 5]) and numpy.allclose(cameras[4][0], [5, 2, 0])
    assert numpy.allclose(cameras[2][0], [2.5, 2, 2.5]) and cameras[2][3] == 50
    smooth = flights.from_keyframes(KEYS.replace("smooth 0", "smooth 1"), 3)
    assert numpy.allclose(smooth[0][0], [0, 2, 5]) and numpy.allclose(smooth[2][0], [5, 2, 0])
    assert flights.from_keyframes("{1,0,0},{0,0,0},{0,0,1};{2,0,0},{0,0,0},{0,0,1}", 2)[1][3] == 60
    for bad, words in (("{1,2,3},{0,0,0},{0,1,0}", "two keys"), ("{1,2},{0,0,0},{0,1,0};{1,2,3}", "not a key")):
        with pytest.raises(ValueError, match=words):
            flights.from_keyframes(bad, 3)


def test_edges_are_counted_by_place():
    positions = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], float)
    assert scores.open_edges(positions, numpy.array([[0, 1, 2], [3, 5, 4]])) == 4
    assert scores.open_edges(positions, numpy.array([[0, 1, 2], [1, 3, 2]])) == 3, "a triangle without area has none"
