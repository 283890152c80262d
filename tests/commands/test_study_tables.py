"""The tables of scripts/evaluate: their cells, and that columns are known. usage: test_study_tables.py PROGRAM"""

import pathlib
import re
import sys
import unittest

import command_case
from command_case import CommandCase

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import study_tables  # noqa: E402


class Cells(unittest.TestCase):
    def spread(self, median, least, most, divisor=1):
        return study_tables.cell({"median": median, "least": least, "most": most}, divisor)

    def test_have_a_range_where_it_can_be_seen(self):
        self.assertEqual(self.spread(2.5, 2, 3), "2.5 (2-3)")
        self.assertEqual(self.spread(-2, -3, -1), "-2 (-3 to -1)")
        self.assertEqual(self.spread(2e6, 1e6, 2e6, study_tables.MB), "2 (1-2)")

    def test_have_none_where_all_print_alike(self):
        self.assertEqual(self.spread(2.5, 2.5, 2.5), "2.5")
        self.assertEqual(self.spread(2.5001, 2.5, 2.5002), "2.5")

    def test_may_be_empty_or_words(self):
        self.assertEqual([study_tables.cell(value) for value in (None, True, "morph")], ["", "yes", "morph"])


class Columns(CommandCase):
    def known(self, experiment):
        about = self.results("experiments", experiment, "--quiet")
        return {entry["name"] for entry in about["parameters"] + about["columns"]} | {"data"}

    def test_are_those_of_the_experiments(self):
        for study, tables in study_tables.TABLES.items():
            text = (ROOT / "experiments/sweeps" / f"{study}.toml").read_text(encoding="utf-8")
            experiments = dict(re.findall(r'\[\[sweep\]\]\nname = "(\w+)"\nexperiment = "(\w+)"', text))
            for title, sweeps, columns in tables:
                for experiment in {experiments[sweep] for sweep in sweeps}:
                    with self.subTest(table=title, experiment=experiment):
                        self.assertLessEqual({column[1] for column in columns}, self.known(experiment))


if __name__ == "__main__":
    command_case.main(__doc__)
