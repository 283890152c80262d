"""Builds within a limit of memory: the same files, temporary files that go, builds that continue.
usage: test_command_limit.py PROGRAM"""

import os
import random
import resource
import signal
import subprocess
import time

import command_case
from command_case import CommandCase, dirty_mesh, end_by, glb, model, needs_failing_disk, obj, ply

LIMIT = "90MiB"  # building `big` takes more in memory, and less out of core


def big():
    return model("big.ply", "generate", "sphere", "--triangles", 1_600_000)


def expected(*options):
    return model(f"big{'_'.join(options)}.lode", "build", big(), *options).read_bytes()


BUILD = ("--cell-triangles", "1500", "--threads", "2")  # small blocks
OUT_OF_CORE = (*BUILD, "--memory-limit", LIMIT)


class SameFiles(CommandCase):
    def test_within_the_limit(self):
        for options in (BUILD, (*BUILD, "--compress"), (*BUILD, "--strategy", "levels"), (*BUILD, "--lattice", "20")):
            with self.subTest(options=options):
                results = self.results("build", big(), "-o", "m.lode", *options, "--memory-limit", LIMIT)
                self.assertEqual((self.folder / "m.lode").read_bytes(), expected(*options))
                self.assertLess(results["peak_bytes"], 90 << 20)
                self.assertEqual(results["memory_limit"], 90 << 20)
                scratch = results["scratch"]
                self.assertLess(abs(results["scratch_bytes"] / scratch["expected_bytes"] - 1), 0.25, scratch)
                self.assertEqual(scratch["folder"], ".")
                self.assertEqual(set(self.listing()), {"m.lode", "results.json"})

    def test_says_where_temporary_files_go_before_it_begins(self):
        (self.folder / "fast").mkdir()
        said = self.lodestone("build", big(), "-o", "m.lode", *OUT_OF_CORE, "--scratch", "fast")
        self.assertRegex(said, r"\Atemporary files: about \d+\.\d MB in fast\n")
        self.assertEqual(set(self.listing()), {"fast", "m.lode"})
        kept = self.lodestone("build", big(), "-o", "m.lode", *OUT_OF_CORE, "--scratch", "fast", "--resume")
        self.assertRegex(kept, r"\Atemporary files: about \d+\.\d MB in fast/m\.lode\.scratch, kept until")
        self.assertEqual(set(self.listing()), {"fast", "m.lode"})

    def test_in_memory_where_that_fits(self):
        results = self.results("build", big(), "-o", "m.lode", *BUILD, "--memory-limit", "8GiB", "--resume")
        self.assertNotIn("scratch", results)
        self.assertEqual((self.folder / "m.lode").read_bytes(), expected(*BUILD))

    def test_more_files_than_a_shell_lets_be_open(self):
        part = model("part.ply", "generate", "sphere", "--triangles", 300).read_bytes()
        files = [self.write(f"{i}.ply", part) for i in range(60)]
        done = command_case.call("build", *files, "-o", "m.lode", "--memory-limit", "1GiB", "--quiet", cwd=self.folder,
                                 preexec=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (40, 4096)))
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_attributes_can_be_left_out(self):
        points, faces, repairs = dirty_mesh(1)
        self.write("m.ply", ply(points, faces))
        results = self.results("build", "m.ply", "-o", "m.lode", "--memory-limit", "1GiB", "--no-attributes")
        self.assertEqual({name: results["repairs"][name] for name in repairs}, repairs)


class Refusals(CommandCase):
    def test_too_small(self):
        for limit in ("1MiB", "40MiB"):
            line = self.refused("build", big(), "-o", "m.lode", *BUILD, "--memory-limit", limit,
                                names=["big.ply", "MiB of memory; give --memory-limit "])
        need = line.split("--memory-limit ")[1].split()[0]
        results = self.results("build", big(), "-o", "m.lode", *BUILD, "--memory-limit", need)
        self.assertLess(results["peak_bytes"], int(need.removesuffix("MiB")) << 20)

    def test_options_that_need_the_whole_mesh(self):
        for option in ("--measure-error", "--refine"):
            self.refused("build", big(), "-o", "m.lode", *OUT_OF_CORE, option, names=["big.ply", option, "--memory-limit"])

    def test_sizes(self):
        for size in ("", "GiB", "2 GiB", "-1GiB", "0", "2QiB", "nan", "1e30GiB"):
            self.refused("build", big(), "-o", "m.lode", f"--memory-limit={size}")
        self.refused("build", big(), "-o", "m.lode", "--resume", names=["--memory-limit"])
        self.refused("build", big(), "-o", "m.lode", "--scratch", ".", names=["--memory-limit"])

    def test_files_that_must_be_read_as_a_whole(self):
        n = 400
        points = [(x, y, x * y / n) for y in range(n) for x in range(n)]
        faces = [(y * n + x, y * n + x + 1, y * n + x + n) for y in range(n - 1) for x in range(n - 1)]
        self.write("m.obj", obj(points, faces))
        self.write("m.glb", glb(points, faces))
        for name in ("m.obj", "m.glb"):
            for limit in ("1MiB", "25MiB"):
                self.refused("build", name, "-o", "m.lode", "--memory-limit", limit,
                             names=[name, "binary PLY", "--memory-limit "])
            self.results("build", name, "-o", "m.lode", "--memory-limit", "300MiB")
            (self.folder / "m.lode").unlink()
            (self.folder / "results.json").unlink()

    def test_no_folder_for_temporary_files(self):
        for extra in ((), ("--resume",)):
            self.refused("build", big(), "-o", "m.lode", *OUT_OF_CORE, "--scratch", "nowhere", *extra,
                         names=["nowhere", "No such file", "create the folder"])


class Interrupts(CommandCase):
    def start(self, *options):
        return subprocess.Popen([command_case.PROGRAM, "build", str(big()), "-o", "m.lode", *OUT_OF_CORE, "--quiet",
                                 *options], cwd=self.folder, stderr=subprocess.PIPE)

    def seconds(self):
        began = time.monotonic()
        process = self.start()
        process.communicate()
        self.assertEqual(process.returncode, 0)
        (self.folder / "m.lode").unlink()
        return time.monotonic() - began

    def test_nothing_is_left(self):
        seconds = self.seconds()
        for number in (signal.SIGINT, signal.SIGTERM):
            for share in (0.2, 0.5, 0.8):
                ends = []
                while not ends or ends[-1] > 3 and len(ends) < 3:  # under a second where cores are free
                    ends.append(self.end_at(share * seconds, number))
                self.assertLess(ends[-1], 3)

    def end_at(self, seconds, number):
        """The seconds that a build takes to end, after so many and this signal, with nothing left."""
        process = self.start()
        time.sleep(seconds)
        end = end_by(process, number)
        self.assertLess(end.processor_seconds, 1)
        if process.returncode:
            self.assertEqual((process.returncode, end.errors),
                             (128 + number, b"lodestone: interrupted; no unfinished file was left\n"))
        if left := self.listing():  # the signal came between the last step, which names the file, and the end
            self.assertTrue(left == {"m.lode": expected(*BUILD)}, f"left unfinished: {[*left]}")
            (self.folder / "m.lode").unlink()
        return end.seconds

    def test_killed_and_continued(self):
        seconds, moments, stopped, said = self.seconds(), random.Random(1), 0, []
        for trial in range(20):  # until enough of them came in time, on a machine that has more to do now and then
            if trial >= 4 and stopped > 4:
                break
            number = (signal.SIGKILL, signal.SIGINT)[trial % 2]
            for interruption in range(8):
                process = self.start("--resume")
                if interruption < 7:
                    time.sleep(moments.uniform(0.1, 0.8) * seconds)
                    process.send_signal(number)
                errors = process.communicate(timeout=60)[1].decode()
                if process.returncode == 0:
                    break
                stopped += 1
                if number == signal.SIGINT and process.returncode > 0:
                    said.append(errors)
                    # The signal may come when the file is there already and only the clearing up is left.
                    if "m.lode" in os.listdir(self.folder):
                        self.assertEqual((self.folder / "m.lode").read_bytes(), expected(*BUILD), trial)
                    self.assertLessEqual(set(os.listdir(self.folder)), {"m.lode", "m.lode.scratch"})
            self.assertEqual((self.folder / "m.lode").read_bytes(), expected(*BUILD), trial)
            self.assertEqual(os.listdir(self.folder), ["m.lode"])
            (self.folder / "m.lode").unlink()
        self.assertGreater(stopped, 4)
        kept = "lodestone: interrupted; --resume continues from the temporary files that were kept\n"
        self.assertIn(kept, said)
        # A signal that comes while the program still reads its options finds nothing begun.
        self.assertLessEqual(set(said), {kept, "lodestone: interrupted; no unfinished file was left\n"})

    def test_continues_where_it_was(self):
        (self.folder / "m.lode.tmp.4000000.0").write_bytes(b"of a killed process")
        for _ in range(20):
            process = self.start("--resume")
            while process.poll() is None and not self.has_blocks():
                time.sleep(0.002)
            process.kill()
            process.communicate()
            if process.returncode:
                break
        results = self.results("build", big(), "-o", "m.lode", *OUT_OF_CORE, "--resume")
        self.assertGreater(results["scratch"]["blocks_resumed"], 0)
        self.assertIn("resume", results["stages"])
        self.assertEqual((self.folder / "m.lode").read_bytes(), expected(*BUILD))
        self.assertEqual(set(self.listing()), {"m.lode", "results.json"})

    def has_blocks(self):
        cells = self.folder / "m.lode.scratch" / "cells"
        return cells.exists() and cells.stat().st_size > 1 << 20

    def test_of_another_build(self):
        process = self.start("--resume")
        while process.poll() is None and not self.has_blocks():
            time.sleep(0.002)
        process.kill()
        process.communicate()
        self.refused("build", big(), "-o", "m.lode", "--memory-limit", LIMIT, "--resume", "--cell-triangles", 1501,
                     names=["m.lode.scratch", "with other parameters", "remove it"])


@needs_failing_disk
class Disks(CommandCase):
    def test_full(self):
        whole = 36 * 1_600_000
        for share in (0.05, 0.5, 1, 1.8):
            with self.subTest(share=share):
                self.fails_on_disk("build", big(), "-o", "m.lode", *OUT_OF_CORE, "--quiet",
                                   names=["No space left", "free some space"], DISK_WRITES=int(share * whole))

    def test_input_that_fails_or_becomes_shorter(self):
        size = big().stat().st_size
        for share in (0.1, 0.9, 1.5, 2.5):
            build = ("build", big(), "-o", "m.lode", *OUT_OF_CORE, "--quiet")
            self.fails_on_disk(*build, names=["big.ply", "byte", "cannot read"], DISK_READS=int(share * size))
            self.fails_on_disk(*build, names=["big.ply", "byte", "the file ends here"], DISK_READS=int(share * size),
                               DISK_ENDS=1)


if __name__ == "__main__":
    command_case.main(__doc__)
