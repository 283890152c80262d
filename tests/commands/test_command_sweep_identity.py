"""What a run of lodestone sweep is known by: data, files, program. usage: test_command_sweep_identity.py PROGRAM"""

import hashlib
import json
import os
import pathlib
import subprocess

import command_case
from sweep_case import HEAD, SweepCase, section


class RecordedPaths(SweepCase):
    """camera = "walk.json", on a small sphere."""

    KEYS = [{"position": [4, 0, 1], "target": [0, 0, 0], "fov_degrees": 50},
            {"position": [0, 1.6, 0.3], "target": [0, 0.2, 0]}]
    HEAD = 'name = "walk"\n[data]\nball = { generate = "sphere", triangles = 4000 }\n'
    COMMON = "cell_triangles = 200, frames = 12, from = 0.2, width = 96, height = 72"

    def path_file(self, name, keys):
        return self.write(name, json.dumps({"frames": keys}))

    def text(self, experiment, parameters, cameras='"paths/walk.json"'):
        return self.HEAD + (f'[[sweep]]\nname = "s"\nexperiment = "{experiment}"\ndata = "ball"\n'
                            f"parameters = {{ camera = [{cameras}], {self.COMMON}, {parameters} }}\n")

    def files(self, output, run):
        return set(os.listdir(self.folder / output / "runs" / run))

    def setUp(self):
        super().setUp()
        (self.folder / "paths").mkdir()
        self.path_file("paths/walk.json", self.KEYS)

    def test_in_each_experiment_that_draws(self):
        for experiment, parameters in (
                ("flight", 'kappa0 = 1.5, image = true, backend = "soft", effects = "head-light,geomorph"'),
                ("systems", 'effects = ["auto", "none"]'),
                ("raster", 'measured_frames = 2, effects = "all"')):
            self.sweep(self.text(experiment, parameters, '"paths/walk.json", "fly-in"'), output=experiment)
            for run, parameters, _ in self.runs(experiment):
                (row,) = self.rows(run, 0, experiment)
                if experiment != "raster":
                    self.assertEqual((row["admissible"], row["open_edges"], row["gap_max"], row["torn_pixels"]),
                                     (True, 0, 0, 0), parameters)
                    self.assertGreater(row["jump_max"], 0)
                    self.assertLessEqual(row["jump_over_bound"], 1)
                    self.assertLessEqual({"worst-drawn.png", "worst-full.png", "worst-flip.png", "differences.png",
                                          "flight.webp"}, self.files(experiment, run))
            merged = f"{experiment}-merged"
            self.results("merge", experiment, "-o", merged, "--quiet")
            for run, _, _ in self.runs(experiment):
                self.assertEqual(self.files(merged, run), self.files(experiment, run))
            column = "hash" if experiment == "raster" else "jump_max"
            flown = {p["camera"]: self.rows(run, 0, experiment)[0][column] for run, p, _ in self.runs(experiment)}
            self.assertNotEqual(flown["paths/walk.json"], flown["fly-in"])

    def test_content_decides_and_not_the_name(self):
        flight = self.text("flight", "rounds = 1")
        self.sweep(flight)
        (run, parameters, _), = self.runs()
        self.assertEqual(parameters["camera"], "paths/walk.json")
        recorded = self.read(run, "parameters.json")["files"]["camera"]
        content = (self.folder / "paths/walk.json").read_bytes()
        self.assertEqual(recorded["sha256"], hashlib.sha256(content).hexdigest())
        self.assertEqual((self.folder / "out" / recorded["path"]).read_bytes(), content)
        self.assertEqual(self.plan()["files"], {"paths/walk.json": recorded})
        (self.folder / "paths/walk.json").rename(self.folder / "stroll.json")
        renamed = flight.replace("paths/walk.json", "stroll.json")
        self.assertEqual(self.sweep(renamed, "--resume")["ran"], 0)
        self.path_file("stroll.json", self.KEYS[::-1])
        self.assertEqual(self.sweep(renamed, "--resume")["ran"], 1)
        self.assertNotEqual(self.runs()[0][0], run)
        other = self.folder / "elsewhere"  # the sweep file is called from there: paths are relative to the file
        other.mkdir()
        done = command_case.call("sweep", "../sweep.toml", "-o", "../out", "--resume", "--quiet", "--json", "-",
                                 cwd=other)
        self.assertEqual(json.loads(done.stdout)["before"], 1, done.stderr)
        merged = self.results("merge", "out", "-o", "all", "--quiet")
        self.assertEqual(merged["done"], 1)
        copy = self.plan("all")["files"]["stroll.json"]["path"]
        self.assertEqual((self.folder / "all" / copy).read_bytes(), (self.folder / "stroll.json").read_bytes())

    def test_missing_and_broken(self):
        self.write("sweep.toml", self.text("systems", "rounds = 1", '"paths/none.json"'))
        for more in ((), ("--dry-run",)):
            self.refused("sweep", "sweep.toml", "-o", "out", *more,
                         names=['sweep.toml: line 8: sweep 1, camera = "paths/none.json": ', "cannot be opened",
                                "relative to"])
        self.write("paths/none.json", '{"frames": [{"position": [1, 2]}]}')
        self.refused("sweep", "sweep.toml", "-o", "out", names=["line 8", 'has no "target"', "a good file"])
        self.write("sweep.toml", self.text("raster", 'effects = "fog,glow"', '"orbit"'))
        self.refused("sweep", "sweep.toml", "-o", "out", names=["line 8", "unknown effect 'glow'", "head-light"])
        self.assertIn("recorded path (.json)", self.lodestone("experiments", "flight"))
        self.assertIn("ambient-occlusion", self.lodestone("experiments", "flight"))


class Identity(SweepCase):
    """Copies of the program with some bytes changed."""

    def program(self, name, change=None):
        """(hash, commit) that the copy states."""
        content = pathlib.Path(command_case.PROGRAM).read_bytes()
        copy = self.write(name, change(content) if change else content)
        copy.chmod(0o755)
        self.write("sweep.toml", HEAD + section("x = 1"))
        subprocess.run([copy, "sweep", "sweep.toml", "-o", name + ".out"], cwd=self.folder, check=True,
                       capture_output=True, timeout=60)
        (run, _, _), = self.runs(name + ".out")
        manifest = self.read(run, "manifest.0.json", name + ".out")
        return self.plan(name + ".out")["program"], manifest["commit"]

    def test_is_of_what_the_program_does_and_not_of_its_commit(self):
        program, commit = self.program("same")
        if commit != "unknown":
            other = self.program("committed", lambda content: content.replace(commit.encode(), b"0123456789" * 4))
            self.assertEqual(other, (program, "0123456789" * 4))
        text = b"Lodestone: level of detail of large triangle surfaces"
        other = self.program("changed", lambda content: content.replace(text, text.replace(b"Lode", b"Bode")))
        self.assertNotEqual(other[0], program)


    def test_run_of_another_program_is_an_error(self):
        self.sweep(HEAD + section("x = 1"))
        (run, parameters, _), = self.runs()
        job = {"experiment": "probe", "parameters": parameters, "input": self.read(run, "parameters.json")["input"],
               "repetition": 0, "processors": []}
        for program, expected in ((self.plan()["program"], False), ("0" * 64, True)):
            work = self.folder / program
            (work / "files").mkdir(parents=True)
            (work / "job.json").write_text(json.dumps({**job, "program": program}))
            self.lodestone("sweep-run", work, "--report", 1)
            self.assertEqual((work / "fault.json").exists(), expected)
            self.assertNotEqual((work / "rows.jsonl").exists(), expected)
        self.assertIn("libraries changed since the sweep began", (work / "fault.json").read_text())


if __name__ == "__main__":
    command_case.main(__doc__)
