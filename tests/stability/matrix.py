"""Hard surfaces through every command: each gives a valid result or the error that is expected, within a stated time and
memory."""

import json
import math
import os
import pathlib
import re
import resource
import subprocess
import tempfile
import threading
from dataclasses import dataclass, field

# Processor time and resident memory: per triangle, and what any start takes.
SECONDS, SECONDS_PER_TRIANGLE = 1.0, 50e-6
BYTES, BYTES_PER_TRIANGLE = 64 << 20, 2000
WALL_SECONDS, ADDRESS_SPACE = 1200, 8 << 30  # beyond them a command is ended
# In memory: a file system that has just removed thousands of files (the tiles of the last case) takes its time over new ones.
FOLDER = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


@dataclass
class Step:
    name: str
    words: list
    makes: str = ""  # a file that later steps need
    needs: str = ""
    errors: str = ""  # a pattern of messages that are a right answer to valid input
    within: float = math.inf  # largest distance that comparing may give, over the diagonal
    bytes: int = BYTES  # that its start takes
    same: str = ""  # the file whose bytes `makes` has


SMALL = ["--cell-triangles", "100", "--levels", "5"]
FRAMES = ["--frames", "3", "--size", "160x120"]
UNIFORM = ["--radii", "uniform", "--kappa0"]
ADVERSARIAL = ["--frames", "4", "--backend", "null", "--camera", "adversarial"]
FLOAT32, ROUNDING = 1e-6, 1e-12  # of coordinates in files; of distances from thin triangles
FLOAT32_STEP = 2.0**-149  # below the smallest normal number the files of float32 hold multiples of it
NO_CRACK = "it cannot crack"
NO_UV = "texture coordinates"
NO_VIEW = "no view sees three neighbouring samples"


def build_and_verify(variant, options, errors=""):
    """Levels are few where edges are split: at 32 cells a side nearly every surface would exceed the limit."""
    file = variant.split()[0] + ".lode"
    return [Step(f"build, {variant}", ["build", "in.ply", "-o", file, *options], makes=file, errors=errors),
            Step(f"verify, {variant}", ["verify", file], needs=file)]


def render(name, *options, **more):
    return Step(f"render, {name}", ["render", "small.lode", *FRAMES, *options, "-o", "frames", "--json", "render.json"],
                needs="small.lode", **more)


def export_and_back(suffix, *options, errors=""):
    file = "out" + suffix
    return [Step(f"export {suffix}", ["export", "small.lode", "-o", file, *options], needs="small.lode", makes=file, errors=errors),
            Step(f"{suffix} and back", ["compare", "small.lode", file, "--json", "distance.json"], needs=file, within=FLOAT32)]


# {kappa0}: 1.05 of the reach.
STEPS = [
    Step("build", ["build", "in.ply", "-o", "default.lode"], makes="default.lode"),
    Step("build, small cells", ["build", "in.ply", "-o", "small.lode", *SMALL], makes="small.lode"),
    Step("verify", ["verify", "small.lode", "--input", "in.ply"], needs="small.lode"),
    *build_and_verify("endpoint", ["--placement", "endpoint", *SMALL]),
    *build_and_verify("cluster", ["--simplifier", "cluster", *SMALL]),
    *build_and_verify("openmesh", ["--simplifier", "openmesh", *SMALL]),
    *build_and_verify("meshopt", ["--simplifier", "meshopt", *SMALL]),
    *build_and_verify("measured", ["--measure-error", *SMALL]),
    *build_and_verify("compressed", ["--compress", *SMALL]),
    *build_and_verify("halved", ["--half-levels", "--cell-triangles", "100", "--levels", "9"]),
    *build_and_verify("refined", ["--refine", "--levels", "3"], errors="splitting all edges longer"),
    Step("build on disk", ["build", "in.ply", "-o", "disk.lode", "--memory-limit", "24MiB", *SMALL], makes="disk.lode", same="small.lode",
         errors="needs? .* of memory|give it as binary PLY of triangles"),
    Step("info", ["info", "small.lode", "--json", "info.json"], needs="small.lode"),
    render("soft"),
    render("gl", "--backend", "gl", bytes=3 * BYTES),  # with a driver in software
    render("null", "--backend", "null"),
    render("at 1.05 rho", "--backend", "null", *UNIFORM, "{kappa0}"),
    Step("adversarial at 1.05 rho", ["render", "small.lode", *ADVERSARIAL, *UNIFORM, "{kappa0}", "--json", "render.json"],
         needs="small.lode", errors=NO_CRACK),
    Step("adversarial below it", ["render", "small.lode", *ADVERSARIAL, *UNIFORM, "1", "--allow-inadmissible"],
         needs="small.lode", errors=NO_CRACK),
    Step("compare", ["compare", "in.ply", "in.ply", "--json", "distance.json"], within=ROUNDING, errors="no triangle"),  # of points and lines, too
    *export_and_back(".ply"),
    *export_and_back(".obj"),
    *export_and_back(".stl", errors="STL, which has float32 alone"),
    *export_and_back(".glb", "--up", "y"),  # as it is, not turned
    Step("export, tiles", ["export", "small.lode", "--tiles", "tiles", "--morph"], needs="small.lode", makes="tiles"),
    Step("tiles and back", ["compare", "small.lode", "tiles", "--json", "distance.json"], needs="tiles", within=FLOAT32),
    Step("progressive .lpm", ["progressive", "in.ply", "-o", "out.lpm"]),
    Step("progressive .glb", ["progressive", "in.ply", "-o", "outp.glb"]),
    Step("progressive, attributes", ["progressive", "in.ply", "-o", "outp.glb", "--metric", "attribute-quadric"]),
    Step("progressive, parametric", ["progressive", "in.ply", "-o", "outp.glb", "--metric", "parametric"], errors=NO_UV),
    Step("reconstruct", ["reconstruct", "in.ply", "-o", "maps.ply", "--triangles", "500"], errors=NO_VIEW),
    Step("reconstruct, shell", ["reconstruct", "in.ply", "-o", "shell.ply", "--triangles", "500", "--outside-only"], errors=NO_VIEW),
    Step("spherical", ["spherical", "in.ply", "-o", "sphere.glb", "--texture", "64"]),
]


@dataclass
class Outcome:
    step: str
    command: str
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
    triangles: int  # that they are cut into
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


def spoken(words, folder):
    """The words with the reach filled in."""
    if "{kappa0}" not in words:
        return words
    rho = load(folder, "info.json")["kappa0_admissible_above"]["euclidean"]
    return [str(max(1.05 * rho, 0.1)) if word == "{kappa0}" else word for word in words]


def load(folder, name):
    return json.loads(pathlib.Path(folder, name).read_text(encoding="utf-8"))


def wrong_result(step, folder):
    """What is wrong with a result that the command took for a right one; '' if nothing is."""
    if "render.json" in step.words and (found := load(folder, "render.json")["open_edges"]):
        return f"{found} open edges"
    if step.within < math.inf:
        distance = load(folder, "distance.json")
        most = max(distance[way]["max"] for way in ("forward", "backward"))
        if not most <= step.within * distance["diagonal"] + (FLOAT32_STEP if step.within == FLOAT32 else 0):
            return f"{most:g} apart, of {distance['diagonal']:g}"
    if step.same and pathlib.Path(folder, step.makes).read_bytes() != pathlib.Path(folder, step.same).read_bytes():
        return f"its bytes are not those of {step.same}"
    return ""


def run_case(program, name, wanted=None, options=()):
    """The case through the steps of these names, all if none are given; options of generate."""
    with tempfile.TemporaryDirectory(dir=FOLDER) as folder:
        made = subprocess.run([program, "generate", "hard:" + name, *options, "-o", "in.ply", "--json", "-", "--quiet"], cwd=folder,
                              capture_output=True, text=True, check=True)
        about = json.loads(made.stdout)
        case = Case(name, about["what"], about["faces"], about["triangles"], [])
        for step in STEPS:
            if wanted and step.name not in wanted or step.needs and not os.path.exists(os.path.join(folder, step.needs)):
                continue
            status, line, seconds, size = run(program, spoken(step.words, folder), folder)
            fault, error = judge(step, about["refusal"] if step.words[1] == "in.ply" and step.words[0] != "compare" else "", status, line)
            outcome = Outcome(step.name, step.words[0], fault, error, seconds, size)
            if not fault and not error:
                outcome.fault = wrong_result(step, folder)
            outcome.over = [what for what, over in (("time", seconds > SECONDS + SECONDS_PER_TRIANGLE * case.triangles),
                                                    ("memory", size > step.bytes + BYTES_PER_TRIANGLE * case.triangles)) if over]
            case.outcomes.append(outcome)
        return case
