"""What the tests of sweeps share: sweep files of the experiment `probe`, and what has to hold of a directory."""

import json
import os
import re
import signal
import subprocess

import command_case
from command_case import CommandCase, processes_in

HEAD = 'name = "test"\n[data]\ntiny = { generate = "box", triangles = 12 }\n'


def section(parameters, more="", name="s"):
    return f'[[sweep]]\nname = "{name}"\nexperiment = "probe"\ndata = "tiny"\nparameters = {{ {parameters} }}\n{more}\n'


def start(*arguments, cwd, environment=None):
    """A sweep that goes on while the test does, in a process group of its own."""
    return subprocess.Popen([command_case.PROGRAM, "sweep", *map(str, arguments)], cwd=cwd, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, start_new_session=True, env=environment)


def end_quietly(process):
    """Reads what it has to say, so that nothing is left open."""
    output, errors = process.communicate(timeout=60)
    return process.returncode, output.decode(), errors.decode()


def children_in(folder):
    """Processes at work in a folder on runs."""
    return processes_in(folder, lambda words: "sweep-run" in words)


class SweepCase(CommandCase):
    def sweep(self, text, *arguments, output="out"):
        """Writes the file and runs it; returns the summary."""
        self.write("sweep.toml", text)
        return self.results("sweep", "sweep.toml", "-o", output, *arguments, "--quiet")

    def failing_sweep(self, *arguments, **more):
        return self.failing("sweep", *arguments, **more)

    def rows_so_far(self, output="out"):
        return list(self.folder.glob(f"{output}/runs/*/rows.0.jsonl"))

    def plan(self, output="out"):
        return json.loads((self.folder / output / "sweep.json").read_text())

    def runs(self, output="out"):
        """(id, parameters, repetitions) of every run that sweep.json lists."""
        return [(run["id"], run["parameters"], sweep["repetitions"])
                for sweep in self.plan(output)["sweeps"] for run in sweep["runs"]]

    def file(self, run, name, output="out"):
        return self.folder / output / "runs" / run / name

    def rows(self, run, repetition, output="out"):
        return [json.loads(line) for line in self.file(run, f"rows.{repetition}.jsonl", output).read_text().splitlines()]

    def read(self, run, name, output="out"):
        return json.loads(self.file(run, name, output).read_text())

    def check_rows(self, run, parameters, repetition, output="out"):
        self.assertEqual([(row["number"], row["multiple"]) for row in self.rows(run, repetition, output)],
                         [(i, parameters["x"] * (i + 1)) for i in range(parameters["rows"])])

    def check_complete(self, output="out"):
        """Every repetition of every run has its rows, and nothing else lies about."""
        for run, parameters, repetitions in self.runs(output):
            for repetition in range(repetitions):
                self.check_rows(run, parameters, repetition, output)
                self.assertFalse(self.file(run, f"fault.{repetition}.json", output).exists())
        self.check_clean(output)

    def check_clean(self, output="out"):
        """Nothing half-done: what lies in the directory is what the decision lists."""
        known = re.compile(r"sweep\.json|\.lock|data|data/(hashes\.json|[a-z]+-\d+-\d+\.ply)|runs|runs/[0-9a-f]{16}"
                           r"(/(\.lock|parameters\.json|log\.txt|rows\.\d+\.jsonl|(manifest|fault)\.\d+\.json))?")
        for path in (self.folder / output).rglob("*"):
            name = path.relative_to(self.folder / output).as_posix()
            self.assertRegex(name, rf"\A(?:{known.pattern})\Z")
        self.assertEqual(children_in(self.folder), [])


def kill(process, group):
    """Ends a sweep without warning: alone, or with its children."""
    try:
        if group:
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
    except ProcessLookupError:
        pass
    process.communicate(timeout=60)
