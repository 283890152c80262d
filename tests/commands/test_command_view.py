"""The viewer in a real window on a virtual display, driven by mouse and keyboard: what it shows and how it moves.

usage: test_command_view.py PROGRAM. What the window shows is read from the memory of the X server.
"""

import json
import math
import os
import pathlib
import time

import command_case
from command_case import hierarchy
from png import Picture, read_png
from view_case import BACKGROUND, CAMERA, HEIGHT, SIZE, WIDTH, ViewCase, Viewer


class Pictures(ViewCase):
    def test_the_window_shows_what_render_draws(self):
        for arguments in ((), ("--tint",), ("--samples", 4), ("--kappa0", 1.5, "--blend", "late"),
                          ("--pixel-error", 4, "--metric", "chebyshev")):
            viewer = self.view("--camera", self.camera_file(), "--backend", "soft", *arguments)
            self.assertEqual(viewer.picture(), self.rendered("--backend", "soft", *arguments), arguments)
            self.assertGreater(self.covered(viewer.picture()), 20000)
            self.assertEqual(viewer.closed()["backend"], "soft")

    def test_gl_draws_into_the_window(self):
        self.needs_gl()
        viewer = self.view("--camera", self.camera_file(), "--backend", "gl", "--tint")
        self.assertEqual(viewer.picture(), self.rendered("--backend", "gl", "--tint"))
        banded = viewer.press("m")
        self.assertNotEqual(banded, viewer.press("x"))
        found = viewer.closed()
        self.assertEqual(found["backend"], "gl")
        self.assertIn("GLFW window", found["device"])

    def test_a_camera_at_rest_costs_nothing(self):
        viewer = self.view()

        def ticks():
            fields = pathlib.Path(f"/proc/{viewer.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
            return int(fields[11]) + int(fields[12])

        viewer.settled(1)
        before = ticks()
        time.sleep(3)
        self.assertLess(ticks() - before, 0.1 * os.sysconf("SC_CLK_TCK"))
        found = viewer.closed()
        # One picture beside the panel, one without it.
        self.assertEqual((found["uploads"], found["draws"], found["selections"]), (1, 2, 2))
        self.assertLess(found["window_frames"], 60)

    def test_the_window_changes_its_size(self):
        viewer = self.view("--camera", self.camera_file(), "--backend", "soft")
        whole = viewer.picture()
        for size in ((1, 1), (2, 300), (300, 2)):
            self.display.resize(viewer.window, *size)
            viewer.settled()
            viewer.press("x", "x", "b", "b", "space", "space")
        self.display.resize(viewer.window, 400, 300)
        viewer.settled()
        self.assertEqual(self.display.grab(400, 300), self.rendered("--backend", "soft", size=(400, 300)))
        self.display.resize(viewer.window, *SIZE)
        self.assertEqual(viewer.settled(), whole)
        viewer.closed()

    def marks(self, picture):
        """Pixels in the colour of what is inadmissible."""
        red = bytes([255, 107, 92])
        return sum(picture[i:i + 3] == red for i in range(0, len(picture), 3))

    def with_panel(self, *arguments):
        viewer = Viewer(self, hierarchy(), "--camera", self.camera_file(), *arguments)
        viewer.wait_for(hierarchy().name)
        return viewer

    def test_panel_marks_what_is_inadmissible(self):
        for arguments, marked in ((("--kappa0", 6, "--radii", "uniform"), False),
                                  (("--kappa0", 0.5, "--radii", "uniform"), True),
                                  (("--kappa0", 0.5), False), (("--blend", "step"), True)):
            viewer = self.with_panel(*arguments)
            self.assertEqual(self.marks(viewer.picture()) > 20, marked, arguments)
            viewer.closed()

    def test_the_panel_is_used_by_mouse(self):
        """Where its buttons are is known; what they do is seen."""
        viewer = self.with_panel()
        kappa0, uniform, slider, levels = (182, 119), (110, 165), 142, (18, 304)
        self.display.drag(kappa0, kappa0, steps=1, rest=0.5)
        admissible = viewer.after(self.display.drag, uniform, uniform, steps=1, rest=0.5)
        self.assertEqual(self.marks(admissible), 0)
        coarse = viewer.after(self.display.drag, (90, slider), (24, slider), rest=0.5)
        self.assertGreater(self.marks(coarse), 20)
        self.assertNotEqual(self.beside_panel(coarse), self.beside_panel(admissible))
        tinted = viewer.after(self.display.drag, levels, levels, steps=1, rest=0.5)
        self.assertNotEqual(self.beside_panel(tinted), self.beside_panel(coarse))
        found = viewer.closed()
        self.assertEqual(found["camera"]["position"], CAMERA["position"])  # drags over the panel are the panel's

    def test_the_panel_leaves_the_model_free(self):
        """The whole model is seen beside the panel, and in both halves of a split screen; text grows with the window."""
        viewer = Viewer(self, hierarchy())
        viewer.wait_for(hierarchy().name)
        for keys, parts in (((), [(270, WIDTH)]), (("x",), [(270, 455), (457, WIDTH)])):
            picture = viewer.press(*keys)
            for left, right in parts:
                rows = [picture[3 * (y * WIDTH + left):3 * (y * WIDTH + right)] for y in range(40, HEIGHT - 40)]
                covered = sum(row[i:i + 3] != BACKGROUND for row in rows for i in range(0, len(row), 3))
                self.assertGreater(covered, 5000)
                self.assertTrue(all(row[:3] == BACKGROUND == row[-3:] for row in rows))
        whole = viewer.press("x")
        self.display.resize(viewer.window, 1920, 1080)
        viewer.settled()
        large = self.display.grab(1920, 1080)
        at = lambda x, y: large[3 * (y * 1920 + x):][:3]
        self.assertNotEqual(at(400, 900), BACKGROUND)  # the panel, 405 pixels wide now
        self.assertEqual(at(410, 900), BACKGROUND)
        self.display.resize(viewer.window, *SIZE)
        self.assertEqual(self.beside_panel(viewer.settled()), self.beside_panel(whole))
        viewer.closed()



class Steering(ViewCase):
    def test_the_mouse_moves_the_camera(self):
        viewer = self.view()
        seen = {viewer.picture(), viewer.after(self.display.drag, (300, 200), (400, 250)),
                viewer.after(self.display.drag, (300, 200), (340, 240), number=3),
                viewer.after(self.display.click, 300, 200, number=4)}
        self.assertEqual(len(seen), 4)
        home = viewer.press("Home")
        self.assertIn(home, seen)
        found = viewer.closed()
        self.assertGreater(found["draws"], 4)
        self.assertEqual(found["uploads"], 1)

    def test_a_double_click_focuses_on_the_surface(self):
        viewer = self.view("--camera", self.camera_file())
        at_rest = viewer.picture()
        self.assertEqual(viewer.after(self.display.click, 5, 5, times=2), at_rest)  # background
        for _ in range(5):  # a busy machine may click too slowly for a double click
            if viewer.after(self.display.click, WIDTH // 2 + 40, HEIGHT // 2 - 30, times=2) != at_rest:
                break
        self.assertNotEqual(viewer.picture(), at_rest)
        camera = viewer.closed()["camera"]
        self.assertAlmostEqual(math.dist(camera["target"], (0, 0, 0)), 1, delta=0.15)  # on the dented sphere
        self.assertAlmostEqual(math.dist(camera["target"], camera["position"]),
                               math.dist(CAMERA["position"], camera["target"]) / 2, delta=1e-6)

    def test_flying(self):
        viewer = self.view("--camera", self.camera_file())
        at_rest = viewer.press("Tab")
        self.display.key("w", hold=0.4)
        self.assertNotEqual(viewer.settled(), at_rest)
        camera = viewer.closed()["camera"]
        way = [b - a for a, b in zip(CAMERA["position"], camera["position"])]
        towards = [t - p for t, p in zip(CAMERA["target"], CAMERA["position"])]
        self.assertGreater(math.hypot(*way), 0.05)
        cosine = sum(a * b for a, b in zip(way, towards)) / math.hypot(*way) / math.hypot(*towards)
        self.assertAlmostEqual(cosine, 1, delta=1e-6)

    def test_recorded_paths_play(self):
        viewer = self.view("--camera", self.camera_file())
        self.display.key("r")
        moved = viewer.after(self.display.drag, (300, 200), (400, 250))
        viewer.press("r")  # the window says where the path is
        viewer.press("Home")
        keys = json.loads((self.folder / "path001.json").read_text())["frames"]
        self.assertGreater(len(keys), 5)
        self.assertEqual([round(c, 9) for c in keys[0]["position"]], CAMERA["position"])
        self.display.key("p")
        time.sleep(len(keys) / 30 + 2)
        viewer.press("Escape")
        found = viewer.closed()
        self.assertEqual(found["files"], ["./path001.json"])
        for a, b in zip(found["camera"]["position"], keys[-1]["position"]):
            self.assertAlmostEqual(a, b, delta=1e-9)
        self.assertNotEqual(moved, self.rendered())
        self.assertEqual(moved, self.rendered(camera=self.camera_file(keys[-1], name="last.json")))


class Looks(ViewCase):
    def test_switches_change_the_picture_and_back(self):
        viewer = self.view("--camera", self.camera_file())
        plain = viewer.picture()
        for key in "tmbgox":
            self.assertNotEqual(viewer.press(key), plain, key)
            self.assertEqual(viewer.press(key), plain, key)
        self.assertNotEqual(viewer.press("minus", "minus", "minus", "minus", "minus", "minus"), plain)
        viewer.closed()

    def test_a_frozen_selection_stays(self):
        viewer = self.view("--camera", self.camera_file(), "--tint", "--pixel-error", 0.3)
        viewer.press("space")
        self.display.drag((300, 200), (500, 250))
        frozen = viewer.after(self.display.click, 300, 200, number=5, times=8)
        thawed = viewer.press("space")
        self.assertNotEqual(frozen, thawed)
        found = viewer.closed()
        # The first pictures, with and without the panel, and the last one; many more were drawn between them.
        self.assertEqual(found["selections"], 3)
        self.assertGreater(found["draws"], 5)

    def test_split_screen_shows_two_settings(self):
        viewer = self.view("--camera", self.camera_file())
        both = viewer.press("x")
        # The names of the settings stand in the upper right corners.
        below = 3 * 320 * 40
        left, right = Picture(self.half(both, False)[below:]), Picture(self.half(both, True)[below:])
        self.assertEqual(left, right)
        self.assertEqual(self.column(both, 320), BACKGROUND * HEIGHT)
        other = viewer.press("v", "t")
        self.assertEqual(self.half(other, False)[below:], left)
        self.assertNotEqual(self.half(other, True)[below:], right)
        viewer.press("c")
        width, height, saved = read_png(self.folder / "screenshot001.png")
        self.assertEqual((width, height), SIZE)
        self.assertEqual(self.half(saved, True), self.half_of_render("--tint"))
        viewer.closed()

    def half_of_render(self, *arguments):
        return self.rendered(*arguments, size=(320, HEIGHT))

    def test_screenshots(self):
        viewer = self.view("--camera", self.camera_file(), "-o", self.folder)
        plain = viewer.picture()
        # With the panel it is what is seen beside it.
        beside = self.beside_panel(viewer.press("h"))
        viewer.press("c", "h", "c")
        viewer.press("F12")
        for name, seen in (("screenshot001.png", beside), ("screenshot002.png", plain), ("screenshot003.png", plain)):
            self.assertEqual(read_png(self.folder / name)[2], seen)
        found = viewer.closed()
        self.assertEqual([pathlib.Path(f).name for f in found["files"]], [f"screenshot00{k}.png" for k in (1, 2, 3)])
        self.assertIn("screenshot001.png", viewer.said)

    def test_a_screenshot_that_cannot_be_written(self):
        viewer = self.view("-o", self.folder / "nowhere")
        viewer.press("c")
        self.assertEqual(viewer.closed()["files"], [])
        self.assertIn("nowhere", viewer.said)


if __name__ == "__main__":
    command_case.main(__doc__)
