"""The model of many ranks: factors that were put in come out again, and larger jobs cost what they must."""

import math
import pathlib
import unittest
from types import SimpleNamespace

from report_case import FolderCase
from lodestone_report import distributed, rank_model
from lodestone_report.rank_model import NETWORKS, Curve, Job, Model
from lodestone_report.result_tables import STAGES

TRIANGLE, MESSAGE, SENT = 1e-7, 2e-6, 20.0     # of every stage: seconds, seconds, bytes
TABLES = 2e-8                                  # seconds of rank 0 for a triangle
ROUNDS = (10, 2)
BORDER = 4    # vertices between ranks over the root of triangles times ranks


class Setting:
    def __init__(self, **values):
        self.values = values

    def value(self, name):
        return self.values.get(name)


def job(triangles, ranks, threads=1):
    """A job as the model has it, but for blocks that are dealt out evenly."""
    values = {"data": f"model of {triangles}", "input_triangles": triangles, "ranks": ranks, "rank_threads": threads,
              "processors": 2, "cell_triangles": 1200, "imbalance_triangles": 1.0}
    growing = ROUNDS[1] * rank_model.pieces_of(Job(triangles, ranks))
    rounds, messages = ROUNDS[0] + growing, ranks * rank_model.messages_of(ROUNDS[0], growing, ranks)
    for stage in STAGES:
        work = triangles * (4 / 3 if stage == "levels" else 1)
        moved = BORDER * math.sqrt(triangles * ranks) if stage == "clean" and ranks > 1 else triangles * (1 - 1 / ranks)
        sent = SENT * moved + rank_model.HEAD * messages
        values |= {f"{stage}_cpu_seconds": TRIANGLE * work + MESSAGE * messages, f"{stage}_bytes": sent,
                   f"{stage}_rounds": rounds, f"{stage}_messages": messages, f"{stage}_seconds": TRIANGLE * work / ranks / threads}
    sent = sum(values[f"{stage}_bytes"] for stage in STAGES)
    values |= {"first_write_bytes": 2 * triangles * (1 - 1 / ranks), "first_write_cpu_seconds": ((TRIANGLE - TABLES) * triangles + MESSAGE * messages) / ranks + TABLES * triangles,
               "cpu_seconds": sum(values[f"{stage}_cpu_seconds"] for stage in STAGES), "seconds": 1.0,
               "bytes_per_triangle": sent / triangles, "rounds_of_messages": rounds * len(STAGES),
               "first_peak_bytes": 4e7 + 60 * triangles / ranks + 5 * triangles,
               "peak_bytes": 4e7 + 60 * triangles / ranks if ranks > 1 else None}
    return Setting(**values)


def plan(blocks, ranks, coarser=0, seed=0):
    triangles = 4.0 ** -coarser * 1e6
    x = blocks / ranks
    return Setting(data="model", seed=seed, cell_triangles=1200, ranks=ranks, coarser=coarser, level_blocks=blocks,
                   level_triangles=triangles, level_imbalance=max(1.0, 1 / x) * (1.5 if seed else 1), moved_bytes=8 * triangles,
                   input_triangles=1e6, border_vertices=BORDER * math.sqrt(1e6 * ranks), first_rank_bytes=5e6)


JOBS = [job(n, r) for n in (200_000, 1_000_000, 4_000_000) for r in (1, 2, 4, 8)]
PLANS = [plan(80 // 4**c, r, c, seed) for c in range(3) for r in (4, 16, 64) for seed in (0, 1)]


class Fits(unittest.TestCase):
    def test_find_factors_and_none_below_zero(self):
        rows = [(n, m) for n in (1, 3, 10) for m in (0, 2, 50)]
        for found, expected in zip(rank_model.fit(rows, [2 * n + 0.5 * m for n, m in rows]), (2, 0.5)):
            self.assertAlmostEqual(found, expected)
        self.assertGreaterEqual(min(rank_model.fit(rows, [2 * n - 0.01 * m for n, m in rows])), 0)
        self.assertEqual(rank_model.fit([(1,), (2,)], [0, 0]), [])

    def test_curves_go_through_medians_and_on(self):
        curve = Curve.through([(1, 4), (1, 5), (1, 9), (4, 1)])
        self.assertEqual([curve.at(1), curve.at(2), curve.at(4), curve.at(100)], [5, 3, 1, 1])
        self.assertEqual([curve.at(0.25), curve.at(0.25, -1)], [5, 20])


class Models(unittest.TestCase):
    def setUp(self):
        self.model = Model(JOBS, PLANS)

    def test_have_the_costs_of_the_jobs(self):
        for stage in ("clean", "route", "finest", "levels"):
            triangle, _, message = self.model.cost[stage]
            self.assertAlmostEqual(triangle / TRIANGLE, 1, delta=0.02)
            self.assertAlmostEqual(message / MESSAGE, 1, delta=0.2)
            self.assertAlmostEqual(self.model.rounds[stage][0], ROUNDS[0])
            self.assertAlmostEqual(self.model.rounds[stage][1], ROUNDS[1])
        self.assertAlmostEqual(self.model.first[""], TABLES)
        for stage in ("clean", "route"):
            self.assertAlmostEqual(self.model.sent[stage][""], SENT)

    def test_predict_jobs_that_they_have_not_seen(self):
        for seen in JOBS:
            others = [other for other in JOBS if other is not seen]
            found = Model(others, PLANS).predict(Model.job(seen))
            self.assertAlmostEqual(found.cpu_seconds / seen.value("cpu_seconds"), 1, delta=0.03)
            self.assertAlmostEqual(found.rounds, seen.value("rounds_of_messages"))
            if seen.value("ranks") > 1:
                self.assertAlmostEqual(found.peak_bytes / seen.value("peak_bytes"), 1, delta=0.01)
                self.assertAlmostEqual(found.first_peak_bytes / seen.value("first_peak_bytes"), 1, delta=0.01)

    def test_larger_jobs(self):
        before = None
        for ranks in (16, 64, 256, 1024, 4096):
            large = Job(1e9, ranks)
            found = self.model.predict(large, NETWORKS[1])
            direct = self.model.predict(large, NETWORKS[1], direct=True)
            self.assertTrue(found.heads < direct.heads or ranks < 64)
            self.assertTrue(found.seconds < direct.seconds or ranks < 256)
            self.assertGreater(found.first_peak_bytes, found.peak_bytes)
            self.assertGreaterEqual(found.first_seconds, TABLES * 1e9 * (1 - 1 / ranks) * 0.99)
            self.assertGreaterEqual(self.model.predict(large, NETWORKS[1], sampled=True).imbalance, found.imbalance)
            self.assertGreater(self.model.predict(large, NETWORKS[0]).seconds, found.seconds)
            if before:
                self.assertLess(found.peak_bytes, before.peak_bytes)
                self.assertGreater(found.heads, before.heads)
            before = found

    def test_what_breaks_is_sorted_by_ranks(self):
        ranks = [count or math.inf for count, *_ in distributed.breaks(self.model)]
        self.assertEqual(ranks, sorted(ranks))
        text = "\n".join(distributed.breaking_lines(self.model))
        for word in ("rank 0 alone", "Splitters", "Coarse levels", "Metadata of cells", "32 and 31 bits", "The order"):
            self.assertIn(word, text)


class Page(FolderCase):
    def results(self, jobs):
        return SimpleNamespace(settings=lambda *sweeps: PLANS if sweeps == distributed.PLANS else jobs,
                               source=lambda sweeps: "Commit 0123456")

    def test_has_a_table_and_a_picture_of_what_is_predicted(self):
        folder = pathlib.Path(self.folder)
        text = "\n".join(distributed.lines(self.results(JOBS), folder))
        self.assertIn("| model of 4000000 | 8 | 1 |", text)
        self.assertIn("\n| 10^12 | 4,096 |", text)
        self.assertIn("![", text)
        self.assertIn("<svg", (folder / distributed.PICTURE).read_text())

    def test_is_empty_without_enough_jobs(self):
        folder = pathlib.Path(self.folder)
        (folder / distributed.PICTURE).write_text("of before")
        self.assertEqual(distributed.lines(self.results(JOBS[:2]), folder), [])
        self.assertFalse((folder / distributed.PICTURE).exists())


if __name__ == "__main__":
    unittest.main()
