"""lodestone_report.correlation against values that are known."""

import random
import unittest

import report_case  # noqa: F401  (first: it finds the interpreter and the package)
from lodestone_report.correlation import matrix, rank_correlation, ranks
from lodestone_report.settings import Cell, Setting


def setting(path, **values):
    return Setting(None, 0, {"path": Cell(path), **{name: Cell(value) for name, value in values.items()}})


class Correlations(unittest.TestCase):
    def test_equal_values_share_their_ranks(self):
        self.assertEqual(ranks([30, 10, 20, 10]), [4, 1.5, 3, 1.5])
        self.assertEqual(ranks([]), [])

    def test_what_rises_together_correlates_whatever_its_course(self):
        self.assertAlmostEqual(rank_correlation([[(x, x ** 3) for x in range(-5, 6)]]), 1)
        self.assertAlmostEqual(rank_correlation([[(x, -(2.0 ** x)) for x in range(9)]]), -1)

    def test_is_that_of_the_formula_without_ties(self):
        chance = random.Random(5)
        for _ in range(50):
            n = chance.randrange(3, 12)
            pairs = list(zip(chance.sample(range(99), n), chance.sample(range(99), n)))
            differences = sum((a - b) ** 2 for a, b in zip(ranks([x for x, _ in pairs]), ranks([y for _, y in pairs])))
            self.assertAlmostEqual(rank_correlation([pairs]), 1 - 6 * differences / (n * (n * n - 1)))

    def test_groups_are_ranked_by_themselves(self):
        falling = [(1, 3), (2, 2), (3, 1)]
        apart = [falling, [(x + 10, y + 10) for x, y in falling]]
        self.assertAlmostEqual(rank_correlation(apart), -1)
        self.assertGreater(rank_correlation([apart[0] + apart[1]]), 0)

    def test_there_is_none_without_differences(self):
        self.assertIsNone(rank_correlation([[(1, 2), (1, 3)]]))
        self.assertIsNone(rank_correlation([]))

    def test_matrix_has_all_above_the_diagonal_and_paths_below(self):
        settings = [setting("a", x=float(k), y=float(-k)) for k in range(3)]
        settings += [setting("b", x=10.0 + k, y=10.0 - k) for k in range(3)] + [setting("b", x=99.0, y=None)]
        above, below = matrix(settings, ["x", "y"], lambda s: s.value("path"))
        self.assertEqual(above, ["", "0.54 (6)"])
        self.assertEqual(below, ["-1.00 (6)", ""])


if __name__ == "__main__":
    unittest.main()
