"""The viewer in a real window on a virtual display: files that open, and what goes wrong.

usage: test_command_view_files.py PROGRAM
"""

import json
import time

import command_case
from command_case import hierarchy, model, sphere, until
from png import read_png
from view_case import CAMERA, HEIGHT, WIDTH, ViewCase, Viewer


class Files(ViewCase):
    def test_a_mesh_is_built(self):
        built = model("default.lode", "build", sphere())
        viewer = self.view("--backend", "soft", file=sphere())
        shown = viewer.picture()
        viewer.closed()
        self.assertIn("lodestone: up is z, guessed by the format; --up AXIS gives another\n", viewer.said)
        viewer = self.view("--backend", "soft", "--up", "z", file=built)
        self.assertEqual(viewer.picture(), shown)
        viewer.closed()
        self.assertNotIn("up is", viewer.said)
        self.assertEqual(sorted(self.listing()), ["view.json"])

    def large(self):
        return model("large.ply", "generate", "terrain", "--triangles", 3_000_000)

    def building(self):
        viewer = Viewer(self, self.large(), "--threads", 1)
        until(lambda: viewer.running() and "building" in viewer.title(), "building", 120)
        return viewer

    def test_the_window_answers_while_it_builds(self):
        viewer = self.building()
        before = viewer.picture()
        self.display.key("h")
        until(lambda: viewer.picture() != before and "building" in viewer.title(), "the panel goes", 5)
        share = viewer.title()
        until(lambda: viewer.title() != share, "progress")
        viewer.wait_for(self.large().name)
        self.assertGreater(self.covered(viewer.picture()), 20000)
        viewer.closed()

    def test_closing_while_building_leaves_nothing(self):
        viewer = self.building()
        begin = time.monotonic()
        viewer.closed()
        self.assertLess(time.monotonic() - begin, 10)
        self.assertEqual(sorted(self.listing()), ["view.json"])

    def test_an_interrupt_leaves_nothing(self):
        viewer = self.building()
        status, line = viewer.interrupted()
        self.assertEqual((status, line), (130, "lodestone: interrupted; no unfinished file was left\n"))
        self.assertEqual(self.listing(), {})

    def test_cancelling_keeps_the_window(self):
        viewer = self.building()
        viewer.press("Escape")
        self.assertNotIn("building", viewer.settled(1) and viewer.title())
        viewer.closed()
        self.assertIn("not opened", viewer.said)

    def test_dropped_files_open(self):
        viewer = self.view()
        first = viewer.picture()
        box = model("box.ply", "generate", "box", "--triangles", 2000)
        self.display.drop(viewer.window, [box])
        second = viewer.wait_for("box.ply")
        self.assertNotEqual(second, first)
        self.display.drop(viewer.window, [self.write("broken.ply", "ply\nformat ascii 1.0\nend_header\n")])
        until(lambda: viewer.picture() != second, "the error")
        viewer.settled()
        self.display.drop(viewer.window, [self.camera_file()])
        time.sleep(0.5)
        viewer.press("Escape")
        found = viewer.closed()
        self.assertIn("broken.ply", viewer.said)
        self.assertEqual(found["uploads"], 2)
        for a, b in zip(found["camera"]["position"], CAMERA["position"]):
            self.assertAlmostEqual(a, b, delta=1e-9)

    def test_scenes(self):
        """The first picture is the first of `render`; what is wrong with a scene is a line."""
        scene = self.write("two.toml", f'''
            [[model]]
            file = "{hierarchy()}"
            colour = [0.9, 0.4, 0.3]
            [[model]]
            generate = "torus"
            triangles = 2000
            position = [1, -2, 0]
            [lighting]
            directional = {{ towards = [1, 0, 1], strength = 0.7 }}
            [camera]
            key = [{{ position = [5, -4, 3], target = [0, 0, 0] }}, {{ position = [4, 5, 3], target = [0, 0, 0] }}]
            ''')
        viewer = self.view("--backend", "soft", file=scene)
        self.lodestone("render", scene, "--frames", 1, "--size", f"{WIDTH}x{HEIGHT}", "-o", "frames", "--quiet")
        self.assertEqual(viewer.picture(), read_png(self.folder / "frames" / "frame0000.png")[2])
        at_rest = viewer.picture()
        self.display.key("p")
        until(lambda: viewer.picture() != at_rest, "the scene's way")
        self.display.drop(viewer.window, [self.write("wrong.toml", "[[model]]\nfile = 'a.lode'\nsize = 3\n")])
        viewer.press("Escape")
        viewer.closed()
        self.assertIn("wrong.toml: line 3: unknown key 'size'", viewer.said)

    def test_files_dropped_together_are_shown_together(self):
        viewer = self.view()
        box = model("box.ply", "generate", "box", "--triangles", 2000)
        self.display.drop(viewer.window, [box, hierarchy()])
        viewer.wait_for("box.ply and 1 more")
        found = viewer.closed()
        self.assertEqual(found["uploads"], 2)

    def test_an_empty_window_waits(self):
        viewer = Viewer(self, "--backend", "soft")
        viewer.settled()
        self.display.drag((600, 200), (640, 250))
        for key in "tmbxvrpc":
            self.display.key(key)
        self.display.drop(viewer.window, [hierarchy()])
        viewer.wait_for(hierarchy().name)
        self.assertEqual(viewer.closed()["uploads"], 1)

    def test_streaming(self):
        """What has come in the end is what the whole file shows; a budget that is too small is kept all the same."""
        narrow = model("narrow.lode", "build", sphere(), "--levels", 3, "--sigma0", 0.2)
        arguments = ("--camera", self.camera_file(), "--backend", "soft", "--pixel-error", 6)
        whole = self.view(*arguments, file=narrow)
        shown = whole.picture()
        self.assertEqual(whole.closed()["resident_bytes"], 0)
        viewer = self.view(*arguments, "--memory-budget", "800KiB", file=narrow)
        self.assertEqual(viewer.settled(2), shown)
        found = viewer.closed()
        self.assertTrue(found["complete"])
        self.assertTrue(0 < found["resident_bytes"] <= 800 * 1024)
        self.assertEqual(found["uploads"], 1)
        viewer = self.view(*arguments[:-1], 0.2, "--memory-budget", "300KiB", file=narrow)
        self.assertGreater(self.covered(viewer.settled(2)), 20000)
        viewer.press("space", "x", "space")
        found = viewer.closed()
        self.assertFalse(found["complete"])
        self.assertTrue(0 < found["resident_bytes"] <= 300 * 1024)


class Troubles(ViewCase):
    def test_without_a_display(self):
        for display in ("", ":4711"):
            line = self.refused("view", hierarchy(), environment={"DISPLAY": display, "WAYLAND_DISPLAY": ""})
            self.assertRegex(line, "no display.*lodestone render\n")

    def test_without_opengl_45(self):
        for backend in ("gl", "auto"):
            viewer = self.view("--camera", self.camera_file(), "--backend", backend, "--up", "z",
                               environment={"MESA_GL_VERSION_OVERRIDE": "3.3"})
            expected = self.rendered("--backend", "soft")
            until(lambda: viewer.picture() == expected, "the picture, once the line has gone")
            self.assertEqual(viewer.closed()["backend"], "soft")
            self.assertRegex(viewer.said, r"\Alodestone: OpenGL 4.5 is missing[^\n]*drawing with soft instead\n\Z")

    def test_the_display_is_lost(self):
        viewer = self.view("--camera", self.camera_file())
        self.display.key("r")
        self.display.drag((300, 200), (400, 250))
        self.display.lose()
        out, err = viewer.process.communicate(timeout=30)
        self.assertEqual((viewer.process.returncode, out), (5, ""))
        self.assertIn("lodestone: the connection to the display was lost\n", err)
        self.assertGreater(len(json.loads((self.folder / "path001.json").read_text())["frames"]), 5)

    def test_cameras_that_cannot_be_drawn(self):
        far = self.camera_file({**CAMERA, "position": [1e60, 0, 0]}, name="far.json")
        viewer = Viewer(self, hierarchy(), "--camera", far)
        at_home = viewer.wait_for(hierarchy().name)
        self.assertGreater(self.covered(at_home), 20000)
        nan = self.write("nan.json", '{"frames": [{"position": [NaN, 0, 0], "target": [0, 0, 0]}]}')
        self.display.drop(viewer.window, [nan])
        self.display.drop(viewer.window, [far])
        viewer.settled()
        camera = viewer.closed()["camera"]
        self.assertTrue(all(abs(c) < 10 for c in camera["position"]))
        self.assertIn("nan.json", viewer.said)
        self.assertIn("too far away", viewer.said)

    def test_a_file_that_turns_out_to_be_altered(self):
        """Streamed cells are checked when they are loaded."""
        # With these bounds the second half are cells that are not drawn at first.
        content = bytearray(model("narrow.lode", "build", sphere(), "--levels", 3, "--sigma0", 0.2).read_bytes())
        for at in range(len(content) // 2, len(content) * 9 // 10, 5000):  # signatures, last, are checked at once
            content[at] ^= 0x55
        viewer = Viewer(self, self.write("altered.lode", content), "--memory-budget", "700KiB", "--pixel-error", 0.1,
                        "--up", "z")
        # The coarse model may be gone again before anybody sees its name: nameless for a while means given up.
        nameless = [time.monotonic()]

        def given_up():
            if not viewer.running() or viewer.title() != "Lodestone":
                nameless[0] = time.monotonic()
            return time.monotonic() - nameless[0] > 3

        until(given_up, "the model given up")
        self.display.drop(viewer.window, [hierarchy()])
        viewer.wait_for(hierarchy().name)
        viewer.closed()
        self.assertIn("altered.lode", viewer.said)
        self.assertEqual(viewer.said.count("\n"), 1)

    def test_bad_arguments(self):
        for arguments in (("--size", "0x0"), ("--size", "wide"), ("--pixel-error", 0), ("--kappa0", -1),
                          ("--blend", "none"), ("--backend", "null"), ("--camera", "missing.json"),
                          ("--pixel-error", "nan")):
            self.refused("view", hierarchy(), *arguments, names=[str(arguments[1]) if arguments[1] == "wide" else ""])

    def test_files_that_cannot_be_opened(self):
        for name in ("missing.lode", "missing.ply"):
            self.refused("view", name, names=[f"lodestone: {name}"], environment={"DISPLAY": self.display.name})


if __name__ == "__main__":
    command_case.main(__doc__)
