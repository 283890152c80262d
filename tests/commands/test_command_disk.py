"""Disks that fail half-way: one line that names the file, and nothing left. usage: test_command_disk.py PROGRAM

FAILING_DISK names the library built from failing_disk.cpp; without it only the limits of the system are tested."""

import os
import resource
import subprocess
import unittest

import command_case
from command_case import CommandCase, hierarchy, model, obj, sphere

SHIM = os.environ.get("FAILING_DISK", "")


class DiskCase(CommandCase):
    def fails(self, *arguments, names, preexec=None, **disk):
        before = self.listing()
        environment = dict(os.environ, **{name: str(value) for name, value in disk.items()})
        if disk:
            environment["LD_PRELOAD"] = SHIM
        done = subprocess.run([command_case.PROGRAM, *map(str, arguments)], cwd=self.folder, env=environment,
                              preexec_fn=preexec, capture_output=True, timeout=120, check=False)
        self.assertEqual((done.returncode, done.stdout), (1, b""), (arguments, disk, done.stderr))
        line = done.stderr.decode()
        self.assertRegex(line, r"\Alodestone: [^\n]+\n\Z", arguments)
        for name in names:
            self.assertIn(name, line, arguments)
        self.assertEqual(self.listing(), before, (arguments, disk))


@unittest.skipUnless(SHIM, "the failing disk is not built for sanitizers")
class BrokenMedium(DiskCase):
    def test_input(self):
        size = sphere().stat().st_size
        for share in (0, 0.3, 0.9):
            for command in (("build", sphere(), "-o", "m.lode"), ("info", sphere()), ("compare", sphere(), sphere())):
                with self.subTest(command=command, share=share):
                    self.fails(*command, names=["sphere.ply", "byte", "cannot read"], DISK_READS=int(share * size))

    def test_text_input(self):
        self.write("m.obj", obj([(x, y, x * y) for x in range(60) for y in range(60)],
                                [(a, a + 1, a + 60) for a in range(3500)]))
        self.fails("build", "m.obj", "-o", "m.lode", names=["m.obj", "cannot read"], DISK_READS=20000)

    def test_input_that_becomes_shorter(self):
        size = sphere().stat().st_size
        for share in (0.3, 0.9):
            self.fails("build", sphere(), "-o", "m.lode", names=["sphere.ply"], DISK_READS=int(share * size),
                       DISK_ENDS=1)


@unittest.skipUnless(SHIM, "the failing disk is not built for sanitizers")
class FullDisk(DiskCase):
    def test_build(self):
        whole = hierarchy().stat().st_size
        for form in ((), ("--compress",)):
            for share in (0, 0.1, 0.5, 0.9):
                with self.subTest(form=form, share=share):
                    self.fails("build", sphere(), "-o", "m.lode", "--levels", 3, *form,
                               names=["m.lode", "No space left"], DISK_WRITES=int(share * whole * (0.3 if form else 1)))

    def test_other_outputs(self):
        self.fails("generate", "sphere", "--triangles", 20000, "-o", "m.ply", names=["m.ply", "No space left"],
                   DISK_WRITES=100000)
        for name in ("m.ply", "m.obj", "m.glb"):
            self.fails("export", hierarchy(), "-o", name, names=[name, "No space left"], DISK_WRITES=1000)
        self.fails("render", hierarchy(), "--backend", "soft", "--size", "64x64", "--frames", 3, "-o", "frames",
                   names=["frames", "No space left"], DISK_WRITES=100)
        self.fails("info", hierarchy(), "--json", "m.json", names=["m.json", "No space left"], DISK_WRITES=10)

    def test_what_was_there_stays(self):
        self.write("m.lode", "mine")
        self.fails("build", sphere(), "-o", "m.lode", names=["m.lode"], DISK_WRITES=100000)


class LimitOfFileSizes(DiskCase):
    def test_shell_limit(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))

        self.fails("build", sphere(), "-o", "m.lode", names=["m.lode", "File too large"], preexec=limit)
        self.fails("generate", "sphere", "--triangles", 100000, "-o", "m.ply", names=["m.ply", "File too large"],
                   preexec=limit)


if __name__ == "__main__":
    command_case.main(__doc__)
