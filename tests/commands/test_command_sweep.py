"""lodestone sweep and experiments as a user meets them. usage: test_command_sweep.py PROGRAM"""

import json
import os
import re
import subprocess
import time

import command_case
from command_case import model, until
from sweep_case import HEAD, SweepCase, children_in, end_quietly, section, start


class Experiments(SweepCase):
    def test_list_has_names_and_questions(self):
        listed = self.results("experiments", "--quiet")
        self.assertIn("probe", [experiment["name"] for experiment in listed])
        for experiment in listed:
            self.assertTrue(experiment["question"].rstrip(")").rstrip(".").rstrip() and "?" in experiment["question"])
        text = self.lodestone("experiments")
        for experiment in listed:
            self.assertIn(experiment["name"], text)

    def test_one_has_parameters_and_columns(self):
        text = self.lodestone("experiments", "probe")
        for word in ("failure", "seconds", "multiple", "accuracy", "not-finite"):
            self.assertIn(word, text)
        probe = self.results("experiments", "probe", "--quiet")
        self.assertIn({"name": "rows", "default": 3, "unit": "", "description": "how many", "choices": [], "least": 0,
                       "most": 100000}, probe["parameters"])

    def test_unknown(self):
        self.refused("experiments", "prob", names=["'prob'", "probe"])


class Runs(SweepCase):
    def test_grid_with_repetitions(self):
        summary = self.sweep(HEAD + section("x = [1, 2.5], rows = [0, 2]", "repetitions = 2"))
        self.assertEqual({key: summary[key] for key in ("name", "runs", "repetitions", "before", "ran", "failures")},
                         {"name": "test", "runs": 4, "repetitions": 8, "before": 0, "ran": 8, "failures": []})
        self.assertEqual(sorted((p["x"], p["rows"]) for _, p, _ in self.runs()), [(1, 0), (1, 2), (2.5, 0), (2.5, 2)])
        self.check_complete()

    def test_what_is_there_of_a_run(self):
        self.sweep(HEAD + section("x = 2"))
        plan = self.plan()
        (run, parameters, _), = self.runs()
        data = plan["data"]["tiny"]
        self.assertEqual(data["generate"], {"shape": "box", "triangles": 12, "seed": 1})
        recorded = self.read(run, "parameters.json")
        self.assertEqual(recorded["parameters"], parameters)
        self.assertEqual((recorded["experiment"], recorded["data"], recorded["input_sha256"], recorded["program"]),
                         ("probe", "tiny", data["sha256"], plan["program"]))
        self.lodestone("report", "out", "-o", "out.html", "--quiet")
        self.assertIn(data["sha256"], (self.folder / "out.html").read_text())
        content = (self.folder / recorded["input"]).read_bytes()
        self.assertEqual(data["bytes"], len(content))
        self.assertEqual(self.rows(run, 0)[0]["bytes"], len(content))
        manifest = self.read(run, "manifest.0.json")
        for key in ("commit", "dirty", "compiler", "flags", "build_type", "version", "cpu", "cores", "system", "load"):
            self.assertIn(key, manifest)
        self.assertNotIn("gl", manifest)
        for library in manifest["libraries"]:
            self.assertRegex(library, r"\A/[^ ]+\.so[^ ]* ([0-9a-f]{8,64})\Z")
        self.assertTrue(any("libmeshoptimizer" in library for library in manifest["libraries"]))
        self.assertRegex(manifest["start"], r"\A\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ\Z")
        self.assertLess(0, manifest["wall_seconds"])
        self.assertLess(0, manifest["cpu_seconds"])
        self.assertLess(1e6, manifest["peak_bytes"])
        self.assertLess(manifest["peak_bytes"], manifest["memory_bytes"])
        self.assertIn("probe at work, repetition 0", self.file(run, "log.txt").read_text())
        self.assertEqual(list(self.file(run, "").glob("**/*.tmp")), [])

    def test_manifest_has_the_driver_of_what_drew_on_gl(self):
        self.write("sweep.toml", HEAD.replace("box", "sphere").replace("12", "500") + section(
            'backend = ["null", "gl"], rounds = 1, measured_frames = 0, frames = 2, width = 64, height = 48').replace(
                "probe", "raster"))
        done = command_case.call("sweep", "sweep.toml", "-o", "out", "--quiet", cwd=self.folder)
        drawn = {parameters["backend"]: run for run, parameters, _ in self.runs()}
        if done.returncode != 0 and re.search("OpenGL|LODESTONE_GL", done.stderr.decode()):
            self.skipTest(done.stderr.decode())
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.assertNotIn("gl", self.read(drawn["null"], "manifest.0.json"))
        driver = self.read(drawn["gl"], "manifest.0.json")["gl"]
        self.assertEqual(sorted(driver), ["renderer", "vendor", "version"])
        self.assertTrue(all(driver.values()), driver)

    def test_pinned_to_as_many_processors_as_threads(self):
        allowed = sorted(os.sched_getaffinity(0))
        self.sweep(HEAD + section("threads = [0, 1]"))
        manifests = {p["threads"]: self.read(run, "manifest.0.json") for run, p, _ in self.runs()}
        self.assertEqual(manifests[0]["affinity"], allowed)
        # All of them, and not pinned, where another test has the processors.
        self.assertEqual(len(manifests[1]["affinity"]), 1 if manifests[1]["pinned"] else len(allowed))

    def test_more_threads_than_processors(self):
        allowed = len(os.sched_getaffinity(0))
        self.write("sweep.toml", HEAD + section(f"threads = [1, {allowed + 1}]"))
        self.failing_sweep("sweep.toml", "-o", "out", names=["1 of 2", f"threads = {allowed + 1}: there are {allowed} processors"])
        self.assertEqual([self.file(run, "rows.0.jsonl").exists() for run, _, _ in self.runs()], [True, False])

    def test_jobs_on_all_processors_take_turns(self):
        self.write("sweep.toml", HEAD + section("x = [1, 2, 3], threads = 0, seconds = 0.4"))
        begin = time.monotonic()
        self.lodestone("sweep", "sweep.toml", "-o", "out", "--jobs", 3)
        seconds = time.monotonic() - begin
        self.check_complete()
        if all(self.read(run, "manifest.0.json")["pinned"] for run, _, _ in self.runs()):  # by no other test
            self.assertGreater(seconds, 1.2)

    def test_rounds(self):
        text = self.write("sweep.toml", HEAD + section("x = [1, 2, 3]", "repetitions = 2")).name
        lines = self.lodestone("sweep", text, "-o", "out").splitlines()
        self.assertEqual([line.split("repetition ")[1][0] for line in lines[:6]], list("000111"))
        self.assertRegex(lines[0], r"\A1/6  s  [0-9a-f]{16}  tiny  x=1.0  repetition 0: [\d.]+ s\Z")
        self.assertIn("3 runs, 6 repetitions: 0 were done before, 6 ran, 0 failed", lines[6])

    def test_jobs(self):
        text = self.write("sweep.toml", HEAD + section("x = [1, 2, 3, 4]", "repetitions = 2")).name
        self.assertIn("not comparable", self.lodestone("sweep", text, "-o", "out", "--jobs", 3).splitlines()[0])
        self.check_complete()

    def test_progress_has_the_time_left(self):
        self.write("sweep.toml", HEAD + section("x = [1, 2, 3, 4], seconds = 0.6"))
        shown = self.on_terminal("sweep", "sweep.toml", "-o", "out")
        shares = [int(share) for share in re.findall(r"test +\[[#.]+\] +(\d+) %  \d+ s left", shown)]
        self.assertGreater(len(shares), 3, shown)
        self.assertEqual(shares, sorted(shares))
        self.assertLess(shares[0], 75)

    def test_forms(self):
        text = HEAD + section("x = [1, 2, 3]", "repetitions = 3\nsmall = { repetitions = 1, parameters = { x = 2 } }\n"
                                               "full = { parameters = { x = [1, 2, 3, 4] } }")
        self.assertEqual(self.sweep(text, "--small")["repetitions"], 1)
        self.assertEqual(self.plan()["form"], "small")
        self.assertEqual(self.sweep(text, "--resume")["ran"], 8)
        self.assertEqual(self.plan()["form"], "standard")
        self.assertEqual(self.sweep(text, "--resume", "--full")["ran"], 3)
        self.assertEqual(self.plan()["form"], "full")
        self.check_complete()

    def test_only_some_sweeps(self):
        text = HEAD + section("x = [1, 2]") + section("x = [2, 3, 4]", name="t") + section("x = 9", name="u")
        self.assertEqual(self.sweep(text, "--only", "t")["runs"], 3)
        self.assertEqual([sweep["name"] for sweep in self.plan()["sweeps"]], ["t"])
        self.assertEqual(self.sweep(text, "--resume", "--only", "t", "--only", "u")["ran"], 1)
        self.refused("sweep", "sweep.toml", "-o", "out", "--resume", "--only", "tt", names=["sweep.toml", "no sweep 'tt'", "t"])

    def test_two_sweeps_share_a_run(self):
        summary = self.sweep(HEAD + section("x = [1, 2]", "repetitions = 1") + section("x = [2, 3]", "repetitions = 2", "t"))
        self.assertEqual((summary["runs"], summary["repetitions"]), (3, 5))
        self.assertEqual([len(sweep["runs"]) for sweep in self.plan()["sweeps"]], [2, 2])
        self.check_complete()

    def test_dry_run_changes_nothing(self):
        text = self.write("sweep.toml", HEAD + section("x = [1, 2]", "repetitions = 2")).name
        dry = self.lodestone("sweep", text, "-o", "out", "--dry-run").splitlines()
        self.assertEqual(dry[0], "s  -  tiny  x=1.0  0 of 2 done")
        self.assertIn("2 runs, 4 repetitions, 0 done", dry)
        self.assertFalse((self.folder / "out").exists())
        self.lodestone("sweep", text, "-o", "out")
        before = self.listing()
        dry = self.lodestone("sweep", text, "-o", "out", "--dry-run").splitlines()
        self.assertEqual(dry[0], f"s  {self.runs()[0][0]}  tiny  x=1.0  2 of 2 done")
        self.assertEqual(self.listing(), before)

    def test_settings_without_a_number_are_told_before(self):
        text = (HEAD + '[[sweep]]\nname = "s"\nexperiment = "raster"\ndata = "tiny"\nmetrics = ["frame_ms"]\n'
                'parameters = { backend = ["null", "soft"] }\n'
                '[[figure]]\ntitle = "t"\nsweep = "s"\nx = "frame_ms"\ny = "psnr"\n')
        self.write("sweep.toml", text)
        dry = self.lodestone("sweep", "sweep.toml", "-o", "out", "--dry-run")
        note = "note: sweep.toml: line 14: figure 't', y 'psnr' is measured in 1 of 2 settings of sweep 's' only; "
        self.assertIn(note, dry)
        self.write("sweep.toml", text.replace('["null", "soft"]', '"null"'))
        self.refused("sweep", "sweep.toml", "-o", "out", "--dry-run",
                     names=["line 14", "'psnr' is measured in no setting of sweep 's'", 'something else than "null"'])
        self.assertIn("something else than", self.lodestone("experiments", "raster"))
        self.write("sweep.toml", HEAD + section("x = 1", 'metrics = ["multiple"]'))
        self.lodestone("sweep", "sweep.toml", "-o", "out")
        self.assertEqual(self.plan()["sweeps"][0]["metrics"], ["multiple"])

    def test_prepare_runs_nothing(self):
        text = self.write("sweep.toml", HEAD + section("x = [1, 2]")).name
        self.lodestone("sweep", text, "-o", "out", "--prepare")
        self.assertEqual(len(self.runs()), 2)
        self.assertTrue((self.folder / "out/data/box-12-1.ply").exists())
        self.assertFalse((self.folder / "out/runs").exists())
        self.lodestone("sweep", text, "-o", "out")
        self.check_complete()


class Resume(SweepCase):
    def test_needs_to_be_asked_for(self):
        text = HEAD + section("x = [1, 2]")
        self.sweep(text)
        self.refused("sweep", "sweep.toml", "-o", "out", names=["out", "2 runs", "--resume"])
        self.assertEqual(self.sweep(text, "--resume")["ran"], 0)

    def test_runs_what_is_missing_or_changed(self):
        self.sweep(HEAD + section("x = [1, 2]"))
        first = {p["x"]: run for run, p, _ in self.runs()}
        before = self.file(first[1], "rows.0.jsonl").stat()
        summary = self.sweep(HEAD + section("x = [1, 3]"), "--resume")
        self.assertEqual((summary["before"], summary["ran"]), (1, 1))
        self.check_complete()
        self.assertEqual(self.file(first[1], "rows.0.jsonl").stat().st_mtime_ns, before.st_mtime_ns)
        self.assertNotIn(first[2], [run for run, _, _ in self.runs()])
        self.assertEqual(self.rows(first[2], 0)[0]["multiple"], 2)  # left alone
        self.file(first[1], "rows.0.jsonl").unlink()
        self.assertEqual(self.sweep(HEAD + section("x = [1, 3]"), "--resume")["ran"], 1)
        self.assertEqual(self.sweep(HEAD + section("x = [1, 3]", "repetitions = 3"), "--resume")["ran"], 4)
        self.check_complete()

    def test_changed_data_is_another_run(self):
        mesh = self.write("m.ply", model("a.ply", "generate", "box", "--triangles", 12).read_bytes())
        text = 'name = "test"\n[data]\ntiny = { path = "m.ply" }\n' + section("x = 1")
        self.sweep(text)
        self.assertEqual(self.sweep(text, "--resume")["ran"], 0)
        mesh.write_bytes(model("b.ply", "generate", "sphere", "--triangles", 500).read_bytes())
        self.assertEqual(self.sweep(text, "--resume")["ran"], 1)
        self.assertEqual(len(list((self.folder / "out/runs").iterdir())), 2)

    def test_data_that_changes_during_a_sweep_is_not_recorded_under_its_old_hash(self):
        box = model("a.ply", "generate", "box", "--triangles", 12).read_bytes()
        mesh = self.write("m.ply", box)
        self.write("sweep.toml", 'name = "test"\n[data]\ntiny = { path = "m.ply" }\n' +
                   section("x = [1, 2, 3], seconds = [0, 1]"))
        process = start("sweep.toml", "-o", "out", cwd=self.folder)
        until(lambda: children_in(self.folder) and self.rows_so_far(), "rows", 60)
        mesh.write_bytes(model("b.ply", "generate", "sphere", "--triangles", 500).read_bytes())
        status, _, errors = end_quietly(process)
        self.assertEqual(status, 1)
        self.assertIn("error: m.ply changed since the sweep began; run again with --resume", errors)
        done = [self.file(run, "rows.0.jsonl").exists() for run, _, _ in self.runs()]
        for (run, _, _), is_done in zip(self.runs(), done):
            self.assertNotEqual(self.file(run, "fault.0.json").exists(), is_done)
            if is_done:
                self.assertEqual(self.rows(run, 0)[0]["bytes"], len(box))
        self.assertIn(done.count(False), range(1, 6))
        self.check_clean()
        summary = self.results("sweep", "sweep.toml", "-o", "out", "--resume", "--quiet")
        self.assertEqual(summary["ran"], 6)
        self.check_complete()

    def test_failures_are_tried_again_but_not_what_does_not_verify(self):
        text = HEAD + section('failure = ["first", "verify"]', "repetitions = 2")
        self.write("sweep.toml", text)
        self.failing_sweep("sweep.toml", "-o", "out", names=["3 of 4 repetitions failed"])
        summary = self.write("sweep.toml", text) and command_case.call(
            "sweep", "sweep.toml", "-o", "out", "--resume", "--quiet", "--json", "-", cwd=self.folder)
        self.assertEqual(json.loads(summary.stdout)["ran"], 1)

    def test_another_sweep_or_other_files(self):
        self.sweep(HEAD + section("x = 1"))
        self.write("other.toml", HEAD.replace("test", "other") + section("x = 1"))
        self.refused("sweep", "other.toml", "-o", "out", "--resume", names=["out", "holds the sweep 'test'"])
        (self.folder / "home").mkdir()
        self.write("home/letter.txt", "dear")
        self.refused("sweep", "sweep.toml", "-o", "home", names=["home", "holds other files"])
        self.refused("sweep", "sweep.toml", "-o", "sweep.toml", names=["is a file"])


class Failures(SweepCase):
    def test_each_kind_is_recorded_and_the_sweep_goes_on(self):
        kinds = {"verify": ("verify", "is not"), "not-finite": ("verify", "multiple is not finite"),
                 "column": ("verify", "surprise is not a column of probe"), "error": ("error", "an error was asked for"),
                 "unsupported": ("error", "not available here"), "memory": ("error", "out of memory"),
                 "cancelled": ("crash", "ended with status"), "crash": ("crash", "signal 6"),
                 "killed": ("crash", "signal 9"), "exit": ("crash", "ended with status 3")}
        names = ", ".join(f'"{name}"' for name in ("none", *kinds))
        self.write("sweep.toml", HEAD + section(f"failure = [{names}]"))
        self.failing_sweep("sweep.toml", "-o", "out", names=[f"{len(kinds)} of {len(kinds) + 1} repetitions failed", "out/runs/"])
        for run, parameters, _ in self.runs():
            failure = parameters["failure"]
            if failure == "none":
                self.assertFalse(self.file(run, "fault.0.json").exists())
                continue
            kind, message = kinds[failure]
            fault = self.read(run, "fault.0.json")
            self.assertEqual(fault["kind"], kind, failure)
            self.assertIn(message, " ".join(fault["messages"]), failure)
            self.assertEqual(self.file(run, "rows.0.jsonl").exists(), kind == "verify", failure)
            self.assertTrue(self.read(run, "manifest.0.json")["wall_seconds"] > 0)
        self.check_clean()
        self.lodestone("report", "out", "-o", "out.html", "--quiet")
        page = (self.folder / "out.html").read_text()
        for _, message in kinds.values():
            self.assertIn(message, page)

    def test_crash_has_the_last_words_of_the_log(self):
        self.write("sweep.toml", HEAD + section('failure = "crash"'))
        self.failing_sweep("sweep.toml", "-o", "out", names=["signal 6"])
        (run, _, _), = self.runs()
        self.assertEqual(self.read(run, "fault.0.json")["messages"][1], "probe at work, repetition 0")

    def test_missing_and_other_data(self):
        self.write("sweep.toml", 'name = "test"\n[data]\ntiny = { path = "none.ply" }\n' + section("x = 1"))
        self.refused("sweep", "sweep.toml", "-o", "out", "--dry-run",
                     names=["sweep.toml: line 3: tiny", "none.ply is missing; correct the path"])
        self.failing_sweep("sweep.toml", "-o", "out", names=["none.ply is missing; correct the path"])
        self.write("ours.toml", 'name = "test"\n[data]\ntiny = { path = "build/data/none.ply" }\n' + section("x = 1"))
        self.failing_sweep("ours.toml", "-o", "out3", names=["build/data/none.ply is missing; get the models by scripts/data"])
        self.write("ours.toml", 'name = "test"\n[data]\nbox = { generate = "box", triangles = 12 }\n'
                   'tiny = { path = "build/data/none.ply" }\n' + section("x = 1").replace('"tiny"', '["box", "tiny"]'))
        words = self.lodestone("sweep", "ours.toml", "-o", "out4", "--leave-out-missing")
        self.assertIn("note: tiny: build/data/none.ply is missing, and its runs are left out; get the models by scripts/data", words)
        self.assertEqual([run["data"] for run in self.plan("out4")["sweeps"][0]["runs"]], ["box"])
        self.assertEqual(self.plan("out4")["left_out"], {"tiny": "build/data/none.ply"})
        self.write("m.ply", model("a.ply", "generate", "box", "--triangles", 12).read_bytes())
        text = f'name = "test"\n[data]\ntiny = {{ path = "m.ply", sha256 = "{"0" * 64}" }}\n' + section("x = 1")
        self.write("sweep.toml", text)
        line = self.failing_sweep("sweep.toml", "-o", "out2", names=["line 3: tiny", "has the sha256", "not 0000", "or correct"])
        right = line.split("has the sha256 ")[1][:64]
        self.assertEqual(right, subprocess.run(["sha256sum", self.folder / "m.ply"], capture_output=True, text=True,
                                               check=True).stdout[:64])
        self.sweep(text.replace("0" * 64, right), output="out5")

    def test_scenes_and_companions_count(self):
        self.write("scene.toml", '[[model]]\nfile = "m.ply"\n')
        self.write("m.ply", model("a.ply", "generate", "box", "--triangles", 12).read_bytes())
        self.write("note.txt", "a")
        scene = 'name = "test"\n[data]\ntiny = { path = "scene.toml" }\n' + section("x = 1")
        with_note = scene.replace('"scene.toml" }', '"scene.toml", with = "note.txt" }')
        hashes = []
        for text, change in ((scene, None), (scene, ("m.ply", b"b")), (with_note, None), (with_note, ("note.txt", b"b"))):
            if change:
                self.write(*change)
            self.sweep(text, "--resume", "--prepare")
            hashes.append(self.plan()["data"]["tiny"]["sha256"])
        self.assertEqual(len(set(hashes)), 4)
        (self.folder / "m.ply").unlink()
        self.refused("sweep", "sweep.toml", "-o", "out", "--dry-run", names=["line 3: tiny", "m.ply is missing"])

    def test_errors_of_the_file_name_the_line(self):
        self.write("sweep.toml", HEAD + section("y = 1"))
        self.refused("sweep", "sweep.toml", "-o", "out", names=["sweep.toml: line 8: sweep 1, unknown parameter 'y'"])
        flight = ('[[sweep]]\nname = "s"\nexperiment = "flight"\ndata = "tiny"\n'
                  "[sweep.parameters]\nkappa0 = 2.0\nkappa0_over_rho = 0.5\n")
        self.write("sweep.toml", HEAD + flight)
        self.refused("sweep", "sweep.toml", "-o", "out", "--dry-run",
                     names=["sweep.toml: line 10: sweep 1, kappa0 = 2.0 and kappa0_over_rho = 0.5 exclude each other"])
        self.refused("sweep", "none.toml", "-o", "out", names=["none.toml", "cannot be opened"])
        (self.folder / "folder").mkdir()
        self.refused("sweep", "folder", "-o", "out", names=["folder: is a folder", ".toml"])
        self.refused("sweep", "-o", "out", names=["FILE"])


if __name__ == "__main__":
    command_case.main(__doc__)
