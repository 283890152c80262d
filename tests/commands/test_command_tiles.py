"""`lodestone export --tiles`: a tileset that validators accept and the program reads back. usage: FILE PROGRAM"""

import collections
import itertools
import json
import math
import os
import shutil
import subprocess
import unittest

import command_case
import tileset_checker
from command_case import MODULES, SOURCE, TEXTURED, CommandCase, hierarchy, model, obj, sphere

KOMABA = SOURCE / "build/data/textured/komaba_tiles_022"


def tileset(name, lode, *options):
    """The folder of a tileset, made once."""
    folder = command_case._models / name
    if not folder.exists():
        done = command_case.call("export", lode, "--tiles", folder, *options)
        assert done.returncode == 0, done.stderr.decode()
    return folder


def far_box():
    """Far from the origin, as a place on Earth is, and with flat sides: no error anywhere."""
    corners = list(itertools.product((-3957000, -3956984), (3351000, 3351016), (3697000, 3697032)))
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    path = command_case._models / "far.obj"
    path.write_text(obj(corners, faces))
    return model("far.lode", "build", path, "--levels", 1, "--up", "z")


class Tiles(CommandCase):
    def test_counts_and_structure(self):
        result = self.results("export", hierarchy(), "--tiles", "tiles")
        found = tileset_checker.check(self.folder / "tiles")
        info = self.results("info", hierarchy())
        self.assertEqual(found.leaf_triangles, info["input_triangles"])
        self.assertEqual(found.triangles, info["stored_triangles"])
        self.assertEqual(found.leaves, info["level_table"][-1]["cells"])
        self.assertEqual((result["tiles"], result["tilesets"], result["textures"], result["triangles"]),
                         (found.contents, 1, 0, found.triangles))
        sizes = sum(p.stat().st_size for p in (self.folder / "tiles").rglob("*") if p.is_file())
        self.assertEqual(result["bytes"], sizes)

    def test_errors_are_those_measured(self):
        info = self.results("info", hierarchy())
        document = json.loads((tileset("sphere.tiles", hierarchy()) / "tileset.json").read_text())
        largest = {}

        def walk(tile, level):
            largest[level] = max(largest.get(level, 0), tile["geometricError"])
            for child in tile.get("children", []):
                walk(child, level + 1)

        walk(document["root"], 0)
        for level in info["level_table"]:
            measured = level["error_ratio"] / 2 ** level["level"] * info["scale"]
            self.assertAlmostEqual(largest[level["level"]], measured, delta=1e-5 * measured)
        self.assertGreater(document["geometricError"], info["scale"])

    def test_any_number_of_threads_gives_the_same_bytes(self):
        listings = []
        for threads in (1, 3):
            self.lodestone("export", hierarchy(), "--tiles", "tiles", "--threads", threads)
            listings.append(self.listing())
            shutil.rmtree(self.folder / "tiles")
        self.assertEqual(*listings)

    def test_reads_back_as_the_finest_level(self):
        for lode in (hierarchy(), far_box()):
            folder = tileset(lode.stem + ".tiles", lode)
            info = self.results("info", lode)
            distances = self.results("compare", folder, f"{lode}:{info['levels'] - 1}")
            for way in ("forward", "backward"):
                self.assertLess(distances[way]["max"], 1e-14 * 4e6)
            result = self.results("build", folder, "-o", "again.lode")
            self.assertEqual(result["input_triangles"], info["input_triangles"])
            self.assertEqual(result["input_vertices"], info["input_vertices"])

    def test_far_from_the_origin(self):
        folder = tileset("far.tiles", far_box())
        found = tileset_checker.check(folder)
        self.assertEqual(found.leaf_triangles, 12)
        root = json.loads((folder / "tileset.json").read_text())["root"]
        self.assertEqual(root["transform"][12:15], [-3957000, 3351000, 3697000])
        self.assertEqual({tuple(p) for p in found.leaf_points},
                         set(itertools.product((0.0, 16.0), (0.0, 16.0), (0.0, 32.0))))

    def test_morph_gives_each_vertex_its_parent(self):
        narrow = model("narrow.lode", "build", sphere(), "--levels", 3, "--sigma0", 0.2)
        self.lodestone("export", narrow, "--tiles", "tiles", "--morph")
        tileset_checker.check(self.folder / "tiles")
        document = json.loads((self.folder / "tiles/tileset.json").read_text())
        info = self.results("info", narrow)
        figures = document["extras"]["lodestone"]
        self.assertAlmostEqual(figures["sigma0"], info["sigma0"])
        self.assertEqual([r["euclidean"] for r in figures["reach"]],
                         [level["reach"]["euclidean"] for level in info["level_table"]])

        def walk(tile, above):
            glb = tileset_checker.Glb(self.folder / "tiles" / tile["content"]["uri"])
            attributes = glb.json["meshes"][0]["primitives"][0]["attributes"]
            places = glb.values(attributes["POSITION"], "f", 3)
            if above is None:
                self.assertNotIn("_PARENT", attributes)
            else:
                bound = figures["sigma0"] / 2 ** tile["extras"]["level"] / 2 * 1.0001
                parents = glb.values(attributes["_PARENT"], "f", 3)
                for place, parent in zip(places, parents, strict=True):
                    self.assertLessEqual(sum((a - b) ** 2 for a, b in zip(place, parent, strict=True)), bound**2)
                self.assertLessEqual(len(set(parents) - above), len(set(parents)) // 50)  # but for degenerate stars
            for child in tile.get("children", []):
                walk(child, set(places))

        walk(document["root"], None)

    def test_morph_gives_each_vertex_its_parents_attributes(self):
        """A hilly field whose texture coordinates and colours tell the place."""
        count = 60
        lines = ["ply", "format ascii 1.0", f"element vertex {count * count}", "property float x", "property float y",
                 "property float z", "property float s", "property float t", "property uchar red", "property uchar green",
                 "property uchar blue", f"element face {2 * (count - 1) ** 2}", "property list uchar int vertex_indices",
                 "end_header"]
        for k in range(count * count):
            x, y = k % count, k // count
            lines.append(f"{x} {y} {3 * math.sin(x / 5) * math.cos(y / 7)} {x / count} {y / count} {4 * x} {4 * y} 77")
        for k in range(count * (count - 1)):
            if k % count < count - 1:
                lines += [f"3 {k} {k + 1} {k + count + 1}", f"3 {k} {k + count + 1} {k + count}"]
        (self.folder / "field.ply").write_text("\n".join(lines) + "\n")
        self.lodestone("build", "field.ply", "-o", "field.lode", "--cell-triangles", 200)
        self.lodestone("export", "field.lode", "--tiles", "tiles", "--morph")
        tileset_checker.check(self.folder / "tiles")
        seen = collections.Counter()

        def vertices(glb, names):
            attributes = glb.json["meshes"][0]["primitives"][0]["attributes"]
            return list(zip(*(glb.values(attributes[name], code, n)
                              for name, code, n in zip(names, "ffH", (3, 2, 4), strict=True)), strict=True))

        def walk(tile, above):
            glb = tileset_checker.Glb(self.folder / "tiles" / tile["content"]["uri"])
            own = vertices(glb, ("POSITION", "TEXCOORD_0", "COLOR_0"))
            self.assertEqual(len(own), tile["extras"]["vertices"])
            triangles = sum(glb.json["accessors"][p["indices"]]["count"] for p in glb.json["meshes"][0]["primitives"]) // 3
            self.assertEqual(triangles, tile["extras"]["triangles"])
            if above is not None:
                parents = vertices(glb, ("_PARENT", "_PARENTTEXCOORD", "_PARENTCOLOR"))
                seen.update(parent in above for parent in parents)
            for child in tile.get("children", []):
                walk(child, set(own))

        walk(json.loads((self.folder / "tiles/tileset.json").read_text())["root"], None)
        self.assertGreater(seen[True], 1000)
        self.assertLessEqual(seen[False], seen[True] // 50)  # those whose parents only degenerate triangles use


class Validators(CommandCase):
    """The public validators, where npm could fetch them (scripts/setup)."""

    def test_gltf_validator_accepts_every_tile(self):
        self.validate(tileset("sphere.tiles", hierarchy()))
        self.validate(tileset("far.tiles", far_box()))
        self.lodestone("export", hierarchy(), "--tiles", "tiles", "--morph")
        self.validate(self.folder / "tiles")

    def test_gltf_validator_accepts_textured_tiles(self):
        if not KOMABA.is_dir():
            self.skipTest("the textured models are not unpacked: scripts/data")
        self.validate(tileset("komaba.tiles", model("komaba.lode", "build", KOMABA)))
        lode = model("komaba_levels.lode", "build", KOMABA, "--texture-levels")
        self.validate(tileset("komaba_levels.tiles", lode))
        (self.folder / "level").mkdir()
        self.lodestone("export", lode, "--level", 1, "-o", "level/m.glb")
        self.validate(self.folder / "level")

    def test_normal_maps_leave_tangents_to_viewers(self):
        """Which glTF allows, and the validator warns of."""
        self.validate(tileset("bust.tiles", model("bust.lode", "build", TEXTURED, "--levels", 1, "--texture-levels")),
                      known="MESH_PRIMITIVE_GENERATED_TANGENT_SPACE")

    def test_3d_tiles_validator_accepts_the_tileset(self):
        validator = MODULES / ".bin/3d-tiles-validator"
        if not validator.exists():
            self.skipTest("3d-tiles-validator is not installed: the registry that scripts/setup asked has no such "
                          "package; tileset_checker.py checks the same structure instead")
        for folder in (tileset("sphere.tiles", hierarchy()), tileset("far.tiles", far_box())):
            report = self.folder / "report.json"
            subprocess.run([validator, "--tilesetFile", folder / "tileset.json", "--reportFile", report],
                           capture_output=True, timeout=500, check=False)
            found = json.loads(report.read_text())
            self.assertEqual((found["numErrors"], found["numWarnings"]), (0, 0), found)


def images_of(folder):
    """The images in a tileset: those of its textures, without thumbnails, and of atlases, beside their tiles."""
    return {path.resolve() for path in folder.rglob("*.jpg") if not path.stem.endswith("_thumbnail")}


def linked_images(folder):
    """The images that the tiles of a folder name."""
    return {(path.parent / image["uri"]).resolve() for path in folder.rglob("*.glb")
            for image in tileset_checker.Glb(path).json["images"]}


class Textures(CommandCase):
    @unittest.skipUnless(KOMABA.is_dir(), "the textured models are not unpacked: scripts/data")
    def test_every_image_is_written_once_and_comes_back(self):
        lode = model("komaba.lode", "build", KOMABA)
        folder = tileset("komaba_morph.tiles", lode, "--morph")
        found = tileset_checker.check(folder)
        info = self.results("info", lode)
        self.assertEqual(found.leaf_triangles, info["input_triangles"])
        built = self.results("build", folder, "-o", "again.lode")
        self.assertEqual(built["input_triangles"], info["input_triangles"])
        finest = linked_images(folder / str(len(info["level_table"]) - 1))
        self.assertEqual(built["attributes"]["textures"], len(finest))
        self.assertEqual(built["attributes"]["materials"], len(finest))
        self.assertEqual(linked_images(folder), images_of(folder))
        self.assertEqual(len({path.read_bytes() for path in images_of(folder)}), len(images_of(folder)))
        # Vertices between two atlases have coordinates in both.
        vertices = self.results("export", lode, "-o", "finest.glb")["vertices"]
        again = self.results("export", "again.lode", "-o", "again.glb")["vertices"]
        self.assertTrue(vertices <= again < 1.02 * vertices, (vertices, again))


    @unittest.skipUnless(KOMABA.is_dir(), "the textured models are not unpacked: scripts/data")
    def test_tiles_of_many_materials_have_few_draws(self):
        lode = model("komaba.lode", "build", KOMABA)
        folder = tileset("komaba.tiles", lode)
        self.assertEqual(tileset_checker.check(folder).leaf_triangles, self.results("info", lode)["input_triangles"])
        draws = [len(tileset_checker.Glb(path).json["meshes"][0]["primitives"]) for path in folder.rglob("*.glb")]
        self.assertLessEqual(max(draws), 4)
        linked = linked_images(folder)
        self.assertEqual(linked, images_of(folder))
        again = self.results("build", folder, "-o", "again.lode")
        self.assertEqual(again["input_triangles"], self.results("info", lode)["input_triangles"])
        result = self.results("export", lode, "--tiles", "tiles")
        self.assertEqual((result["draws"], result["textures"]), (sum(draws), len(linked)))
        self.assertGreater(result["atlases"], 5)

    @unittest.skipUnless(KOMABA.is_dir(), "the textured models are not unpacked: scripts/data")
    def test_levels_have_textures_of_their_own(self):
        plain = model("komaba.lode", "build", KOMABA)
        lode = model("komaba_levels.lode", "build", KOMABA, "--texture-levels")
        info, before = self.results("info", lode), self.results("info", plain)
        self.assertEqual(info["materials"], 27)
        copies = [copy for texture in info["textures"] for copy in texture["copies"]]
        self.assertEqual([t["copies"] for t in before["textures"]], [[]] * 27)
        self.assertIn(f"27 textures of {sum(t['bytes'] for t in info['textures'])} bytes, {len(copies)} copies",
                      self.lodestone("info", lode))
        self.assertGreater(len(copies), 20)
        self.assertTrue(all(min(c["width"], c["height"]) >= 32 for c in copies))
        self.assertTrue(self.results("verify", lode)["valid"])
        for threads in (1, 3):
            self.lodestone("build", KOMABA, "-o", "m.lode", "--texture-levels", "--threads", threads)
            self.assertEqual((self.folder / "m.lode").read_bytes(), lode.read_bytes())
        folder = tileset("komaba_levels_morph.tiles", lode, "--morph")
        found = tileset_checker.check(folder)
        self.assertEqual(linked_images(folder), images_of(folder))
        self.assertEqual(found.leaf_triangles, info["input_triangles"])
        sizes = []
        for level in range(len(info["level_table"])):
            (self.folder / str(level)).mkdir()
            self.lodestone("export", lode, "--level", level, "-o", f"{level}/m.obj")
            sizes.append(sum(p.stat().st_size for p in (self.folder / str(level)).glob("*.jpg")))
        self.assertEqual(sizes[-1], sum(t["bytes"] for t in info["textures"]))
        self.assertTrue(all(coarse < fine for coarse, fine in itertools.pairwise(sizes)), sizes)

    def test_textures_that_cannot_be_halved_are_notes(self):
        self.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/1\n")
        self.write("m.mtl", "newmtl a\nmap_Kd a.png\n")
        self.write("a.png", b"\x89PNG\r\n\x1a\n...")
        result = self.results("build", "m.obj", "-o", "m.lode", "--texture-levels", "--levels", 1)
        self.assertEqual(result["texture_copies"], 0)
        self.assertEqual(len(result["warnings"]), 1)
        self.assertRegex(result["warnings"][0], r"\Am.obj: texture 'a.png' is not a valid PNG image: .+full resolution\Z")


class Checker(CommandCase):
    """The checker itself: it finds each fault."""

    def broken(self, change):
        document = json.loads((tileset("sphere.tiles", hierarchy()) / "tileset.json").read_text())
        folder = self.folder / "tiles"
        shutil.copytree(tileset("sphere.tiles", hierarchy()), folder, dirs_exist_ok=True)
        change(document, folder)
        (folder / "tileset.json").write_text(json.dumps(document))
        with self.assertRaises(tileset_checker.Wrong) as caught:
            tileset_checker.check(folder)
        return str(caught.exception)

    def test_finds_faults(self):
        def leaf(tile):
            return leaf(tile["children"][0]) if "children" in tile else tile

        def set_errors(tile):
            tile["geometricError"] = 1e-3
            for child in tile.get("children", []):
                set_errors(child)

        def shrink(tile):
            tile["boundingVolume"]["box"][3] *= 0.9999

        self.assertIn("outside", self.broken(lambda d, _: shrink(d["root"])))
        self.assertIn("content outside", self.broken(lambda d, _: shrink(leaf(d["root"]))))
        self.assertIn("geometricError", self.broken(lambda d, _: d["root"]["children"][0].update(geometricError=1e3)))
        self.assertIn("leaf", self.broken(lambda d, _: set_errors(d["root"])))
        self.assertIn("refine", self.broken(lambda d, _: d["root"].pop("refine")))
        self.assertIn("children", self.broken(lambda d, _: leaf(d["root"]).update(children=[])))
        self.assertIn("missing", self.broken(lambda d, _: leaf(d["root"])["content"].update(uri="3/none.glb")))
        self.assertIn("nothing refers", self.broken(lambda _, folder: (folder / "rest.txt").write_text("")))


class Refusals(CommandCase):
    def test_folders(self):
        shutil.copy(hierarchy(), self.folder / "m.lode")
        (self.folder / "full").mkdir()
        (self.folder / "full/file").write_text("")
        export = ("export", "m.lode", "--tiles")
        self.refused(*export, "full", names=["full", "is not empty"])
        self.refused(*export, "m.lode", names=["m.lode", "is a file"])
        self.refused(*export, "nowhere/tiles", names=["nowhere/tiles", "No such file"])
        self.refused(*export, "m.lode/tiles", names=["m.lode/tiles"])
        self.refused(*export, "", names=["--tiles"])
        self.refused(*export, "tiles", "-o", "m.ply", names=["--tiles", "--output"])
        self.refused(*export, "tiles", "--level", 1, names=["--tiles", "--level"])
        self.refused("export", "m.lode", "--morph", "-o", "m.ply", names=["--morph", "--tiles"])
        self.refused("export", "m.lode", names=["--output or --tiles is required"])
        self.refused("export", "none.lode", "--tiles", "tiles", names=["none.lode"])

    def test_empty_folders_are_filled(self):
        (self.folder / "empty").mkdir()
        self.lodestone("export", hierarchy(), "--tiles", "empty")
        self.lodestone("export", hierarchy(), "--tiles", "new/")
        os.symlink("empty2", self.folder / "link")
        (self.folder / "empty2").mkdir()
        self.lodestone("export", hierarchy(), "--tiles", "link")
        expected = sorted(os.listdir(self.folder / "empty"))
        self.assertIn("tileset.json", expected)
        for name in ("new", "empty2"):
            self.assertEqual(sorted(os.listdir(self.folder / name)), expected)

    def test_an_interrupted_export_leaves_nothing(self):
        big = model("big.lode", "build", model("big.ply", "generate", "terrain", "--triangles", 3_000_000),
                    "--simplifier", "cluster", "--cell-triangles", 60)
        for made in (False, True):
            if made:
                (self.folder / "tiles").mkdir()
            self.interrupt("export", big, "--tiles", "tiles", sign="*.glb")


if __name__ == "__main__":
    command_case.main(__doc__)
