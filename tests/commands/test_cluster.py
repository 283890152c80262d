"""Shards of a sweep under Snakemake, locally and on a Slurm of one node that the test starts and stops.
usage: test_cluster.py PROGRAM"""

import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time
import unittest

import command_case
from command_case import model
from sweep_case import HEAD, SweepCase, section

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLUSTER = ROOT / "experiments/cluster"
OUR_CHILD = ["setpriv", "--pdeathsig", "TERM"]  # ends with this process, however that ends
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


class Slurm:
    """munged, slurmctld and slurmd of one node on the loopback device, in a folder, as root."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.daemons = []
        self.environment = {"SLURM_CONF": str(self.folder / "slurm.conf")}

    @staticmethod
    def missing():
        """Why there can be none here; empty: there can."""
        programs = [name for name in ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "sinfo", "setpriv")
                    if not shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")]
        if programs:
            return f"not installed: {', '.join(programs)} (scripts/setup)"
        return "" if os.geteuid() == 0 else "slurmd needs root"

    def start(self):
        for name in ("state", "spool", "munge"):
            (self.folder / name).mkdir()
        (self.folder / "munge").chmod(0o711)
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        host = socket.gethostname().split(".")[0]
        (self.folder / "slurm.conf").write_text(self.configuration(host))
        munge = self.folder / "munge"
        self.run_daemon("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={munge}/socket",
                        f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed")
        self.wait_until(lambda: (munge / "socket").exists())
        self.run_daemon("slurmctld", "-D", "-f", self.folder / "slurm.conf")
        self.run_daemon("slurmd", "-D", "-f", self.folder / "slurm.conf", "-N", host)
        self.wait_until(lambda: b"idle" in self.ask("sinfo", "--noheader", "--format=%t"))

    def configuration(self, host):
        ports = []
        for _ in range(2):
            with socket.socket() as free:
                free.bind(("127.0.0.1", 0))
                ports.append(free.getsockname()[1])
        lines = {"ClusterName": "lodestone", "SlurmctldHost": f"{host}(127.0.0.1)", "SlurmUser": "root",
                 "AuthType": "auth/munge", "AuthInfo": f"socket={self.folder}/munge/socket", "CredType": "cred/munge",
                 "SlurmctldPort": ports[0], "SlurmdPort": ports[1], "StateSaveLocation": self.folder / "state",
                 "SlurmdSpoolDir": self.folder / "spool", "SlurmctldPidFile": self.folder / "slurmctld.pid",
                 "SlurmdPidFile": self.folder / "slurmd.pid", "ProctrackType": "proctrack/linuxproc",
                 "TaskPlugin": "task/none", "JobAcctGatherType": "jobacct_gather/none",
                 "AccountingStorageType": "accounting_storage/none", "SelectType": "select/cons_tres",
                 "SelectTypeParameters": "CR_CPU", "MpiDefault": "none", "SwitchType": "switch/none",
                 "ReturnToService": 2, "SchedulerParameters": "sched_interval=1,batch_sched_delay=0",
                 "NodeName": f"{host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=1024 State=UNKNOWN",
                 "PartitionName": f"all Nodes={host} Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:4"}
        return "".join(f"{key}={value}\n" for key, value in lines.items())

    def run_daemon(self, *command):
        """In the foreground."""
        path = {**os.environ, "PATH": os.environ.get("PATH", "") + ":/usr/sbin:/sbin", **self.environment}
        with open(self.folder / f"{command[0]}.out", "wb") as log:
            self.daemons.append(subprocess.Popen([*OUR_CHILD, *map(str, command)], stdout=log, stderr=log, env=path,
                                                 start_new_session=True))

    def ask(self, *command):
        return subprocess.run(command, capture_output=True, timeout=30, check=False,
                              env={**os.environ, **self.environment}).stdout

    def wait_until(self, holds):
        end = time.monotonic() + 40
        while not holds():
            if time.monotonic() > end or any(daemon.poll() is not None for daemon in self.daemons):
                logs = "".join(path.read_text(errors="replace")[-1500:] for path in sorted(self.folder.glob("*.out")))
                raise RuntimeError(f"Slurm does not start here: {logs}")
            time.sleep(0.2)

    def stop(self):
        self.ask("scancel", "--user=root", "--signal=KILL")
        for daemon in reversed(self.daemons):
            daemon.send_signal(signal.SIGTERM)
            try:
                daemon.wait(timeout=10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait(timeout=10)


@unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed (scripts/setup)")
@unittest.skipIf(Slurm.missing(), Slurm.missing())
class OnSlurm(ClusterCase):
    def setUp(self):
        super().setUp()
        (self.folder / "slurm").mkdir()
        self.slurm = Slurm(self.folder / "slurm")
        self.addCleanup(self.slurm.stop)
        try:
            self.slurm.start()
        except (RuntimeError, OSError) as error:
            self.skipTest(str(error))

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
