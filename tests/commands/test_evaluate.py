"""scripts/evaluate around a program that only pretends: interrupts, reports of before, words of failure."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

EVALUATE = pathlib.Path(__file__).resolve().parents[2] / "scripts/evaluate"
# Sweeps until it is told to end, tidies up for a while, and says so; or does what FAKE_* ask for.
PROGRAM = """#!/usr/bin/env python3
import json, os, pathlib, signal, sys, time
out = pathlib.Path(sys.argv[sys.argv.index("-o") + 1])
if sys.argv[1] == "report":
    if os.environ.get("FAKE_REPORT") == "broken":
        sys.exit(1)
    empty = dict.fromkeys(("runs", "complete", "incomplete", "unverified", "failed", "missing"), 0)
    pathlib.Path(sys.argv[sys.argv.index("--json") + 1]).write_text(json.dumps({**empty, "studies": []}))
    sys.exit(0)
signals = []
def stop(number, _):
    signals.append(number)
signal.signal(signal.SIGINT, stop), signal.signal(signal.SIGTERM, stop)
out.mkdir(parents=True, exist_ok=True)
(out / "sweep.json").write_text("{}")
while os.environ.get("FAKE_SWEEP") == "long" and not signals:
    time.sleep(0.01)
if signals:
    time.sleep(0.5)
    (out / "tidy").write_text(str(signals))
sys.exit(130 if signals else int(os.environ.get("FAKE_STATUS", 0)))
"""


class Evaluate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.program = self.folder / "program"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        self.out = self.folder / "out"

    def start(self, **settings):
        return subprocess.Popen([sys.executable, EVALUATE, "-o", self.out, "--program", self.program, "ablation"],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, **settings},
                                start_new_session=True)

    def wait_for(self, path):
        end = time.monotonic() + 60
        while not path.exists():
            self.assertLess(time.monotonic(), end, f"no {path}")
            time.sleep(0.02)

    def test_an_interrupt_reaches_the_sweep_once_and_waits_for_it(self):
        # A terminal tells the whole group, `kill` one process.
        for number, tell in ((signal.SIGINT, os.killpg), (signal.SIGINT, os.kill), (signal.SIGTERM, os.kill)):
            with self.subTest(signal=number, tell=tell.__name__):
                tidy = self.out / "ablation/tidy"
                tidy.unlink(missing_ok=True)
                (self.out / "ablation/sweep.json").unlink(missing_ok=True)
                process = self.start(FAKE_SWEEP="long")
                self.wait_for(self.out / "ablation/sweep.json")
                tell(process.pid, number)
                _, words = process.communicate(timeout=60)
                self.assertEqual(process.returncode, 128 + number, words)
                self.assertEqual(tidy.read_text(), str([int(number)]))
                self.assertIn("goes on where this one stopped", words)
                self.assertNotIn("Traceback", words)

    def test_a_report_of_before_is_not_shown_as_new(self):
        process = self.start()
        words, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn("0 runs", words)
        (self.out / "report.json").write_text(json.dumps({"runs": 11}))
        process = self.start(FAKE_REPORT="broken")
        words, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertEqual(words, "")
        self.assertNotIn("report.html", errors)

    def test_a_study_that_fails_is_told_and_the_rest_is_reported(self):
        process = self.start(FAKE_STATUS="1")
        words, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertIn("ablation.log", errors)
        self.assertIn("0 runs", words)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
