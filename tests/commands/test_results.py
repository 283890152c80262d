"""scripts/results: its tables know their columns, its pages say what the rows say, and it runs and interrupts sweeps.

usage: test_results.py PROGRAM
"""

import csv
import gzip
import io
import os
import pathlib
import re
import signal
import subprocess
import sys
import unittest

import command_case
from command_case import SOURCE as ROOT
from command_case import CommandCase, FolderCase, until
from sweep_folder import SweepFolder, column, parameter

RESULTS = ROOT / "scripts/results"
sys.path.insert(0, str(ROOT / "python"))

from lodestone_report import costs, published_rows, result_tables, results  # noqa: E402
from lodestone_report.settings import Cell  # noqa: E402

# Sweeps until it is told to end, tidies up for a while, and says so; or does what FAKE_* ask for.
PROGRAM = """#!/usr/bin/env python3
import json, os, pathlib, signal, sys, time
out = pathlib.Path(sys.argv[sys.argv.index("-o") + 1])
if sys.argv[1] == "report":
    if os.environ.get("FAKE_REPORT") == "broken":
        sys.exit(1)
    out.write_text("a report")
    sys.exit(0)
signals = []
def stop(number, _):
    signals.append(number)
signal.signal(signal.SIGINT, stop), signal.signal(signal.SIGTERM, stop)
out.mkdir(parents=True, exist_ok=True)
(out / "arguments").write_text(" ".join(sys.argv[1:]))
sheet = {"name": out.name, "title": "A study", "question": "What?", "sweeps": [], "figures": []}
(out / "sweep.json").write_text(json.dumps(sheet))
while os.environ.get("FAKE_SWEEP") == "long" and not signals:
    time.sleep(0.01)
if signals:
    time.sleep(0.5)
    (out / "tidy").write_text(str(signals))
sys.exit(130 if signals else int(os.environ.get("FAKE_STATUS", 0)))
"""


class Cells(unittest.TestCase):
    def spread(self, median, least, most, divisor=1):
        return results.cell_text(Cell(median, least, most), divisor)

    def test_have_a_range_where_it_can_be_seen(self):
        self.assertEqual(self.spread(2.5, 2, 3), "2.5 (2-3)")
        self.assertEqual(self.spread(-2, -3, -1), "-2 (-3 to -1)")
        self.assertEqual(self.spread(2e6, 1e6, 2e6, result_tables.MB), "2 (1-2)")

    def test_have_none_where_all_print_alike(self):
        self.assertEqual(self.spread(2.5, 2.5, 2.5), "2.5")
        self.assertEqual(self.spread(2.5001, 2.5, 2.5002), "2.5")

    def test_may_be_empty_or_words(self):
        self.assertEqual([results.cell_text(Cell(value)) for value in (None, True, "morph")], ["", "yes", "morph"])


class Files(unittest.TestCase):
    def test_are_where_a_checkout_has_them(self):
        for study in (ROOT / "experiments/studies/standard").glob("*.toml"):
            for name in re.findall(r'path = "([^"]+)"', study.read_text(encoding="utf-8")):
                file = pathlib.Path(os.path.normpath(study.parent / name))
                # scripts/data lays models there, and a checkout may lack them.
                self.assertTrue(file.is_relative_to(ROOT / "build/data") or file.exists(), (study.name, name))


class Columns(CommandCase):
    def known(self, experiment):
        about = self.results("experiments", experiment, "--quiet")
        return {entry["name"] for entry in about["parameters"] + about["columns"]} | {"data"}

    def test_are_those_of_the_experiments(self):
        self.assertEqual(sorted(results.STUDIES), sorted(path.stem for path in (ROOT / "experiments/studies/standard").glob("*.toml")))
        for page in result_tables.PAGES:
            text = (ROOT / "experiments/studies/standard" / f"{page.study}.toml").read_text(encoding="utf-8")
            experiments = dict(re.findall(r'\[\[sweep\]\]\nname = "(\w+)"\nexperiment = "(\w+)"', text))
            self.assertEqual({name for table in page.tables for name in table.sweeps}, set(experiments), page.study)
            for table in page.tables:
                for experiment in {experiments[sweep] for sweep in table.sweeps}:
                    with self.subTest(table=table.title, experiment=experiment):
                        self.assertLessEqual({column[1] for column in table.columns}, self.known(experiment))


    def test_of_what_accuracy_costs_are_known_too(self):
        for part in costs.PARTS:
            text = (ROOT / "experiments/studies/standard" / f"{part.study}.toml").read_text(encoding="utf-8")
            experiments = dict(re.findall(r'\[\[sweep\]\]\nname = "(\w+)"\nexperiment = "(\w+)"', text))
            for sweep in part.sweeps:
                with self.subTest(part=part.title, sweep=sweep):
                    columns = {part.error[1], *part.ways, *(column for _, column, _ in part.costs)}
                    self.assertLessEqual(columns, self.known(experiments[sweep]))


class CostPage(FolderCase):
    """The page across studies, of a folder of the study `accuracy` by hand."""

    def setUp(self):
        super().setUp()
        study = SweepFolder(self.folder / "accuracy", "accuracy", "Accuracy")
        study.sweep("families", [column("family", "label"), column("rms", "accuracy"), column("cpu_seconds", "cost"),
                                 column("triangles", "cost")], [], repetitions=1)
        run = study.run("families", "ball", {})
        study.rows(run, 0, [{"family": "hlod", "rms": 0.1, "cpu_seconds": 1, "triangles": 5000},
                            {"family": "meshoptimizer", "rms": 0.1, "cpu_seconds": 3, "triangles": 4000}],
                   start="2026-01-31T12:00:00Z")
        results.write_pages({"accuracy": study.write()}, self.folder / "pages")

    def test_has_the_cheapest_way_for_each_cost(self):
        page = (self.folder / "pages/cost.md").read_text(encoding="utf-8")
        self.assertIn("| 0.1 | 1 of 1 | 1: hlod | 4,000: meshoptimizer |", page)
        self.assertIn("; 2026-01-31; `scripts/results accuracy`", page)
        self.assertNotIn("A frame", page)

    def test_is_named_on_the_first_page(self):
        self.assertIn("[cost](cost.md)", (self.folder / "pages/README.md").read_text(encoding="utf-8"))


class Pages(FolderCase):
    """A folder of the study `guarantee` by hand: two runs that hold, one that does not verify."""

    def setUp(self):
        super().setUp()
        study = SweepFolder(self.folder / "guarantee", "guarantee", "The guarantee")
        study.sweep("one_pixel", [column("open_edges", "accuracy", "", "edges that do not meet"),
                                  column("jump_over_bound", "accuracy"), column("surface_triangles", "cost")],
                    [parameter("camera")], repetitions=1)
        for camera, data, jump in (("fly-in", "ball", 0.98), ("orbit", "ball", 0.5), ("fly-in", "scan", 1.25)):
            run = study.run("one_pixel", data, {"camera": camera})
            study.rows(run, 0, [{"open_edges": 0, "jump_over_bound": jump, "surface_triangles": 1234567}],
                       start="2026-01-31T12:00:00Z")
            if jump > 1:
                study.fault(run, 0, "verify", "a vertex jumps beyond its bound")
        study.sheet["left_out"] = {"statue": "build/data/scans/statue.ply"}
        self.studies = results.write_pages({"guarantee": study.write()}, self.folder / "pages", "--full")

    def page(self, name):
        return (self.folder / "pages" / f"{name}.md").read_text(encoding="utf-8")

    def test_say_what_the_rows_say_and_where_they_are_from(self):
        page = self.page("guarantee")
        self.assertIn("| ball | fly-in | 1,234,567 | 0 | 0.98 |", page)
        self.assertIn("Commit 0123456; A processor of 2 cores, 2 cores, 25 GiB, g++ 12.2.0; 2026-01-31; "
                      "`scripts/results --full guarantee`", page)
        self.assertIn("- **residual edges**: edges that do not meet", page)

    def test_list_what_did_not_verify_and_leave_it_out(self):
        page = self.page("guarantee")
        self.assertNotIn("| scan |", page)
        self.assertIn("- one_pixel, scan: unverified: a vertex jumps beyond its bound", page)
        self.assertIn("- statue: build/data/scans/statue.ply was missing (scripts/data)", page)

    def test_head_with_figures_that_are_computed(self):
        first = self.page("README")
        self.assertIn("| [guarantee](guarantee.md) | flights at admissible radii | 2 |", first)
        self.assertIn("| [guarantee](guarantee.md) | largest jump of a vertex over its bound | 0.98 |", first)
        self.assertIn("What is to be found out? | 2 of 3 |", first)
        self.assertNotIn("[build]", first)

    def test_every_row_is_in_one_file(self):
        packed = (self.folder / "pages" / published_rows.ROWS).read_bytes()
        rows = list(csv.DictReader(io.StringIO(gzip.decompress(packed).decode())))
        self.assertEqual([(row["data"], row["camera"], row["state"], row["jump_over_bound"]) for row in rows],
                         [("ball", "fly-in", "verified", "0.98"), ("ball", "orbit", "verified", "0.5"),
                          ("scan", "fly-in", "unverified", "1.25")])
        results.write_pages({"guarantee": self.folder / "guarantee"}, self.folder / "pages", "--full")
        self.assertEqual((self.folder / "pages" / published_rows.ROWS).read_bytes(), packed)

    def test_a_sheet_says_what_the_rows_are(self):
        sheet = self.page("rows")
        self.assertIn("every row of every run, 3 rows of 3 runs,", sheet)
        self.assertIn("| open_edges |  | edges that do not meet | guarantee |", sheet)
        for name in csv.DictReader(io.StringIO(gzip.decompress((self.folder / "pages" / published_rows.ROWS).read_bytes())
                                               .decode())).fieldnames:
            self.assertIn(f"| {name} |", sheet)

    def test_are_those_of_the_folders_that_are_there(self):
        results.write_pages({}, self.folder / "pages")
        self.assertEqual([path.name for path in (self.folder / "pages").iterdir()], ["README.md"])

    def test_the_committed_ones_are_of_this_form(self):
        pages = ROOT / "docs/results"
        self.assertLess(len((pages / "README.md").read_text(encoding="utf-8").splitlines()), 150)
        for path in pages.glob("*.md"):
            if path.name in ("README.md", published_rows.SHEET):
                continue
            self.assertIn(path.stem, [*results.STUDIES, results.COST_PAGE])
            for section in path.read_text(encoding="utf-8").split("\n## ")[1:]:
                if "\n| --- |" in section:
                    self.assertRegex(section, r"\nCommit [0-9a-f]{7}.*; .*; \d{4}-\d\d-\d\d.*; `scripts/results", path.name)


class Reproduce(unittest.TestCase):
    def reproduce(self, *arguments):
        return subprocess.run([sys.executable, ROOT / "scripts/reproduce", *arguments], capture_output=True, text=True)

    def test_lists_every_table_and_figure(self):
        listed = self.reproduce("--list").stdout
        for page in result_tables.PAGES:
            for table in page.tables:
                names = " ".join(f"{page.study}/{sweep}" for sweep in table.sweeps)
                self.assertIn(f"table   {table.title}: {names}\n", listed)
            for title in re.findall(r'^\[\[figure\]\]\ntitle = "([^"]+)"', (ROOT / "experiments/studies/standard" /
                                    f"{page.study}.toml").read_text(encoding="utf-8"), re.MULTILINE):
                self.assertIn(f"figure  {title}: {page.study}/", listed)

    def test_refuses_what_is_none_of_them(self):
        refused = self.reproduce("--small", "scaling/nothing")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("'scaling/nothing'; scripts/reproduce --list", refused.stderr)


class Runs(FolderCase):
    def setUp(self):
        super().setUp()
        self.program = self.folder / "program"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        self.out = self.folder / "out"

    def start(self, *arguments, **settings):
        return subprocess.Popen([sys.executable, RESULTS, "-o", self.out, "--pages", self.folder / "pages",
                                 "--program", self.program, *(arguments or ["ablation"])],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, **settings},
                                start_new_session=True)

    def run_to_end(self, *arguments, **settings):
        process = self.start(*arguments, **settings)
        words, errors = process.communicate(timeout=60)
        self.assertEqual(words, "")
        return process.returncode, errors

    def test_an_interrupt_reaches_the_sweep_once_and_waits_for_it(self):
        # A terminal tells the whole group, `kill` one process.
        for number, tell in ((signal.SIGINT, os.killpg), (signal.SIGINT, os.kill), (signal.SIGTERM, os.kill)):
            with self.subTest(signal=number, tell=tell.__name__):
                tidy = self.out / "ablation/tidy"
                tidy.unlink(missing_ok=True)
                (self.out / "ablation/sweep.json").unlink(missing_ok=True)
                process = self.start(FAKE_SWEEP="long")
                until((self.out / "ablation/sweep.json").exists, "sweep.json", 60)
                tell(process.pid, number)
                _, words = process.communicate(timeout=60)
                self.assertEqual(process.returncode, 128 + number, words)
                self.assertEqual(tidy.read_text(), str([int(number)]))
                self.assertIn("run the same command again to continue", words)
                self.assertNotIn("Traceback", words)

    def test_a_report_of_before_is_not_shown_as_new(self):
        status, errors = self.run_to_end()
        self.assertEqual(status, 0, errors)
        page = (self.folder / "pages/ablation.md").read_text()
        self.assertIn("# A study", page)
        self.assertIn("report.html", errors)
        status, errors = self.run_to_end(FAKE_REPORT="broken")
        self.assertEqual(status, 1)
        self.assertFalse((self.out / "report.html").exists())
        self.assertNotIn("report.html", errors)

    def test_a_study_that_fails_is_told_and_the_rest_is_reported(self):
        status, errors = self.run_to_end(FAKE_STATUS="1")
        self.assertEqual(status, 1)
        self.assertIn("ablation.log", errors)
        self.assertTrue((self.folder / "pages/README.md").exists())

    def test_the_form_is_handed_on_and_nothing_runs_to_write_only(self):
        arguments = self.out / "effects/arguments"
        self.assertEqual(self.run_to_end("--full", "effects")[0], 0)
        self.assertIn("effects.toml", arguments.read_text())
        self.assertTrue(arguments.read_text().endswith("--resume --leave-out-missing --full"), arguments.read_text())
        arguments.unlink()
        self.assertEqual(self.run_to_end("--write-only", "effects")[0], 0)
        self.assertFalse(arguments.exists())

    def test_a_part_of_a_study_is_handed_on(self):
        self.assertEqual(self.run_to_end("scaling/schedule", "scaling/weak", "effects")[0], 0)
        self.assertTrue((self.out / "scaling/arguments").read_text().endswith("--only schedule --only weak"))
        self.assertNotIn("--only", (self.out / "effects/arguments").read_text())
        process = subprocess.run([sys.executable, RESULTS, "--program", self.program, "scaling/schedule"], capture_output=True, text=True)
        self.assertEqual(process.returncode, 2)
        self.assertIn("give -o and --pages", process.stderr)

    def test_nothing_is_written_of_nothing(self):
        status, errors = self.run_to_end("--write-only")
        self.assertEqual(status, 1)
        self.assertIn("no study in", errors)
        self.assertFalse((self.folder / "pages").exists())


if __name__ == "__main__":
    command_case.main(__doc__)
