"""What the tests of the viewer share: the program with its window, on a virtual display of its own."""

import json
import os
import signal
import subprocess
import time

import command_case
from command_case import CommandCase, hierarchy, until
from png import Picture, read_png
from x_display import Display

SIZE = (642, 480)  # of the window: two halves of 320 and a line between them
WIDTH, HEIGHT = SIZE
CAMERA = {"position": [2.5, -1.5, 1.2], "target": [0, 0, 0], "up": [0, 0, 1], "fov_degrees": 45}
BACKGROUND = bytes([24, 26, 30])


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

    def after(self, act, *arguments, **more):
        """The picture at rest after an act of the display, with the pointer out of the way."""
        act(*arguments, **more)
        self.display.away()
        return self.settled()

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
        probe = command_case.call("view", environment={"DISPLAY": "", "WAYLAND_DISPLAY": ""})
        if b"left out of this build" in probe.stderr:
            self.skipTest(probe.stderr.decode().strip())
        display = Display()
        self.display = display.__enter__()
        self.addCleanup(display.__exit__, None, None, None)

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
        return Picture(b"".join(picture[3 * (y * WIDTH + first):][:3 * 320] for y in range(HEIGHT)))

    def beside_panel(self, picture):
        return Picture(b"".join(picture[3 * (y * WIDTH + 270):3 * (y + 1) * WIDTH] for y in range(HEIGHT)))

    def covered(self, picture):
        """Pixels that are not background."""
        return sum(picture[i:i + 3] != BACKGROUND for i in range(0, len(picture), 3))
