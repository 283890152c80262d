"""Writes the summary of scripts/demo, one page with pictures (summary.html), and prints it as text (Markdown).

usage: summary.py FOLDER

The folder holds what the program wrote: build-NAME.json, verify-NAME.json and render-NAME.json, and a contact sheet for
each render in NAME/contact.png.
"""

import html
import json
import pathlib
import sys

STYLE = """
body { font: 16px/1.5 sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 0.9rem; }
th, td { border-bottom: 1px solid #ccc; padding: 0.2rem 0.8rem 0.2rem 0; text-align: left; vertical-align: top; }
img { max-width: 100%; }
figure { margin: 1.5rem 0; }
figcaption, details { font-size: 0.9rem; }
"""
PICTURES = {
    "scan": "The scan at a tolerance of one pixel.",
    "scan-levels": "The same flight, as coarse as the guarantee allows, coloured by level: the nearer, the finer.",
    "soft": "The generated sphere at a tolerance of one pixel.",
    "gl": "The same, drawn with OpenGL.",
    "levels": "The same flight over small cells, as coarse as the guarantee allows, coloured by level.",
}


def load(path):
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        sys.exit(f"summary: {path}: {error}")


def named(folder, kind):
    """The files KIND-NAME.json of the folder, by name."""
    return {path.stem.removeprefix(f"{kind}-"): load(path) for path in sorted(folder.glob(f"{kind}-*.json"))}


def hierarchies(builds):
    """Header and rows of a table with one column for each hierarchy."""
    rows = {
        "input triangles": lambda b: f"{b['input_triangles']:,}",
        "levels": lambda b: b["levels"],
        "stored triangles": lambda b: f"{b['stored_triangles']:,} ({b['stored_triangles'] / b['input_triangles']:.2f} of the input)",
        "sigma0": lambda b: f"{b['sigma0']:.4g}",
        "seconds, reading and writing included": lambda b: f"{b['file_seconds']:.2f}",
        "million triangles per core-second, partition to packed levels": lambda b: f"{b['mtri_per_core_second']:.2f}",
        "peak memory": lambda b: f"{b['peak_bytes'] / 2**20:.0f} MiB",
    }
    return ["hierarchy", *builds], [[name, *map(value, builds.values())] for name, value in rows.items()]


def checks(verify):
    rows = [[c["name"], "passed" if c["passed"] else "FAILED", c.get("detail", "")] for c in verify["checks"]]
    return ["check", "result", "detail"], rows


def verdict(name, verify):
    word = "valid" if verify["valid"] else "NOT VALID"
    return f"The hierarchy of {name} is {word}: {len(verify['checks'])} checks."


def flights(renders):
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
    header = ["flight", "frames", "triangles a frame", "ms a frame (median)", "open edges (max)", "gap, % (max)",
              "vertex jump, pixels (max)", "step of the camera, % (max)", "vertex jump over its bound (max)"]
    return header, rows


GUARANTEE = ("No cracks: open edges and gap are 0. No pops: no vertex jumps farther than the analytic bound (at most 1).")


def markdown_table(table):
    header, rows = table
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in [header, *rows]]
    lines.insert(1, "|" + "---|" * len(header))
    return "\n".join(lines)


def html_table(table):
    def line(tag, cells):
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"

    header, rows = table
    return "\n".join(["<table>", line("th", header), *(line("td", row) for row in rows), "</table>"])


def text_of(folder, builds, verifies, renders):
    parts = ["# Lodestone demo", markdown_table(hierarchies(builds))]
    for name, verify in verifies.items():
        parts += [verdict(name, verify), markdown_table(checks(verify))]
    parts += [markdown_table(flights(renders)), GUARANTEE,
              "\n".join(["Files:", "", f"- page with pictures: {folder / 'summary.html'}",
                         *(f"- contact sheet `{name}`: {folder / name / 'contact.png'}" for name in renders),
                         *(f"- hierarchy: {folder / name}.lode" for name in builds),
                         f"- measurements: {folder}/*.json"])]
    return "\n\n".join(parts) + "\n"


def page_of(builds, verifies, renders):
    parts = ["<!DOCTYPE html>", '<html lang="en"><head><meta charset="utf-8"><title>Lodestone demo</title>',
             f"<style>{STYLE}</style></head><body>", "<h1>Lodestone demo</h1>"]
    for name in sorted(renders, key=lambda name: ([*PICTURES, name].index(name), name)):
        caption = html.escape(PICTURES.get(name, name))
        parts.append(f'<figure><img src="{name}/contact.png" alt="{caption}"><figcaption>{caption}</figcaption></figure>')
    parts += ["<h2>Flights</h2>", html_table(flights(renders)), f"<p>{GUARANTEE}</p>",
              "<h2>Hierarchies</h2>", html_table(hierarchies(builds))]
    for name, verify in verifies.items():
        parts.append(f"<details><summary>{html.escape(verdict(name, verify))}</summary>{html_table(checks(verify))}</details>")
    return "\n".join([*parts, "</body></html>"]) + "\n"


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: summary.py FOLDER")
    folder = pathlib.Path(sys.argv[1])
    builds, verifies, renders = (named(folder, kind) for kind in ("build", "verify", "render"))
    if not builds or not verifies or not renders:
        sys.exit(f"summary: {folder}: needs build-*.json, verify-*.json and render-*.json")
    (folder / "summary.html").write_text(page_of(builds, verifies, renders))
    print(text_of(folder, builds, verifies, renders), end="")


if __name__ == "__main__":
    main()
