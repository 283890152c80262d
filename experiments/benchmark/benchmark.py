#!/usr/bin/env python3
"""A benchmark of level of detail: models, flights, reference frames, and a checker of what any renderer drew.

usage: benchmark.py make DIR [--small] [--model NAME]... [--flight NAME]... [--keyframes FILE]
       benchmark.py draw DIR SUBMISSION [--pixel-error T]
       benchmark.py score DIR SUBMISSION

  make   writes DIR/MODEL/model.ply, and for each flight path.json, the cameras, and frame NNNN.png of the full surface
  draw   makes a submission by Lodestone, as an example: pictures and meshes with a tolerance of T pixels (1)
  score  reads SUBMISSION/MODEL/FLIGHT/NNNN.png, NNNN.ply, or both, and writes scores.json and scores.md there

--keyframes adds a flight `imported` from a text file of camera paths as vk_lod_clusters writes them. README.md beside this
file is the protocol. Needs the Python package of Lodestone (build/release/python on PYTHONPATH) and matplotlib.
"""

import argparse
import json
import pathlib
import sys
import tomllib

import lodestone
import numpy
from matplotlib import image

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import flights  # noqa: E402
import scores  # noqa: E402

ROOT = HERE.parents[1]
COLUMNS = ("triangles", "distance", "distance_pixels", "new_open_edges", "hole_pixels", "flip", "ssim", "pop", "largest_pop")


def say(text):
    print(f"benchmark: {text}", file=sys.stderr, flush=True)


def read_model(entry, small):
    if "generate" in entry:
        return lodestone.generate(entry["generate"], triangles=small["triangles"] if small else entry["triangles"])
    path = ROOT / entry["path"]
    if not path.exists():
        raise SystemExit(f"benchmark: {path} is missing; scripts/data lays it there")
    return lodestone.read(path, attributes=False)


def write_picture(path, picture):
    image.imsave(path, numpy.ascontiguousarray(picture))


def read_picture(path):
    return (image.imread(path)[:, :, :3] * 255).round().astype(numpy.uint8)


def make(given):
    table = tomllib.loads((HERE / "benchmark.toml").read_text(encoding="utf-8"))
    small = table["small"] if given.small else None
    size, frames = (small or table)["size"], (small or table)["frames"]
    for name in given.model or (small["models"] if small else table["models"]):
        if name not in table["models"]:
            raise SystemExit(f"benchmark: no model {name}; known are {', '.join(table['models'])}")
        mesh = read_model(table["models"][name], small)
        folder = given.folder / name
        folder.mkdir(parents=True, exist_ok=True)
        mesh.save(folder / "model.ply")
        surface, full = flights.Surface(mesh.positions, mesh.up), scores.whole(mesh)
        chosen = {flight: flights.cameras(surface, flight, frames, table["fov_degrees"])
                  for flight in given.flight or table["flights"]["names"]}
        if given.keyframes:
            chosen["imported"] = flights.from_keyframes(given.keyframes.read_text(encoding="utf-8"), frames)
        for flight, cameras in chosen.items():
            say(f"{name}, {flight}: {frames} frames")
            (folder / flight).mkdir(exist_ok=True)
            (folder / flight / "path.json").write_text(flights.to_json(cameras), encoding="utf-8")
            for number, camera in enumerate(cameras):
                write_picture(folder / flight / f"{number:04}.png", scores.draw(full, camera, size))


def tests_in(folder):
    """(model folder, flight folder, cameras, size of the pictures) of all flights."""
    found = sorted(folder.glob("*/*/path.json"))
    if not found:
        raise SystemExit(f"benchmark: {folder} holds no flight; `benchmark.py make {folder}` makes them")
    for path in found:
        cameras = flights.from_json(path.read_text(encoding="utf-8"))
        height, width, _ = read_picture(path.parent / "0000.png").shape
        yield path.parents[1], path.parent, cameras, (width, height)


def draw(given):
    hierarchies = {}
    for model, flight, cameras, size in tests_in(given.folder):
        if model not in hierarchies:
            hierarchies = {model: lodestone.build(model / "model.ply")}
        out = given.submission / model.name / flight.name
        out.mkdir(parents=True, exist_ok=True)
        for number, (place, aim, up, fov) in enumerate(cameras):
            camera = lodestone.Camera(tuple(place), tuple(aim), tuple(up), float(numpy.radians(fov)))
            options = {"size": size, "pixel_error": given.pixel_error, "effects": "geomorph,head-light,smooth-normals"}
            write_picture(out / f"{number:04}.png", lodestone.render(hierarchies[model], camera, **options))
            lodestone.select(hierarchies[model], camera, **options).mesh().save(out / f"{number:04}.ply")


def score_flight(model, flight, cameras, size, drawn, full):
    mesh, edges = full
    empty, before, frames = scores.background(size), None, []
    for number, camera in enumerate(cameras):
        reference, row = read_picture(flight / f"{number:04}.png"), {"frame": number}
        surface, picture = drawn / f"{number:04}.ply", drawn / f"{number:04}.png"
        if not surface.exists() and not picture.exists():
            raise SystemExit(f"benchmark: neither {picture} nor {surface} is there")
        if surface.exists():
            own = lodestone.read(surface, attributes=False)
            row |= scores.of_mesh(mesh, own, camera, size)
            row["new_open_edges"] = max(row.pop("open_edges") - edges, 0)
        shown = read_picture(picture) if picture.exists() else scores.draw(scores.whole(own), camera, size)
        if shown.shape != reference.shape:
            raise SystemExit(f"benchmark: {picture} is {shown.shape[1]}x{shown.shape[0]}, not {size[0]}x{size[1]}")
        row |= scores.of_picture(reference, shown, empty)
        still = before and scores.stands_still(cameras[number - 1], camera)
        row["pop"] = scores.pop((before[0], reference), (before[1], shown)) if still else None
        before = (reference, shown)
        frames.append(row)
    return frames


def markdown(rows):
    lines = ["| model | flight | " + " | ".join(COLUMNS) + " |", "| " + " | ".join(["---"] * 2 + ["---:"] * len(COLUMNS)) + " |"]
    for row in rows:
        cells = ["" if row.get(c) is None else f"{row[c]:,.0f}" if c in ("triangles", "hole_pixels", "new_open_edges")
                 else f"{row[c]:.3g}" for c in COLUMNS]
        lines.append(f"| {row['model']} | {row['flight']} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def score(given):
    rows, full = [], {}
    for model, flight, cameras, size in tests_in(given.folder):
        drawn = given.submission / model.name / flight.name
        if not drawn.exists():
            say(f"{model.name}, {flight.name}: not submitted")
            continue
        if model not in full:
            mesh = lodestone.read(model / "model.ply", attributes=False)
            full = {model: (mesh, scores.open_edges(mesh.positions, mesh.triangles))}
        frames = score_flight(model, flight, cameras, size, drawn, full[model])
        rows.append({"model": model.name, "flight": flight.name, **scores.summary(frames), "by_frame": frames})
        say(f"{model.name}, {flight.name}: {len(frames)} frames")
    if not rows:
        raise SystemExit(f"benchmark: {given.submission} holds none of the flights of {given.folder}")
    (given.submission / "scores.json").write_text(json.dumps({"rows": rows}, indent=1) + "\n", encoding="utf-8")
    (given.submission / "scores.md").write_text(markdown(rows), encoding="utf-8")
    print(markdown(rows), end="")


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].removeprefix("usage: "), description=__doc__.split("\n")[0])
    commands = parser.add_subparsers(required=True)
    for name, function in (("make", make), ("draw", draw), ("score", score)):
        command = commands.add_parser(name)
        command.set_defaults(run=function)
        command.add_argument("folder", type=pathlib.Path, metavar="DIR")
        if name == "make":
            command.add_argument("--small", action="store_true")
            command.add_argument("--model", action="append")
            command.add_argument("--flight", action="append", choices=flights.FLIGHTS)
            command.add_argument("--keyframes", type=pathlib.Path, metavar="FILE")
        else:
            command.add_argument("submission", type=pathlib.Path, metavar="SUBMISSION")
        if name == "draw":
            command.add_argument("--pixel-error", type=float, default=1.0)
    given = parser.parse_args()
    try:
        given.run(given)
    except (OSError, ValueError, lodestone.Error) as error:
        raise SystemExit(f"benchmark: {error}") from None


if __name__ == "__main__":
    main()
