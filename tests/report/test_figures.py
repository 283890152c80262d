"""What figures show: curves, marks, fronts, categories, and what is said of them."""

import csv
import io
import unittest

from report_case import column, make_run, make_sweep, request
from lodestone_report.figures import make_figure
from lodestone_report.settings import aggregate


def border_sweep():
    sweep = make_sweep([column("gap", "pixels", "accuracy"), column("seconds", "s"), column("memory", "bytes"),
                        column("rho", kind="accuracy")], ["kappa0", "blend"])
    for blend in ("linear", "step"):
        for kappa0 in (4.0, 1.0, 2.0):
            row = {"gap": max(0.0, 3 - kappa0), "seconds": kappa0, "memory": 2097152, "rho": 3.0}
            sweep.runs.append(make_run(f"{blend}{kappa0}", "sphere", {"kappa0": kappa0, "blend": blend}, [row]))
    return sweep


def figure_of(sweep, *what, **more):
    return make_figure(request(*what, **more), [aggregate(sweep)])


class Figures(unittest.TestCase):
    def test_curves_are_sorted_and_marks_are_drawn_once(self):
        figure = figure_of(border_sweep(), "kappa0", "gap", series=["data", "blend"], mark="rho")
        (panel,) = figure.panels
        self.assertEqual([s.name for s in panel.series], ["sphere, linear", "sphere, step"])
        self.assertEqual([p.x for p in panel.series[0].points], [1, 2, 4])
        self.assertEqual([(mark.x, mark.label) for mark in figure.marks], [(3.0, "rho")])
        self.assertEqual(figure.outcome, "gap: from rho (2 settings) 0 pixels; below rho (4 settings) 1 to 2 pixels.")

    def test_marks_of_several_inputs_name_them_and_too_many_are_not_drawn(self):
        sweep = border_sweep()
        for k, run in enumerate(sweep.runs[:3]):
            run.data, run.repetitions[0].rows[0]["rho"] = "cube", 2.0
        self.assertEqual([mark.label for mark in figure_of(sweep, "kappa0", "gap", mark="rho").marks], ["rho (cube)", "rho (sphere)"])
        sweep.runs = [make_run(str(k), "", {"kappa0": k, "blend": ""}, [{"gap": 1, "rho": k}]) for k in range(7)]
        figure = figure_of(sweep, "kappa0", "gap", mark="rho")
        self.assertEqual((figure.marks, figure.notes), ([], ["rho is not drawn: it has 7 values"]))

    def test_seeds_at_one_place_are_taken_together_and_that_is_said(self):
        sweep = make_sweep([column("seconds", "s"), column("memory", "bytes")], ["kappa0", "seed"])
        for seed, seconds in ((1, 1.0), (2, 10.0)):
            row = {"seconds": seconds, "memory": 2097152}
            sweep.runs.append(make_run(str(seed), "sphere", {"kappa0": 1.0, "seed": seed}, [row]))
        figure = figure_of(sweep, "kappa0", "seconds", "memory")
        self.assertEqual([panel.y_unit for panel in figure.panels], ["s", "MiB"], "seconds and bytes share no axis")
        first = figure.panels[0].series[0].points[0]
        self.assertEqual((first.settings, first.y, first.y_least, first.y_most), (2, 5.5, 1.0, 10.0))
        self.assertEqual(first.label, "median of 2 seeds")
        self.assertEqual(len(figure.notes), 1)
        self.assertEqual(figure.panels[1].series[0].points[0].y, 2.0)

    def test_curves_that_mix_settings_are_refused(self):
        sweep = border_sweep()
        for k, run in enumerate(sweep.runs):
            run.repetitions[0].rows[0]["seconds"] = float(k)
        refused = figure_of(sweep, "kappa0", "seconds")
        self.assertEqual((refused.count, refused.outcome), (0, "Not drawn: settings that differ in blend fall on one curve; name it in "
                                                               "series, or choose by where."))
        self.assertEqual(figure_of(sweep, "kappa0", "seconds", series=["blend"]).count, 6)
        self.assertEqual(figure_of(sweep, "kappa0", "seconds", where={"blend": "step"}).count, 3)
        self.assertEqual(figure_of(sweep, "kappa0", "seconds", kind="scatter").count, 6, "a scatter plot draws every one of them")
        self.assertIn("blend", figure_of(sweep, "seconds", "kappa0").outcome, "along a measured x as well")
        self.assertEqual(figure_of(sweep, "seconds", "kappa0", where={"blend": "step"}).count, 3, "which follows what is swept")
        self.assertEqual(figure_of(sweep, "kappa0", "rho").panels[0].series[0].points[0].y, 3.0, "equal values hide nothing")

    def test_rows_of_several_workers_are_not_mixed(self):
        sweep = make_sweep([column("workers", kind="count"), column("seconds", "s")], ["task", "mode"])
        for task in ("build", "raster"):
            for mode in ("strong", "weak"):
                rows = [{"workers": n, "seconds": len(task) / n + len(mode)} for n in (1, 2)]
                sweep.runs.append(make_run(task + mode, "sphere", {"task": task, "mode": mode}, rows))
        self.assertIn("differ in mode and workers fall", figure_of(sweep, "task", "seconds", kind="bar").outcome)
        self.assertIn("differ in mode fall", figure_of(sweep, "workers", "seconds", series=["task"]).outcome)
        self.assertEqual(figure_of(sweep, "workers", "seconds", series=["task", "mode"]).count, 8)

    def test_where_compares_numbers_and_truth_values_are_none(self):
        sweep = border_sweep()
        for wanted, count in ((">= 2", 4), ("< 2", 2), (2, 2), (True, 0), ("<= 4", 6), ("2", 0)):
            self.assertEqual(figure_of(sweep, "kappa0", "gap", kind="scatter", where={"kappa0": wanted}).count, count, wanted)

    def test_fronts_name_the_cheapest_setting_for_an_error(self):
        figure = figure_of(border_sweep(), "seconds", "gap", kind="scatter", pareto=True)
        (front,) = figure.panels[0].fronts
        self.assertEqual((front.candidates, len(front.points)), (6, 6), "two blends tie everywhere")
        self.assertEqual([(c.limit, c.point.x, len(c.tied)) for c in front.choices], [(0, 4.0, 1), (1, 2.0, 1), (2, 1.0, 1)])
        self.assertEqual(figure.outcome, "6 of 6 settings on the front; gap of at most 1 pixels costs 2 s (kappa0 = 2, blend = linear; "
                                         "tied with kappa0 = 2, blend = step).")
        rows = list(csv.DictReader(io.StringIO(figure.csv())))
        self.assertEqual([row["front"] for row in rows], ["True"] * 6)
        self.assertEqual([float(row["x"]) for row in rows], [4, 1, 2, 4, 1, 2])

    def test_settings_compete_where_conditions_are_equal(self):
        sweep = border_sweep()
        sweep.parameters[1].condition = True
        figure = figure_of(sweep, "seconds", "gap", kind="scatter", pareto=True)
        self.assertEqual([(f.conditions, f.candidates, len(f.points)) for f in figure.panels[0].fronts],
                         [("sphere, linear", 3, 3), ("sphere, step", 3, 3)])

    def test_what_cracks_is_on_no_front_unless_it_is_asked_for(self):
        sweep = border_sweep()
        sweep.columns += [column("open_edges", kind="accuracy"), column("admissible", kind="label")]
        for run in sweep.runs:
            sound = run.parameters["kappa0"] > 1
            run.repetitions[0].rows[0] |= {"open_edges": 0 if sound else 5, "admissible": sound}
        figure = figure_of(sweep, "seconds", "gap", kind="scatter", pareto=True)
        (front,) = figure.panels[0].fronts
        self.assertEqual((front.candidates, {p.x for p in front.points}, figure.count), (4, {2.0, 4.0}, 6))
        self.assertEqual(figure.notes, ["2 of 6 points crack or have inadmissible radii, and are on no front"])
        asked = figure_of(sweep, "seconds", "gap", kind="scatter", pareto=True, where={"admissible": False, "open_edges": "> 0"})
        self.assertEqual((asked.panels[0].fronts[0].candidates, asked.notes), (2, []))

    def test_fronts_of_quality_rise(self):
        sweep = make_sweep([column("psnr", "dB", "quality"), column("seconds", "s")], ["tolerance"])
        for tolerance, psnr, seconds in ((1.0, 42.0, 3.0), (2.0, 38.0, 2.0), (3.0, 35.0, 2.5), (4.0, 33.0, 1.0)):
            sweep.runs.append(make_run(str(tolerance), "sphere", {"tolerance": tolerance}, [{"psnr": psnr, "seconds": seconds}]))
        figure = figure_of(sweep, "seconds", "psnr", pareto=True)
        self.assertEqual([p.y for p in figure.panels[0].fronts[0].points], [33, 38, 42], "35 dB for 2.5 s is beaten by 38 dB for 2 s")
        self.assertEqual(figure.outcome, "3 of 4 settings on the front; psnr of at least 38 dB costs 2 s (tolerance = 2).")

    def test_a_front_is_that_of_one_error(self):
        sweep = make_sweep([column("rms", "%", "accuracy"), column("error_max", "%", "accuracy"), column("seconds", "s")], ["sigma0"])
        for sigma0 in (1.0, 2.0):
            row = {"rms": sigma0, "error_max": 10 * sigma0, "seconds": 3 - sigma0}
            sweep.runs.append(make_run(str(sigma0), "sphere", {"sigma0": sigma0}, [row]))
        (panel,) = figure_of(sweep, "seconds", "rms", "error_max").panels
        self.assertEqual((panel.y_name, [s.name for s in panel.series]), ("rms, error_max", ["rms", "error_max"]), "one unit, one axis")
        figure = figure_of(sweep, "seconds", "rms", "error_max", pareto=True)
        self.assertEqual([panel.fronts[0].candidates for panel in figure.panels], [2, 2])

    def test_texts_and_bars_have_places_of_their_own(self):
        bars = figure_of(border_sweep(), "blend", "gap", series=["kappa0"], kind="bar", pareto=True, mark="rho", log="x")
        self.assertEqual((bars.categories, bars.log_x, bars.marks), (["linear", "step"], False, []))
        self.assertEqual(bars.panels[0].series[0].points[1].x, 1.0)
        self.assertEqual(bars.panels[0].fronts, [])
        self.assertEqual(bars.notes, ["No Pareto front: the cost is not a number", "rho is not drawn: x is not a number"])
        self.assertEqual(bars.records()[0]["x"], "linear")
        self.assertEqual(figure_of(border_sweep(), "kappa0", "gap", series=["blend"], kind="bar").categories, ["1", "2", "4"])

    def test_without_numbers_a_figure_says_so(self):
        sweep = border_sweep()
        for run in sweep.runs:
            run.repetitions[0].rows[0]["gap"] = None
        figure = figure_of(sweep, "kappa0", "gap", pareto=True)
        self.assertEqual(figure.outcome, "No setting that verified has numbers for gap.")
        self.assertEqual(figure.notes, ["6 of 6 points have no number and are left out"])

    def test_several_sweeps_are_told_apart(self):
        other = border_sweep()
        other.name = "other"
        figure = make_figure(request("kappa0", "gap", series=["sweep"]), [aggregate(border_sweep()), aggregate(other)])
        self.assertEqual([s.name for s in figure.panels[0].series], ["sweep", "other"])
        scatter = make_figure(request("kappa0", "gap", kind="scatter"), [aggregate(border_sweep()), aggregate(other)])
        self.assertTrue(scatter.panels[0].series[0].points[0].label.startswith("sweep = sweep, "))


if __name__ == "__main__":
    unittest.main()
