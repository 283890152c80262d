"""The up axis, from a file to what is drawn and written. usage: FILE PROGRAM"""

import json
import struct
import unittest

import command_case
from command_case import CommandCase, obj
from png import read_png

# A tent: its ridge is up.
CORNERS = [(0, 0, 0), (4, 0, 0), (4, 0, 2), (0, 0, 2), (1, 3, 1), (3, 3, 1)]
FACES = [(0, 1, 2, 3), (0, 4, 5, 1), (3, 2, 5, 4), (0, 3, 4), (1, 5, 2)]


def glb_json(path):
    data = path.read_bytes()
    return json.loads(data[20:20 + struct.unpack("<I", data[12:16])[0]])


def lpm_header(path):
    data = path.read_bytes()
    return json.loads(data[16:16 + struct.unpack("<I", data[8:12])[0]])


class Up(CommandCase):
    def setUp(self):
        super().setUp()
        (self.folder / "tent.obj").write_text(obj(CORNERS, FACES))

    def up_of(self, name):
        info = self.results("info", name)
        return info["up"], info["up_guessed"]

    def test_is_guessed_with_a_note_or_given(self):
        note = "note: up is y, guessed by the format; --up AXIS gives another\n"
        self.assertIn(note, self.lodestone("build", "tent.obj", "-o", "guessed.lode"))
        self.assertEqual(self.up_of("guessed.lode"), ("y", True))
        self.assertNotIn("note: up", self.lodestone("build", "tent.obj", "-o", "given.lode", "--up", "-x"))
        self.assertEqual(self.up_of("given.lode"), ("-x", False))
        self.refused("build", "tent.obj", "-o", "wrong.lode", "--up", "up", names=["--up up: unknown", "x, y, z"])

    def test_is_that_of_glb_and_of_tiles(self):
        self.lodestone("build", "tent.obj", "-o", "tent.lode", "--up", "z")
        self.lodestone("export", "tent.lode", "-o", "z.glb")
        self.lodestone("export", "tent.lode", "-o", "y.glb", "--up", "y")
        self.assertNotIn("rotation", glb_json(self.folder / "y.glb")["nodes"][0])
        half = 0.5 ** 0.5
        for got, expected in zip(glb_json(self.folder / "z.glb")["nodes"][0]["rotation"], (-half, 0, 0, half)):
            self.assertAlmostEqual(got, expected)
        self.assertEqual(self.up_of("z.glb"), ("y", False))
        origins = {name: self.results("info", name)["origin"] for name in ("tent.lode", "z.glb", "y.glb")}
        self.assertEqual(origins["y.glb"], origins["tent.lode"])
        self.assertEqual(origins["z.glb"], [0, 0, -3])  # (x, z, -y)
        for up, turned in (("z", [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]), ("y", [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0])):
            self.lodestone("export", "tent.lode", "--tiles", up, "--up", up, "--morph")
            tileset = json.loads((self.folder / up / "tileset.json").read_text())
            self.assertEqual(tileset["root"]["transform"][:12], turned)
            self.assertEqual(tileset["extras"]["lodestone"]["up"], up)
            self.assertEqual(self.up_of(up), ("z", False))

    def test_is_that_of_position_maps(self):
        note = "note: up is y, guessed by the format; --up AXIS gives another\n"
        self.assertIn(note, self.lodestone("reconstruct", "tent.obj", "-o", "a.ply", "--resolution", 16))
        self.assertNotIn("note: up", self.lodestone("reconstruct", "tent.obj", "-o", "x.glb", "--resolution", 16,
                                                    "--up", "x", "--maps", "maps"))
        def turn(name):
            return glb_json(self.folder / name)["nodes"][0].get("rotation")
        self.assertIsNotNone(turn("x.glb"))
        self.assertNotIn("note: up", self.lodestone("reconstruct", "maps", "-o", "again.glb"))
        self.assertEqual(turn("again.glb"), turn("x.glb"))
        self.lodestone("reconstruct", "maps", "-o", "y.glb", "--up", "y")
        self.assertIsNone(turn("y.glb"))

    def test_is_kept_in_progressive_files(self):
        for up in ("y", "-z"):
            self.lodestone("progressive", "tent.obj", "-o", "tent.lpm", "--up", up)
            self.lodestone("progressive", "tent.obj", "-o", "tent.glb", "--up", up)
            self.assertEqual(lpm_header(self.folder / "tent.lpm")["up"], up)
            self.assertEqual(glb_json(self.folder / "tent.glb")["nodes"][0]["extras"],
                             {"up": up, "origin": [0, 0, 0]})
            for name in ("tent.lpm", "tent.glb"):
                self.lodestone("lod", name, "--vertices", 100, "-o", "level.obj")
                places = {line for line in (self.folder / "level.obj").read_text().splitlines() if line[:2] == "v "}
                self.assertLessEqual({f"v {x} {y} {z}" for x, y, z in CORNERS}, places, name)

    def test_turns_the_picture(self):
        """The tent on its side, told so, looks as the one that stands."""
        lying = [(x, -z, y) for x, y, z in CORNERS]
        (self.folder / "lying.obj").write_text(obj(lying, FACES))
        def picture(name, up):
            self.lodestone("render", name, "--up", up, "--camera", "orbit", "--frames", 2, "--size", "64x48", "-o", "out")
            return read_png(self.folder / "out/frame0001.png")[2]

        def differing(a, b):
            return sum(abs(x - y) > 8 for x, y in zip(a, b))

        standing, lying = picture("tent.obj", "y"), picture("lying.obj", "z")
        self.assertLess(differing(standing, lying), 20)  # of 9216: rounding along edges
        self.assertGreater(differing(standing, picture("lying.obj", "y")), 500)


if __name__ == "__main__":
    command_case.main(__doc__)
