"""The viewer in a real window on a virtual display, driven by mouse and keyboard. usage: test_command_view.py PROGRAM

What the window shows is read from the memory of the X server.
"""

import json
import math
import os
import pathlib
import signal
import subprocess
import time

import command_case
from command_case import CommandCase, hierarchy, model, sphere
from png import read_png
from x_display import Display

SIZE = (642, 480)  # of the window: two halves of 320 and a line between them
WIDTH, HEIGHT = SIZE
CAMERA = {"position": [2.5, -1.5, 1.2], "target": [0, 0, 0], "up": [0, 0, 1], "fov_degrees": 45}
BACKGROUND = bytes([24, 26, 30])


def until(condition, what, timeout=30.0):
    """The first true value of a condition; an error after so many seconds."""
    end = time.monotonic() + timeout
    while not (value := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"not within {timeout} s: {what}")
        time.sleep(0.05)
    return value


class Viewer:
    """The program with its window, as a person before it has it."""

    def __init__(self, case, *arguments, environment=None):
        self.case, self.display = case, case.display
        self.results = case.folder / "view.json"
        self.process = subprocess.Popen(
            [command_case.PROGRAM, "view", *map(str, arguments), "--size", f"{WIDTH}x{HEIGHT}", "--json",
             str(self.results)], cwd=case.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "DISPLAY": self.display.name, **(environment or {})})
        case.addCleanup(self.end)
        self.window = until(lambda: self.running() and self.focused(), "a window")
        self.display.away()

    def running(self):
        if self.process.poll() is not None:
            raise AssertionError(f"it ended: {self.process.communicate()}")
        return True

    def focused(self):
        window = self.display.find("Lodestone")
        return window if window and self.display.focus(window) else None

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()

    def title(self):
        return self.display.title(self.window)

    def wait_for(self, name):
        until(lambda: self.running() and self.title() == f"{name} - Lodestone", f"{name} in the title", 120)
        return self.settled()

    def picture(self):
        return self.display.grab(WIDTH, HEIGHT)

    def settled(self, seconds=0.5):
        """The picture once it has stayed the same for a while."""
        last, since, end = self.picture(), time.monotonic(), time.monotonic() + 30
        while time.monotonic() - since < seconds:
            time.sleep(0.1)
            if (now := self.picture()) != last:
                last, since = now, time.monotonic()
            self.case.assertLess(time.monotonic(), end, "the picture never comes to rest")
        return last

    def press(self, *keys):
        for key in keys:
            self.display.key(key)
        return self.settled()

    def closed(self):
        """Closes the window; the results that are written then."""
        self.display.close(self.window)
        out, err = self.process.communicate(timeout=60)
        self.case.assertEqual((self.process.returncode, out), (0, ""), err)
        self.said = err
        return json.loads(self.results.read_text())

    def interrupted(self, signals=signal.SIGINT):
        self.process.send_signal(signals)
        out, err = self.process.communicate(timeout=60)
        return self.process.returncode, err


class ViewCase(CommandCase):
    def setUp(self):
        super().setUp()
        self.display = self.enterContext(Display()) if hasattr(self, "enterContext") else self.entered(Display())

    def entered(self, context):
        self.addCleanup(context.__exit__, None, None, None)
        return context.__enter__()

    def camera_file(self, *cameras, name="camera.json"):
        return self.write(name, json.dumps({"frames": list(cameras) or [CAMERA]}))

    def view(self, *arguments, file=None, environment=None):
        """A viewer with its panel hidden, at rest."""
        file = file or hierarchy()
        viewer = Viewer(self, file, *arguments, environment=environment)
        viewer.wait_for(file.name)
        viewer.press("h")
        return viewer

    def rendered(self, *arguments, size=SIZE, camera=None):
        self.lodestone("render", hierarchy(), "--camera", camera or self.camera_file(), "--frames", 1, "--size",
                       f"{size[0]}x{size[1]}", "-o", "frames", *arguments, "--quiet")
        return read_png(self.folder / "frames" / "frame0000.png")[2]

    def column(self, picture, x):
        return b"".join(picture[3 * (y * WIDTH + x):][:3] for y in range(HEIGHT))

    def half(self, picture, right):
        first = 322 if right else 0
        return b"".join(picture[3 * (y * WIDTH + first):][:3 * 320] for y in range(HEIGHT))

    def covered(self, picture):
        """Pixels that are not background."""
        return sum(picture[i:i + 3] != BACKGROUND for i in range(0, len(picture), 3))

    def with_gl(self):
        probe = command_case.call("render", hierarchy(), "--frames", 1, "--size", "16x16", "--backend", "gl")
        if probe.returncode != 0:
            self.skipTest(probe.stderr.decode().strip())


class Pictures(ViewCase):
    def test_the_window_shows_what_render_draws(self):
        for arguments in ((), ("--tint",), ("--samples", 4), ("--kappa0", 1.5, "--blend", "late"),
                          ("--pixel-error", 4, "--metric", "chebyshev")):
            viewer = self.view("--camera", self.camera_file(), "--backend", "soft", *arguments)
            self.assertEqual(viewer.picture(), self.rendered("--backend", "soft", *arguments), arguments)
            self.assertGreater(self.covered(viewer.picture()), 20000)
            self.assertEqual(viewer.closed()["backend"], "soft")

    def test_gl_draws_into_the_window(self):
        self.with_gl()
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
        self.assertEqual((found["uploads"], found["draws"], found["selections"]), (1, 1, 1))
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

    def test_panel_marks_what_is_inadmissible(self):
        red = bytes([255, 107, 92])

        def marks(*arguments):
            viewer = Viewer(self, hierarchy(), "--camera", self.camera_file(), *arguments)
            viewer.wait_for(hierarchy().name)
            picture = viewer.picture()
            viewer.closed()
            return sum(picture[i:i + 3] == red for i in range(0, len(picture), 3))

        self.assertEqual(marks("--kappa0", 6, "--radii", "uniform"), 0)
        self.assertGreater(marks("--kappa0", 0.5, "--radii", "uniform"), 20)
        self.assertEqual(marks("--kappa0", 0.5), 0)
        self.assertGreater(marks("--blend", "step"), 20)


class Steering(ViewCase):
    def test_the_mouse_moves_the_camera(self):
        viewer = self.view()
        seen = {viewer.picture()}
        self.display.drag((300, 200), (400, 250))
        self.display.away()
        seen.add(viewer.settled())
        self.display.drag((300, 200), (340, 240), number=3)
        self.display.away()
        seen.add(viewer.settled())
        self.display.click(300, 200, number=4)
        self.display.away()
        seen.add(viewer.settled())
        self.assertEqual(len(seen), 4)
        home = viewer.press("Home")
        self.assertIn(home, seen)
        found = viewer.closed()
        self.assertGreater(found["draws"], 4)
        self.assertEqual(found["uploads"], 1)

    def test_a_double_click_focuses_on_the_surface(self):
        viewer = self.view("--camera", self.camera_file())
        at_rest = viewer.picture()
        self.display.click(5, 5, times=2)  # background
        self.display.away()
        self.assertEqual(viewer.settled(), at_rest)
        self.display.click(WIDTH // 2 + 40, HEIGHT // 2 - 30, times=2)
        self.display.away()
        self.assertNotEqual(viewer.settled(), at_rest)
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
        self.display.drag((300, 200), (400, 250))
        self.display.away()
        moved = viewer.settled()
        viewer.press("r")  # the window says where the path is
        viewer.press("Home")
        keys = json.loads((self.folder / "path001.json").read_text())["frames"]
        self.assertGreater(len(keys), 5)
        self.assertEqual([round(c, 9) for c in keys[0]["position"]], CAMERA["position"])
        self.display.key("p")
        time.sleep(len(keys) / 30)
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
        for key in "tmbx":
            self.assertNotEqual(viewer.press(key), plain, key)
            self.assertEqual(viewer.press(key), plain, key)
        self.assertNotEqual(viewer.press("minus", "minus", "minus", "minus", "minus", "minus"), plain)
        viewer.closed()

    def test_a_frozen_selection_stays(self):
        viewer = self.view("--camera", self.camera_file(), "--tint", "--pixel-error", 0.3)
        viewer.press("space")
        self.display.drag((300, 200), (500, 250))
        self.display.click(300, 200, number=5, times=8)
        self.display.away()
        frozen = viewer.settled()
        thawed = viewer.press("space")
        self.assertNotEqual(frozen, thawed)
        found = viewer.closed()
        # Of the first picture, of the frozen view, and of the last picture; many more were drawn.
        self.assertEqual(found["selections"], 3)
        self.assertGreater(found["draws"], 5)

    def test_split_screen_shows_two_settings(self):
        viewer = self.view("--camera", self.camera_file())
        both = viewer.press("x")
        # The names of the settings stand in the upper right corners.
        below = 3 * 320 * 40
        left, right = self.half(both, False)[below:], self.half(both, True)[below:]
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
        viewer.press("h", "c")
        viewer.press("F12")
        for name in ("screenshot001.png", "screenshot002.png"):
            self.assertEqual(read_png(self.folder / name)[2], plain)
        found = viewer.closed()
        self.assertEqual([pathlib.Path(f).name for f in found["files"]], ["screenshot001.png", "screenshot002.png"])
        self.assertIn("screenshot001.png", viewer.said)

    def test_a_screenshot_that_cannot_be_written(self):
        viewer = self.view("-o", self.folder / "nowhere")
        viewer.press("c")
        self.assertEqual(viewer.closed()["files"], [])
        self.assertIn("nowhere", viewer.said)


class Files(ViewCase):
    def test_a_mesh_is_built(self):
        built = model("default.lode", "build", sphere())
        viewer = self.view("--backend", "soft", file=sphere())
        shown = viewer.picture()
        viewer.closed()
        viewer = self.view("--backend", "soft", file=built)
        self.assertEqual(viewer.picture(), shown)
        viewer.closed()
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
        arguments = ("--camera", self.camera_file(), "--backend", "soft", "--pixel-error", 6)
        whole = self.view(*arguments)
        shown = whole.picture()
        self.assertEqual(whole.closed()["resident_bytes"], 0)
        viewer = self.view(*arguments, "--memory-budget", "800KiB")
        self.assertEqual(viewer.settled(2), shown)
        found = viewer.closed()
        self.assertTrue(found["complete"])
        self.assertTrue(0 < found["resident_bytes"] <= 800 * 1024)
        self.assertEqual(found["uploads"], 1)
        viewer = self.view(*arguments[:-1], 0.2, "--memory-budget", "300KiB")
        self.assertGreater(self.covered(viewer.settled(2)), 20000)
        viewer.press("space", "x", "space")
        found = viewer.closed()
        self.assertFalse(found["complete"])
        self.assertTrue(0 < found["resident_bytes"] <= 300 * 1024)


class Troubles(ViewCase):
    def test_without_a_display(self):
        for display in ("", ":4711"):
            done = subprocess.run([command_case.PROGRAM, "view", str(hierarchy())], cwd=self.folder,
                                  env={**os.environ, "DISPLAY": display, "WAYLAND_DISPLAY": ""}, capture_output=True,
                                  timeout=60, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr.decode(), r"\Alodestone: [^\n]*no display[^\n]*lodestone render\n\Z")

    def test_without_opengl_45(self):
        for backend in ("gl", "auto"):
            viewer = self.view("--camera", self.camera_file(), "--backend", backend,
                               environment={"MESA_GL_VERSION_OVERRIDE": "3.3"})
            expected = self.rendered("--backend", "soft")
            until(lambda: viewer.picture() == expected, "the picture, once the line has gone")
            self.assertEqual(viewer.closed()["backend"], "soft")
            self.assertRegex(viewer.said, r"\Alodestone: OpenGL 4.5 is missing[^\n]*drawing by soft\n\Z")

    def test_the_display_is_lost(self):
        viewer = self.view("--camera", self.camera_file())
        self.display.key("r")
        self.display.drag((300, 200), (400, 250))
        self.display.lose()
        out, err = viewer.process.communicate(timeout=30)
        self.assertEqual((viewer.process.returncode, out), (1, ""))
        self.assertIn("lodestone: the connection to the display was lost\n", err)
        self.assertGreater(len(json.loads((self.folder / "path001.json").read_text())["frames"]), 5)

    def test_cameras_that_cannot_be_drawn(self):
        far = self.camera_file({**CAMERA, "position": [1e300, 0, 0]}, name="far.json")
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

    def test_bad_arguments(self):
        for arguments in (("--size", "0x0"), ("--size", "wide"), ("--pixel-error", 0), ("--kappa0", -1),
                          ("--blend", "none"), ("--backend", "null"), ("--camera", "missing.json"),
                          ("--pixel-error", "nan")):
            self.refused("view", hierarchy(), *arguments, names=[str(arguments[1]) if arguments[1] == "wide" else ""])

    def test_files_that_cannot_be_opened(self):
        environment = {**os.environ, "DISPLAY": self.display.name}
        for name in ("missing.lode", "missing.ply"):
            done = subprocess.run([command_case.PROGRAM, "view", name], cwd=self.folder, env=environment,
                                  capture_output=True, timeout=60, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr.decode(), rf"\Alodestone: {name}[^\n]+\n\Z")


if __name__ == "__main__":
    command_case.main(__doc__)
