"""A Slurm of some nodes on this machine, which a class of tests starts and stops."""

import contextlib
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest

from command_case import processes_in

OUR_CHILD = ["setpriv", "--pdeathsig", "TERM"]  # ends with this process, however that ends


class Slurm:
    """munged, slurmctld and a slurmd for each node, all on the loopback device, in a folder, as root."""

    def __init__(self, folder, nodes):
        self.folder = pathlib.Path(folder)
        self.nodes = [f"n{i + 1}" for i in range(nodes)]
        self.daemons = []
        self.environment = {"SLURM_CONF": str(self.folder / "slurm.conf")}

    @staticmethod
    def missing():
        """Why there can be none here; empty: there can."""
        programs = [name for name in ("munged", "slurmctld", "slurmd", "sbatch", "srun", "scontrol", "sinfo", "setpriv")
                    if not shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")]
        if programs:
            return f"not installed: {', '.join(programs)} (scripts/setup)"
        return "" if os.geteuid() == 0 else "slurmd needs root"

    def start(self):
        for name in ("state", "munge", *(f"{kind}-{node}" for kind in ("spool", "tmp") for node in self.nodes)):
            (self.folder / name).mkdir()
        (self.folder / "munge").chmod(0o711)
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        (self.folder / "slurm.conf").write_text(self.configuration())
        munge = self.folder / "munge"
        self.run_daemon("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={munge}/socket",
                        f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed")
        self.wait_until(lambda: (munge / "socket").exists())
        self.run_daemon("slurmctld", "-D", "-f", self.folder / "slurm.conf")
        for node in self.nodes:
            self.run_daemon("slurmd", "-D", "-f", self.folder / "slurm.conf", "-N", node)
        self.wait_until(lambda: self.ask("sinfo", "--noheader", "--Node", "--format=%t").split() ==
                        [b"idle"] * len(self.nodes))

    def configuration(self):
        host = socket.gethostname().split(".")[0]
        port, *ports = self.free_ports(1 + len(self.nodes))
        lines = {"ClusterName": "lodestone", "SlurmctldHost": f"{host}(127.0.0.1)", "SlurmUser": "root",
                 "AuthType": "auth/munge", "AuthInfo": f"socket={self.folder}/munge/socket", "CredType": "cred/munge",
                 "SlurmctldPort": port, "StateSaveLocation": self.folder / "state",
                 "SlurmdSpoolDir": self.folder / "spool-%n", "SlurmctldPidFile": self.folder / "slurmctld.pid",
                 "TmpFS": self.folder / "tmp-%n",  # else the PMIx servers of two nodes make the same folder
                 "SlurmdPidFile": self.folder / "slurmd-%n.pid", "ProctrackType": "proctrack/linuxproc",
                 "TaskPlugin": "task/none", "JobAcctGatherType": "jobacct_gather/none",
                 "AccountingStorageType": "accounting_storage/none", "SelectType": "select/cons_tres",
                 "SelectTypeParameters": "CR_CPU", "MpiDefault": "none", "SwitchType": "switch/none",
                 "ReturnToService": 2, "SchedulerParameters": "sched_interval=1,batch_sched_delay=0",
                 "PartitionName": "all Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:4"}
        nodes = [f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={at} CPUs=2 RealMemory=1024\n"
                 for node, at in zip(self.nodes, ports)]
        return "".join([*nodes, *(f"{key}={value}\n" for key, value in lines.items())])

    @staticmethod
    def free_ports(count):
        with contextlib.ExitStack() as kept:
            free = [kept.enter_context(socket.socket()) for _ in range(count)]
            for one in free:
                one.bind(("127.0.0.1", 0))
            return [one.getsockname()[1] for one in free]

    def run_daemon(self, *command):
        """In the foreground."""
        path = {**os.environ, "PATH": os.environ.get("PATH", "") + ":/usr/sbin:/sbin", **self.environment}
        with open(self.folder / f"{command[0]}.out", "ab") as log:
            self.daemons.append(subprocess.Popen([*OUR_CHILD, *map(str, command)], stdout=log, stderr=log, env=path,
                                                 cwd=self.folder, start_new_session=True))

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
        # That of a killed rank may wait for itself for ever (Slurm 22.05).
        for process in processes_in(self.folder, lambda words: words[0].startswith("slurmstepd")):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)


@unittest.skipIf(Slurm.missing(), Slurm.missing())
class SlurmCase(unittest.TestCase):
    """All tests of a class share a Slurm."""

    nodes = 1

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.slurm = Slurm(folder.name, cls.nodes)
        cls.addClassCleanup(cls.slurm.stop)
        try:
            cls.slurm.start()
        except (RuntimeError, OSError) as error:
            raise unittest.SkipTest(str(error)) from error
