"""Hard surfaces through every command: each gives a valid result or the error that is expected, within a stated time and
memory."""

import json
import os
import re
import resource
import subprocess
import tempfile
import threading
from dataclasses import dataclass, field

# Processor time and resident memory: per face, and what any start takes.
SECONDS, SECONDS_PER_FACE = 1.0, 50e-6
BYTES, BYTES_PER_FACE = 64 << 20, 2000
WALL_SECONDS, ADDRESS_SPACE = 240, 8 << 30  # beyond them a command is ended


@dataclass
class Step:
    name: str
    words: list
    makes: str = ""  # a file that later steps need
    needs: str = ""
    errors: str = ""  # a pattern of messages that are a right answer to valid input


SMALL = ["--cell-triangles", "100", "--levels", "5"]
INADMISSIBLE = ["--kappa0", "1", "--radii", "uniform", "--allow-inadmissible"]

STEPS = [
    Step("build", ["build", "in.ply", "-o", "default.lode"], makes="default.lode"),
    Step("build, small cells", ["build", "in.ply", "-o", "small.lode", *SMALL], makes="small.lode"),
    Step("verify", ["verify", "small.lode", "--input", "in.ply"], needs="small.lode"),
    Step("build, endpoint", ["build", "in.ply", "-o", "endpoint.lode", "--placement", "endpoint", *SMALL], makes="endpoint.lode"),
    Step("verify it", ["verify", "endpoint.lode"], needs="endpoint.lode"),
    Step("build, cluster", ["build", "in.ply", "-o", "cluster.lode", "--simplifier", "cluster", *SMALL], makes="cluster.lode"),
    Step("verify it ", ["verify", "cluster.lode"], needs="cluster.lode"),
    Step("build, measured", ["build", "in.ply", "-o", "measured.lode", "--measure-error", *SMALL], makes="measured.lode"),
    Step("verify it  ", ["verify", "measured.lode"], needs="measured.lode"),
    Step("build, refined", ["build", "in.ply", "-o", "refined.lode", "--refine", *SMALL], errors="splitting all edges longer"),
    Step("build, compressed", ["build", "in.ply", "-o", "packed.lode", "--compress", *SMALL], makes="packed.lode"),
    Step("verify it   ", ["verify", "packed.lode"], needs="packed.lode"),
    Step("build on disk", ["build", "in.ply", "-o", "disk.lode", "--memory-limit", "24MiB", *SMALL],
         errors="needs? .* of memory|give it as binary PLY of triangles"),
    Step("info", ["info", "small.lode"], needs="small.lode"),
    Step("render", ["render", "small.lode", "--frames", "3", "--size", "160x120", "-o", "frames", "--json", "render.json"], needs="small.lode"),
    Step("render, adversarial", ["render", "small.lode", "--frames", "4", "--backend", "null", "--camera", "adversarial", *INADMISSIBLE],
         needs="small.lode", errors="it cannot crack"),
    Step("compare", ["compare", "in.ply", "in.ply"], errors="no triangle"),  # of points and lines, too
    Step("export .ply", ["export", "small.lode", "-o", "out.ply", "--level", "0"], needs="small.lode", makes="out.ply"),
    Step("and back", ["compare", "in.ply", "out.ply"], needs="out.ply"),
    Step("export .obj", ["export", "small.lode", "-o", "out.obj"], needs="small.lode"),
    Step("export .stl", ["export", "small.lode", "-o", "out.stl"], needs="small.lode", errors="STL, which has float32 alone"),
    Step("export .glb", ["export", "small.lode", "-o", "out.glb"], needs="small.lode"),
    Step("export, tiles", ["export", "small.lode", "--tiles", "tiles", "--morph"], needs="small.lode"),
    Step("progressive .lpm", ["progressive", "in.ply", "-o", "out.lpm"]),
    Step("progressive .glb", ["progressive", "in.ply", "-o", "outp.glb"]),
    Step("reconstruct", ["reconstruct", "in.ply", "-o", "maps.ply", "--triangles", "500"], errors="no view sees three neighbouring samples"),
    Step("reconstruct, shell", ["reconstruct", "in.ply", "-o", "shell.ply", "--triangles", "500", "--outside-only"],
         errors="no view sees three neighbouring samples"),
    Step("spherical", ["spherical", "in.ply", "-o", "sphere.glb", "--texture", "64"]),
]


@dataclass
class Outcome:
    step: str
    fault: str = ""  # why it is wrong
    error: str = ""  # a message that is a right answer
    seconds: float = 0
    bytes: int = 0
    over: list = field(default_factory=list)  # "time", "memory"


@dataclass
class Case:
    name: str
    what: str
    faces: int
    outcomes: list


def names(program):
    listed = subprocess.run([program, "generate", "hard:", "-o", "none.ply"], capture_output=True, text=True).stderr
    return re.search(r"known are (.*)", listed)[1].split(", ")


def run(program, words, folder):
    """Exit status, last line, processor seconds, largest resident memory."""
    limit = (ADDRESS_SPACE, ADDRESS_SPACE)
    process = subprocess.Popen([program, *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, limit))
    timer = threading.Timer(WALL_SECONDS, process.kill)
    timer.start()
    with process.stdout:
        lines = re.split(r"[\r\n]+", process.stdout.read().decode(errors="replace").strip())
    _, status, usage = os.wait4(process.pid, 0)
    timer.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, lines[-1], usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


# Faults of the input, of a file, of this machine or of its limits, not of the command line or the program.
REFUSALS = range(3, 7)


def judge(step, refusal, status, line):
    """The fault, '' for none, and the message of an error that is right."""
    if refusal:
        right = status in REFUSALS and refusal in line
        return ("" if right else f"status {status} where '{refusal}' was expected: {line}", line if right else "")
    if status == 0:
        return "", ""
    if status in REFUSALS and step.errors and re.search(step.errors, line):
        return "", line
    return f"status {status}: {line}", ""


def run_case(program, name, wanted=None):
    """The case through the steps of these names, all if none are given."""
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run([program, "generate", "hard:" + name, "-o", "in.ply", "--json", "-", "--quiet"], cwd=folder,
                              capture_output=True, text=True, check=True)
        about = json.loads(made.stdout)
        case = Case(name, about["what"], about["faces"], [])
        for step in STEPS:
            if wanted and step.name not in wanted or step.needs and not os.path.exists(os.path.join(folder, step.needs)):
                continue
            status, line, seconds, size = run(program, step.words, folder)
            fault, error = judge(step, about["refusal"] if step.words[1] == "in.ply" and step.words[0] != "compare" else "", status, line)
            outcome = Outcome(step.name.strip(), fault, error, seconds, size)
            if not fault and os.path.exists(os.path.join(folder, "render.json")) and step.name == "render":
                outcome.fault = cracks(os.path.join(folder, "render.json"))
            outcome.over = [what for what, over in (("time", seconds > SECONDS + SECONDS_PER_FACE * case.faces),
                                                    ("memory", size > BYTES + BYTES_PER_FACE * case.faces)) if over]
            case.outcomes.append(outcome)
        return case


def cracks(path):
    with open(path, encoding="utf-8") as file:
        found = json.load(file)["open_edges"]
    return f"{found} open edges" if found else ""
