"""Sweeps that are killed, shared, interrupted, or meet a full disk: no row is lost, doubled or half there.
usage: test_command_sweep_kill.py PROGRAM"""

import json
import os
import random
import signal
import subprocess
import time

import command_case
from command_case import needs_failing_disk, on_disk, until
from sweep_case import HEAD, SweepCase, children_in, end_quietly, kill, section, start

INTERRUPTED = "lodestone: interrupted; finished runs were kept, --resume continues\n"


class Killed(SweepCase):
    def test_at_random_fifty_times(self):
        chance = random.Random(20)
        self.write("sweep.toml", HEAD + section("x = { from = 1, to = 20, count = 20 }, rows = 200, seconds = 0.02",
                                                "repetitions = 3"))
        seen, kills = {}, 0
        while kills < 50:
            process = start("sweep.toml", "-o", "out", "--resume", "--jobs", chance.choice([1, 1, 3]), cwd=self.folder)
            try:
                process.wait(timeout=chance.uniform(0.02, 0.5))
            except subprocess.TimeoutExpired:
                pass
            kill(process, group=chance.random() < 0.5)
            kills += 1
            self.check_rows_so_far(seen)
            if chance.random() < 0.1 and seen:  # so that there is work to the end
                path = chance.choice(sorted(seen))
                path.unlink()
                del seen[path]
        summary = self.results("sweep", "sweep.toml", "-o", "out", "--resume", "--quiet", "--jobs", 2)
        self.assertEqual((summary["before"], summary["repetitions"]), (len(seen), 60))
        self.check_rows_so_far(seen)
        self.assertEqual(len(seen), 60)
        self.check_complete()

    def check_rows_so_far(self, seen):
        """Each file of rows is whole, has its manifest, and is the one that was there before."""
        for path in (self.folder / "out").glob("runs/*/rows.*.jsonl"):
            status = path.stat()
            mark = (status.st_ino, status.st_mtime_ns)
            self.assertEqual(seen.setdefault(path, mark), mark, "written twice")
            parameters = json.loads((path.parent / "parameters.json").read_text())["parameters"]
            self.check_rows(path.parent.name, parameters, path.name.split(".")[1])
            json.loads((path.parent / path.name.replace("rows", "manifest").replace("jsonl", "json")).read_text())
        self.assertEqual(list((self.folder / "out").glob("runs/*/fault.*")), [])
        for path in seen:
            self.assertTrue(path.exists(), "lost")

    def test_child_alone(self):
        self.write("sweep.toml", HEAD + section("seconds = 30"))
        process = start("sweep.toml", "-o", "out", "--quiet", cwd=self.folder)
        os.kill(until(lambda: children_in(self.folder), "a child")[0], signal.SIGKILL)
        status, _, errors = end_quietly(process)
        self.assertEqual(status, 1)
        self.assertIn("1 of 1 repetitions failed", errors)
        self.assertIn("ended by signal 9", errors)
        self.check_clean()

    def test_parent_alone_takes_its_children_with_it(self):
        self.write("sweep.toml", HEAD + section("seconds = 30"))
        process = start("sweep.toml", "-o", "out", "--quiet", cwd=self.folder)
        until(lambda: children_in(self.folder), "a child")
        kill(process, group=False)
        until(lambda: not children_in(self.folder), "the end of its children", 10)


class Interrupted(SweepCase):
    def test_by_signal(self):
        for number, group in ((signal.SIGINT, True), (signal.SIGTERM, False)):
            with self.subTest(signal=number):
                output = f"out{number}"
                self.write("sweep.toml", HEAD + section("x = [1, 2], seconds = [0, 30]"))
                process = start("sweep.toml", "-o", output, "--quiet", "--jobs", 4, cwd=self.folder)
                until(lambda: len(self.rows_so_far(output)) == 2 and children_in(self.folder), "two rows and a child")
                began = time.monotonic()
                os.killpg(process.pid, number) if group else process.send_signal(number)
                status, _, errors = end_quietly(process)
                self.assertLess(time.monotonic() - began, 10)
                self.assertEqual(status, 128 + number)
                self.assertEqual(errors, INTERRUPTED)
                self.check_clean(output)
                self.assertEqual(len(self.rows_so_far(output)), 2)
                self.assertEqual(list(self.folder.glob(f"{output}/runs/*/fault.*")), [])

    def test_while_children_start(self):
        """A child that has yet to become itself says nothing in the sweep's place."""
        chance = random.Random(21)
        self.write("sweep.toml", HEAD + section("x = { from = 1, to = 500, count = 500 }"))
        for i in range(10):
            output = f"out{i}"
            process = start("sweep.toml", "-o", output, "--quiet", "--jobs", 8, cwd=self.folder)
            until(lambda: self.rows_so_far(output), "rows")
            time.sleep(chance.uniform(0, 0.2))
            os.killpg(process.pid, signal.SIGINT)
            status, _, errors = end_quietly(process)
            self.assertEqual((status, errors), (128 + signal.SIGINT, INTERRUPTED))
            self.check_clean(output)
            self.assertEqual(list(self.folder.glob(f"{output}/runs/*/fault.*")), [])


class Shared(SweepCase):
    def test_two_and_three_processes(self):
        for count in (2, 3):
            with self.subTest(processes=count):
                self.write("sweep.toml", HEAD + section("x = { from = 1, to = 12, count = 12 }, seconds = 0.03",
                                                        "repetitions = 2"))
                output = f"out{count}"
                processes = [start("sweep.toml", "-o", output, "--resume", "--quiet", "--json", f"{i}.json",
                                   cwd=self.folder) for i in range(count)]
                for process in processes:
                    self.assertEqual(end_quietly(process), (0, "", ""))
                parts = [json.loads((self.folder / f"{i}.json").read_text()) for i in range(count)]
                self.assertEqual(sum(part["ran"] for part in parts), 24)  # none twice
                self.check_complete(output)

    def test_work_of_a_killed_process_is_taken_over(self):
        self.write("sweep.toml", HEAD + section("x = [1, 2], seconds = 0.3"))
        first = start("sweep.toml", "-o", "out", "--resume", "--quiet", cwd=self.folder)
        second = start("sweep.toml", "-o", "out", "--resume", "--quiet", cwd=self.folder)
        time.sleep(0.25)
        kill(first, group=True)
        self.assertEqual(end_quietly(second)[0], 0)
        self.check_complete()

    def test_data_is_made_once(self):
        text = HEAD.replace("triangles = 12", "triangles = 300000") + section("x = [1, 2]")
        self.write("sweep.toml", text)
        processes = [start("sweep.toml", "-o", "out", "--resume", "--quiet", cwd=self.folder) for _ in range(3)]
        for process in processes:
            self.assertEqual(end_quietly(process), (0, "", ""))
        self.check_complete()


@needs_failing_disk
class FullDisk(SweepCase):
    def test_ends_the_sweep_and_loses_nothing(self):
        self.write("sweep.toml", HEAD + section("x = [1, 2, 3], rows = 50"))
        failed = 0
        for room in range(0, 40000, 1500):
            done = command_case.call("sweep", "sweep.toml", "-o", "out", "--resume", "--quiet", cwd=self.folder,
                                     environment=on_disk(DISK_WRITES=room))
            line = done.stderr.decode()
            if done.returncode == 0:
                continue
            failed += 1
            self.assertIn(done.returncode, (command_case.NEGATIVE, command_case.FILE), line)
            self.assertEqual(done.stdout, b"")
            self.assertRegex(line, r"\Alodestone: [^\n]+\n\Z")
            self.assertRegex(line, "No space left|cannot be written")
            self.check_clean() if (self.folder / "out").exists() else None
        self.assertGreater(failed, 0)
        self.results("sweep", "sweep.toml", "-o", "out", "--resume", "--quiet")
        self.check_complete()


if __name__ == "__main__":
    command_case.main(__doc__)
