"""Runs a file of tests of the package. usage: run_pytest.py PACKAGE_FOLDER|missing PROGRAM FILE [pytest arguments]"""

import importlib.util
import os
import pathlib
import sys

package, program, *arguments = sys.argv[1:]
if package == "missing":
    print("skipped: the Python package is not built; scripts/setup python installs what it needs (pybind11, numpy)")
    sys.exit(77)
if importlib.util.find_spec("pytest") is None:
    print(f"skipped: {sys.executable} has no pytest; scripts/setup test installs it")
    sys.exit(77)
here = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [package, str(here)]
os.environ["LODESTONE_PROGRAM"] = program
os.environ["PYTHONPATH"] = package  # of interpreters that the tests start
import pytest  # noqa: E402

sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", "--rootdir", str(here), *arguments]))
