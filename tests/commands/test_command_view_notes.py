"""Notes over the pictures of the viewer: legends, axes, the cell under the pointer, a measured distance.

usage: test_command_view_notes.py PROGRAM. What the window shows is read from the memory of the X server.
"""

import re

import command_case
from command_case import hierarchy
from view_case import BACKGROUND, HEIGHT, WIDTH, ViewCase, Viewer

LEFT = 270  # where the panel ends
AXES = [bytes([242, 89, 77]), bytes([115, 204, 89]), bytes([102, 153, 255])]
YELLOW = bytes([255, 220, 90])
MIDDLE = ((LEFT + WIDTH) // 2, HEIGHT // 2)


class Notes(ViewCase):
    def with_panel(self, *arguments):
        viewer = Viewer(self, hierarchy(), "--camera", self.camera_file(), "--backend", "soft", *arguments)
        viewer.wait_for(hierarchy().name)
        return viewer

    def pixels(self, picture, colour, left=LEFT, top=0, right=WIDTH, bottom=HEIGHT):
        """Number of pixels of a colour in a part of the window."""
        rows = (picture[3 * (y * WIDTH + left):3 * (y * WIDTH + right)] for y in range(top, bottom))
        return sum(row[i:i + 3] == colour for row in rows for i in range(0, len(row), 3))

    def differing(self, a, b):
        """The box of the pixels beside the panel that differ, as left, top, right, bottom."""
        places = [(x, y) for y in range(HEIGHT) for x in range(LEFT, WIDTH)
                  if a[3 * (y * WIDTH + x):][:3] != b[3 * (y * WIDTH + x):][:3]]
        xs, ys = zip(*places)
        return min(xs), min(ys), max(xs), max(ys)

    def test_legends_tell_the_colours(self):
        viewer = self.with_panel()
        plain = viewer.picture()
        # Overdraw: the whole ramp stands in the lower left corner, white for 16 and more.
        for key, colours in (("o", [(26, 31, 115), (242, 217, 51), (242, 102, 26)]),
                             ("m", [(40, 110, 255), (255, 140, 30)]),
                             ("f", [(191, 191, 191), (230, 51, 38)]), ("t", [])):
            shown = viewer.press(key)
            corner = [LEFT, HEIGHT - 130, LEFT + 160, HEIGHT]
            for colour in colours:
                self.assertGreaterEqual(self.pixels(shown, bytes(colour), *corner), 100, (key, colour))
                self.assertEqual(self.pixels(plain, bytes(colour), *corner), 0)
            self.assertGreater(self.pixels(shown, b"\xff\xff\xff", *corner), 20, key)  # words
            self.assertEqual(self.pixels(plain, b"\xff\xff\xff", *corner), 0)
            viewer.press(key)
        viewer.closed()

    def test_axes_turn_with_the_camera(self):
        viewer = self.with_panel()
        corner = (WIDTH - 84, HEIGHT - 84, WIDTH, HEIGHT)
        before = viewer.picture()
        for colour in AXES[::2]:  # y points away from this camera, and is dimmed
            self.assertGreater(self.pixels(before, colour, *corner), 10)
        turned = viewer.after(self.display.drag, (400, 200), (500, 200))
        self.assertNotEqual(*([picture[3 * (y * WIDTH + corner[0]):3 * (y + 1) * WIDTH]
                               for y in range(corner[1], HEIGHT)] for picture in (before, turned)))
        # Without the panel there is nothing but the picture.
        bare = viewer.press("h")
        self.assertEqual(sum(self.pixels(bare, colour, 0) for colour in AXES), 0)
        viewer.closed()

    def test_the_cell_under_the_pointer_is_told(self):
        viewer = self.with_panel()
        plain = viewer.picture()
        self.display.move(*MIDDLE)
        told = viewer.settled()
        left, top, right, bottom = self.differing(plain, told)
        self.assertGreater(right - left, 150)  # words beside the pointer, and the cell's box
        self.assertGreater(bottom - top, 50)
        self.display.move(LEFT + 15, 15)  # background, and the pointer itself
        self.assertLess(max(self.differing(plain, viewer.settled())[2:]), LEFT + 40)
        self.display.away()
        self.assertEqual(self.beside_panel(viewer.settled()), self.beside_panel(plain))
        viewer.press("i")
        self.display.move(*MIDDLE)
        left, top, right, bottom = self.differing(plain, viewer.settled())
        self.assertLess(max(right - left, bottom - top), 30)  # the pointer
        viewer.closed()

    def test_a_distance_is_measured(self):
        viewer = self.with_panel()
        viewer.press("i", "l")
        x, y = MIDDLE
        one = viewer.after(self.display.click, x - 40, y)
        self.assertGreater(self.pixels(one, YELLOW, x - 45, y - 5, x - 35, y + 5), 15)
        two = viewer.after(self.display.click, x + 40, y + 30)
        self.assertGreater(self.pixels(two, YELLOW, x - 35, y, x + 35, y + 30), 15)  # the line
        # A third click begins anew; while it is off clicks set nothing.
        self.assertEqual(self.beside_panel(viewer.after(self.display.click, x - 40, y)), self.beside_panel(one))
        viewer.press("l")
        self.assertEqual(self.beside_panel(viewer.after(self.display.click, x + 40, y)), self.beside_panel(one))
        found = viewer.closed()
        self.assertEqual(found["camera"]["position"], [2.5, -1.5, 1.2])


if __name__ == "__main__":
    command_case.main(__doc__)
