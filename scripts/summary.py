"""Prints the one-page summary of scripts/demo (Markdown) from the JSON files that the program wrote into a folder."""

import json
import pathlib
import sys


def load(path):
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        sys.exit(f"summary: {path}: {error}")


def table(header, rows):
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in [header, *rows]]
    lines.insert(1, "|" + "---|" * len(header))
    return "\n".join(lines)


def building(build):
    stored = build["stored_triangles"] / build["input_triangles"]
    return table(
        ["hierarchy", "value"],
        [
            ["input triangles", f"{build['input_triangles']:,}"],
            ["levels", build["levels"]],
            ["stored triangles", f"{build['stored_triangles']:,} ({stored:.2f} of the input)"],
            ["sigma0", f"{build['sigma0']:.4g}"],
            ["seconds, reading and writing included", f"{build['file_seconds']:.2f}"],
            ["million triangles per core-second, partition to packed levels", f"{build['mtri_per_core_second']:.2f}"],
            ["peak memory", f"{build['peak_bytes'] / 2**20:.0f} MiB"],
        ],
    )


def verification(verify):
    rows = [[c["name"], "passed" if c["passed"] else "FAILED", c.get("detail", "")] for c in verify["checks"]]
    word = "valid" if verify["valid"] else "NOT VALID"
    return f"The file is **{word}**: {len(rows)} checks.\n\n" + table(["check", "result", "detail"], rows)


def frames(renders):
    rows = []
    for name, render in renders.items():
        triangles = [frame["triangles"] for frame in render["frames"]]
        rows.append(
            [
                name,
                len(triangles),
                f"{min(triangles):,} - {max(triangles):,}",
                f"{render['frame_ms_median']:.1f}",
                render["open_edges"],
                f"{render['gap_max']:.3g}",
                f"{render['jump_pixels']:.3f}",
                f"{render['viewpoint_step']:.3g}",
                f"{render['jump_over_bound']:.3f}",
            ]
        )
    header = ["fly-in", "frames", "triangles a frame", "ms a frame (median)", "open edges (max)", "gap, % (max)",
              "vertex jump, pixels (max)", "step of the camera, % (max)", "vertex jump over its bound (max)"]
    return table(header, rows) + (
        "\n\n`soft` and `gl` draw at a tolerance of one pixel; `levels` draws small cells as coarse as the guarantee"
        " allows, coloured by level.\n\n"
        "No cracks: open edges and gap are 0. No pops: no vertex jumps farther than the analytic bound (at most 1)."
    )


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: summary.py FOLDER")
    folder = pathlib.Path(sys.argv[1])
    build, verify = load(folder / "build.json"), load(folder / "verify.json")
    renders = {path.stem.removeprefix("render-"): load(path) for path in sorted(folder.glob("render-*.json"))}
    if not renders:
        sys.exit(f"summary: {folder}: no render-*.json")
    pictures = [f"- contact sheet `{name}`: {folder / name / 'contact.png'}" for name in renders]
    print("# Lodestone demo\n")
    print(building(build), verification(verify), frames(renders), sep="\n\n")
    print("\nFiles:\n", *pictures, f"- hierarchy: {folder / 'sphere.lode'}", f"- measurements: {folder}/*.json", sep="\n")


if __name__ == "__main__":
    main()
