"""lodestone-mpi under its launcher and on Slurm: the bytes of lodestone build, figures of every rank, and ranks that
end early.
usage: LODESTONE_MPI=PROGRAM LAUNCHER=mpirun test_distributed.py PROGRAM"""

import contextlib
import json
import os
import pathlib
import pty
import signal
import subprocess
import tempfile
import unittest

import command_case
from command_case import FILE, INPUT, RESOURCE, SOURCE, USAGE, CommandCase, model, processes_in, until
from slurm_case import SlurmCase

# Open MPI: more ranks than processors, also as root in a container.
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none"}
SCRIPT = SOURCE / "experiments/cluster/lodestone-mpi.sbatch"
SCAN = SOURCE / "build/data/scans/lucy100k.ply"
TILES = SOURCE / "build/data/textured/komaba_tiles_022"


def surface():
    """A scan, or a generated surface where the models are not unpacked."""
    return SCAN if SCAN.exists() else model("small.ply", "generate", "sphere", "--triangles", 100_000)


def workers(threads):
    """As many as one process has of `threads`: one in a build without oneTBB."""
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder, "m.json")
        done = command_case.call("build", surface(), "-o", report.with_suffix(".lode"), "--threads", threads, "--json", report,
                                 "--quiet", cwd=folder)
        assert done.returncode == 0, done.stderr
        return json.loads(report.read_text())["threads"]


def command(ranks, *arguments, subcommand="build"):
    return [os.environ["LAUNCHER"], "-n", str(ranks), os.environ["LODESTONE_MPI"], subcommand, *map(str, arguments)]


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class DistributedCase(CommandCase):
    def assert_refused(self, done, status, *words):
        """With one line of the program, whatever the launcher adds, and no output."""
        self.assertEqual(done.returncode, status, done.stderr)
        lines = [line for line in done.stderr.splitlines() if line.startswith("lodestone")]
        self.assertEqual(len(lines), 1, done.stderr)
        for word in words:
            self.assertIn(word, lines[0])
        self.assertEqual(self.listing(), {})

    def kill_one(self, ranks):
        """When there are so many ranks in the folder."""
        program = os.environ["LODESTONE_MPI"]
        pids = until(lambda: processes_in(self.folder, lambda words: words[0] == program)[ranks - 1:], f"{ranks} ranks")
        os.kill(pids[0], signal.SIGKILL)


class UnderLauncher(DistributedCase):
    def job(self, ranks, *arguments, subcommand="build"):
        return subprocess.run(command(ranks, *arguments, subcommand=subcommand), cwd=self.folder, capture_output=True,
                              timeout=300, text=True, env=ENVIRONMENT, check=False)

    def built(self, ranks, *arguments):
        done = self.job(ranks, *arguments, "-o", "m.lode", "--json", "m.json", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(set(self.listing()), {"m.lode", "m.json"})
        return (self.folder / "m.lode").read_bytes(), json.loads((self.folder / "m.json").read_text())

    def test_same_bytes_for_any_ranks_and_threads(self):
        expected = model("expected.lode", "build", surface(), "--no-attributes").read_bytes()
        for ranks, threads in ((1, 2), (2, 1), (3, 2), (5, 1)):
            with self.subTest(ranks=ranks, threads=threads):
                built, figures = self.built(ranks, surface(), "--no-attributes", "--threads", threads)
                self.assertTrue(built == expected)
                self.assertEqual(len(figures["ranks"]), ranks)
                self.assertEqual(figures["threads"], workers(threads))
                self.assertEqual(sum(rank["triangles"] for rank in figures["ranks"]), figures["input_triangles"])
                self.assertEqual(sum(rank["bytes_sent"] for rank in figures["ranks"]), figures["bytes_sent"])
                for rank in figures["ranks"]:
                    self.assertGreater(rank["peak_bytes"], 1 << 20)
                    self.assertTrue(rank["host"])
                for value in figures["imbalance"].values():
                    self.assertGreaterEqual(value, 1)

    def test_several_files_are_one_mesh(self):
        other = model("ball.ply", "generate", "sphere", "--triangles", 3000)
        files = [surface(), other, *(folder for folder in [TILES] if folder.exists())]
        self.assertTrue(self.built(3, *files, "--up", "z", "--no-attributes")[0] ==
                        model("files.lode", "build", *files, "--up", "z", "--no-attributes").read_bytes())

    def test_attributes_and_halved_textures(self):
        expected = model("halved.lode", "build", command_case.TEXTURED, "--texture-levels").read_bytes()
        for ranks in (1, 3):
            self.assertTrue(self.built(ranks, command_case.TEXTURED, "--texture-levels")[0] == expected, ranks)

    def test_a_generated_surface_needs_no_file(self):
        made = model("terrain.ply", "generate", "terrain", "--triangles", 50_000, "--seed", 5)
        expected = model("terrain.lode", "build", made).read_bytes()
        self.assertTrue(self.built(3, "--generate", "terrain:5e4:5", "--threads", 1)[0] == expected)

    def test_all_ranks_have_one_bar_on_the_terminal(self):
        pid, terminal = pty.fork()
        if pid == 0:
            os.chdir(self.folder)
            job = command(3, "--generate", "sphere:3e5", "-o", "m.lode", "--threads", 1)
            os.execvpe(job[0], job, ENVIRONMENT)
        shown = b""
        with contextlib.suppress(OSError):  # the end of a terminal
            while part := os.read(terminal, 1 << 16):
                shown += part
        os.close(terminal)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), 0, shown)
        for work in ("reading", "welding", "sorting", "building level 1"):
            self.assertEqual(shown.count(f"\r{work} ...".encode()), 1, shown)

    def test_a_trace_has_a_process_for_each_rank(self):
        done = self.job(2, "--generate", "sphere:2e5", "-o", "m.lode", "--threads", 1, "--trace", "trace.json", "--quiet",
                        "--json", "m.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        events = json.loads((self.folder / "trace.json").read_text())["traceEvents"]
        names = {event["pid"]: event["args"]["name"] for event in events if event["name"] == "process_name"}
        self.assertEqual([names[rank].split(" on ")[0] for rank in (0, 1)], ["rank 0", "rank 1"])
        figures = json.loads((self.folder / "m.json").read_text())
        for rank in (0, 1):
            own = [event for event in events if event["pid"] == rank and event["ph"] == "X"]
            stages = [event for event in own if event["tid"] == 1]
            self.assertEqual([stage["name"] for stage in stages], ["reading", "sorting", "sharing", "building", "writing"])
            waits = [event for event in own if event["name"] == "wait"]
            # The last stage ends after its figures were taken, which have to be gathered.
            for stage, name in zip(stages, ("clean", "route", "finest", "levels")):
                within = [wait for wait in waits if stage["ts"] <= wait["ts"] < stage["ts"] + stage["dur"]]
                waited = sum(wait["dur"] for wait in within) * 1e-6
                self.assertLessEqual(waited, figures["ranks"][rank]["stages"][name]["waited_seconds"] + 1e-6 * len(within))
            self.assertGreater(sum(wait["dur"] for wait in waits), 0)
            self.assertTrue(any(event["tid"] == 0 for event in own))
        self.assertLess(figures["waited_share"], 1)

    def test_runs_without_a_launcher(self):
        done = subprocess.run(command(1, "--generate", "sphere:2000", "-o", "m.lode")[3:], cwd=self.folder,
                              capture_output=True, timeout=60, text=True, env=ENVIRONMENT, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("by 1 ranks", done.stdout)

    def test_tiles_are_those_of_one_process(self):
        lode = model("textured.lode", "build", command_case.TEXTURED, "--cell-triangles", 100)
        command_case.call("export", lode, "--tiles", self.folder / "expected", "--morph")
        expected = contents(self.folder / "expected")
        done = self.job(3, lode, "--tiles", "tiles", "--morph", "--threads", 1, "--json", "tiles.json", "--quiet",
                        subcommand="export")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(contents(self.folder / "tiles") == expected)
        figures = json.loads((self.folder / "tiles.json").read_text())
        self.assertEqual([rank["rank"] for rank in figures["ranks"]], [0, 1, 2])
        self.assertEqual(sum(rank["tiles"] for rank in figures["ranks"]), figures["tiles"])
        self.assertEqual(sum(map(len, expected.values())), figures["bytes"])

    def test_tiles_are_refused_in_one_line(self):
        for arguments, status, words in (
                (("missing.lode", "--tiles", "tiles"), FILE, ["rank ", "missing.lode: cannot open"]),
                ((command_case.TEXTURED, "--tiles", "tiles"), INPUT, ["rank "]),
                (("missing.lode",), USAGE, ["--tiles"]), (("missing.lode", "--tiles", ""), USAGE, ["--tiles"])):
            self.assert_refused(self.job(3, *arguments, subcommand="export"), status, *words)

    def test_verify_says_what_one_process_says(self):
        for lode in (model("for-ranks.lode", "build", surface(), "--cell-triangles", 300),
                     model("textured.lode", "build", command_case.TEXTURED, "--cell-triangles", 100)):
            with self.subTest(lode=lode.name):
                self.check_verified(lode)

    def check_verified(self, lode):
        expected = self.folder / "one.json"
        command_case.call("verify", lode, "--json", expected)
        done = self.job(3, lode, "--threads", 1, "--json", "ranks.json", subcommand="verify")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("holds identity", done.stdout)
        self.assertIn(f"{lode}: valid", done.stdout)
        one, ranks = (json.loads((self.folder / name).read_text()) for name in ("one.json", "ranks.json"))
        self.assertEqual({key: ranks[key] for key in one}, one)
        self.assertEqual([rank["rank"] for rank in ranks["ranks"]], [0, 1, 2])
        self.assertTrue(all(rank["cells"] > 0 and rank["bytes_sent"] > 0 for rank in ranks["ranks"]))

    def test_verify_refuses_in_one_line(self):
        for arguments, status, words in (
                (("missing.lode",), FILE, ["rank ", "missing.lode: cannot open"]),
                ((), USAGE, ["FILE"])):
            self.assert_refused(self.job(3, *arguments, subcommand="verify"), status, *words)

    def plan(self, *arguments):
        return subprocess.run([os.environ["LODESTONE_MPI"], "plan", *map(str, arguments)], cwd=self.folder,
                              capture_output=True, timeout=60, text=True, env=ENVIRONMENT, check=False)

    def test_a_plan_tells_what_a_build_reports(self):
        self.assertEqual(self.job(1, "--generate", "sphere:60000", "-o", "m.lode").returncode, 0)
        done = self.plan("m.lode", "--ranks", "3,512", "--json", "plan.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("512 ranks: imbalance", done.stdout)
        plan = json.loads((self.folder / "plan.json").read_text())
        (self.folder / "plan.json").unlink()
        (self.folder / "m.lode").unlink()
        _, figures = self.built(3, "--generate", "sphere:60000")
        self.assertAlmostEqual(plan["plans"][0]["imbalance"], figures["imbalance"]["triangles"])
        moved = sum(rank["stages"]["levels"]["bytes_sent"] for rank in figures["ranks"])
        self.assertLess(0, moved - plan["plans"][0]["moved_bytes"])
        self.assertLess(moved - plan["plans"][0]["moved_bytes"], 40 * 6 * figures["rounds"])
        self.assertEqual([plan["plans"][1][key] for key in ("ranks", "samples")], [512, plan["triangles"]])

    def test_a_plan_refuses_what_is_no_number_or_no_file(self):
        self.assert_refused(self.plan("m.lode", "--ranks", "2,x"), USAGE, "'x' is not a number of ranks")
        self.assert_refused(self.plan("m.lode", "--ranks", ","), USAGE, "--ranks")
        self.assert_refused(self.plan("missing.lode"), FILE, "missing.lode")

    def test_errors_are_one_line_of_one_rank(self):
        self.assert_refused(self.job(3, "missing.ply", "-o", "m.lode"), FILE, "rank 0 on ", "missing.ply: cannot open")
        self.assert_refused(self.job(2, surface(), "-o", "no/m.lode"), FILE, "rank 0 on ", "no/m.lode")
        self.assert_refused(self.job(2, surface(), "-o", "m.lode", "--ranks"), USAGE, "lodestone-mpi build --help")
        self.assert_refused(self.job(2, "-o", "m.lode"), USAGE, "either files or --generate")
        self.assert_refused(self.job(2, surface(), "--generate", "sphere:100", "-o", "m.lode"), USAGE, "--generate")

    def test_a_limit_is_kept_with_temporary_files(self):
        job = ("--generate", "sphere:2e6", "--cell-triangles", 300, "--threads", 1)
        expected, figures = self.built(2, *job)
        self.assertFalse(figures["spilled"])
        for name in ("m.lode", "m.json"):
            (self.folder / name).unlink()
        done = self.job(2, *job, "-o", "m.lode", "--memory-limit", "1MiB")
        self.assert_refused(done, RESOURCE, "generated surface: building by ranks needs ", "give --memory-limit ")
        least = done.stderr.split("--memory-limit ")[1].split("MiB")[0]
        built, figures = self.built(2, *job, "--memory-limit", f"{least}MiB")
        self.assertTrue(built == expected)
        self.assertTrue(figures["spilled"])
        self.assertEqual(figures["memory_limit"], int(least) << 20)
        for rank in figures["ranks"]:
            self.assertLess(rank["peak_bytes"], int(least) << 20)

    def test_limits_are_refused_in_one_line(self):
        small = ("--generate", "sphere:5000", "-o", "m.lode")
        self.assert_refused(self.job(2, *small, "--memory-limit", "much"), USAGE, "--memory-limit")
        for option in (("--scratch", "."), ("--resume",)):
            self.assert_refused(self.job(2, *small, *option), USAGE, option[0], "--memory-limit")

    def test_attributes_have_to_fit_the_limit(self):
        self.assert_refused(self.job(2, command_case.TEXTURED, "-o", "m.lode", "--memory-limit", "32MiB"), RESOURCE,
                            "attributes", "--no-attributes", "give --memory-limit ", "more ranks")
        built, figures = self.built(2, command_case.TEXTURED, "--memory-limit", "1GiB", "--threads", 1)
        self.assertTrue(built == model("limited.lode", "build", command_case.TEXTURED).read_bytes())
        self.assertFalse(figures["spilled"])

    def temporary_files(self):
        """Those without names that processes have open in the folder."""
        found = []
        for pid in processes_in(self.folder, lambda words: words[0] == os.environ["LODESTONE_MPI"]):
            for descriptor in pathlib.Path(f"/proc/{pid}/fd").iterdir():
                with contextlib.suppress(OSError):  # closed meanwhile
                    if os.readlink(descriptor).startswith(f"{self.folder}/scratch/"):
                        found.append(descriptor)
        return found

    def test_an_interrupted_job_leaves_no_temporary_file(self):
        (self.folder / "scratch").mkdir()
        with subprocess.Popen(command(2, "--generate", "sphere:4e6", "-o", "m.lode", "--threads", 1, "--memory-limit",
                                      "170MiB", "--scratch", "scratch", "--quiet"),
                              cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=ENVIRONMENT) as job:
            until(self.temporary_files, "temporary files", timeout=60)
            job.send_signal(signal.SIGINT)
            self.assertNotEqual(job.wait(60), 0)
        self.assertEqual(self.listing(), {"scratch": None})
        self.assertEqual(list((self.folder / "scratch").iterdir()), [])

    def test_an_interrupted_job_continues_with_other_ranks(self):
        surface = ("--generate", "sphere:3e6", "--threads", 1)
        expected, _ = self.built(2, *surface)
        for name in ("m.lode", "m.json"):
            (self.folder / name).unlink()

        def start(job):
            def cells():
                return sum(file.stat().st_size for file in self.folder.glob("m.lode.scratch/cells-*"))
            before = cells()
            process = subprocess.Popen(job, cwd=self.folder, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
            until(lambda: cells() > before + (4 << 20), "blocks in the files", timeout=60)
            return process

        def ended(process):
            _, said = process.communicate(timeout=60)
            self.assertNotEqual(process.returncode, 0)
            self.assertEqual({name.split(".tmp")[0] for name in os.listdir(self.folder)}, {"m.lode.scratch"})
            return said

        job = (*surface, "-o", "m.lode", "--quiet", "--resume", "--memory-limit")
        process = start(command(3, *job, "118MiB"))
        self.kill_one(3)
        ended(process)
        process = start(command(1, *job, "160MiB")[3:])  # a launcher may end before it passes on what is said
        process.send_signal(signal.SIGINT)
        self.assertEqual(ended(process), "lodestone-mpi: interrupted; --resume continues from the temporary files that "
                                         "were kept\n")
        built, figures = self.built(2, *surface, "--resume", "--memory-limit", "118MiB")
        self.assertTrue(built == expected)
        self.assertGreater(sum(rank["blocks_resumed"] for rank in figures["ranks"]), 10)

    def test_a_rank_that_is_killed_ends_the_job_without_a_file(self):
        with subprocess.Popen(command(3, "--generate", "sphere:20e6", "-o", "m.lode", "--threads", 1, "--quiet"),
                              cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              env=ENVIRONMENT) as job:
            self.kill_one(3)
            self.assertNotEqual(job.wait(60), 0)
            self.assertIn("signal 9", job.stdout.read())
        self.assertEqual(self.listing(), {})


class OnSlurm(SlurmCase, DistributedCase):
    """Two nodes, which are one machine."""

    nodes = 2

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.environment = {**ENVIRONMENT, **cls.slurm.environment}
        for plugin in ("pmix", "pmi2"):  # of Open MPI, of MPICH
            cls.environment["SLURM_MPI_TYPE"] = plugin
            if cls.srun(2, "--version", cwd=None).stdout.count("\n") == 1:  # one job, not two of one rank
                return
        raise unittest.SkipTest("Slurm has no plugin that starts this MPI")

    @classmethod
    def srun(cls, ranks, *arguments, cwd):
        return subprocess.run(["srun", "--nodes=2", f"--ntasks={ranks}", "--kill-on-bad-exit=1",
                               os.environ["LODESTONE_MPI"], *map(str, arguments)], cwd=cwd, capture_output=True,
                              timeout=60, text=True, env=cls.environment, check=False)

    def batch(self, *arguments):
        """The script as a job; its log is m.txt."""
        return subprocess.Popen(["sbatch", "--wait", "--quiet", "--cpus-per-task=2", "--mem=500M", "--output=m.txt", SCRIPT,
                                 *map(str, arguments)], cwd=self.folder, env=self.environment)

    def test_the_same_bytes(self):
        expected = model("expected.lode", "build", surface(), "--no-attributes").read_bytes()
        done = self.srun(3, "build", surface(), "--no-attributes", "-o", "m.lode", "--threads", 1, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("by 3 ranks of 1 threads", done.stdout)
        self.assertTrue((self.folder / "m.lode").read_bytes() == expected)
        with self.batch(surface(), "--no-attributes", "-o", "b.lode") as job:
            self.assertEqual(job.wait(60), 0)
        self.assertIn(f"by 2 ranks of {workers(2)} threads", (self.folder / "m.txt").read_text())
        self.assertTrue((self.folder / "b.lode").read_bytes() == expected)

    def test_an_error_is_one_line(self):
        self.assert_refused(self.srun(2, "build", "missing.ply", "-o", "m.lode", cwd=self.folder), FILE,
                            "rank 0 on ", "missing.ply: cannot open")

    def test_a_rank_that_is_killed_ends_the_job_of_the_script(self):
        with self.batch("--generate", "sphere:20e6", "-o", "m.lode", "--quiet") as job:
            self.kill_one(2)
            self.assertNotEqual(job.wait(60), 0)
        self.assertIn("Killed", (self.folder / "m.txt").read_text())
        self.assertEqual(set(self.listing()), {"m.txt"})


if __name__ == "__main__":
    command_case.main(__doc__)
