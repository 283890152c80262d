"""The tables of scripts/evaluate: rows of `lodestone report --json`, picked and put into Markdown; nothing is computed here."""

MB = 1e6

# Of each study: title, sweeps, and columns as (heading, parameter or column, divisor).
TABLES = {
    "scaling": [
        ("Strong and weak scaling", ("strong", "weak"),
         [("data", "data"), ("task", "task"), ("mode", "mode"), ("workers", "workers"),
          ("processors", "processors"), ("seconds", "seconds"), ("CPU seconds", "cpu_seconds"), ("speed-up", "speedup"), ("efficiency, %", "efficiency"), ("Karp-Flatt", "karp_flatt"),
          ("busy, %", "busy"), ("idle, s", "idle"), ("same result", "same")]),
        ("Strategies of the build", ("strategies",),
         [("data", "data"), ("cell triangles", "cell_triangles"), ("strategy", "strategy"), ("workers", "workers"),
          ("seconds", "seconds"), ("speed-up", "speedup"), ("efficiency, %", "efficiency"), ("idle, s", "idle"),
          ("idle tail, s", "idle_tail")]),
    ],
    "cost_of_accuracy": [
        ("Building: the level two above the finest", ("build", "build_optimal"),
         [("data", "data"), ("simplifier", "simplifier"), ("placement", "placement"), ("sigma0", "sigma0"),
          ("CPU seconds", "cpu_seconds"), ("Mtri per core-second", "mtri_per_core_second"), ("stored / input", "stored_ratio"),
          ("triangles", "level_triangles"), ("RMS, %", "rms"), ("max, %", "error_max"), ("normals, degrees", "normal_mean"),
          ("valid", "valid")]),
        ("Drawing", ("view",),
         [("data", "data"), ("backend", "backend"), ("pixel error", "pixel_error"), ("triangles", "triangles"),
          ("ms a frame", "frame_ms"), ("slowest, ms", "frame_ms_worst"), ("CPU ms", "frame_cpu_ms"),
          ("error on the screen, pixels", "screen_error"), ("image error, %", "image_error"), ("PSNR, dB", "psnr"),
          ("SSIM", "ssim"), ("FLIP", "flip")]),
        ("Reconstructing", ("reconstruct",),
         [("data", "data"), ("resolution", "resolution"), ("views", "view_count"), ("merge", "merge"), ("triangles", "triangles"),
          ("CPU seconds", "cpu_seconds"), ("RMS, %", "rms"), ("max, %", "error_max"), ("coverage, %", "coverage"),
          ("slivers, %", "slivers"), ("manifold", "manifold")]),
        ("Progressive meshes", ("progressive", "progressive_textured"),
         [("data", "data"), ("metric", "metric"), ("triangles", "triangles"), ("share, %", "share"),
          ("CPU seconds", "cpu_seconds"), ("RMS, %", "rms"), ("max, %", "error_max"), ("normals, degrees", "normal_mean"),
          ("residual edges", "residual_edges")]),
    ],
    "ablation": [
        ("Below and above the admissible border", ("border", "metrics"),
         [("data", "data"), ("metric", "metric"), ("viewpoints", "camera"), ("kappa0 / rho", "over_border"),
          ("admissible", "admissible"), ("residual edges", "open_edges"), ("cracked, %", "cracked_frames"),
          ("gap, % of extent", "gap_max"), ("gap, pixels", "gap_pixels"), ("T-junctions", "t_junctions"),
          ("torn pixels", "torn_pixels"), ("jump / bound", "jump_over_bound")]),
        ("Radii: uniform and by level", ("radii",),
         [("data", "data"), ("radii", "radii"), ("kappa0 / rho", "over_border"), ("surface triangles", "surface_triangles"),
          ("triangles drawn", "triangles"), ("select, ms", "select_ms"), ("residual edges", "open_edges"),
          ("jump / bound", "jump_over_bound")]),
        ("Blending functions", ("blend",),
         [("data", "data"), ("blend", "blend"), ("jump / bound", "jump_over_bound"), ("jump, pixels", "jump_pixels"),
          ("jump p99, pixels", "jump_p99_pixels"), ("image error, %", "image_error"), ("pop p99, %", "pop_p99"),
          ("pop area, pixels", "pop_area"), ("FLIP pop p99", "flip_pop_p99"), ("FLIP pop area", "flip_pop_area"),
          ("residual edges", "open_edges")]),
        ("sigma0", ("sigma0",),
         [("data", "data"), ("sigma0", "sigma0"), ("rho", "rho"), ("surface triangles", "surface_triangles"),
          ("ms a frame", "frame_ms"), ("image error, %", "image_error"), ("FLIP", "flip"), ("jump, pixels", "jump_pixels"),
          ("residual edges", "open_edges")]),
        ("Width of the band", ("band",),
         [("data", "data"), ("blend", "blend"), ("beta", "beta"), ("surface triangles", "surface_triangles"),
          ("jump, % of extent", "jump_max"), ("jump / step", "jump_per_step"), ("jump / bound", "jump_over_bound"),
          ("residual edges", "open_edges")]),
    ],
    "systems": [
        ("Systems on the same path", ("scans", "generated", "orbit"),
         [("data", "data"), ("path", "camera"), ("pixel error", "pixel_error"), ("system", "system"),
          ("residual edges", "open_edges"), ("cracked, %", "cracked_frames"), ("gap, pixels", "gap_pixels"),
          ("torn pixels", "torn_pixels"), ("jump, pixels", "jump_pixels"), ("jump / bound", "jump_over_bound"),
          ("image error, %", "image_error"), ("FLIP", "flip"), ("pop p99, %", "pop_p99"), ("FLIP pop p99", "flip_pop_p99"),
          ("FLIP pop area", "flip_pop_area"), ("ms a frame", "frame_ms"),
          ("slowest, ms", "frame_ms_worst")]),
    ],
    "published": [
        ("Stand-ins for the published models", ("size_1", "size_2", "size_3", "size_4"),
         [("model", "model"), ("data", "data"), ("published", "published"), ("limit, GiB", "memory_limit"),
          ("vertices", "vertices"), ("triangles", "triangles"), ("HLOD vertices", "hlod_vertices"),
          ("HLOD triangles", "hlod_triangles"), ("seconds", "seconds"), ("CPU seconds", "cpu_seconds"),
          ("read, s", "read_seconds"), ("build, s", "build_seconds"), ("of that spill, s", "spill_seconds"),
          ("write, s", "write_seconds"), ("build, CPU s", "build_cpu_seconds"), ("Mtri per core-second", "mtri_per_core_second"),
          ("file to file", "mtri_per_core_second_file"), ("peak MB", "peak_memory", MB), ("file MB", "bytes", MB),
          ("valid", "valid")]),
        ("Families of levels at equal triangles", ("families",),
         [("data", "data"), ("family", "family"), ("level", "level"), ("triangles", "triangles"), ("seconds", "seconds"),
          ("CPU seconds", "cpu_seconds"), ("all levels at once", "all_levels"), ("RMS, %", "rms"), ("max, %", "error_max"),
          ("p99, %", "error_p99"), ("normals, degrees", "normal_mean"), ("slivers, %", "slivers"), ("manifold", "manifold")]),
    ],
    "effects": [
        ("Effects", ("soft", "gl"),
         [("scene", "data"), ("backend", "backend"), ("effects", "effects"), ("ms a frame", "frame_ms"),
          ("CPU ms", "frame_cpu_ms"), ("gain, ms", "gain_ms"), ("gain, CPU ms", "gain_cpu_ms"), ("gain, %", "gain"),
          ("same picture", "same_picture"), ("differing, %", "differing")]),
    ],
}


def number(value, divisor=1):
    value = value / divisor
    if float(value).is_integer() and abs(value) >= 1000:
        return f"{int(value):,}"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def cell(value, divisor=1):
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict):                                # over repetitions or rounds
        median, least, most = (number(value[key], divisor) for key in ("median", "least", "most"))
        dash = " to " if value["least"] < 0 else "-"           # gains may be losses
        return median if median == least == most else f"{median} ({least}{dash}{most})"
    return number(value, divisor) if isinstance(value, (int, float)) else str(value)


def table(sweeps, columns):
    rows = [setting["values"] for sweep in sweeps for setting in sweep["settings"]]
    lines = ["| " + " | ".join(column[0] for column in columns) + " |", "|" + "---|" * len(columns)]
    for row in rows:
        lines.append("| " + " | ".join(cell(row.get(column[1]), *column[2:]) for column in columns) + " |")
    return lines if rows else ["No run of this table has verified rows."]


def markdown(report):
    lines = [f"{report['runs']} runs: {report['complete']} complete, {report['incomplete']} incomplete, "
             f"{report['unverified']} not verified, {report['failed']} failed, {report['missing']} missing.", ""]
    for study in report["studies"]:
        lines += [f"## {study['title']}", "", study["question"], ""]
        for title, names, columns in TABLES.get(study["name"], []):
            sweeps = [sweep for sweep in study["sweeps"] if sweep["name"] in names]
            lines += [f"### {title}", "", *table(sweeps, columns), ""]
        for figure in study["figures"]:
            if figure.get("outcome"):
                lines.append(f"- {figure['title']}: {figure['outcome']}")
        lines.append("")
    return "\n".join(lines)
