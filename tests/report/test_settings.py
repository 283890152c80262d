"""Rows over repetitions: medians, ranges, what is left out, what tells settings apart, scaling; numbers for people."""

import math
import unittest

from report_case import column, make_run, make_sweep
from lodestone_report.findings import count_runs, reported
from lodestone_report.reading import unsteady_results
from lodestone_report.settings import aggregate
from lodestone_report.runs import Fault, Repetition
from lodestone_report.text import number_text, value_text


class Aggregate(unittest.TestCase):
    def check_cell(self, cell, value, least, most, count=None):
        self.assertEqual((cell.value, cell.least, cell.most), (value, least, most))
        if count is not None:
            self.assertEqual(cell.count, count)

    def test_costs_are_medians_and_accuracy_is_that_of_the_repetition_that_measured_it(self):
        sweep = make_sweep([column("seconds", "s"), column("gap", "pixels", "accuracy")], ["kappa0"])
        sweep.runs = [make_run("a", "sphere", {"kappa0": 2.0}, [{"seconds": 3.0, "gap": 0.5}], [{"seconds": 1.0}],
                               [{"seconds": 2.0, "gap": None}])]
        table = aggregate(sweep)
        (setting,) = table.settings
        self.check_cell(setting.at("seconds"), 2.0, 1.0, 3.0, 3)
        self.check_cell(setting.at("gap"), 0.5, 0.5, 0.5, 1)
        self.assertEqual((setting.value("kappa0"), setting.value("data"), setting.value("nothing")), (2.0, "sphere", None))
        self.assertEqual(table.varied, [])

    def test_ranges_within_a_repetition_widen_those_over_all(self):
        sweep = make_sweep([column("seconds", "s"), column("seconds_min", "s"), column("seconds_max", "s"),
                            column("gap", kind="accuracy"), column("gap_max", kind="accuracy")])
        sweep.runs = [make_run("a", "", {}, [{"seconds": 3, "seconds_min": 2, "seconds_max": 4, "gap_max": 1}],
                               [{"seconds": 5, "seconds_min": 4.5, "seconds_max": 9}])]
        table = aggregate(sweep)
        self.check_cell(table.settings[0].at("seconds"), 4.0, 2.0, 9.0, 2)
        self.assertEqual([c.name for c in table.columns], ["seconds", "gap", "gap_max"], "gap_max is not a cost")
        self.assertEqual(table.settings[0].value("seconds_max"), 6.5, "figures may name it")

    def test_runs_that_do_not_verify_are_left_out_with_all_their_repetitions(self):
        sweep = make_sweep([column("seconds", "s")], ["kappa0"])
        sweep.runs = [make_run(name, "sphere", {"kappa0": 1}, [{"seconds": 1}], [{"seconds": 2}])
                      for name in ("good", "wrong", "crashed", "lacking", "missing")]
        _, wrong, crashed, lacking, missing = sweep.runs
        wrong.repetitions[1].fault = Fault("verify", ["open edges"])
        crashed.repetitions = [Repetition(r, None, Fault("crash", ["signal 9"])) for r in range(2)]
        lacking.repetitions[0] = Repetition(0, None, Fault("error", ["no room"]))
        missing.repetitions = [Repetition(r) for r in range(2)]
        self.assertEqual([run.state for run in sweep.runs], ["complete", "unverified", "failed", "incomplete", "missing"])
        table = aggregate(sweep)
        self.assertEqual([s.run.id for s in table.settings], ["good", "lacking"])
        self.assertEqual(table.settings[1].value("seconds"), 2.0)
        counts = count_runs([sweep])
        self.assertEqual(counts, {"runs": 5, "complete": 1, "incomplete": 1, "unverified": 1, "failed": 1, "missing": 1})
        self.assertEqual(reported(counts), 2)

    def test_runs_whose_results_differ_are_left_out(self):
        sweep = make_sweep([column("triangles", kind="count")])
        sweep.runs = [make_run(name, "", {}, [{"triangles": 10}], [{"triangles": other}]) for name, other in (("a", 11), ("b", 10))]
        for run in sweep.runs:
            run.unsteady = unsteady_results(run, sweep.columns)
        self.assertEqual(sweep.runs[0].state, "unverified")
        self.assertEqual([s.run.id for s in aggregate(sweep).settings], ["b"])

    def test_rows_of_a_run_are_joined_by_place_and_told_apart_by_texts(self):
        sweep = make_sweep([column("stage", kind="label"), column("hash", kind="label"), column("seconds", "s")])
        sweep.runs = [make_run("a", "", {}, *([{"stage": "read", "hash": "0123456789abcdef", "seconds": a},
                                               {"stage": "write", "hash": "fedcba9876543210", "seconds": 10 * a}] for a in (1, 2, 3)))]
        table = aggregate(sweep)
        self.assertEqual([s.value("seconds") for s in table.settings], [2.0, 20.0])
        self.assertEqual(table.varied, ["stage"])
        self.assertEqual(table.settings[1].label(table.varied), "stage = write")

    def test_labels_that_follow_from_others_are_not_repeated(self):
        sweep = make_sweep([column("effects", kind="label"), column("effect", kind="label")])
        sweep.runs = [make_run("a", "", {}, [{"effects": "all but fog", "effect": "fog"}, {"effects": "all", "effect": None}]),
                      make_run("b", "", {}, [{"effects": "all but light", "effect": "light"}])]
        self.assertEqual(aggregate(sweep).varied, ["effects"])

    def test_numbers_may_part_rows_and_truth_values_do_not(self):
        sweep = make_sweep([column("frame", kind="label"), column("closed", kind="label")])
        sweep.runs = [make_run("a", "", {}, [{"frame": 12345678, "closed": True}, {"frame": 1, "closed": False}])]
        self.assertEqual(aggregate(sweep).varied, ["frame"])

    def test_parameters_that_differ_in_type_differ(self):
        sweep = make_sweep([column("seconds", "s")], ["image", "size"])
        sweep.runs = [make_run(str(image), "", {"image": image, "size": 1}, [{"seconds": 1}]) for image in (True, 1)]
        self.assertEqual(aggregate(sweep).varied, ["image"])

    def test_scaling_is_against_one_thread_of_the_same_setting(self):
        sweep = make_sweep([column("seconds", "s")], ["strategy", "threads"])
        for strategy, serial in (("graph", 0.0), ("levels", 0.2)):
            for threads in (1, 2, 4):
                seconds = 8 * (serial + (1 - serial) / threads)
                sweep.runs.append(make_run(f"{strategy}{threads}", "sphere", {"strategy": strategy, "threads": threads},
                                           [{"seconds": seconds}], [{"seconds": seconds * 1.1}], [{"seconds": seconds}]))
        for setting in aggregate(sweep).settings:
            threads, serial = setting.value("threads"), 0 if setting.value("strategy") == "graph" else 0.2
            speedup = setting.at("speedup")
            self.assertAlmostEqual(speedup.value, 1 / (serial + (1 - serial) / threads), 12)
            self.assertAlmostEqual(setting.value("efficiency"), speedup.value / threads, 12)
            self.assertEqual(speedup.count, 3)
            if threads == 1:
                self.check_cell(speedup, 1, 1, 1)
                self.assertIsNone(setting.value("karp_flatt"))
                continue
            self.assertAlmostEqual(speedup.least, speedup.value / 1.1, 12)
            self.assertAlmostEqual(speedup.most, speedup.value * 1.1, 12)
            self.assertAlmostEqual(setting.value("karp_flatt"), serial, 12)
            self.assertLess(setting.at("karp_flatt").least, serial)
            self.assertGreater(setting.at("karp_flatt").most, serial)

    def test_scaling_of_an_experiment_is_that_of_the_medians(self):
        columns = [column(name) for name in ("seconds", "speedup", "karp_flatt")] + [
            column("workers", kind="count"), column("work", kind="count"), column("efficiency", "%")]
        sweep = make_sweep(columns, ["task"])

        def rows(one, two):
            speedup = one / two
            return [{"workers": 1, "work": 10, "seconds": one, "speedup": 1.0, "efficiency": 100.0, "karp_flatt": None},
                    {"workers": 2, "work": 10, "seconds": two, "speedup": speedup, "efficiency": 50 * speedup,
                     "karp_flatt": 2 / speedup - 1}]

        sweep.runs = [make_run("a", "sphere", {"task": "build"}, rows(9.0, 5.0), rows(10.0, 6.0), rows(12.0, 5.5))]
        one, two = aggregate(sweep).settings
        self.assertEqual((one.value("speedup"), one.value("karp_flatt")), (1.0, None))
        self.assertAlmostEqual(two.value("speedup"), 10 / 5.5, 12, "not the median of the three speed-ups, 1.8")
        self.assertAlmostEqual(two.value("efficiency"), 100 * 10 / 5.5 / 2, 12)
        self.assertAlmostEqual(two.value("karp_flatt"), 2 / (10 / 5.5) - 1, 12)
        self.assertAlmostEqual(two.at("speedup").least, 9 / 6, 12)
        self.assertAlmostEqual(two.at("speedup").most, 12 / 5, 12)

    def test_weak_scaling_has_more_work_and_no_serial_share(self):
        columns = [column(name) for name in ("seconds", "speedup", "karp_flatt", "efficiency")] + [
            column("workers", kind="count"), column("work", kind="count")]
        sweep = make_sweep(columns, ["mode"])
        rows = [{"workers": n, "work": 10 * n, "seconds": 4.0, "speedup": 0, "efficiency": 0, "karp_flatt": None} for n in (1, 2)]
        sweep.runs = [make_run("a", "sphere", {"mode": "weak"}, rows)]
        two = aggregate(sweep).settings[1]
        self.assertEqual((two.value("speedup"), two.value("efficiency"), two.value("karp_flatt")), (2.0, 1.0, None))

    def test_without_one_thread_there_is_no_speedup(self):
        sweep = make_sweep([column("seconds", "s")], ["threads"])
        sweep.runs = [make_run(str(threads), "", {"threads": threads}, [{"seconds": 1.0}]) for threads in (2, 4)]
        self.assertEqual([s.value("speedup") for s in aggregate(sweep).settings], [None, None])


class Repetitions(unittest.TestCase):
    def check(self, says, *repetitions):
        columns = [column("hash", kind="label"), column("triangles", kind="count"), column("gap", kind="accuracy"), column("seconds")]
        self.assertEqual(unsteady_results(make_run("a", "", {}, *repetitions), columns), says)

    def test_results_are_equal_and_costs_are_not(self):
        self.check([])
        self.check([], [{"triangles": 10, "gap": 0.1, "seconds": 1}], [{"triangles": 10, "gap": 0.1 * (1 + 1e-12), "seconds": 2}])
        self.check([], [{"hash": "a", "gap": 0.1}], [{"hash": "a"}], [{"hash": "a", "gap": None}])
        self.check(["triangles differs between repetitions: 10 and 11"], [{"triangles": 10}], [{"triangles": 11}])
        self.check(["gap differs between repetitions: 0.25 and 0.5"], [{"gap": None}], [{"gap": 0.25}], [{"gap": 0.5, "hash": "b"}])
        self.check(["hash differs between repetitions: a and b", "gap differs between repetitions: 1 and 2"],
                   [{"hash": "a", "gap": 1}], [{"hash": "b", "gap": 2}])
        self.check(["hash differs between repetitions: true and 1"], [{"hash": True}], [{"hash": 1}])
        self.check(["the number of rows differs between repetitions: 1 and 2"], [{"seconds": 1}], [{"seconds": 2}, {"seconds": 3}])


class NumberText(unittest.TestCase):
    def test_numbers_are_for_people(self):
        for value, text in ((0, "0"), (-0.0, "0"), (1234567, "1,234,567"), (-1234, "-1,234"), (0.0123456, "0.01235"),
                            (1.5e-7, "1.5e-07"), (123456.7, "123,457"), (-123456.5, "-123,457"), (9999.4, "9999"),
                            (9999.7, "10,000"), (1e20, "1e+20"), (math.nan, "not a number"), (-math.inf, "-infinite")):
            self.assertEqual(number_text(value), text)
        self.assertEqual([value_text(value) for value in (True, None, "a", 0.5, [1])], ["yes", "–", "a", "0.5", "[1]"])


if __name__ == "__main__":
    unittest.main()
