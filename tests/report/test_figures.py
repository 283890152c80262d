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

    def test_settings_at_one_place_are_taken_together_and_that_is_said(self):
        sweep = border_sweep()
        for run in sweep.runs[3:]:
            run.repetitions[0].rows[0]["seconds"] = 10.0
        figure = figure_of(sweep, "kappa0", "seconds", "memory")
        self.assertEqual([panel.y_unit for panel in figure.panels], ["s", "MiB"], "seconds and bytes share no axis")
        first = figure.panels[0].series[0].points[0]
        self.assertEqual((first.settings, first.y, first.y_least, first.y_most), (2, 5.5, 1.0, 10.0))
        self.assertEqual(first.label, "median of 2 settings")
        self.assertEqual(len(figure.notes), 1)
        self.assertEqual(figure.panels[1].series[0].points[0].y, 2.0)

    def test_fronts_name_the_cheapest_setting_for_an_error(self):
        figure = figure_of(border_sweep(), "seconds", "gap", kind="scatter", pareto=True)
        (front,) = figure.panels[0].fronts
        self.assertEqual((front.candidates, len(front.points)), (6, 3))
        self.assertEqual([(c.limit, front.points[c.point].x) for c in front.choices], [(0, 4.0), (1, 2.0), (2, 1.0)])
        self.assertEqual(figure.outcome, "3 of 6 settings on the front; gap of at most 1 pixels costs 2 s (kappa0 = 2, blend = linear).")
        rows = list(csv.DictReader(io.StringIO(figure.csv())))
        self.assertEqual([row["front"] for row in rows], ["True"] * 3 + ["False"] * 3)
        self.assertEqual([float(row["x"]) for row in rows], [4, 1, 2, 4, 1, 2])

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
