"""Commands that are killed: what lies under a final name is whole, and the same command again ends as if nothing had been.
usage: [KILLS=N] test_command_kill.py PROGRAM

Each command is killed once, or KILLS / 10 times, at random moments; sweeps are in test_command_sweep_kill.py."""

import os
import random
import subprocess
import time

import command_case
from command_case import hierarchy, sphere
from fault_case import FaultCase, commands, content

KILLS = int(os.environ.get("KILLS", "10"))
KILLED = ("build", "compressed", "export", "tiles", "archive", "render", "progressive", "reconstruct", "spherical", "page")


def is_temporary(name):
    return ".tmp." in name


class Killed(FaultCase):
    def kill_at(self, share, arguments, seconds):
        """True if it was killed, and had not ended before."""
        process = subprocess.Popen([command_case.PROGRAM, *map(str, arguments)], cwd=self.folder / "work",
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        try:
            process.wait(timeout=share * seconds)
        except subprocess.TimeoutExpired:
            process.kill()
        errors = process.communicate()[1].decode()
        self.assertIn(process.returncode, (0, -9), errors)
        return process.returncode == -9

    def check_what_is_there(self, name, expected):
        """Of pictures any number, of all else everything or nothing."""
        found = {file: data for file, data in content(self.folder / "work").items() if not is_temporary(file)}
        self.assertEqual([file for file in found if found[file] != expected.get(file)], [])
        if name != "render":
            self.assertIn(set(found), (set(), set(expected)))

    def clear(self, name, chance):
        """An empty folder to work in; now and then with the empty folder that is to be written."""
        work = self.folder / "work"
        subprocess.run(["rm", "-rf", work], check=True)
        work.mkdir()
        if name in ("tiles", "page") and chance.random() < 0.5:
            (work / name).mkdir()

    def test_pictures_and_maps(self):
        """Temporaries of files in a folder that a command fills; what others have there is kept."""
        work = self.folder / "work"
        arguments = commands(sphere(), hierarchy())
        maps = ("reconstruct", sphere(), "-o", "r.ply", "--resolution", 32, "--maps", "frames")
        for command, left in ((arguments["render"], ("frame0001.png", "contact.png")), (maps, ("view000.exr", "views.json"))):
            self.clear("", random)
            (work / "frames").mkdir()
            kept = work / "frames/mine.png.tmp.1.2"
            kept.touch()
            for file in left:
                (work / f"frames/{file}.tmp.1.2").touch()
            done = command_case.call(*command, "--quiet", cwd=work)
            self.assertEqual((done.returncode, done.stderr.decode()), (0, ""))
            self.assertEqual([p for p in work.rglob("*") if is_temporary(p.name)], [kept])

    def test_at_random_moments(self):
        chance, killed = random.Random(22), 0
        for name in KILLED:
            arguments = (*commands(sphere(), hierarchy(), frames=8)[name], "--quiet")
            began = time.monotonic()
            expected = self.expected(arguments)
            seconds = time.monotonic() - began
            subprocess.run(["rm", "-rf", self.folder / "expected"], check=True)
            for i in range(max(1, KILLS // len(KILLED))):
                with self.subTest(command=name, kill=i):
                    self.clear(name, chance)
                    share = chance.uniform(0.05, 1)
                    while not self.kill_at(share, arguments, seconds):  # a faster run than the first one
                        self.clear(name, chance)
                        share *= 0.8
                    killed += 1
                    self.check_what_is_there(name, expected)
                    had_ended = name in ("tiles", "page") and content(self.folder / "work") == expected
                    done = command_case.call(*arguments, cwd=self.folder / "work")
                    if had_ended:  # but for its exit
                        self.assertEqual(done.returncode, command_case.FILE)
                        self.assertRegex(done.stderr.decode(), r"\Alodestone: \w+: is not empty")
                    else:
                        self.assertEqual((done.returncode, done.stderr.decode()), (0, ""))
                    self.assertEqual(content(self.folder / "work"), expected)
                    self.assertEqual([p for p in (self.folder / "work").rglob("*") if is_temporary(p.name)], [])
        self.assertGreaterEqual(killed, len(KILLED))


if __name__ == "__main__":
    command_case.main(__doc__)
