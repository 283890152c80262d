"""The directory of a sweep, made by hand as docs/format.md says. usage: sweep_folder.py DIR"""

import base64
import hashlib
import json
import pathlib
import random
import struct
import sys
import zlib

MANIFEST = {"commit": "0123456789abcdef0123456789abcdef01234567", "dirty": False, "compiler": "g++ 12.2.0",
            "flags": "-O3 -ffp-contract=off", "cpu": "A processor of 2 cores", "cores": 2, "affinity": [0, 1],
            "memory_bytes": 25 * 2**30, "host": "one"}
WEBP = base64.b64decode("UklGRiIAAABXRUJQVlA4IBYAAAAwAQCdASoBAAEADsD+JaQAA3AAAAAA")  # of one pixel


def column(name, kind, unit="", meaning="what it says"):
    return {"name": name, "unit": unit, "meaning": meaning, "kind": kind}


def parameter(name, unit="", description="what it sets"):
    return {"name": name, "unit": unit, "description": description}


def run_id(*what):
    return hashlib.sha256(repr(what).encode()).hexdigest()[:16]


def png(width, height, colour):
    """Bytes of a PNG with a gradient of `colour`."""
    lines = b"".join(b"\0" + bytes(int(c * (x + y) / (width + height)) for x in range(width) for c in colour)
                     for y in range(height))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


class SweepFolder:
    """Sweeps, their runs and what these left; write() puts down sweep.json, everything else is there at once."""

    def __init__(self, path, name="study", title="A study", question="What is to be found out?"):
        self.path = pathlib.Path(path)
        self.sheet = {"name": name, "title": title, "question": question, "program": "f" * 64, "figures": [], "sweeps": []}
        (self.path / "runs").mkdir(parents=True, exist_ok=True)

    def sweep(self, name, columns, parameters, repetitions=1, experiment="flight", question="Does it crack?"):
        self.sheet["sweeps"].append({"name": name, "experiment": experiment, "question": question, "repetitions": repetitions,
                                     "parameters": parameters, "columns": columns, "runs": []})
        return name

    def figure(self, title, sweep, x, y, **more):
        self.sheet["figures"].append({"title": title, "sweep": [sweep] if isinstance(sweep, str) else sweep, "x": x,
                                      "y": [y] if isinstance(y, str) else y, "series": [], "kind": "line", "log": "",
                                      "mark": "", "pareto": False, **more})

    def run(self, sweep, data, parameters):
        """The folder of a new run, with nothing but its parameters in it."""
        name = run_id(sweep, data, sorted(parameters.items()))
        entry = next(s for s in self.sheet["sweeps"] if s["name"] == sweep)
        entry["runs"].append({"id": name, "data": data, "parameters": parameters})
        folder = self.path / "runs" / name
        folder.mkdir()
        self.put(folder / "parameters.json", {"experiment": entry["experiment"], "data": data, "input": f"data/{data}.ply",
                                              "input_sha256": run_id(data) * 4, "program": "f" * 64, "parameters": parameters})
        return folder

    def put(self, path, value):
        path.write_text(json.dumps(value))

    def rows(self, folder, repetition, rows, **manifest):
        (folder / f"rows.{repetition}.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        self.put(folder / f"manifest.{repetition}.json", {**MANIFEST, "seconds": 1.0 + repetition, **manifest})

    def fault(self, folder, repetition, kind, *messages):
        self.put(folder / f"fault.{repetition}.json", {"kind": kind, "messages": list(messages)})

    def write(self):
        self.put(self.path / "sweep.json", self.sheet)
        return self.path


def small_study(path, gap="gap", **more):
    """One sweep of two settings with two repetitions each, all in order."""
    study = SweepFolder(path, **more)
    study.sweep("border", [column(gap, "accuracy", "pixels"), column("seconds", "cost", "s")], [parameter("kappa0")], 2)
    for kappa0 in (1.0, 4.0):
        folder = study.run("border", "sphere", {"kappa0": kappa0})
        for repetition in range(2):
            study.rows(folder, repetition, [{"seconds": kappa0 + repetition, gap: 4 - kappa0 if repetition == 0 else None}])
    study.figure("Gaps", "border", "kappa0", gap)
    return study


def add_border(study, chance):
    """Cracks below kappa0 = rho; one run does not verify, one crashes, one is not there yet, one lacks a repetition."""
    study.sweep("border", [column("gap_max", "accuracy", "pixels", "longest gap"), column("seconds", "cost", "s", "of a frame"),
                           column("triangles", "count", "", "drawn"), column("rho", "accuracy"), column("closed", "label")],
                [parameter("kappa0", "cell sizes", "radius"), parameter("blend", "", "blending function"),
                 parameter("threads")], repetitions=3)
    for data, rho in (("sphere", 2.1), ("armadillo <1>", 2.6)):
        for blend in ("linear", "step"):
            for kappa0 in (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0):
                folder = study.run("border", data, {"kappa0": kappa0, "blend": blend, "threads": 2})
                if (data, blend, kappa0) == ("sphere", "step", 8.0):
                    continue
                if (data, blend, kappa0) == ("sphere", "step", 6.0):
                    study.fault(folder, 0, "crash", "killed by signal 9")
                    continue
                for repetition in range(3):
                    if (data, blend, kappa0, repetition) == ("sphere", "linear", 8.0, 2):
                        study.fault(folder, 2, "error", "cannot write: No space left on device")
                        continue
                    row = {"seconds": 0.004 * kappa0 ** 1.7 * chance.uniform(0.97, 1.1), "triangles": int(9000 * kappa0 ** 1.9)}
                    if repetition == 0:
                        row |= {"gap_max": max(0.0, (rho - kappa0) * (3 if blend == "step" else 1)), "rho": rho, "closed": True}
                    study.rows(folder, repetition, [row], host="two" if repetition == 2 else "one")
                if (data, blend, kappa0) == ("armadillo <1>", "step", 3.0):
                    study.fault(folder, 1, "verify", "gap_max is 0.4 and should be 0", "open edges: 12 & more")
                if kappa0 == 2.0:
                    (folder / "worst.png").write_bytes(png(160, 100, (90, 140, 200)))
                    (folder / "worst.difference.png").write_bytes(png(160, 100, (220, 80, 60)))
                    (folder / "worst.film.webp").write_bytes(WEBP)
    study.figure("Cracks below and above the border", "border", "kappa0", "gap_max", series=["data", "blend"], log="xy", mark="rho")
    study.figure("Time and triangles", "border", "kappa0", ["seconds", "triangles"], series=["data", "blend"], log="x")


def add_costs(study, chance):
    study.sweep("costs", [column("error", "accuracy", "% of the diagonal"), column("seconds", "cost", "s"),
                          column("seconds_min", "cost", "s"), column("seconds_max", "cost", "s"),
                          column("peak_memory", "cost", "bytes")],
                [parameter("simplifier"), parameter("sigma0")], repetitions=2, experiment="build",
                question="What does accuracy cost in time?")
    for simplifier, speed in (("quadric", 1), ("cluster", 0.4), ("meshopt", 0.7)):
        for sigma0 in (0.05, 0.1, 0.2, 0.4):
            folder = study.run("costs", "sphere", {"simplifier": simplifier, "sigma0": sigma0})
            for repetition in range(2):
                seconds = speed * (0.5 + 0.1 / sigma0) * chance.uniform(0.98, 1.05)
                study.rows(folder, repetition, [{"error": sigma0 ** 1.5 / speed * 0.2 if repetition == 0 else None,
                                                 "seconds": seconds, "seconds_min": seconds * 0.95,
                                                 "seconds_max": seconds * 1.08, "peak_memory": int(3e8 * (1 + sigma0))}])
    study.figure("What accuracy costs", "costs", "seconds", "error", series=["simplifier"], kind="scatter", log="y", pareto=True)
    study.figure("Memory by simplifier", "costs", "simplifier", "peak_memory", series=["sigma0"], kind="bar")


def add_scaling(study, chance):
    study.sweep("threads", [column("seconds", "cost", "s")], [parameter("strategy"), parameter("threads")], repetitions=3,
                experiment="build", question="What do more threads bring?")
    for strategy, serial in (("graph", 0.04), ("levels", 0.15)):
        for threads in (1, 2, 4, 8):
            folder = study.run("threads", "sphere", {"strategy": strategy, "threads": threads})
            for repetition in range(3):
                seconds = 8 * (serial + (1 - serial) / threads) * chance.uniform(0.99, 1.04)
                study.rows(folder, repetition, [{"seconds": seconds}])
    study.figure("Speed-up", "threads", "threads", "speedup", series=["strategy"], log="xy")
    study.figure("Efficiency and serial share", "threads", "threads", ["efficiency", "karp_flatt"], series=["strategy"])


def make(path):
    """A study with everything that a report shows."""
    chance = random.Random(1)
    study = SweepFolder(path, "ablation", "Ablation over kappa0 & the blending function",
                        "Which settings crack, which pop, and what do they cost?")
    add_border(study, chance)
    add_costs(study, chance)
    add_scaling(study, chance)
    (study.path / "runs" / "00000000deadbeef").mkdir()
    return study.write()


if __name__ == "__main__":
    make(sys.argv[1])
