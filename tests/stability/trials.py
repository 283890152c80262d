"""Tests of the suite as scripts/mutate runs them: with a fault switched on, and within limits of time, memory and disk."""

import json
import os
import pathlib
import re
import resource
import subprocess
import time

START_SECONDS, SLOWER = 10, 4    # processor time that a test may take beside its usual time, and by which factor
WALL_SECONDS, WALL_SLOWER = 120, 40    # the machine may be shared
BYTES = 8 << 30    # address space of GoogleTest programs, and file size of all


class Trial:
    """A GoogleTest program, run whole, or one test of CTest that is none."""

    def __init__(self, name, command, folder, properties, is_program):
        self.name, self.command, self.folder, self.is_program = name, command, folder, is_program
        self.environment = dict(pair.split("=", 1) for pair in properties.get("ENVIRONMENT", []))
        self.seconds = None    # of processor time without a fault; None: it fails
        self.sees = {}    # what it does to faults by number: "reached" or "changed"

    def run(self, environment):
        """Whether it passes, and its processor time."""
        def limit():
            most = int(START_SECONDS + SLOWER * self.seconds) if self.seconds is not None else 1200
            resource.setrlimit(resource.RLIMIT_CPU, (most, most))
            resource.setrlimit(resource.RLIMIT_FSIZE, (BYTES, BYTES))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            if self.is_program:
                resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
            os.setsid()
        begin = time.monotonic()
        process = subprocess.Popen(self.command, cwd=self.folder, env={**os.environ, **self.environment, **environment},
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   preexec_fn=limit)
        most = WALL_SECONDS + WALL_SLOWER * (self.seconds or 30)
        while True:
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            if ended:
                process.returncode = os.waitstatus_to_exitcode(status)
                return process.returncode == 0, usage.ru_utime + usage.ru_stime
            if time.monotonic() - begin > most:
                os.killpg(process.pid, 9)
            time.sleep(0.02)

    def record(self, count, file):
        """Runs it without a fault: its time, and what it does to each of so many faults."""
        pathlib.Path(file).write_bytes(bytes(2 * count))
        passed, seconds = self.run({"PLANTED_SEEN": str(file)})
        self.seconds = seconds if passed else None
        seen = pathlib.Path(file).read_bytes()
        self.sees = {n: "changed" if seen[2 * n + 1] else "reached" for n in range(count) if seen[2 * n]}

    def recorded(self):
        return {"name": self.name, "seconds": self.seconds, "sees": self.sees}

    def recall(self, row):
        self.seconds, self.sees = row["seconds"], {int(number): what for number, what in row["sees"].items()}
        return self

    def passes(self, fault):
        return self.run({"PLANTED": str(fault)})[0]


def programs(build, targets):
    """The GoogleTest programs among the targets of a build (ninja -t targets all), built or not."""
    for path in re.findall(r"(?m)^(tests/\S*/test_\w+): CXX_EXECUTABLE_LINKER", targets):
        command = [str(pathlib.Path(build, path)), "--gtest_brief=1", "--gtest_fail_fast"]
        yield Trial(pathlib.Path(path).name, command, str(pathlib.Path(build, path).parent), {}, True)


def all_trials(build, targets):
    """The tests of a build; those of documents and of the package see no fault."""
    listing = subprocess.run(["ctest", "--show-only=json-v1"], cwd=build, check=True, capture_output=True, text=True)
    trials = list(programs(build, targets))
    for entry in json.loads(listing.stdout)["tests"]:
        command = entry.get("command", [])
        properties = {p["name"]: p["value"] for p in entry.get("properties", [])}
        if not command or {"house", "package"} & set(properties.get("LABELS", [])):
            continue
        if not any(argument.startswith("--gtest_filter") for argument in command):
            trials.append(Trial(entry["name"], command, properties.get("WORKING_DIRECTORY", str(build)), properties, False))
    return trials


def nearest(trials, file):
    """Those in the folder of tests that is nearest to a source file."""
    most = max(nearness(trial, file) for trial in trials)
    return [trial for trial in trials if nearness(trial, file) == most]


def nearness(trial, file):
    """How many folders the path of the test's program shares with that of the file."""
    parts, at = pathlib.PurePosixPath(file).parts, pathlib.Path(trial.command[0]).parts
    below = at[at.index("tests") + 1:] if "tests" in at else ()
    shared = 0
    while shared < min(len(parts), len(below)) and parts[shared] == below[shared]:
        shared += 1
    return shared


def in_order(trials, fault, file):
    """The tests in which the fault changes a value. Each folder in common is worth four times the time."""
    return sorted((trial for trial in trials if trial.sees.get(fault) == "changed"),
                  key=lambda trial: (trial.seconds + 0.1) / 4 ** nearness(trial, file))
