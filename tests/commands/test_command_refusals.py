"""The command refuses what it cannot do in one line, and leaves nothing behind. usage: test_command_refusals.py PROGRAM"""

import os
import random
import shutil
import signal
import subprocess
import time
import unittest

import command_case
from command_case import CommandCase, binary_stl, hierarchy, model, ply, sphere

CORNER = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
ONE = [(0, 1, 2)]


class Usage(CommandCase):
    def setUp(self):
        super().setUp()
        shutil.copy(sphere(), self.folder / "m.ply")
        shutil.copy(hierarchy(), self.folder / "m.lode")

    def test_unknown_words(self):
        self.refused(names=["subcommand", "lodestone --help"])
        self.refused("biuld", names=["subcommand 'biuld'"])
        self.refused("--verbose", names=["option '--verbose'"])
        for name in ("generate", "build", "info", "verify", "compare", "render", "export"):
            self.refused(name, names=["required", f"lodestone {name} --help"])
            self.refused(name, "--bogus", names=["option '--bogus'", f"lodestone {name} --help"])
        self.refused("info", "m.lode", "rest", names=["argument 'rest'"])
        self.refused("build", "m.ply", "-o", names=["--output"])

    def test_values_of_every_subcommand(self):
        for value in ("-1", "100000", "many", "1.5", ""):
            self.refused("info", "m.lode", "--threads", value, names=["--threads"])

    def test_values_of_generate(self):
        self.refused("generate", "cube", "-o", "x.ply", names=["cube", "sphere, terrain, torus, box, pile"])
        for count in ("0", "1", "-5", "10000000000", "9" * 30, "abc"):
            self.refused("generate", "sphere", "--triangles", count, "-o", "x.ply", names=["triangles"])
        for seed in ("-1", "x"):
            self.refused("generate", "sphere", "--seed", seed, "-o", "x.ply", names=["--seed"])
        self.refused("generate", "sphere", "-o", "x.obj", names=["x.obj", ".ply"])

    def test_values_of_build(self):
        for sigma0 in ("0", "-1", "nan", "inf", "1e9", "x"):
            self.refused("build", "m.ply", "-o", "x.lode", "--sigma0", sigma0, names=["sigma0"])
        for cells in ("0", "-3", "x"):
            self.refused("build", "m.ply", "-o", "x.lode", "--cell-triangles", cells, names=["--cell-triangles"])
        for levels in ("-1", "99", "x"):
            self.refused("build", "m.ply", "-o", "x.lode", "--levels", levels, names=["--levels"])
        for bits in ("0", "-1", "25", "x"):
            self.refused("build", "m.ply", "-o", "x.lode", "--compress", "--lattice", bits, names=["--lattice"])
        self.refused("build", "m.ply", "-o", "x.lode", "--simplifier", "best",
                     names=["best", "quadric, cluster, openmesh, meshopt"])
        self.refused("build", "m.ply", "-o", "x.lode", "--placement", "best", names=["best", "optimal, endpoint"])
        self.refused("build", "m.ply", "-o", "x.lode", "--simplifier", "cluster", "--placement", "optimal",
                     names=["cluster", "quadric"])
        self.refused("build", "m.ply", "-o", "x.lode", "--strategy", "best", names=["best", "serial, levels, graph"])
        self.refused("build", "m.ply", "-o", "x.ply", names=["x.ply", ".lode"])

    def test_values_of_export_and_compare(self):
        self.refused("export", "m.lode", "--level", 4, "-o", "x.ply", names=["m.lode", "level 4"])
        self.refused("export", "m.lode", "--level", -1, "-o", "x.ply", names=["--level"])
        for name in ("x.png", "x"):
            self.refused("export", "m.lode", "-o", name, names=[name, ".ply, .obj, .stl or .glb"])
        for level in ("4", "", "x", "-1", "999999999999"):
            self.refused("compare", "m.ply", f"m.lode:{level}", names=["m.lode", f"level '{level}'"])

    def test_values_of_render(self):
        render = ("render", "m.lode", "--backend", "null")
        for frames in ("0", "-1", "x"):
            self.refused(*render, "--frames", frames, names=["--frames"])
        for size in ("0x0", "10", "10x", "x10", "-1x10", "10x10x10", "99999x1", "axb", ""):
            self.refused(*render, "--size", size, names=["--size"])
        self.refused("render", "m.lode", "--backend", "ray", names=["ray", "soft, gl, null"])
        self.refused(*render, "--kappa0", 3, "--pixel-error", 1, names=["--kappa0", "--pixel-error"])
        self.refused(*render, "--radii", "uniform", names=["kappa0"])
        self.refused(*render, "--radii", "uniform", "--pixel-error", 2, names=["kappa0"])
        self.refused(*render, "--radii", "some", names=["--radii some"])
        self.refused(*render, "--blend", "none", names=["none", "smoothstep", "step"])
        self.refused(*render, "--metric", "taxi", names=["--metric taxi"])
        self.refused(*render, "--camera", "adversarial", names=["cannot crack", "--camera"])
        self.refused(*render, "--camera", "adversarial", "--radii", "per-level", names=["--camera", "--kappa0"])
        adaptive = (*render, "--radii", "adaptive")
        self.refused(*adaptive, "--kappa0", 2, names=["--radii adaptive", "--pixel-error"])
        for option, values in {"--pixel-error": ("0", "-1", "nan", "x"), "--kappa0": ("0", "-1", "nan", "x"),
                               "--beta": ("0", "nan", "x"), "--delta": ("-1", "nan", "x")}.items():
            for value in values:
                self.refused(*render, option, value, names=[option[2:].replace("-", " ") if value != "x" else option])

    def test_inadmissible_radius(self):
        uniform = ("render", "m.lode", "--backend", "null", "--frames", 2, "--radii", "uniform", "--kappa0", "0.5")
        self.refused(*uniform, names=["m.lode", "0.5", "--allow-inadmissible"])
        self.lodestone(*uniform, "--allow-inadmissible")


class Outputs(CommandCase):
    def setUp(self):
        super().setUp()
        shutil.copy(sphere(), self.folder / "m.ply")
        shutil.copy(hierarchy(), self.folder / "m.lode")
        (self.folder / "folder.ply").mkdir()
        (self.folder / "folder.lode").mkdir()

    def writers(self):
        """Calls that write, each up to the name of its output."""
        yield ("generate", "box", "--triangles", 1000, "-o"), "ply"
        yield ("build", "m.ply", "-o"), "lode"
        yield ("export", "m.lode", "-o"), "ply"

    def test_unwritable(self):
        for call, suffix in self.writers():
            self.refused(*call, f"nowhere/x.{suffix}", names=[f"nowhere/x.{suffix}", "No such file or directory"])
            self.refused(*call, f"m.ply/x.{suffix}", names=[f"m.ply/x.{suffix}", "Not a directory"])
            self.refused(*call, f"folder.{suffix}", names=[f"folder.{suffix}", "Is a directory"])
            self.refused(*call, "", names=["--output"])

    def test_unwritable_results_come_before_the_work(self):
        for call, suffix in self.writers():
            self.refused(*call, f"x.{suffix}", "--json", "nowhere/x.json", names=["nowhere/x.json"])
        for call in (("info", "m.lode"), ("verify", "m.lode"), ("compare", "m.ply", "m.ply"),
                     ("render", "m.lode", "--frames", 1, "-o", "frames")):
            self.refused(*call, "--json", "nowhere/x.json", names=["nowhere/x.json"])
            self.refused(*call, "--json", "folder.ply", names=["folder.ply"])

    def test_no_file_destroys_another(self):
        shutil.copy(self.folder / "m.ply", self.folder / "mesh.lode")
        os.symlink("m.lode", self.folder / "link.ply")
        self.refused("build", "mesh.lode", "-o", "mesh.lode", names=["mesh.lode", "IN", "--output"])
        self.refused("build", "mesh.lode", "-o", "./folder.lode/../mesh.lode", names=["mesh.lode"])
        self.refused("build", "m.ply", "-o", "x.lode", "--json", "m.ply", names=["m.ply", "--json"])
        self.refused("build", "m.ply", "-o", "x.lode", "--json", "x.lode", names=["x.lode", "--output", "--json"])
        self.refused("export", "m.lode", "-o", "link.ply", names=["m.lode"])
        self.refused("verify", "m.lode", "--input", "m.ply", "--json", "m.ply", names=["m.ply"])
        self.refused("compare", "m.ply", "m.lode:2", "--json", "m.lode", names=["m.lode"])
        self.refused("render", "m.lode", "--json", "m.lode", names=["m.lode"])

    def test_frames_need_a_folder(self):
        render = ("render", "m.lode", "--frames", 2, "--size", "32x32", "-o")
        self.refused(*render, "m.ply", names=["m.ply", "folder"])
        self.refused(*render, "m.ply/frames", names=["m.ply/frames", "folder"])

    def test_failed_flight_takes_its_frames_back(self):
        (self.folder / "frames" / "frame0002.png").mkdir(parents=True)
        self.refused("render", "m.lode", "--frames", 4, "--size", "32x32", "-o", "frames", names=["frame0002.png"])

    @unittest.skipUnless(os.path.exists("/dev/full"), "there is no /dev/full here")
    def test_full_disk_of_standard_output(self):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([command_case.PROGRAM, "info", hierarchy()], stdout=full, stderr=subprocess.PIPE,
                                  check=False)
        self.assertEqual(done.returncode, command_case.FILE)
        self.assertRegex(done.stderr.decode(), r"\Alodestone: [^\n]*No space left on device[^\n]*\n\Z")


class Meshes(CommandCase):
    def check(self, name, content, *places):
        self.write(name, content)
        self.refused("build", name, "-o", "x.lode", names=[name, *places])
        self.write("ok.ply", ply(CORNER, ONE))
        self.refused("compare", "ok.ply", name, names=[name, *places])
        (self.folder / "ok.ply").unlink()
        (self.folder / name).unlink()

    def test_missing(self):
        self.refused("build", "none.ply", "-o", "x.lode", names=["none.ply", "No such file"])
        self.refused("build", "", "-o", "x.lode", names=["IN"])
        self.refused("build", ".", "-o", "x.lode", names=["neither a tileset.json nor .hgt"])
        self.refused("build", "line\nend.ply", "-o", "x.lode", names=["end.ply"])
        for call in (("info",), ("verify",), ("render",), ("export", "-o", "x.ply"), ("compare", "none.ply")):
            self.refused(*call, "none.lode", names=["none."])
        shutil.copy(hierarchy(), self.folder / "m.lode")
        self.refused("verify", "m.lode", "--input", "none.ply", names=["none.ply"])

    def test_empty(self):
        for suffix in ("ply", "stl", "obj", "off", "drc", "data"):
            self.check(f"m.{suffix}", b"", "empty")
        self.check("m.ply", ply(CORNER, []), "no triangle")
        self.check("m.stl", binary_stl([]), "no triangle")

    def test_damaged(self):
        """One file of each format and kind of place; the tests of the readers (core/formats) have every fault."""
        whole, good = sphere().read_bytes(), ply(CORNER, ONE)
        self.check("m.ply", whole[:-1])
        self.check("m.ply", whole[:-4] + b"\xff\xff\xff\x7f", "out of range")
        self.check("m.ply", good.replace("ascii", "text"), "line 2")
        self.check("m.ply", good.replace("ascii", "binary_little_endian").replace("vertex 3", f"vertex {10**15}"), "header")
        self.check("m.stl", binary_stl([CORNER] * 4)[:-1])
        self.check("m.stl", binary_stl([CORNER], declared=0xFFFFFFFF), "4294967295 facets")
        self.check("m.obj", "".join(f"v {x} {y} {z}\n" for x, y, z in CORNER) + "f 1 2 4\n", "line 4")
        self.check("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6")

    def test_ply_without_a_finite_triangle(self):
        self.write("m.ply", ply([(0, 0, 0), (1, 0, 0), (0, "nan", 0)], ONE))
        self.refused("build", "m.ply", "-o", "x.lode", names=["m.ply", "not finite"])
        self.refused("compare", "m.ply", "m.ply", names=["m.ply", "not finite"])
        shutil.copy(hierarchy(), self.folder / "m.lode")
        self.refused("verify", "m.lode", "--input", "m.ply", names=["m.ply", "not finite"])

    def test_grids(self):
        self.write("m.raw", bytes(24))
        for grid in ("", "4", "4x", "1x12", "4x3:i17", "4x3:i16:0", "4x3:i16:-1", "4x3:i16:x", "4x3x2", "4x9999999999"):
            if grid:
                self.refused("build", "m.raw", "--grid", grid, "-o", "m.lode", names=["--grid", f"'{grid}'"])
        self.refused("build", "m.raw", "--grid", "5x3", "-o", "m.lode", names=["m.raw", "24 bytes", "5 x 3"])
        self.refused("build", sphere(), "--grid", "4x3", "-o", "m.lode", names=["--grid", "by its extension"])
        self.refused("compare", sphere(), sphere(), "--grid", "4x3", names=["--grid", "by its extension"])
        self.refused("verify", hierarchy(), "--input", sphere(), "--grid", "4x3", names=["--grid", "by its extension"])

    def test_tiles(self):
        (self.folder / "city").mkdir()
        self.refused("build", "city", "-o", "m.lode", names=["city", "neither a tileset.json nor .hgt"])
        self.write("city/tileset.json", '{"asset": {"version": "1.1"}, "root": {"content": {"uri": "no.glb"}}}')
        self.refused("build", "city", "-o", "m.lode", names=["tileset.json", "root.content.uri", "'no.glb'", "cannot be found"])
        self.write("city/no.glb", b"glTF")
        self.refused("build", "city/tileset.json", "-o", "m.lode", names=["no.glb", "byte 4"])

    def test_foreign(self):
        for suffix in ("ply", "off", "drc", "data"):
            self.check(f"m.{suffix}", random.Random(1).randbytes(5000))
        shutil.copy(sphere(), self.folder / "m.drc")
        self.refused("build", "m.drc", "-o", "x.lode", names=["m.drc"])


class Hierarchies(CommandCase):
    """Foreign and altered .lode files."""

    def refused_by_all(self, content, *places):
        self.write("m.lode", content)
        self.write("m.ply", ply(CORNER, ONE))
        for call in (("info",), ("verify",), ("render", "-o", "frames"), ("export", "-o", "x.ply"),
                     ("compare", "m.ply")):
            self.refused(*call, "m.lode", names=["m.lode", *places])

    def test_foreign(self):
        self.refused_by_all(sphere().read_bytes(), "not a .lode file")
        self.refused_by_all(random.Random(1).randbytes(5000), "not a .lode file")
        self.refused_by_all(b"")

    def test_instead_of_a_mesh(self):
        for name in ("m.lode", "m.data"):
            shutil.copy(hierarchy(), self.folder / name)
            self.refused("verify", "m.lode", "--input", name, names=[f"--input {name}", "not a mesh"])
            self.refused("build", name, "-o", "x.lode", names=[name, "is a hierarchy (.lode), not a mesh"])

    def test_altered_or_cut_anywhere(self):
        """At one byte for all subcommands; test_lode_file.cpp alters and cuts at every place."""
        for form in ((), ("--compress",)):
            whole = model(f"altered{len(form)}.lode", "build", sphere(), "--levels", 3, *form).read_bytes()
            altered = bytearray(whole)
            altered[len(whole) * 3 // 4] ^= 4
            self.refused_by_all(bytes(altered))
            self.refused_by_all(whole[: len(whole) // 2])
            self.refused_by_all(whole + b"\0")


class Cameras(CommandCase):
    def check(self, content, *places):
        shutil.copy(hierarchy(), self.folder / "m.lode")
        self.write("path.json", content)
        self.refused("render", "m.lode", "--camera", "path.json", "-o", "frames", names=["path.json", *places])

    def test_bad_paths(self):
        for content in ("{", '{"frames": []}', '{"frames": [{"position": [2, 0], "target": [0, 0, 0]}]}'):
            self.check(content)
        (self.folder / "path.json").unlink()
        self.refused("render", "m.lode", "--camera", "path.json", names=["path.json"])


class Interrupts(CommandCase):
    def big(self):
        return model("big.ply", "generate", "terrain", "--triangles", 3_000_000)

    def test_build(self):
        build = ("build", self.big(), "-o", "m.lode", "--threads", 1, "--json", "m.json")
        started = time.monotonic()
        self.lodestone(*build)
        seconds = time.monotonic() - started
        for output in ("m.lode", "m.json"):
            (self.folder / output).unlink()
        for share in (0.05, 0.3, 0.5):
            self.interrupt(*build, after=share * seconds)
        self.interrupt(*build, after=0.4 * seconds, signal_number=signal.SIGTERM)

    def test_generate(self):
        self.interrupt("generate", "sphere", "--triangles", 50_000_000, "-o", "m.ply")

    def test_any_moment_of_writing(self):
        """The file is complete or not there, and no other is, whenever the signal comes; at its end it may come late."""
        generate = ("generate", "terrain", "--triangles", 1_000_000, "-o", "m.ply")
        started = time.monotonic()
        self.lodestone(*generate)
        whole, seconds = (self.folder / "m.ply").read_bytes(), time.monotonic() - started
        moments, interrupted = random.Random(1), 0
        for trial in range(40):
            (self.folder / "m.ply").unlink(missing_ok=True)
            number = (signal.SIGINT, signal.SIGTERM)[trial % 2]
            process = subprocess.Popen([command_case.PROGRAM, *map(str, generate), "--quiet"], cwd=self.folder,
                                       stderr=subprocess.PIPE)
            time.sleep(moments.uniform(0.1, 1.1) * seconds)
            process.send_signal(number)
            errors = process.communicate(timeout=60)[1]
            interrupted += process.returncode != 0
            # Minus the number: before the program had begun to listen.
            self.assertIn(process.returncode, (0, 128 + number, -number), errors)
            self.assertIn(list(self.listing().values()), ([whole], []) if process.returncode else ([whole],), trial)
        self.assertGreater(interrupted, 10)

    def test_export(self):
        big = model("big.lode", "build", self.big(), "--simplifier", "cluster")
        self.interrupt("export", big, "-o", "m.obj")

    def test_render_takes_its_frames_back(self):
        self.interrupt("render", hierarchy(), "--frames", 100000, "--size", "64x64", "-o", "frames")

    def test_work_that_writes_nothing(self):
        self.interrupt("compare", self.big(), sphere(), "--threads", 1, after=0.5)


if __name__ == "__main__":
    command_case.main(__doc__)
