#!/usr/bin/env python3
"""The tables of progressive meshes in docs/results.md, as Markdown.

usage: scripts/progressive.py [PROGRAM [DATA]]   default: build/release/experiments/lodestone, build/data
"""

import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
MODELS = ("scans/stanford-bunny.obj scans/armadillo.obj scans/igea.ply scans/lucy100k.ply scans/nefertiti.obj "
          "scans/skull.obj scans/dragon_vrip_res2.ply textured/Hermes/Hermes.obj textured/Gutenberg/Gutenberg.obj "
          "textured/spot/spot_triangulated.obj textured/WaterBottle/WaterBottle.obj "
          "textured/ShepherdBoy/ShepherdBoy.obj cad/fandisk.obj cad/casting.off").split()
COUNTS = (50_000, 5_000, 500)


def run(program, folder, *words):
    result = folder / "result.json"
    subprocess.run([program, *map(str, words), "--json", result, "--quiet"], check=True, cwd=folder)
    return json.loads(result.read_text())


def distance(program, folder, a, b):
    """RMS and maximum, the larger of both directions, in per cent of the diagonal."""
    result = run(program, folder, "compare", a, b)
    worst = lambda key: 100 * max(result[way][key] for way in ("forward", "backward")) / result["diagonal"]
    return f"{worst('rms'):.4f} / {worst('max'):.3f}"


def row(program, folder, model):
    """A line of the first table; the mesh stays in the folder as m.glb."""
    textured = "textured" in str(model)
    make = lambda output, *more: run(program, folder, "progressive", model, "-o", output, "--base", 500, "--threads", 1, *more)
    rate = lambda *more: max(make("m.lpm", *more)["faces_per_cpu_second"] for _ in range(5)) / 1e6
    speed, attributes = rate(), rate("--metric", "attribute-quadric") if textured else None
    full = run(program, folder, "progressive", model, "-o", "full.lpm")
    glb = make("m.glb", "--check-levels", 20)
    errors = []
    for count in COUNTS:
        if count > glb["triangles"]:
            errors.append("")
            continue
        run(program, folder, "lod", "m.glb", "--triangles", count, "-o", "level.ply")
        errors.append(distance(program, folder, model, "level.ply"))
    cells = [model.stem, f"{glb['triangles']:,}", f"{speed:.2f}", f"{attributes:.2f}" if attributes else "",
             f"{full['bytes_per_vertex']:.2f}", f"{full['base_triangles']:,}", *errors, glb["residual_edges"],
             glb["cut_vertices"] or ""]
    return "| " + " | ".join(map(str, cells)) + " |"


def beside_others(program, folder, model):
    """Lines of the second table: levels of a hierarchy, and of the other families with as many triangles.

    A reconstruction has about as many as it is asked for: asked again by what it gave, it stays within a few per cent.
    """
    run(program, folder, "build", model, "-o", "m.lode", "--cell-triangles", 2500, "--no-attributes")
    run(program, folder, "progressive", model, "-o", "m.glb", "--no-attributes")
    levels = run(program, folder, "info", "m.lode")["levels"]
    for level in range(len(levels) - 2, -1, -1):
        count = levels[level]["triangles"]
        if count < 200:
            continue
        run(program, folder, "lod", "m.glb", "--triangles", count, "-o", "level.ply")
        made, asked = 0, count
        for _ in range(3):
            result = run(program, folder, "reconstruct", model, "--triangles", asked, "-o", "views.ply")
            made = result["levels"][0]["mesh"]["triangles"]
            if abs(made - count) <= 0.02 * count:
                break
            asked = max(1, round(asked * count / made))
        yield (f"| {model.stem} | {count:,} | {distance(program, folder, model, f'm.lode:{level}')} | "
               f"{distance(program, folder, model, 'level.ply')} | {distance(program, folder, model, 'views.ply')} | "
               f"{made:,} |")


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/experiments/lodestone").resolve()
    data = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ROOT / "build/data").resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        print("| model | faces | Mfaces / core-s | with attributes | bytes / vertex | base | " +
              " | ".join(f"{count:,}" for count in COUNTS) + " | cracks | cut |")
        print("|---" * 11 + "|")
        for name in MODELS:
            print(row(program, folder, data / name), flush=True)
        print("\n| model | triangles | hierarchy | progressive | reconstruction | of triangles |\n|---|---|---|---|---|---|")
        for name in MODELS[:4]:
            for line in beside_others(program, folder, data / name):
                print(line, flush=True)


if __name__ == "__main__":
    main()
