"""`lodestone reconstruct`: what it writes, what it says, what it refuses. usage: FILE PROGRAM"""

import json

import command_case
from command_case import CommandCase, sphere


class Reconstruct(CommandCase):
    def test_a_closed_surface_stays_closed(self):
        report = self.results("reconstruct", sphere(), "-o", "lod.ply", "--resolution", 48, "--measure")
        level = report["levels"][0]
        self.assertTrue(level["manifold"] and level["closed"])
        self.assertEqual(level["euler"], 2)
        self.assertGreater(level["coverage"], 99.5)
        self.assertLess(level["slivers"], 2)
        for direction in ("forward", "backward"):
            self.assertLess(level[direction]["rms"], 0.002 * level["diagonal"])
        self.assertAlmostEqual(level["rms"], 100 * max(level[d]["rms"] for d in ("forward", "backward"))
                               / level["diagonal"])
        for stage in ("views", "draw", "connect", "merge", "sharpen"):
            self.assertGreaterEqual(level["stages"][stage]["seconds"], 0)
        info = self.results("info", "lod.ply")
        self.assertEqual(info["triangles"], level["triangles"])

    def test_the_outside_of_a_mesh_and_of_maps_is_one_closed_shell(self):
        report = self.results("reconstruct", sphere(), "-o", "lod.ply", "--resolution", 32, "--outside-only", "--measure",
                              "--maps", "maps")
        again = self.results("reconstruct", "maps", "-o", "again.ply", "--outside-only")
        for level in (report["levels"][0], again["levels"][0]):
            self.assertTrue(level["manifold"] and level["closed"])
            self.assertEqual((level["euler"], level["mesh"]["components"]), (2, 1))
        self.assertGreater(report["levels"][0]["coverage"], 99.5)
        self.assertEqual(report["levels"][0]["stages"]["views"]["seconds"], 0)
        for other in (("--merge", "concatenate"), ("--projection", "perspective")):
            self.refused("reconstruct", sphere(), "-o", "lod.ply", "--outside-only", *other)

    def test_maps_give_fewer_triangles_on_request(self):
        self.lodestone("reconstruct", sphere(), "-o", "lod.ply", "--resolution", 40, "--maps", "maps")
        whole = self.results("reconstruct", "maps", "-o", "lod.ply")["levels"][0]
        few = self.results("reconstruct", "maps", "-o", "lod.ply", "--triangles", 3000)["levels"][0]
        self.assertAlmostEqual(few["triangles"], 3000, delta=60)
        coarse = self.results("reconstruct", "maps", "-o", "lod.ply", "--resolution", 20)["levels"][0]
        self.assertAlmostEqual(coarse["triangles"] / whole["triangles"] * (whole["resolution"] / 20) ** 2, 1, delta=0.05)
        for level in (few, coarse):
            self.assertTrue(level["manifold"] and level["closed"])
        self.assertIn("give a --resolution of at most that",
                      self.refused("reconstruct", "maps", "-o", "lod.ply", "--resolution", 400))

    def test_finer_maps_are_nearer_with_as_many_triangles(self):
        level = {}
        for detail in (1, 2):
            level[detail] = self.results("reconstruct", sphere(), "-o", "lod.ply", "--resolution", 40, "--measure", "--detail",
                                         detail)["levels"][0]
        triangles = [level[d]["triangles"] for d in (1, 2)]
        self.assertLess(abs(triangles[0] / triangles[1] - 1), 0.05)
        self.assertGreater(level[2]["sampled_triangles"], 3.5 * triangles[1])
        rms = [level[d]["visible_rms"] for d in (1, 2)]
        self.assertLess(rms[1], 0.8 * rms[0])
        self.refused("reconstruct", sphere(), "-o", "lod.ply", "--detail", 0.5)

    def test_levels_halve_the_resolution(self):
        report = self.results("reconstruct", sphere(), "-o", "lod.obj", "--resolution", 64, "--levels", 3)
        triangles = [level["triangles"] for level in report["levels"]]
        self.assertEqual([level["resolution"] for level in report["levels"]], [64, 32, 16])
        for finer, coarser in zip(triangles, triangles[1:]):
            self.assertTrue(3 < finer / coarser < 5, triangles)
        self.assertEqual(self.listing_names(), {"lod.obj", "lod.1.obj", "lod.2.obj", "results.json"})

    def listing_names(self):
        return {path.name for path in self.folder.iterdir()}

    def test_triangles_and_distance_set_the_resolution(self):
        made = self.results("reconstruct", sphere(), "-o", "lod.ply", "--triangles", 5000)["levels"][0]
        self.assertAlmostEqual(made["triangles"], 5000, delta=250)
        near = self.results("reconstruct", sphere(), "-o", "lod.ply", "--distance", 60)["levels"][0]
        far = self.results("reconstruct", sphere(), "-o", "lod.ply", "--distance", 120)["levels"][0]
        self.assertAlmostEqual(near["resolution"] / far["resolution"], 2, places=6)

    def test_maps_come_back(self):
        for form in ("exr", "pfm"):
            self.lodestone("reconstruct", sphere(), "-o", "lod.ply", "--resolution", 40, "--maps", form, "--map-format", form,
                           "--no-condense", "--sharp", 0)
            views = json.loads((self.folder / form / "views.json").read_text())
            self.assertEqual(len(views["views"]), len(list((self.folder / form).glob("view*." + form))))
            again = self.results("reconstruct", form, "-o", "again.ply", "--sharp", 0)["levels"][0]
            self.assertTrue(again["manifold"] and again["closed"])
        distance = self.results("compare", "lod.ply", "again.ply")
        self.assertLess(distance["forward"]["rms"], 1e-3 * distance["diagonal"])

    def test_concatenation_overlaps(self):
        report = self.results("reconstruct", sphere(), "-o", "lod.ply", "--resolution", 40, "--merge", "concatenate",
                              "--views", "faces")
        level = report["levels"][0]
        self.assertEqual(level["view_count"], 6)
        self.assertGreaterEqual(level["mesh"]["components"], 6)
        self.assertEqual(level["triangles"], level["view_triangles"])

    def test_refusals(self):
        for wrong, names in [
            (["--views", "none"], ["--views"]), (["--merge", "glue"], ["--merge"]), (["--backend", "null"], ["null"]),
            (["--resolution", "1"], ["resolution"]), (["--resolution", "100000"], ["resolution"]),
            (["--projection", "round"], ["--projection"]), (["--distance", "-1"], ["distance"]),
            (["--resolution", "64", "--triangles", "9"], ["--triangles"]), (["--map-format", "png"], ["--map"]),
            (["--sharp", "200"], ["sharp"]), (["--levels", "0"], ["--levels"]),
        ]:
            self.refused("reconstruct", sphere(), "-o", "lod.ply", *wrong, names=names)
        self.refused("reconstruct", sphere(), "-o", sphere(), names=["sphere.ply"])
        self.refused("reconstruct", "missing.ply", "-o", "lod.ply", names=["missing.ply"])
        (self.folder / "views.json").write_text("{}")
        self.refused("reconstruct", "views.json", "-o", "lod.ply", names=["views.json"])
        self.refused("reconstruct", "views.json", "-o", "lod.ply", "--measure", names=["--measure"])


if __name__ == "__main__":
    command_case.main(__doc__)
