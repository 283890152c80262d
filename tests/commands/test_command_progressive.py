"""`lodestone progressive`, `lod` and `page`. usage: FILE PROGRAM"""

import itertools
import json
import os

import command_case
from command_case import HERMES, SOURCE, TEXTURED, CommandCase, model, ply_counts, sphere

BUNNY = SOURCE / "build/data/scans/stanford-bunny.obj"


def progressive(name="sphere.lpm", mesh=None, *options):
    return model(name, "progressive", mesh or sphere(), *options)


class Progressive(CommandCase):
    def test_results(self):
        for name in ("out.lpm", "out.glb"):
            result = self.results("progressive", sphere(), "-o", name, "--base", 500, "--check-levels", 20)
            self.assertEqual(result["residual_edges"], 0)
            size = (self.folder / name).stat().st_size
            self.assertEqual((result["file_bytes"], result["finest_vertices"]), (size, result["input_triangles"] // 2 + 2))
            self.assertIn(result["base_triangles"], (500, 501))
            self.assertEqual((result["cut_edges"], result["cut_vertices"]), (0, 0))
            self.assertAlmostEqual(result["bytes_per_vertex"], size / result["finest_vertices"])

    def test_summary_and_quiet(self):
        said = self.lodestone("progressive", sphere(), "-o", "out.lpm")
        self.assertRegex(said, r"out.lpm: \d+ triangles to a base of \d+ in ")
        self.assertRegex(said, r"\d+ vertices, \d\.\d\d bytes each")
        self.assertEqual(self.lodestone("progressive", sphere(), "-o", "out.lpm", "--quiet"), "")

    def test_same_bytes_for_any_number_of_threads(self):
        for name in ("out.lpm", "out.glb"):
            files = []
            for threads in (1, 2, 4):
                self.lodestone("progressive", sphere(), "-o", name, "--threads", threads)
                files.append((self.folder / name).read_bytes())
            self.assertEqual(files[0], files[1])
            self.assertEqual(files[0], files[2])

    def test_levels(self):
        for file in (progressive(), progressive("sphere.glb")):
            for triangles in (100, 1000, 10001):
                result = self.results("lod", file, "--triangles", triangles, "-o", "level.ply")
                self.assertIn(triangles - result["triangles"], (0, 1, 2))
                self.assertEqual(ply_counts(self.folder / "level.ply"), (result["vertices"], result["triangles"]))
            errors = [self.results("lod", file, "--vertices", v, "-o", "level.obj")["error"] for v in (50, 500, 5000)]
            self.assertEqual(errors, sorted(errors, reverse=True))
            result = self.results("lod", file, "--error", errors[1], "-o", "level.stl")
            self.assertLessEqual(result["error"], errors[1])
            self.assertLessEqual(result["vertices"], 500)

    def test_an_error_holds_for_every_file(self):
        for name, error in (("sphere.lpm", 0.01), ("sphere.glb", 0.01), ("sphere.lpm", 0.003)):
            result = self.results("lod", progressive(name), "--error", error, "-o", "level.ply")
            distance = self.results("compare", sphere(), "level.ply")
            sampled = max(distance[way]["max"] for way in ("forward", "backward"))
            self.assertLessEqual(sampled, result["error"])
            self.assertLessEqual(result["error"], error)
            self.assertGreater(sampled, error / 3)
            self.assertLess(result["triangles"], result["finest_triangles"])

    def test_the_finest_level_is_the_input(self):
        self.lodestone("lod", progressive("sphere.glb"), "--triangles", 10**9, "-o", "finest.ply")
        result = self.results("compare", sphere(), "finest.ply")
        self.assertLess(max(result["forward"]["max"], result["backward"]["max"]), 1e-6 * result["diagonal"])

    def test_a_prefix_is_a_coarser_mesh(self):
        data = progressive().read_bytes()
        (self.folder / "part.lpm").write_bytes(data[:len(data) // 3])
        self.refused("lod", "part.lpm", "--triangles", 5000, "-o", "level.ply", names=["part.lpm", "ends early"])
        result = self.results("lod", "part.lpm", "--triangles", 10**9, "-o", "level.ply", "--prefix")
        self.assertGreater(result["triangles"], 1000)
        self.assertLess(result["triangles"], 15000)

    def test_flat_normals_are_seams_unless_left_out(self):
        lines = ["v %d %d 0" % (x, y) for y in range(11) for x in range(11)]
        faces, normals = [], []
        for x, y in itertools.product(range(10), range(10)):
            a = 11 * y + x + 1
            for corners in ((a, a + 1, a + 12), (a, a + 12, a + 11)):
                normals.append("vn 0 %g 1" % (len(normals) / 100))
                faces.append("f " + " ".join(f"{v}//{len(normals)}" for v in corners))
        (self.folder / "flat.obj").write_text("\n".join(lines + normals + faces) + "\n")
        self.assertGreater(self.results("progressive", "flat.obj", "-o", "a.glb")["base_triangles"], 150)
        self.assertLess(self.results("progressive", "flat.obj", "-o", "b.glb", "--no-normals")["base_triangles"], 10)
        self.assertLess(self.results("progressive", "flat.obj", "-o", "c.lpm")["base_triangles"], 10)  # has none

    def test_attributes_leave_the_shape(self):
        # Normals at the price of the shape made spikes of knees and elbows: 1.4 (.lpm) and 1.7 (.glb) times as far.
        def distance(output, *options):
            self.lodestone("progressive", TEXTURED, "-o", output, *options)
            self.lodestone("lod", output, "--triangles", 1200, "-o", "level.ply")
            return self.results("compare", TEXTURED, "level.ply")["rms"]

        shape = distance("shape.lpm", "--metric", "quadric")
        self.assertLess(distance("textured.lpm"), 1.1 * shape)
        self.assertLess(distance("textured.glb"), 1.3 * shape)

    def test_textured_models_and_the_validator(self):
        for metric in ("quadric", "attribute-quadric", "parametric"):
            result = self.results("progressive", TEXTURED, "-o", f"{metric}.lpm", "--metric", metric)
            self.assertLessEqual(result["bytes_per_vertex"], 6)
            self.assertLess(result["base_triangles"], 400)
        self.lodestone("progressive", TEXTURED, "-o", "plain.glb")
        self.lodestone("progressive", TEXTURED, "-o", "packed.glb", "--compress")
        self.lodestone("lod", "packed.glb", "--triangles", 3000, "-o", "level.glb")
        self.assertEqual(self.validate(self.folder, known="MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"), 3)

    def test_textures_of_a_quality(self):
        if not HERMES.exists():
            self.skipTest("no models: run scripts/data")
        plain = self.results("progressive", HERMES, "-o", "plain.glb")
        small = self.results("progressive", HERMES, "-o", "small.glb", "--texture-quality", 80)
        images = [result["file_bytes"] - result["geometry_bytes"] for result in (plain, small)]
        self.assertLess(3 * images[1], images[0])
        self.assertEqual(small["finest_vertices"], plain["finest_vertices"])
        self.assertEqual(self.validate(self.folder, known="MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"), 2)

    def test_the_bunny_is_as_near_as_was_asked(self):
        if not BUNNY.exists():
            self.skipTest("no models: run scripts/data")
        self.lodestone("progressive", BUNNY, "-o", "bunny.glb")
        self.lodestone("lod", "bunny.glb", "--triangles", 5000, "-o", "level.ply")
        result = self.results("compare", BUNNY, "level.ply")
        for way in ("forward", "backward"):
            self.assertLess(result[way]["rms"], 0.00070 * result["diagonal"])
            self.assertLess(result[way]["max"], 0.0034 * result["diagonal"])


class Page(CommandCase):
    def setUp(self):
        super().setUp()
        (self.folder / "bundle").mkdir()
        for name in ("page.js", "index.html", "page.css"):
            self.write(f"bundle/{name}", name)
        os.environ["LODESTONE_PAGE"] = str(self.folder / "bundle")
        self.addCleanup(os.environ.pop, "LODESTONE_PAGE")

    def test_models_of_every_kind(self):
        self.lodestone("export", command_case.hierarchy(), "--tiles", "town", "--morph")
        result = self.results("page", sphere(), progressive(), progressive("sphere.glb"), command_case.hierarchy(), "town",
                              "-o", "page")
        models = json.loads((self.folder / "page/models.json").read_text())
        self.assertEqual(models, result["models"])
        self.assertEqual([m["kind"] for m in models], ["progressive"] * 3 + ["tiles"] * 2)
        self.assertEqual(len({m["name"] for m in models}), 5)
        for m in models:
            self.assertTrue((self.folder / "page" / m["url"]).is_file(), m)
        self.assertEqual((self.folder / "page/page.js").read_text(), "page.js")

    def test_refusals(self):
        self.refused("page", "none.ply", "-o", "page", names=["none.ply"])
        self.refused("page", sphere(), "-o", "bundle", names=["bundle"])
        self.refused("page", sphere(), "-o", "", names=["--output"])
        self.refused("page", sphere(), "-o", "page", "--metric", "length", names=["length"])
        self.write("bad.lpm", progressive().read_bytes()[:-5])
        self.refused("page", "bad.lpm", "-o", "page", names=["bad.lpm"])
        os.environ["LODESTONE_PAGE"] = str(self.folder / "nothing")
        self.refused("page", sphere(), "-o", "page", names=["page.js", "LODESTONE_PAGE"])


class Refusals(CommandCase):
    def test_progressive(self):
        self.refused("progressive", sphere(), "-o", "out.ply", names=["out.ply", ".glb"])
        self.refused("progressive", sphere(), "-o", "out.lpm", "--metric", "length", names=["length", "quadric"])
        self.refused("progressive", sphere(), "-o", "out.lpm", "--metric", "parametric", names=["texture coordinates"])
        self.refused("progressive", sphere(), "-o", "out.lpm", "--position-bits", 30, names=["--position-bits"])
        self.refused("progressive", sphere(), "-o", "out.lpm", "--base", -1, names=["--base"])
        self.refused("progressive", sphere(), "-o", "out.lpm", "--texture-quality", 101, names=["--texture-quality"])
        self.refused("progressive", "none.ply", "-o", "out.lpm", names=["none.ply"])
        self.refused("progressive", sphere(), names=["--output"])
        self.refused("progressive", sphere(), "-o", "nowhere/out.lpm", names=["nowhere"])

    def test_lod(self):
        self.refused("lod", progressive(), "-o", "a.ply", names=["--vertices", "--triangles", "--error"])
        self.refused("lod", progressive(), "--vertices", 5, "--triangles", 5, "-o", "a.ply", names=["excludes"])
        self.refused("lod", progressive(), "--vertices", 5, "-o", "a.xyz", names=["a.xyz"])
        self.refused("lod", progressive(), "--error", 1e-7, "-o", "a.ply", names=["sphere.lpm", "within", "--position-bits"])
        self.refused("lod", sphere(), "--vertices", 5, "-o", "a.ply", names=["sphere.ply", "not a progressive mesh"])
        (self.folder / "plain.glb").write_bytes(command_case.glb([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
        self.refused("lod", "plain.glb", "--vertices", 5, "-o", "a.ply", names=["plain.glb", "_PARENTINDEX"])


if __name__ == "__main__":
    command_case.main(__doc__)
