"""`lodestone spherical` as a user meets it. usage: FILE PROGRAM"""

import command_case
from command_case import HERMES, CommandCase, sphere


def cube():
    """Its corners, in different colours, and its triangles."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]


class Spherical(CommandCase):
    def coloured_cube(self):
        corners, faces = cube()
        text = command_case.ply([(*c, *(255 * x for x in c)) for c in corners], faces)
        colours = "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
        return self.write("cube.ply", text.replace("element face", colours + "element face"))

    def test_one_colour_needs_no_image(self):
        for maps, images in (("colour,normal", 1), ("colour", 0)):
            result = self.results("spherical", sphere(), "-o", "out.lpm", "--texture", 64, "--maps", maps)
            self.assertEqual((result["pixels"], result["colour_bytes"]), (images * 64 * 64, 0))
            self.assertNotIn("colour_psnr", result)

    def test_results(self):
        result = self.results("spherical", sphere(), "-o", "out.glb", "--texture", 128)
        self.assertEqual(result["file_bytes"], (self.folder / "out.glb").stat().st_size)
        self.assertEqual((result["components"], result["handles"], result["holes"], result["flips"]), (1, 0, 0, 0))
        self.assertEqual(result["pixels"], 128 * 128)
        self.assertGreater(result["efficiency"], 0.9)
        self.assertGreater(result["normal_psnr"], 30)

    def test_maps(self):
        for maps, other in (("colour", "normal"), ("normal", "colour")):
            result = self.results("spherical", self.coloured_cube(), "-o", f"{maps}.glb", "--texture", 64, "--maps", maps)
            self.assertEqual((result["pixels"], result[f"{other}_bytes"]), (64 * 64, 0))
            self.assertGreater(result[f"{maps}_psnr"], 20)
            self.assertNotIn(f"{other}_psnr", result)
        result = self.results("spherical", sphere(), "-o", "all.glb", "--texture", 128,
                              "--maps", "colour,normal,geometry")
        self.assertEqual(result["geometry_image_samples"], 33 * 33)
        self.assertTrue(0 < result["geometry_image_rms"] < result["geometry_image_max"] < 2)
        self.validate(self.folder)

    def test_small_files(self):
        glb = self.results("spherical", sphere(), "-o", "out.glb", "--texture", 64, "--compress")
        lpm = self.results("spherical", sphere(), "-o", "out.lpm", "--texture", 64)
        self.assertLess(lpm["geometry_bytes"], glb["geometry_bytes"] / 2)
        self.assertEqual(lpm["file_bytes"], (self.folder / "out.lpm").stat().st_size)

    def test_quality_costs_bytes(self):
        bytes_of = [self.results("spherical", sphere(), "-o", "out.glb", "--texture", 128, "--quality", q)["normal_bytes"]
                    for q in (10, 90, 100)]
        self.assertEqual(bytes_of, sorted(set(bytes_of)))

    def test_fewer_triangles_carry_the_same_images(self):
        every = self.results("spherical", sphere(), "-o", "all.lpm", "--texture", 64)
        fewer = self.results("spherical", sphere(), "-o", "fewer.lpm", "--texture", 64, "--triangles", 300)
        self.assertLess(every["finest_error"], 2e-3)  # 12 bits
        self.assertGreater(fewer["finest_error"], 10 * every["finest_error"])
        self.assertEqual(self.results("spherical", sphere(), "-o", "all.glb", "--texture", 64)["finest_error"], 0)
        self.assertLessEqual(fewer["finest_triangles"], 300)
        self.assertGreater(fewer["finest_triangles"], 290)
        self.assertEqual(fewer["normal_bytes"], every["normal_bytes"])
        self.assertLess(fewer["geometry_bytes"], every["geometry_bytes"])

    def test_levels_and_page(self):
        self.lodestone("spherical", sphere(), "-o", "out.glb", "--texture", 64)
        for triangles in (100, 1000):
            level = self.results("lod", "out.glb", "--triangles", triangles, "-o", "level.ply")
            self.assertLessEqual(level["triangles"], triangles)

    def test_every_format_of_images_is_valid(self):
        for images in ("webp", "jpeg", "png"):
            self.lodestone("spherical", sphere(), "-o", f"{images}.glb", "--texture", 64, "--images", images)
        self.validate(self.folder)

    def test_same_bytes_for_any_number_of_threads(self):
        files = []
        for threads in (1, 2, 4):
            self.lodestone("spherical", sphere(), "-o", "out.glb", "--texture", 128, "--threads", threads)
            files.append((self.folder / "out.glb").read_bytes())
        self.assertEqual(files[0], files[1])
        self.assertEqual(files[0], files[2])

    def test_refusals(self):
        self.refused("spherical", sphere(), "-o", "out.ply", names=["out.ply", ".glb"])
        self.refused("spherical", sphere(), "-o", "out.glb", "--texture", 100, names=["100 pixels", "power of two"])
        self.refused("spherical", sphere(), "-o", "out.glb", "--effort", "wild", names=["--effort", "best"])
        for maps in ("colour,taste", "colour,", ""):
            self.refused("spherical", sphere(), "-o", "out.glb", "--maps", maps, names=["unknown map", "colour,normal,geometry"])

    def test_a_scan_with_handles_and_many_charts(self):
        if not HERMES.exists():
            self.skipTest("needs the real models (scripts/data)")
        result = self.results("spherical", HERMES, "-o", "hermes.glb", "--texture", 512)
        self.assertEqual((result["handles"], result["flips"]), (9, 0))
        self.assertGreater(result["colour_psnr"], 28)


if __name__ == "__main__":
    command_case.main(__doc__)
