"""The examples, built against the installed package, are run. usage: test_examples.py FOLDER Library|Extending"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

FOLDER = None


class Examples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_example(self, name, *arguments, status=0):
        done = subprocess.run([pathlib.Path(FOLDER) / name, *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(done.returncode, status, f"{name} {arguments}: {done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    def file(self, name):
        return self.folder / name


class Library(Examples):
    def test_a_mesh_of_ones_own_is_built_listed_verified_and_drawn(self):
        model, level = self.file("own.lode"), self.file("level.ply")
        self.assertIn("levels", self.run_example("own_mesh", model))
        self.assertIn("level 0:", self.run_example("levels", model, 1, level))
        self.assertNotIn("FAILS", self.run_example("verify", model))
        self.run_example("draw", model, self.file("picture.png"))
        self.assertEqual(self.file("picture.png").read_bytes()[:4], b"\x89PNG")
        again = self.file("again.lode")
        self.assertIn("in memory", self.run_example("build", level, again))
        self.assertIn("input", self.run_example("verify", again, level))
        self.run_example("verify", again, self.file("other.ply"), status=1)

    def test_programs_that_say_what_they_find(self):
        for name, said in (("measure", "at most"), ("compare", "RMS"), ("cracks", "(admissible): 0 open edges"),
                           ("pops", "of the bound"), ("blend", "Lipschitz constant 2.000")):
            self.assertIn(said, self.run_example(name))
        self.assertNotIn("DIFFERENT", self.run_example("threads", self.folder))

    def test_a_build_is_cancelled_or_done(self):
        self.assertIn("cancelled after", self.run_example("cancel", 1))

    def test_the_other_systems_write_what_they_make(self):
        for name, file in (("progressive", "torus.lpm"), ("shell", "shell.ply"), ("spherical", "sphere.glb")):
            self.run_example(name, self.file(file))
            self.assertGreater(self.file(file).stat().st_size, 1000)


class Extending(Examples):
    def setUp(self):
        super().setUp()
        self.mesh, self.model = self.file("torus.ply"), self.file("torus.lode")
        self.run_example("simplifier", "generate", "torus", "--triangles", 60000, "-o", self.mesh, "--quiet")

    def built(self, program="simplifier", simplifier="shortest-edge"):
        self.run_example(program, "build", self.mesh, "-o", self.model, "--simplifier", simplifier, "--quiet")

    def json_of(self, name, *arguments):
        file = self.file("result.json")
        self.run_example(name, *arguments, "--json", file, "--quiet")
        return json.loads(file.read_text())

    def test_a_simplifier_makes_a_file_that_verifies_and_has_its_name(self):
        self.built()
        self.run_example("backend", "verify", self.model, "--input", self.mesh)  # a program that does not know it
        self.assertEqual(self.json_of("backend", "info", self.model)["simplifier"], "shortest-edge")
        self.assertIn("known are quadric", self.run_example("backend", "build", self.mesh, "-o", self.model,
                                                            "--simplifier", "shortest-edge", status=3))
        proof = self.json_of("simplifier", "render", self.model, "--backend", "null", "--frames", 8)
        self.assertEqual(max(frame["open_edges"] for frame in proof["frames"]), 0)

    def test_a_backend_draws(self):
        self.built("backend", "quadric")
        frames = self.file("frames")
        self.run_example("backend", "render", self.model, "-o", frames, "--backend", "dots", "--frames", 2, "--size",
                         "160x120")
        self.assertEqual(len(list(frames.glob("frame*.png"))), 2)

    def rows(self, program, experiment, parameters):
        sweep, out = self.file("sweep.toml"), self.file("out")
        sweep.write_text(f"""name = "own"
            title = "A part of one's own"
            question = "Does it take part?"
            [data]
            torus = {{ path = "{self.mesh}" }}
            [[sweep]]
            name = "own"
            experiment = "{experiment}"
            data = "torus"
            parameters = {{ {parameters} }}""")
        self.run_example(program, "sweep", sweep, "-o", out)
        return [json.loads(line) for rows in sorted(out.rglob("rows.*.jsonl")) for line in rows.read_text().splitlines()]

    def test_an_experiment_is_listed_and_swept(self):
        self.assertIn("reduction", self.run_example("experiment", "experiments"))
        self.assertIn("cell_triangles", self.run_example("experiment", "experiments", "reduction"))
        rows = self.rows("experiment", "reduction", "cell_triangles = [500, 4000]")
        self.assertEqual(len(rows), 2)
        for row in rows:
            self.assertLess(row["reduction"], 0.5)

    small = 'width = 96, height = 64, frames = 4, cell_triangles = 500, pixel_error = 4.0'

    def test_an_lod_system_and_a_curve_take_part_in_experiments(self):
        row, = self.rows("lod_system", "systems", f'system = "quarters", rounds = 1, {self.small}')
        self.assertTrue(row["admissible"])
        self.assertEqual(row["open_edges"], 0)
        self.assertLessEqual(row["jump_over_bound"], 1)

    def test_a_measure_of_pictures_is_a_column(self):
        self.assertIn("metric_lost-edges", self.run_example("metric", "experiments", "flight"))
        row, = self.rows("metric", "flight",
                         f'image = true, backend = "soft", blend = "table:0,0,0.5,1,1", {self.small}')
        self.assertTrue(0 <= row["metric_lost-edges"] <= row["metric_lost-edges_worst"] <= 100)


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    unittest.main(argv=["test_examples.py", sys.argv[1]])
