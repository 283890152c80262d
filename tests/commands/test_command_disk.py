"""Disks that fail half-way: one line that names the file, and nothing left. usage: test_command_disk.py PROGRAM"""

import resource
import shutil

import command_case
from command_case import CommandCase, hierarchy, needs_failing_disk, obj, on_disk, sphere
from fault_case import FaultCase, commands
from sweep_case import HEAD, SweepCase, section


@needs_failing_disk
class BrokenMedium(CommandCase):
    def test_input(self):
        size = sphere().stat().st_size
        for share in (0, 0.3, 0.9):
            for command in (("build", sphere(), "-o", "m.lode"), ("info", sphere()), ("compare", sphere(), sphere())):
                with self.subTest(command=command, share=share):
                    self.fails_on_disk(*command, names=["sphere.ply", "byte", "cannot read"], DISK_READS=int(share * size))

    def test_text_input(self):
        self.write("m.obj", obj([(x, y, x * y) for x in range(60) for y in range(60)],
                                [(a, a + 1, a + 60) for a in range(3500)]))
        self.fails_on_disk("build", "m.obj", "-o", "m.lode", names=["m.obj", "cannot read"], DISK_READS=20000)

    def test_input_that_becomes_shorter(self):
        size = sphere().stat().st_size
        for share in (0.3, 0.9):
            self.fails_on_disk("build", sphere(), "-o", "m.lode", names=["sphere.ply"], DISK_READS=int(share * size),
                               DISK_ENDS=1)


    def test_mapped_file_that_becomes_shorter(self):
        whole = hierarchy().read_bytes()
        for command in (("verify", "m.lode"), ("export", "m.lode", "-o", "m.ply"),
                        ("render", "m.lode", "--backend", "soft", "--size", "64x64", "-o", "frames")):
            for share in (0, 0.4, 0.9):
                (self.folder / "m.lode").write_bytes(whole)
                with self.subTest(command=command, share=share):
                    self.failing(*command, names=["lodestone: m.lode: became shorter, or its disk failed"],
                                 environment=on_disk(DISK_CUTS=int(share * len(whole))))
                    self.assertEqual(set(self.listing()), {"m.lode"})


@needs_failing_disk
class ShortPieces(CommandCase):
    def test_reads_and_writes_that_move_less_than_asked(self):
        for command in (("build", sphere(), "-o", "m.lode", "--levels", 3), ("build", sphere(), "-o", "n.lode", "--compress"),
                        ("export", hierarchy(), "-o", "m.glb"), ("progressive", sphere(), "-o", "m.lpm")):
            with self.subTest(command=command):
                self.lodestone(*command)
                expected = self.listing()
                for name in expected:
                    (self.folder / name).unlink()
                done = command_case.call(*command, cwd=self.folder, environment=on_disk(DISK_PIECES=4093))
                self.assertEqual((done.returncode, done.stderr), (0, b""))
                self.assertEqual(self.listing(), expected)
                for name in expected:
                    (self.folder / name).unlink()


@needs_failing_disk
class FullDisk(CommandCase):
    def test_build(self):
        whole = hierarchy().stat().st_size
        for form in ((), ("--compress",)):
            for share in (0, 0.1, 0.5, 0.9):
                with self.subTest(form=form, share=share):
                    self.fails_on_disk("build", sphere(), "-o", "m.lode", "--levels", 3, *form,
                                       names=["m.lode", "No space left"], DISK_WRITES=int(share * whole * (0.3 if form else 1)))

    def test_other_outputs(self):
        self.fails_on_disk("generate", "sphere", "--triangles", 20000, "-o", "m.ply", names=["m.ply", "No space left"],
                           DISK_WRITES=100000)
        for name in ("m.ply", "m.obj", "m.glb"):
            self.fails_on_disk("export", hierarchy(), "-o", name, names=[name, "No space left"], DISK_WRITES=1000)
        self.fails_on_disk("render", hierarchy(), "--backend", "soft", "--size", "64x64", "--frames", 3, "-o", "frames",
                           names=["frames", "No space left"], DISK_WRITES=100)
        self.fails_on_disk("info", hierarchy(), "--json", "m.json", names=["m.json", "No space left"], DISK_WRITES=10)

    def test_medium_that_takes_no_writes(self):
        self.fails_on_disk("build", sphere(), "-o", "m.lode", names=["m.lode", "Input/output error"], DISK_WRITES=100000,
                           DISK_BREAKS=1)

    def test_what_was_there_stays(self):
        self.write("m.lode", "mine")
        self.fails_on_disk("build", sphere(), "-o", "m.lode", names=["m.lode"], DISK_WRITES=100000)


@needs_failing_disk
class EndOfAFile(FaultCase):
    """The last steps fail: a disk across a network tells of its troubles when a file is closed."""

    def test_close_and_rename(self):
        for name, arguments in commands(sphere(), hierarchy()).items():
            if name == "verify":
                continue
            for fault in ("DISK_CLOSES", "DISK_RENAMES"):
                for number in (0, 1):
                    with self.subTest(command=name, fault=fault, after=number):
                        if number and name not in ("tiles", "archive", "page"):
                            continue  # of several files the first one succeeds
                        self.refused(*arguments, "--quiet", names=["Input/output error"],
                                     environment=on_disk(**{fault: number}))

    def test_both_folders(self):
        """Folders that are there have their entries moved up one by one."""
        (self.folder / "tiles").mkdir()
        for number in (40, 80, 120, 160, 10000):
            done = command_case.call("export", hierarchy(), "--tiles", "tiles", "--quiet", cwd=self.folder,
                                     environment=on_disk(DISK_RENAMES=number))
            if done.returncode == 0:
                return
            self.assertEqual(list((self.folder / "tiles").iterdir()), [], done.stderr)
        self.fail("never done")


@needs_failing_disk
class SweepsOnSuchADisk(SweepCase):
    def test_each_step(self):
        self.write("sweep.toml", HEAD + section("x = [1, 2], rows = 3"))
        for fault in ("DISK_TEXTS", "DISK_CLOSES", "DISK_RENAMES", "DISK_SYNCS"):
            for number in range(0, 14, 2):
                with self.subTest(fault=fault, after=number):
                    done = command_case.call("sweep", "sweep.toml", "-o", "out", "--quiet", cwd=self.folder,
                                             environment=on_disk(**{fault: number}))
                    self.assertIn(done.returncode, (0, command_case.NEGATIVE, command_case.INPUT, command_case.FILE))
                    if done.returncode:
                        self.assertRegex(done.stderr.decode(), r"\A(lodestone: [^\n]+\n)+\Z")
                    if (self.folder / "out").exists():
                        self.results("sweep", "sweep.toml", "-o", "out", "--resume", "--quiet")
                        self.check_complete()
                        shutil.rmtree(self.folder / "out")


class LimitOfFileSizes(CommandCase):
    def test_shell_limit(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))

        self.refused("build", sphere(), "-o", "m.lode", names=["m.lode", "File too large"], preexec=limit)
        self.refused("generate", "sphere", "--triangles", 100000, "-o", "m.ply", names=["m.ply", "File too large"],
                     preexec=limit)


if __name__ == "__main__":
    command_case.main(__doc__)
