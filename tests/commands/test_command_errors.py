"""build --measure-error and --refine as a user meets them. usage: test_command_errors.py PROGRAM"""

import command_case
from command_case import CommandCase, obj, sphere

CORNERS = [(x, y, z) for z in (0, 0.4) for y in (0, 1) for x in (0, 3)]
BOX = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
       (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]


class MeasuredErrors(CommandCase):
    def test_bound_what_compare_samples(self):
        result = self.results("build", sphere(), "-o", "m.lode", "--levels", 2, "--measure-error")
        self.assertEqual(result["errors"], "measured")
        self.assertGreater(result["stages"]["measure"]["cpu_seconds"], 0)
        info = self.results("info", "m.lode")
        self.assertEqual(info["errors"], "measured")
        self.assertIn("errors measured: no point is farther", self.lodestone("info", "m.lode"))
        self.assertLessEqual(max(self.results("verify", "m.lode")["sampled_over_error"]), 1)
        self.assertTrue(self.results("verify", "m.lode", "--input", sphere())["valid"])
        for level in (0, 1):
            distance = self.results("compare", f"m.lode:{level}", "m.lode:2")
            sampled = max(distance[side]["max"] for side in ("forward", "backward"))
            stored = info["level_table"][level]["error_ratio"] * info["scale"] / 2 ** level
            self.assertGreaterEqual(stored, sampled * (1 - 1e-6))
            self.assertLess(stored, 2 * sampled)

    def test_errors_are_estimated_unless_asked_for(self):
        self.assertEqual(self.results("build", sphere(), "-o", "m.lode", "--levels", 2)["errors"], "estimated")
        for said in (self.lodestone("info", "m.lode"), self.lodestone("build", sphere(), "-o", "m.lode", "--levels", 2)):
            self.assertIn("errors estimated at vertices: points may be somewhat farther", said)
        ratio = self.results("verify", "m.lode")["sampled_over_error"]
        self.assertEqual((len(ratio), ratio[2]), (3, 0))
        self.assertTrue(all(0.5 < r < 2 for r in ratio[:2]))

    def test_compressed_files_have_them_too(self):
        self.lodestone("build", sphere(), "-o", "m.lode", "--levels", 2, "--measure-error", "--compress", "--quiet")
        self.assertTrue(self.results("verify", "m.lode", "--input", sphere())["valid"])


class SplitEdges(CommandCase):
    def setUp(self):
        super().setUp()
        (self.folder / "box.obj").write_text(obj(CORNERS, BOX))

    def test_a_box_keeps_its_reach(self):
        plain = self.results("build", "box.obj", "-o", "plain.lode", "--levels", 3)
        self.assertGreater(plain["long_edges"], 0)
        self.assertIn("--refine splits them", self.lodestone("build", "box.obj", "-o", "plain.lode", "--levels", 3))
        result = self.results("build", "box.obj", "-o", "m.lode", "--levels", 3, "--refine", "--sigma0", 0.2)
        self.assertEqual(result["long_edges"], 0)
        self.assertEqual(result["refined"]["triangles_before"], 12)
        self.assertEqual(result["refined"]["split_triangles"], 12)
        self.assertEqual(result["refined"]["triangles_after"], result["input_triangles"])
        self.assertLess(result["diameter"], 2.2)
        self.assertGreater(plain["diameter"], 4)
        self.assertTrue(self.results("info", "m.lode")["refined"])
        self.assertTrue(self.results("verify", "m.lode", "--input", "box.obj")["valid"])
        cracks = self.results("render", "m.lode", "--backend", "null", "--frames", 3, "--pixel-error", 1)
        self.assertEqual(cracks["open_edges"], 0)

    def test_threads_do_not_change_a_byte(self):
        self.same_bytes("box.obj", "--levels", 3, "--refine", "--compress", ways=[("--threads", n) for n in (1, 2, 7)])

    def test_verify_tells_another_input(self):
        self.lodestone("build", "box.obj", "-o", "m.lode", "--levels", 2, "--refine", "--quiet")
        (self.folder / "other.obj").write_text(obj(CORNERS, [*BOX[1:], (0, 3, 2)]))
        done = command_case.call("verify", "m.lode", "--input", "other.obj", cwd=self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertIn(b"FAILS input", done.stdout)

    def test_a_lattice_too_coarse_is_refused(self):
        self.refused("build", "box.obj", "-o", "m.lode", "--levels", 9, "--lattice", 10, "--refine", names=("lattice",))


if __name__ == "__main__":
    command_case.main(__doc__)
