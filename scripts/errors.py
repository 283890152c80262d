"""Two sections of scripts/measure: errors, estimated and measured, beside sampled distances; and split edges."""

import pathlib

DATA = pathlib.Path("build/data")
CAD = ["--cell-triangles", 300]      # small models have no levels to speak of otherwise

REFINED = {                          # model: file, options of build
    "fandisk": (DATA / "cad/fandisk.obj", CAD),
    "casting": (DATA / "cad/casting.off", CAD),
    "gears": (DATA / "cad/gears.stl", CAD),
    "ADIS16480": (DATA / "cad/ADIS16480.STL", CAD),
    "thingi_88566": (DATA / "cad/thingi_88566.stl", CAD),
    "thingi_1514499": (DATA / "cad/thingi_1514499.stl", CAD),
    "thingi_73416": (DATA / "cad/thingi_73416.stl", CAD),
    "1002_tray_bottom": (DATA / "cad/1002_tray_bottom.STL", CAD),
    "tower_holes": (DATA / "cad/tower_holes.obj", []),
    "N46E008, voids filled": (DATA / "terrain/N46E008.hgt", ["--fill-voids"]),
    "komaba_02": (DATA / "scans/komaba_02.drc", []),
}


class Errors:
    """Runs what it needs by `run`; `find_input` gives the file of a model, or nothing."""

    def __init__(self, run, good, table, find_input, work, coarse, drawn):
        self.run, self.good, self.table, self.find_input = run, good, table, find_input
        self.work, self.coarse, self.drawn = work, coarse, drawn

    def estimated_and_measured(self, names):
        """e_l by the builder and by --measure-error beside the distance from M_L sampled by `compare`, all over h_l."""
        lines, costs = [], []
        for name in names:
            path = self.find_input(name)
            if path is None:
                continue
            key = f"errors-{name}".replace(" ", "-")
            lode, exact = self.work / f"{key}.lode", self.work / f"{key}-measured.lode"
            build = self.run(f"{key}-build", ["build", path, "-o", lode])
            measured = self.run(f"{key}-measure", ["build", path, "-o", exact, "--measure-error"])
            if not (self.good(build) and self.good(measured)):
                continue
            verify = self.run(f"{key}-verify", ["verify", exact])
            info = self.run(f"{key}-info", ["info", lode])["result"]
            levels = len(info["levels"])
            meshes = [self.work / f"{key}-{level}.ply" for level in range(levels)]
            for level, mesh in enumerate(meshes):
                if not self.run.is_known(f"{key}-compare-{level}") and level < levels - 1:
                    for wanted in (level, levels - 1):
                        if not meshes[wanted].exists():
                            self.run(f"{key}-export-{wanted}", ["export", lode, "--level", wanted, "-o", meshes[wanted]])
                if level == levels - 1:
                    continue
                row = self.run(f"{key}-compare-{level}", ["compare", mesh, meshes[-1]])
                if not self.run.dry:
                    mesh.unlink(missing_ok=True)
                if not self.good(row):
                    continue
                unit = info["scale"] / 2 ** level
                far = max(row["result"][side]["max"] for side in ("forward", "backward")) / unit
                e, certain = (b["result"]["error_ratio"][level] for b in (build, measured))
                lines.append([name, level, f"{info['levels'][level]['triangles']:,}", f"{e:.5f}", f"{certain:.5f}",
                              f"{far:.5f}", f"{e / far:.2f}", f"{certain / far:.2f}"])
            stages = measured["result"]["stages"]
            costs.append([name, f"{measured['result']['input_triangles']:,}", f"{stages['build']['cpu_seconds']:.2f}",
                          f"{stages['measure']['cpu_seconds']:.2f}", f"{stages['measure']['seconds']:.2f}",
                          f"{1e6 * stages['measure']['cpu_seconds'] / measured['result']['input_triangles']:.1f}",
                          "valid" if self.good(verify) and verify["result"]["valid"] else "NOT VALID"])
            for file in () if self.run.dry else [lode, exact, *meshes]:
                file.unlink(missing_ok=True)
        return (self.table(["model", "level", "triangles", "e estimated", "e measured", "max distance (sampled) / h",
                            "estimated over sampled", "measured over sampled"], lines) + "\n" +
                self.table(["model", "triangles", "build, CPU s", "measuring, CPU s", "measuring, s by two threads",
                            "us of CPU per triangle", "verify"], costs))

    def refined(self, frames):
        """What --refine does to models with long edges, and what a fly-in draws at one pixel."""
        lines = []
        for name, (path, options) in REFINED.items():
            if not (self.run.dry or path.exists()):
                continue
            for refine in (False, True):
                key = f"refine-{name}-{refine}".replace(" ", "-")
                lode = self.work / f"{key}.lode"
                build = self.run(f"{key}-build", ["build", path, "-o", lode, *options, *(["--refine"] if refine else [])])
                if not self.good(build):
                    continue
                info = self.run(f"{key}-info", ["info", lode])
                reading = [o for o in options if o == "--fill-voids"]
                verify = self.run(f"{key}-verify", ["verify", lode, "--input", path, *reading])
                fly = self.run(f"{key}-fly", ["render", lode, "--backend", "null", "--frames", frames, "--camera", "fly-in",
                                              "--pixel-error", 1])
                if not self.run.dry:
                    lode.unlink(missing_ok=True)
                b = build["result"]
                cracks = fly["result"]["cracks"]["open_edges_max"] if self.good(fly) else "failed"
                lines.append([name, "split" if refine else "as it is", f"{b['input_triangles']:,}", b["levels"],
                              f"{b['long_edges']:,}", f"{b['max_edge_ratio']:.2f}",
                              f"{self.coarse(b['reach']['euclidean'], None):.3f}",
                              f"{info['result']['kappa0_admissible_above']['euclidean']:.3f}", f"{max(b['diameter']):.3f}",
                              f"{self.drawn(fly, 'triangles'):,.0f}" if self.good(fly) else "failed", cracks,
                              "valid" if self.good(verify) and verify["result"]["valid"] else "NOT VALID"])
        return self.table(["model", "edges", "triangles of M_L", "levels", "long half-edges", "longest edge / h_L", "rho",
                           "kappa0 admissible above", "D", "drawn at one pixel", "cracks", "verify"], lines)
