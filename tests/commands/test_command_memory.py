"""Allocations that fail: one line, or the whole result; no temporary and no wrong file.
usage: [ALLOCATIONS=N] test_command_memory.py PROGRAM

About eight allocations of each command fail in turn, or ALLOCATIONS of them ("all": each); then a third as many fail with
all that follow them. The allocations of a sweep and of its children fail apart."""

import collections
import os
import pathlib
import re
import shutil
import subprocess
import unittest

import command_case
from command_case import model
from fault_case import FaultCase, commands, content
from sweep_case import HEAD, SweepCase, section

SHIM = os.environ.get("FAILING_MEMORY", "")  # the library built from failing_memory.cpp
ASKED = os.environ.get("ALLOCATIONS", "8")
needs_failing_memory = unittest.skipUnless(SHIM, "failing memory is not built for sanitizers")


def with_memory(**memory):
    return {"LD_PRELOAD": SHIM} | {f"MEMORY_{name.upper()}": str(value) for name, value in memory.items()}


def textured():
    """A mesh with a material and an image: other libraries allocate, too."""
    folder = command_case._models / "textured"
    if not folder.exists():
        folder.mkdir()
        done = command_case.call("render", mesh(), "--backend", "soft", "--size", "32x32", "--frames", 1, "-o", folder)
        assert done.returncode == 0, done.stderr.decode()
        picture = next(folder.glob("*.png")).name
        (folder / "m.mtl").write_text(f"newmtl wood\nKd 1 1 1\nmap_Kd {picture}\n")
        points = [(x / 8, y / 8, x * y / 64) for y in range(9) for x in range(9)]
        text = "mtllib m.mtl\nusemtl wood\n" + "".join(f"v {x} {y} {z}\nvt {x} {y}\n" for x, y, z in points)
        for y in range(8):
            for x in range(8):
                a = 9 * y + x + 1
                text += "f " + " ".join(f"{k}/{k}" for k in (a, a + 1, a + 10, a + 9)) + "\n"
        (folder / "m.obj").write_text(text)
    return folder / "m.obj"


def mesh():
    return model("small.ply", "generate", "terrain", "--triangles", 400)


def lode():
    return model("small.lode", "build", mesh(), "--levels", 2)


@needs_failing_memory
class FailingAllocations(FaultCase):
    def numbers(self, arguments, share):
        """(first, last, step) of the allocations to fail."""
        folder = self.folder / "counted"
        folder.mkdir()
        done = command_case.call(*arguments, cwd=folder, environment=with_memory(count=self.folder / "count"))
        self.assertEqual(done.returncode, 0, done.stderr)
        count = int((self.folder / "count").read_text())
        shutil.rmtree(folder)
        wanted = share * (count if ASKED == "all" else int(ASKED))
        step = max(1, round(count / wanted))
        return 1 + step // 2, count + step, step

    def check(self, name, arguments):
        expected = self.expected(arguments)
        for mode, share in ({}, 1), ({"stays": 1}, 1 / 3):
            first, last, step = self.numbers(arguments, share)
            work = self.folder / "work"
            work.mkdir()
            done = subprocess.run([command_case.PROGRAM, *map(str, arguments)], cwd=work, capture_output=True, check=False,
                                  env={**os.environ, **with_memory(each=f"{first} {last} {step}", **mode)}, timeout=7200)
            self.assertEqual(done.returncode, 0, done.stderr)
            said = collections.Counter()
            for number in range(first, last + 1, step):
                with self.subTest(command=name, allocation=number, **mode):
                    said[self.outcome(work / str(number), expected)] += 1
            self.assertTrue(any("memory" in line for line in said), said)
            if ASKED == "all":
                print(name, mode, f"{first} {last} {step}", dict(said), flush=True)
            shutil.rmtree(work)
        shutil.rmtree(self.folder / "expected")

    def outcome(self, folder, expected):
        """The line said, after all checks of one process."""
        base = str(folder)
        status = int(pathlib.Path(base + ".status").read_text())
        errors = pathlib.Path(base + ".errors").read_text(errors="replace")
        self.check_nothing_wrong(folder, expected, errors)
        if status == 0:
            self.assertEqual((errors, content(folder)), ("", expected))
            return "done"
        self.assertIn(status, (command_case.RESOURCE << 8, command_case.FILE << 8), errors)
        self.assertRegex(errors, r"\Alodestone: [^\n]+\n\Z")
        return re.sub(r"/\S*/", "", errors.strip())

    def test_each_command(self):
        for name, arguments in commands(mesh(), lode()).items():
            self.check(name, (*arguments, "--threads", 1, "--quiet"))
        self.check("spherical .lpm", ("spherical", mesh(), "-o", "s.lpm", "--texture", 64, "--threads", 1, "--quiet"))

    def test_several_threads(self):
        for name in ("build", "render", "verify"):
            self.check(name, (*commands(mesh(), lode())[name], "--threads", 3, "--quiet"))

    def test_textures(self):
        self.check("textured", ("build", textured(), "-o", "m.lode", "--levels", 1, "--threads", 1, "--quiet"))


@needs_failing_memory
class FailingSweeps(SweepCase):
    def sweep_with(self, of, **memory):
        return command_case.call("sweep", "sweep.toml", "-o", "out", "--quiet", cwd=self.folder,
                                 environment=with_memory(of=of, **memory))

    def check(self, of, wanted, statuses, **mode):
        """About as many allocations fail as are wanted; what is missing comes with --resume."""
        self.write("sweep.toml", HEAD + section("x = [1, 2], rows = 3"))
        self.sweep_with(of, count=self.folder / "count")
        count = int((self.folder / "count").read_text())
        failed = 0
        for number in range(1, count, max(1, count // wanted)):
            with self.subTest(program=of, allocation=number, **mode):
                shutil.rmtree(self.folder / "out", ignore_errors=True)
                done = self.sweep_with(of, fails=number, **mode)
                self.assertIn(done.returncode, (0, *statuses), done.stderr)
                if done.returncode:
                    failed += 1
                    self.assertRegex(done.stderr.decode(), r"\A(lodestone: [^\n]+\n)+\Z")
                self.results("sweep", "sweep.toml", "-o", "out", "--resume", "--quiet")
                self.check_complete()
        self.assertGreater(failed, wanted // 4)

    def test_its_child(self):
        """The child's run is a fault."""
        self.check("sweep-run", 20 if ASKED != "all" else 2000, [command_case.NEGATIVE])

    def test_itself(self):
        for mode in {}, {"stays": 1}:
            self.check("sweep", 10 if ASKED != "all" else 2000, [command_case.RESOURCE, command_case.FILE], **mode)


if __name__ == "__main__":
    command_case.main(__doc__)
