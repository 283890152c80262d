"""lodestone_report.fronts against the definition of a Pareto front."""

import math
import random
import unittest

import report_case  # noqa: F401  (first: it finds the interpreter and the package)
from lodestone_report.fronts import cheapest_within, error_limits, pareto_front


def obvious_front(points):
    """The definition, point by point."""
    def is_beaten(i):
        if not all(map(math.isfinite, points[i])):
            return True
        return any(p[0] <= points[i][0] and p[1] <= points[i][1] and p != points[i] for p in points)

    return sorted((i for i in range(len(points)) if not is_beaten(i)), key=lambda i: points[i][0])


def exact(points):
    """Costs without a range."""
    return [(cost, cost) for cost, _ in points]


class Fronts(unittest.TestCase):
    def test_front_is_that_of_the_definition(self):
        chance = random.Random(7)
        for round_ in range(300):
            points = [(float(chance.randrange(8)), float(chance.randrange(8))) for _ in range(chance.randrange(30))]
            if points and round_ % 3 == 0:
                points[0] = (points[0][0], math.nan)
            self.assertEqual(pareto_front(points), obvious_front(points))
            limit = chance.randrange(9) - 0.5
            cheapest = cheapest_within(points, limit, exact(points))
            costs = [cost for cost, error in points if error <= limit]
            self.assertEqual(sorted(cheapest), [i for i, (cost, error) in enumerate(points) if error <= limit and cost == min(costs)])

    def test_costs_whose_ranges_overlap_are_tied(self):
        points, costs = [(4.0, 1.0), (2.0, 1.0), (3.0, 0.5), (1.0, 9.0)], [(3.6, 5.0), (1.5, 2.5), (2.5, 3.5), (0.9, 1.6)]
        self.assertEqual(cheapest_within(points, 1.0, costs), [1, 2], "3 may be 2.5, and so may 2; 4 is at least 3.6")
        self.assertEqual(cheapest_within(points, 9.0, costs), [3, 1])
        self.assertEqual(cheapest_within(points, 0.1, costs), [])

    def test_limits_are_round_and_span_the_front(self):
        self.assertEqual(error_limits([(1, 0.3), (2, 0.02), (3, 0.03)]), [0.02, 0.05, 0.1, 0.2, 0.5])
        self.assertEqual(error_limits([(1, 3), (2, 0)]), [0, 5])
        self.assertEqual(error_limits([(1, 0)]), [0])
        self.assertEqual(error_limits([]), [])
        self.assertEqual(error_limits([(1, 700), (2, 0.0011)]), [0.01, 0.1, 1, 10, 100, 1000])

    def test_every_limit_is_kept_by_a_point_and_the_last_by_all(self):
        chance = random.Random(3)
        for _ in range(300):
            points = [(chance.random(), 10 ** chance.uniform(-4, 4) * chance.choice((0, 1, 1, 1))) for _ in range(12)]
            limits, front = error_limits(points), pareto_front(points)
            self.assertEqual(limits, sorted(set(limits)))
            for limit in limits:
                self.assertTrue(cheapest_within(points, limit, exact(points)))
            self.assertEqual(cheapest_within(points, limits[-1], exact(points)), front[:1])


if __name__ == "__main__":
    unittest.main()
