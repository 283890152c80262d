"""Shards of a sweep under Snakemake, locally and on a Slurm of one node that the test starts and stops.
usage: test_cluster.py PROGRAM"""

import json
import os
import pathlib
import shutil
import subprocess
import unittest

import command_case
from command_case import model
from slurm_case import OUR_CHILD, SlurmCase
from sweep_case import HEAD, SweepCase, section

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLUSTER = ROOT / "experiments/cluster"
SWEEP = HEAD + section("x = [1, 2, 3, 4, 5, 6]", "repetitions = 2")


def snakemake(folder, *arguments, environment=None, **config):
    """Runs it in the folder; returns (status, output)."""
    settings = [f"{key}={value}" for key, value in {"sweep": "sweep.toml", "output": "out", "shards": 3,
                                                    "lodestone": command_case.PROGRAM, **config}.items() if value]
    done = subprocess.run([*OUR_CHILD, "snakemake", "-s", CLUSTER / "Snakefile", *arguments, "--config", *settings],
                          cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300,
                          check=False, env={**os.environ, "XDG_CACHE_HOME": str(folder), **(environment or {})})
    return done.returncode, done.stdout.decode()


class ClusterCase(SweepCase):
    def summary(self):
        return json.loads((self.folder / "out.shards/summary.json").read_text())

    def check_snakemake(self, *arguments, **more):
        status, output = snakemake(self.folder, *arguments, **more)
        self.assertEqual(status, 0, output)
        return output


@unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed (scripts/setup)")
class Locally(ClusterCase):
    def test_shards_are_run_and_gathered(self):
        self.write("sweep.toml", SWEEP)
        self.check_snakemake("--cores", "2")
        self.assertEqual(self.summary(), {"name": "test", "runs": 6, "repetitions": 12, "ran": 12, "failures": []})
        self.check_complete()
        self.check_snakemake("--cores", "2")
        self.assertEqual((self.summary()["runs"], self.summary()["ran"]), (6, 0))
        self.write("sweep.toml", SWEEP.replace("x = [", "x = [7, "))
        self.check_snakemake("--cores", "2")
        self.assertEqual((self.summary()["runs"], self.summary()["ran"]), (7, 2))
        self.check_complete()

    def test_a_second_call_sees_changed_data_and_tries_errors_again(self):
        mesh = self.write("m.ply", model("a.ply", "generate", "box", "--triangles", 12).read_bytes())
        self.write("sweep.toml", 'name = "test"\n[data]\ntiny = { path = "m.ply" }\n' +
                   section('failure = ["none", "error", "verify"]'))
        self.assertIn("2 failed", self.check_snakemake("--cores", "2"))
        self.assertIn("2 failed", self.check_snakemake("--cores", "2"))
        self.assertEqual((self.summary()["ran"], len(self.summary()["failures"])), (1, 2))
        before = self.plan()["data"]["tiny"]["sha256"]
        mesh.write_bytes(model("b.ply", "generate", "sphere", "--triangles", 500).read_bytes())
        self.check_snakemake("--cores", "2")
        self.assertEqual(self.summary()["ran"], 3)
        self.assertNotEqual(self.plan()["data"]["tiny"]["sha256"], before)

    def test_failed_runs_are_gathered_and_errors_are_errors(self):
        self.write("sweep.toml", HEAD + section('failure = ["none", "crash", "verify"]'))
        self.assertIn("2 failed", self.check_snakemake("--cores", "1"))
        self.assertEqual(sorted(failure["kind"] for failure in self.summary()["failures"]), ["crash", "verify"])
        self.write("sweep.toml", HEAD + section("y = 1"))
        status, output = snakemake(self.folder, "--cores", "1", output="other")
        self.assertNotEqual(status, 0)
        self.assertIn("unknown parameter 'y'", output)

    def test_settings_that_are_missing(self):
        status, output = snakemake(self.folder, "--cores", "1", sweep="")  # left out
        self.assertNotEqual(status, 0)
        self.assertIn("--config sweep=... is missing", output)


@unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed (scripts/setup)")
class OnSlurm(SlurmCase, ClusterCase):
    def test_shards_are_jobs(self):
        self.write("sweep.toml", SWEEP)
        output = self.check_snakemake("--profile", CLUSTER / "slurm", "--latency-wait", "10", memory=100, minutes=5,
                                      environment=self.slurm.environment)
        self.assertEqual(output.count("Submitted"), 5, output)  # the data, three shards and the report
        jobs = self.slurm.ask("scontrol", "show", "job", "--oneliner").decode()
        self.assertEqual(jobs.count("JobState=COMPLETED"), 5, jobs)
        self.assertEqual(self.summary(), {"name": "test", "runs": 6, "repetitions": 12, "ran": 12, "failures": []})
        self.check_complete()
        self.assertIn("<html", (self.folder / "out.html").read_text())
        logs = sorted(path.name.rsplit("-", 1)[0] for path in (self.folder / "out.shards/logs").iterdir())
        self.assertEqual(logs, ["prepare", "report", "shard-1", "shard-2", "shard-3"])


if __name__ == "__main__":
    command_case.main(__doc__)
