"""What the tests of faults share: one command of each kind, and what has to hold of its folder after a fault."""

import os

import command_case
from command_case import CommandCase


def commands(mesh, lode, frames=2):
    """Commands by name, with relative outputs; of a mesh and of its hierarchy."""
    soft = ("--backend", "soft", "--size", "64x64")
    return {
        "generate": ("generate", "sphere", "--triangles", 3000, "-o", "m.ply"),
        "build": ("build", mesh, "-o", "m.lode", "--levels", 2),
        "compressed": ("build", mesh, "-o", "m.lode", "--compress", "--measure-error"),
        "export": ("export", lode, "-o", "m.glb"),
        "tiles": ("export", lode, "--tiles", "tiles", "--morph"),
        "archive": ("export", lode, "--tiles", "tiles.3tz"),
        "verify": ("verify", lode),
        "render": ("render", lode, *soft, "--frames", frames, "-o", "frames"),
        "progressive": ("progressive", mesh, "-o", "m.lpm"),
        "progressive .glb": ("progressive", mesh, "-o", "m.glb"),
        "reconstruct": ("reconstruct", mesh, "-o", "r.ply", "--resolution", 32),
        "spherical": ("spherical", mesh, "-o", "s.glb", "--texture", 64),
        "page": ("page", mesh, lode, "-o", "page"),
    }


class FaultCase(CommandCase):
    def setUp(self):
        super().setUp()
        bundle = self.folder / "bundle"
        bundle.mkdir()
        for name in ("page.js", "index.html", "page.css"):
            (bundle / name).write_text(name)
        os.environ["LODESTONE_PAGE"] = str(bundle)
        self.addCleanup(os.environ.pop, "LODESTONE_PAGE")

    def expected(self, arguments):
        """The folder of this command when nothing fails."""
        folder = self.folder / "expected"
        folder.mkdir()
        done = command_case.call(*arguments, cwd=folder)
        self.assertEqual((done.returncode, done.stderr.decode()), (0, ""), arguments)
        return content(folder)

    def check_nothing_wrong(self, folder, expected, what):
        """What lies under final names is what the command writes; of temporaries there are none."""
        found = content(folder)
        self.assertEqual([name for name in found if found[name] != expected.get(name)], [], what)


def content(folder):
    """Files by relative name; folders have no content."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
