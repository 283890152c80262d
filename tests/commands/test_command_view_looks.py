"""What the panel of the viewer changes about the whole scene: light, effects, clipping plane, visible models.

usage: test_command_view_looks.py PROGRAM. What the window shows is read from the memory of the X server.
"""

import command_case
from command_case import hierarchy
from view_case import BACKGROUND, ViewCase, Viewer

FIRST_HEADER = 357  # its place in the panel of a single model


class Looks(ViewCase):
    def with_panel(self, file=None, *arguments):
        file = file or hierarchy()
        viewer = Viewer(self, file, "--camera", self.camera_file(), "--backend", "soft", *arguments)
        viewer.wait_for(file.name)
        return viewer

    def shown(self, viewer):
        self.display.away()
        return self.beside_panel(viewer.settled())

    def click(self, viewer, x, y):
        return self.drag(viewer, (x, y), (x, y))

    def drag(self, viewer, start, end):
        """As a hand does it, however slow the machine: the panel sees the pointer come, then the button, then the way."""
        self.display.move(*start)
        viewer.settled()
        self.display.button(1, True)
        viewer.settled()
        if end != start:
            self.display.move(*end)
            viewer.settled()
        self.display.button(1, False)
        return self.shown(viewer)

    def mean(self, picture):
        return sum(picture) / len(picture)

    def test_light_is_changed_by_mouse(self):
        viewer = self.with_panel()
        plain = self.shown(viewer)
        self.assertEqual(self.click(viewer, 100, FIRST_HEADER), plain)  # opens the part of the panel
        bright = self.drag(viewer, (50, FIRST_HEADER + 23), (165, FIRST_HEADER + 23))  # ambient
        self.assertGreater(self.mean(bright), self.mean(plain) + 5)
        dark = self.drag(viewer, (95, FIRST_HEADER + 46), (12, FIRST_HEADER + 46))  # the light at the eye
        self.assertNotEqual(dark, bright)
        viewer.closed()

    def test_effects_are_switched_by_mouse(self):
        viewer = self.with_panel()
        plain = self.shown(viewer)
        self.assertEqual(self.click(viewer, 100, FIRST_HEADER + 23), plain)
        flat = self.click(viewer, 18, FIRST_HEADER + 115)  # smooth-normals
        self.assertNotEqual(flat, plain)
        self.assertEqual(self.click(viewer, 18, FIRST_HEADER + 115), plain)
        self.assertNotEqual(self.drag(viewer, (12, FIRST_HEADER + 69), (100, FIRST_HEADER + 69)), plain)  # fog
        viewer.closed()

    def test_a_plane_clips(self):
        viewer = self.with_panel()
        whole = self.shown(viewer)
        viewer.press("k")  # across x, through the middle
        cut = self.shown(viewer)
        self.assertNotEqual(cut, whole)
        self.assertEqual(self.click(viewer, 100, FIRST_HEADER + 46), cut)  # opens the part of the panel
        self.assertNotEqual(self.drag(viewer, (93, FIRST_HEADER + 92), (30, FIRST_HEADER + 92)), cut)
        viewer.press("k")
        self.assertEqual(self.shown(viewer), whole)
        viewer.closed()

    def test_models_are_hidden_by_mouse(self):
        models = "".join(f'[[model]]\ngenerate = "torus"\ntriangles = 2000\nextent = 1\nposition = [0, {y}, 0]\n'
                         f'name = "{name}"\n' for name, y in (("left", -0.7), ("right", 0.7)))
        scene = self.folder / self.write("scene.toml", models)
        viewer = self.with_panel(scene)
        both = self.covered(self.shown(viewer))
        left, right = 115, 138
        without_left = self.covered(self.click(viewer, 18, left))
        self.assertLess(without_left, 0.8 * both)
        self.assertGreater(without_left, 0.2 * both)
        self.assertEqual(self.covered(self.click(viewer, 18, right)), 0 + self.notes(viewer))
        self.click(viewer, 18, left)
        self.assertEqual(self.covered(self.click(viewer, 18, right)), both)
        viewer.closed()

    def notes(self, viewer):
        """Pixels of the axes in the corner, which are all that is seen beside the panel."""
        picture = self.shown(viewer)
        corner = 84
        width = 642 - 270
        return sum(picture[3 * (y * width + x):][:3] != BACKGROUND for y in range(480 - corner, 480)
                   for x in range(width - corner, width))


if __name__ == "__main__":
    command_case.main(__doc__)
