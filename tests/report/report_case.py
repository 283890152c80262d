"""What the tests of lodestone_report share: an interpreter with its modules, and sweeps made by hand."""

import importlib.util
import os
import pathlib
import sys

TESTS = pathlib.Path(__file__).resolve().parents[1]
SYSTEM_PYTHON = "/usr/bin/python3"
if any(importlib.util.find_spec(module) is None for module in ("jinja2", "matplotlib", "pandas")):
    if sys.executable != SYSTEM_PYTHON and os.path.exists(SYSTEM_PYTHON):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, "-B", *sys.argv])
    print("no python3 with jinja2, matplotlib and pandas: skipped")
    sys.exit(77)
sys.path[:0] = [str(TESTS.parent / "python"), str(TESTS / "commands")]

from command_case import FolderCase  # noqa: E402, F401
from lodestone_report.runs import Column, FigureRequest, Repetition, Run, Sweep  # noqa: E402


def column(name, unit="", kind="cost"):
    return Column(name, unit, "", kind)


def make_run(name, data, parameters, *repetitions):
    """A run whose repetitions have these lists of rows."""
    return Run(name, data, parameters, [Repetition(r, rows) for r, rows in enumerate(repetitions)])


def make_sweep(columns, parameters=()):
    return Sweep("sweep", "flight", "", 1, [Column(name) for name in parameters], columns)


def request(x, *y, **more):
    return FigureRequest("A figure", ["sweep"], x, list(y), **more)
