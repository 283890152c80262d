"""lodestone_report.costs on settings whose cheapest ways are known."""

import unittest

import report_case  # noqa: F401  (first: it finds the interpreter and the package)
from lodestone_report.costs import PARTS, Part, part_rows
from lodestone_report.settings import Cell, Setting

PART = Part("Levels", "accuracy", ("families",), ("RMS, %", "rms"), {"family": "{}", "sigma0": "sigma0 {}"},
            (("CPU seconds", "cpu_seconds", 1), ("kB", "bytes", 1e3)))


def setting(data, family, rms, seconds, size, spread=0.0, **others):
    cells = {"data": data, "family": family, "rms": rms, "bytes": size, **others}
    cells = {name: Cell(value, value, value, 1) if isinstance(value, float) else Cell(value) for name, value in cells.items()}
    return Setting(None, 0, cells | {"cpu_seconds": Cell(seconds, seconds - spread, seconds + spread, 1)})


class Costs(unittest.TestCase):
    def test_each_cost_has_its_own_cheapest_way(self):
        rows = part_rows(PART, [setting("bunny", "ours", 0.1, 1.0, 9000.0), setting("bunny", "theirs", 0.1, 2.0, 4000.0)])
        self.assertEqual(rows, [["0.1", "1 of 1", "1: ours", "4: theirs"]])

    def test_models_that_differ_are_counted(self):
        rows = part_rows(PART, [setting("bunny", "ours", 0.1, 1.0, 1.0), setting("bunny", "theirs", 0.1, 2.0, 1.0),
                                setting("dragon", "ours", 0.1, 5.0, 1.0), setting("dragon", "theirs", 0.1, 4.0, 1.0),
                                setting("lucy", "ours", 0.1, 3.0, 1.0)])
        self.assertEqual(rows[0][1:3], ["3 of 3", "1 to 4: ours on 2; theirs on 1"])

    def test_places_that_do_not_reach_the_error_are_left_out(self):
        rows = part_rows(PART, [setting("bunny", "ours", 0.01, 1.0, 1.0), setting("dragon", "ours", 0.2, 2.0, 1.0)])
        self.assertEqual([row[:3] for row in rows], [["0.01", "1 of 2", "1: ours"], ["0.2", "2 of 2", "1 to 2: ours"]])

    def test_cameras_are_places_of_their_own(self):
        rows = part_rows(PART, [setting("bunny", "ours", 0.1, 1.0, 1.0, camera="orbit"),
                                setting("bunny", "ours", 0.1, 3.0, 1.0, camera="fly-in")])
        self.assertEqual(rows[0][1:3], ["2 of 2", "1 to 3: ours"])

    def test_ways_whose_repetitions_overlap_are_named_together(self):
        rows = part_rows(PART, [setting("bunny", "ours", 0.1, 1.0, 1.0, spread=0.3), setting("bunny", "theirs", 0.1, 1.2, 2.0, spread=0.3)])
        self.assertEqual(rows[0][2:], ["1: ours or theirs", "0.001: ours"])

    def test_ways_beyond_three_that_are_tied_are_counted_and_the_cheapest_comes_first(self):
        rows = part_rows(PART, [setting("bunny", f"way {k}", 0.1, 1.0 + k / 10, 1.0, spread=0.5) for k in reversed(range(5))])
        self.assertEqual(rows[0][2], "1: way 0 or way 1 or way 2 and 2 others")

    def test_sweeps_may_sample_a_path_in_their_own_way(self):
        rows = part_rows(PART, [setting("bunny", "ours", 0.1, 1.0, 1.0, camera="orbit", sweep=sweep) for sweep in "ab"])
        self.assertEqual(rows[0][1], "2 of 2")

    def test_ways_say_what_their_numbers_are(self):
        rows = part_rows(PART, [setting("bunny", "ours", 0.1, 1.0, 1.0, sigma0=0.2)])
        self.assertEqual(rows[0][2], "1: ours, sigma0 0.2")

    def test_many_errors_are_thinned_out_between_the_least_and_the_most(self):
        rows = part_rows(PART, [setting("bunny", "ours", 10.0 ** -k, float(k), 1.0) for k in range(6)])
        self.assertEqual([row[0] for row in rows], ["1e-05", "0.0001", "0.001", "0.1", "1"])
        self.assertEqual(rows[0][2], "5: ours")

    def test_ways_beyond_three_are_counted(self):
        rows = part_rows(PART, [setting(f"model {k}", f"way {k}", 0.1, 1.0, 1.0) for k in range(5)])
        self.assertEqual(rows[0][2], "1: way 0 on 1; way 1 on 1; way 2 on 1 and 2 others")

    def test_rows_without_numbers_give_no_answer(self):
        self.assertEqual(part_rows(PART, [setting("bunny", "ours", None, 1.0, 1.0)]), [])
        rows = part_rows(PART, [setting("bunny", "ours", 0.1, 1.0, None)])
        self.assertEqual(rows, [["0.1", "1 of 1", "1: ours", ""]])

    def test_parts_have_different_titles(self):
        self.assertEqual(len({part.title for part in PARTS}), len(PARTS))


if __name__ == "__main__":
    unittest.main()
