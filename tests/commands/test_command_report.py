"""lodestone report as a user meets it, on directories of sweeps made by hand. usage: test_command_report.py PROGRAM"""

import csv
import html.parser
import io
import json
import os
import re
import shutil
import subprocess
import unittest

import command_case
import sweep_folder
from command_case import CommandCase, needs_failing_disk
from sweep_folder import SweepFolder, column, parameter, small_study

HAS_MATPLOTLIB = any(subprocess.run([python, "-c", "import matplotlib"], capture_output=True).returncode == 0
                     for python in ("python3", "/usr/bin/python3") if shutil.which(python))


class PageParser(html.parser.HTMLParser):
    """Text outside scripts, ids, links; whether every element is closed."""

    VOID = {"meta", "link", "img", "br", "input"}

    def __init__(self, page):
        super().__init__()
        self.open, self.words, self.ids, self.links, self.images, self.outside = [], [], [], [], [], []
        self.feed(page)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag not in self.VOID:
            self.open.append(tag)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if tag == "a":
            self.links.append(attributes["href"])
        if tag == "img":
            self.images.append(attributes)
        self.outside += [v for k, v in attributes.items() if k in ("src", "href") and re.match(r"(https?:)?//", v or "")]

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in self.VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, (tag, self.open[-3:])
        self.open.pop()

    def handle_data(self, text):
        if not {"script", "style"} & set(self.open):
            self.words.append(text)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


class WholeReport(CommandCase):
    def setUp(self):
        super().setUp()
        sweep_folder.make(self.folder / "ablation")

    def page(self, *more):
        self.lodestone("report", "ablation", "-o", "report.html", "--quiet", *more)
        return PageParser((self.folder / "report.html").read_text())

    def test_listed_metrics_are_what_the_tables_show(self):
        def heads(metrics):
            study = SweepFolder(self.folder / ("study" + "-".join(metrics)))
            study.sweep("s", [column("level", "count"), column("family", "label"), column("triangles", "count"),
                              column("hash", "label"), column("gap", "accuracy"), column("seconds", "cost", "s"),
                              column("seconds_min", "cost", "s")], [parameter("kappa0")])
            if metrics:
                study.sheet["sweeps"][0]["metrics"] = metrics
            for kappa0 in (1.0, 4.0):
                study.rows(study.run("s", "sphere", {"kappa0": kappa0}), 0, [
                    {"level": level, "family": "hlod", "triangles": 9 * kappa0, "hash": f"{level}" * 16, "gap": kappa0 - level,
                     "seconds": kappa0, "seconds_min": kappa0 / 2} for level in (1, 2)])
            self.lodestone("report", study.write(), "-o", "m.html", "--quiet", "--csv", "m.csv")
            self.assertIn("seconds_min", (self.folder / "m.csv").read_text())
            page = (self.folder / "m.html").read_text()
            table = page[page.index("Sweep s: 4 settings"):]
            return re.findall(r'<th scope="col"[^>]*>([a-z_0-9]+)', table[:table.index("</thead>")])

        self.assertEqual(heads([]), ["kappa0", "level", "triangles", "hash", "gap", "seconds", "run"])
        self.assertEqual(heads(["seconds", "gap"]), ["kappa0", "level", "seconds", "gap", "run"])
        self.assertEqual(heads(["seconds_min"]), ["kappa0", "level", "seconds_min", "run"])

    def test_page_stands_alone_and_says_what_was_found(self):
        page = self.page()
        self.assertEqual(page.outside, [])
        self.assertEqual(len(page.ids), len(set(page.ids)))
        for link in page.links:
            self.assertIn(link.removeprefix("#"), page.ids)
        for part in ("Ablation over kappa0 & the blending function", "Which settings crack", "armadillo <1>", "48 runs",
                     "45 verified", "1 not verified", "1 failed", "1 missing", "Cheapest setting for a given error",
                     "gap_max is 0.4 and should be 0; open edges: 12 & more", "killed by signal 9", "No space left on device",
                     "Mixed: host has 2 values", "repetitions are missing of 1 run;", "1 run of other settings",
                     "gap_max: from rho", "A processor of 2 cores"):
            self.assertIn(part, page.text)
        self.assertEqual(len(page.images), 3 * 4)
        for image in page.images:
            self.assertTrue(image["alt"])
            kind = "webp" if image["alt"].startswith("worst.film") else "png"
            self.assertTrue(image["src"].startswith(f"data:image/{kind};base64,"))

    def test_json_and_csv_have_all_rows(self):
        self.page("--json", "report.json", "--csv", "rows.csv")
        report = json.loads((self.folder / "report.json").read_text(), parse_constant=self.fail)
        self.assertEqual([report[k] for k in ("runs", "complete", "incomplete", "unverified", "failed", "missing")],
                         [48, 44, 1, 1, 1, 1])
        rows = list(csv.DictReader(io.StringIO((self.folder / "rows.csv").read_text())))
        stored = [json.loads(line) for path in (self.folder / "ablation/runs").rglob("rows.*.jsonl")
                  for line in path.read_text().splitlines()]
        self.assertEqual(len(rows), len(stored))
        self.assertEqual(sorted(row["seconds"] for row in rows), sorted(json.dumps(row["seconds"]) for row in stored))
        self.assertEqual(sum(row["state"] == "unverified" for row in rows), 3)
        self.assertEqual({row["data"] for row in rows}, {"sphere", "armadillo <1>"})
        self.assertEqual({row["repetition"] for row in rows}, {"0", "1", "2"})
        self.assertEqual(rows[0]["kappa0"], "1.0")

    def test_unverified_rows_are_in_no_figure(self):
        self.page("--json", "report.json")
        study = json.loads((self.folder / "report.json").read_text())["studies"][0]
        border = study["figures"][0]["panels"][0]["series"]
        self.assertEqual({s["name"]: [p["x"] for p in s["points"]] for s in border}["armadillo <1>, step"],
                         [1.0, 1.5, 2.0, 4.0, 6.0, 8.0])
        self.assertEqual([m["label"] for m in study["figures"][0]["marks"]], ["rho (sphere)", "rho (armadillo <1>)"])
        speedup = study["figures"][4]["panels"][0]["series"][0]["points"]
        self.assertEqual(speedup[0]["y"], 1)
        self.assertGreater(speedup[3]["y"], 5)

    def test_equal_folders_give_equal_bytes(self):
        self.page()
        first = (self.folder / "report.html").read_bytes()
        self.page()
        self.assertEqual((self.folder / "report.html").read_bytes(), first)

    @unittest.skipUnless(HAS_MATPLOTLIB, "python3-matplotlib is not installed")
    def test_plots_are_drawn_for_wide_and_narrow(self):
        self.page()
        page = (self.folder / "report.html").read_text()
        self.assertEqual(page.count("<svg"), 2 * 6)
        self.assertIn("var(--s0)", page)
        for svg in re.findall("<svg.*?</svg>", page, re.DOTALL):
            self.assertNotRegex(svg, "(fill|stroke|color): #", "colours follow light and dark")

    def test_pictures_are_limited(self):
        page = self.page("--pictures", 0)
        self.assertEqual(page.images, [])
        self.assertIn("Left out for their size (--pictures): 12 pictures", page.text)

    def test_summary_on_the_terminal(self):
        told = self.lodestone("report", "ablation", "-o", "report.html")
        self.assertIn("48 runs, 45 verified, 1 not verified, 1 failed, 1 missing", told)
        self.assertIn("What accuracy costs: ", told)
        self.assertIn("report.html: opens in any browser", told)


class SeveralFolders(CommandCase):
    def test_several_studies_in_one_page(self):
        for name in ("one", "two"):
            small_study(self.folder / name, name=name, title=f"Study {name}").write()
        self.lodestone("report", "one", "two", "-o", "report.html", "--quiet")
        page = PageParser((self.folder / "report.html").read_text())
        self.assertEqual(len(page.ids), len(set(page.ids)))
        self.assertIn("4 runs 4 verified", page.text)
        for name in ("one", "two"):
            self.assertIn(f"Study {name}", page.text)
        self.assertIn("None: every repetition of every run is there and verified.", page.text)

    def test_output_is_no_input_of_its_own(self):
        small_study(self.folder / "one").write()
        self.refused("report", "one", "-o", "same.html", "--json", "same.html", names=["same.html"])
        self.refused("report", "one", "-o", "report.txt", names=["--output", ".html"])
        self.refused("report", "one", "-o", "report.html", "--csv", "rows.txt", names=["--csv", ".csv"])


class Faults(CommandCase):
    def report(self):
        return ("report", "study", "-o", "report.html")

    def test_a_broken_line_is_named(self):
        self.refused(*self.report(), names=["study", "no such folder"])
        study = small_study(self.folder / "study")
        study.write()
        path = next(study.path.rglob("rows.1.jsonl"))
        path.write_text('{"seconds": 1}\n{"length": 2}\n')
        self.refused(*self.report(), names=["rows.1.jsonl: line 2: 'length' is not a column"])

    def test_rows_that_did_not_verify_may_have_anything(self):
        study = small_study(self.folder / "study")
        folder = study.path / "runs" / study.sheet["sweeps"][0]["runs"][1]["id"]
        study.rows(folder, 1, [{"length": 2}, 3, {"gap": [1, 2]}])
        study.fault(folder, 1, "verify", "row 0: length is not a column of flight")
        study.write()
        self.lodestone(*self.report(), "--csv", "rows.csv", "--quiet")
        self.assertIn("length is not a column of flight", PageParser((self.folder / "report.html").read_text()).text)

    def test_results_that_differ_between_repetitions_are_left_out(self):
        study = small_study(self.folder / "study")
        study.sheet["sweeps"][0]["columns"].append(column("fingerprint", "label"))
        first, second = (study.path / "runs" / run["id"] for run in study.sheet["sweeps"][0]["runs"])
        for folder, prints in ((first, "ab"), (second, "aa")):
            for repetition in range(2):
                study.rows(folder, repetition, [{"seconds": 1 + repetition, "gap": 0, "fingerprint": prints[repetition]}])
        study.write()
        self.assertIn("1 verified, 1 not verified", self.lodestone(*self.report(), "--json", "report.json"))
        page = PageParser((self.folder / "report.html").read_text())
        self.assertIn("fingerprint differs between repetitions: a and b", page.text)
        sweep = json.loads((self.folder / "report.json").read_text())["studies"][0]["sweeps"][0]
        self.assertEqual([run["state"] for run in sweep["runs"]], ["unverified", "complete"])
        self.assertEqual([setting["run"] for setting in sweep["settings"]], [second.name])

    def test_what_one_sweep_sets_and_another_measures_has_two_columns(self):
        study = SweepFolder(self.folder / "study")
        study.sweep("waits", [column("multiple", "accuracy")], [parameter("seconds")])
        study.rows(study.run("waits", "", {"seconds": 0.5}), 0, [{"multiple": 1}])
        study.sweep("builds", [column("seconds", "cost", "s")], [parameter("sigma0")])
        study.rows(study.run("builds", "sphere", {"sigma0": 0.2}), 0, [{"seconds": 7}])
        study.write()
        self.lodestone(*self.report(), "--csv", "rows.csv", "--quiet")
        waits, builds = csv.DictReader(io.StringIO((self.folder / "rows.csv").read_text()))
        self.assertEqual((waits["parameter.seconds"], waits["seconds"]), ("0.5", ""))
        self.assertEqual((builds["parameter.seconds"], builds["seconds"]), ("", "7"))

    def test_nothing_verified_is_reported_and_no_success(self):
        study = SweepFolder(self.folder / "study")
        study.sweep("border", [column("gap", "accuracy")], [parameter("kappa0")])
        wrong, crashed = (study.run("border", "sphere", {"kappa0": k}) for k in (1.0, 2.0))
        study.run("border", "sphere", {"kappa0": 3.0})
        study.rows(wrong, 0, [{"gap": 1}])
        study.fault(wrong, 0, "verify", "gap is not 0")
        study.fault(crashed, 0, "crash", "signal 11")
        study.figure("Gaps", "border", "kappa0", "gap")
        study.write()
        self.assertEqual(self.failing(*self.report()), "lodestone: report.html: written, but no run has rows that verified: "
                                                       "of 3 runs, 1 did not verify, 1 failed, 1 are not yet run\n")
        page = PageParser((self.folder / "report.html").read_text())
        for part in ("gap is not 0", "signal 11", "not yet run", "No setting that verified has numbers for gap"):
            self.assertIn(part, page.text)

    def with_modules(self, python="/usr/bin/python3", **modules):
        """The environment in which the report runs in a Python with modules that consist of these lines."""
        folder = self.folder / "modules"
        folder.mkdir(exist_ok=True)
        for name, line in modules.items():
            (folder / f"{name}.py").write_text(line + "\n")
        return {"LODESTONE_PYTHON": python, "PYTHONPATH": str(folder)}

    def test_without_matplotlib_there_are_no_plots_and_a_note(self):
        small_study(self.folder / "study").write()
        for line, says in (("raise ImportError", "python3-matplotlib"), ("raise RuntimeError('no font')", "could not draw the plots: no font")):
            done = command_case.call(*self.report(), cwd=self.folder, environment=self.with_modules(matplotlib=line))
            self.assertEqual((done.returncode, done.stderr), (0, b""))
            page = (self.folder / "report.html").read_text()
            self.assertNotIn("<svg", page)
            self.assertIn(says, page)
            self.assertIn(says, done.stdout.decode())
            self.assertEqual([path.name for path in (self.folder / "report_figures").iterdir()], ["01-gaps.csv"])

    def test_without_python_or_jinja2_the_packages_are_named(self):
        small_study(self.folder / "study").write()
        for python, modules in (("/no/such/python", {}), ("/usr/bin/python3", {"jinja2": "raise ImportError"})):
            environment = self.with_modules(python, **modules)
            self.refused(*self.report(), names=["python3-jinja2", python], environment=environment)

    def test_an_environment_without_the_modules_goes_on_in_the_python_of_the_system(self):
        small_study(self.folder / "study").write()
        subprocess.run(["/usr/bin/python3", "-m", "venv", "--without-pip", self.folder / "venv"], check=True)
        path = f"{self.folder / 'venv/bin'}:{os.environ['PATH']}"
        done = command_case.call(*self.report(), cwd=self.folder, environment={"PATH": path})
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.assertTrue((self.folder / "report.html").exists())

    def test_modules_of_the_current_folder_are_not_the_reports(self):
        small_study(self.folder / "study").write()
        self.write("json.py", "raise SystemExit(9)")
        self.lodestone(*self.report(), "--quiet")

    @needs_failing_disk
    def test_full_disk_leaves_nothing(self):
        small_study(self.folder / "study").write()
        for output, room in ((["-o", "report.html"], 1000), (["-o", "report.html", "--csv", "rows.csv"], 20)):
            self.fails_on_disk("report", "study", *output, names=["lodestone: report.html: ", "No space left"],
                               DISK_WRITES=room)


if __name__ == "__main__":
    command_case.main(__doc__)
