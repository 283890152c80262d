"""lodestone_report in a notebook: DataFrames of a study with units, figures that are asked for, and nothing imported early."""

import pathlib
import subprocess
import sys
import unittest

from report_case import FolderCase
import sweep_folder
import lodestone_report as lr


class Notebook(FolderCase):
    def setUp(self):
        super().setUp()
        self.study = lr.load(sweep_folder.make(self.folder / "ablation"))

    def test_rows_have_parameters_columns_state_and_units(self):
        rows = self.study.rows
        stored = [line for path in self.study.folder.rglob("rows.*.jsonl") for line in path.read_text().splitlines()]
        self.assertEqual(len(rows), len(stored))
        self.assertEqual(dict(rows.state.value_counts()), {"verified": len(rows) - 3, "unverified": 3})
        border = rows[(rows.sweep == "border") & (rows.kappa0 == 2) & (rows.blend == "step") & (rows.data == "sphere")]
        self.assertEqual(border.repetition.tolist(), [0, 1, 2])
        self.assertAlmostEqual(border.gap_max.iloc[0], 0.3)
        self.assertTrue(border.gap_max.iloc[1:].isna().all())
        self.assertEqual(rows.attrs["units"]["kappa0"], "cell sizes")
        self.assertEqual(self.study.units["peak_memory"], "bytes")

    def test_settings_are_medians_with_ranges(self):
        settings, rows = self.study.settings, self.study.rows
        self.assertEqual(settings.groupby("sweep").size().to_dict(), {"border": 25, "costs": 12, "threads": 8})
        one = settings[(settings.sweep == "border") & (settings.kappa0 == 4) & (settings.blend == "step")].iloc[0]
        times = rows[rows.run == one.run].seconds
        self.assertEqual((one.seconds, one["seconds least"], one["seconds most"]), (times.median(), times.min(), times.max()))
        self.assertAlmostEqual(settings[settings.sweep == "threads"].speedup.min(), 1)

    def test_verification_problems_and_manifests(self):
        self.assertEqual(dict(self.study.runs.state.value_counts()),
                         {"complete": 44, "incomplete": 1, "unverified": 1, "failed": 1, "missing": 1})
        problems = self.study.problems.set_index("state").problem
        self.assertEqual(len(problems), 4)
        self.assertEqual(problems["failed"], "killed by signal 9")
        self.assertIn("open edges: 12 & more", problems["unverified"])
        manifests = self.study.manifests
        self.assertEqual(set(manifests.host), {"one", "two"})
        self.assertEqual(len(manifests), len(list(self.study.folder.rglob("manifest.*.json"))))

    def test_figures_by_title_and_on_demand(self):
        figure = self.study.figure("Speed-up")
        self.assertEqual(figure.table.curve.unique().tolist(), ["graph", "levels"])
        self.assertIn("<svg", figure._repr_svg_())
        mine = self.study.figure("Mine", x="kappa0", y="seconds", series="blend", sweeps="border", where={"data": "sphere"})
        self.assertEqual([s.name for s in mine.panels[0].series], ["linear", "step"])
        self.assertEqual(mine.plot().axes[0].get_ylabel(), "seconds (s)")
        with self.assertRaisesRegex(KeyError, "no figure 'Nothing'; there are: Cracks below"):
            self.study.figure("Nothing")

    def test_drawing_leaves_the_settings_of_matplotlib_alone(self):
        import matplotlib
        matplotlib.rcParams["font.size"] = 23
        self.study.figure("Speed-up").contents()
        self.assertEqual(matplotlib.rcParams["font.size"], 23)

    def test_a_run_of_two_sweeps_is_one_run(self):
        study = sweep_folder.SweepFolder(self.folder / "twice")
        for name in ("one", "two"):
            study.sweep(name, [sweep_folder.column("gap", "accuracy")], [sweep_folder.parameter("kappa0")])
        folder = study.run("one", "sphere", {"kappa0": 1.0})
        study.rows(folder, 0, [{"gap": 1}])
        study.sheet["sweeps"][1]["runs"] = study.sheet["sweeps"][0]["runs"]
        both = lr.load(study.write())
        self.assertEqual((len(both.unique_runs()), len(both.runs), len(both.manifests)), (1, 2, 1))

    def test_modules_are_imported_when_they_are_used(self):
        code = ("import sys, lodestone_report as lr; lr.load(sys.argv[1]).figures; "
                "print([m for m in ('pandas', 'matplotlib', 'jinja2', 'numpy') if m in sys.modules])")
        done = subprocess.run([sys.executable, "-B", "-c", code, self.study.folder], capture_output=True, text=True, check=True,
                              env={"PYTHONPATH": str(pathlib.Path(lr.__file__).parents[1])})
        self.assertEqual(done.stdout, "[]\n")


if __name__ == "__main__":
    unittest.main()
