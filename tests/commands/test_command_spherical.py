"""`lodestone spherical` as a user meets it. usage: FILE PROGRAM"""

import command_case
from command_case import HERMES, CommandCase, sphere


class Spherical(CommandCase):
    def test_results(self):
        result = self.results("spherical", sphere(), "-o", "out.glb", "--texture", 128)
        self.assertEqual(result["file_bytes"], (self.folder / "out.glb").stat().st_size)
        self.assertEqual((result["components"], result["handles"], result["holes"], result["flips"]), (1, 0, 0, 0))
        self.assertEqual(result["pixels"], 2 * 128 * 128)
        self.assertGreater(result["efficiency"], 0.9)
        self.assertGreater(result["normal_psnr"], 30)
        fewer = self.results("spherical", sphere(), "-o", "out.glb", "--texture", 128, "--no-normals")
        self.assertEqual((fewer["pixels"], fewer["normal_bytes"]), (128 * 128, 0))
        self.assertNotIn("normal_psnr", fewer)

    def test_small_files(self):
        glb = self.results("spherical", sphere(), "-o", "out.glb", "--texture", 64, "--compress")
        lpm = self.results("spherical", sphere(), "-o", "out.lpm", "--texture", 64)
        self.assertLess(lpm["geometry_bytes"], glb["geometry_bytes"] / 2)
        self.assertEqual(lpm["file_bytes"], (self.folder / "out.lpm").stat().st_size)

    def test_quality_costs_bytes(self):
        bytes_of = [self.results("spherical", sphere(), "-o", "out.glb", "--texture", 128, "--quality", q)["normal_bytes"]
                    for q in (10, 90, 100)]
        self.assertEqual(bytes_of, sorted(set(bytes_of)))

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

    def test_a_scan_with_handles_and_many_charts(self):
        if not HERMES.exists():
            self.skipTest("needs the real models (scripts/data)")
        result = self.results("spherical", HERMES, "-o", "hermes.glb", "--texture", 512)
        self.assertEqual((result["handles"], result["flips"]), (9, 0))
        self.assertGreater(result["colour_psnr"], 28)


if __name__ == "__main__":
    command_case.main(__doc__)
