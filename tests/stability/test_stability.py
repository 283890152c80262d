"""The catalogue of hard surfaces through the commands, without those cases that take long (scripts/stability has them)."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import matrix  # noqa: E402

PROGRAM = sys.argv.pop()
LONG = {"wheel", "confetti", "uneven", "crossing"}
STEPS = {"build, small cells", "verify", "build, measured", "verify, measured", "render, soft", "export .ply", ".ply and back",
         "progressive .lpm", "reconstruct", "spherical"}


class Stability(unittest.TestCase):
    def test_every_case_gives_a_valid_result_or_its_error(self):
        names = matrix.names(PROGRAM)
        self.assertGreater(len(names), 30)
        for name in names:
            if name in LONG:
                continue
            with self.subTest(name):
                case = matrix.run_case(PROGRAM, name, STEPS)
                self.assertEqual([(o.step, o.fault) for o in case.outcomes if o.fault], [])
                self.assertGreaterEqual(len(case.outcomes), 5)

    def test_faults_are_seen(self):
        step = matrix.Step("", ["build", "in.ply"], errors="too much")
        self.assertEqual(matrix.judge(step, "", 0, ""), ("", ""))
        self.assertEqual(matrix.judge(step, "", 3, "too much of it"), ("", "too much of it"))
        for status, line in ((3, "nothing known"), (-11, "too much"), (1, "too much"), (7, "too much")):
            self.assertNotEqual(matrix.judge(step, "", status, line)[0], "")
        self.assertEqual(matrix.judge(step, "no triangle", 3, "has no triangle")[0], "")
        self.assertNotEqual(matrix.judge(step, "no triangle", 0, "")[0], "")


if __name__ == "__main__":
    unittest.main()
