"""What the tests of the command share: the program, a folder for each test, models made once, and one way to run it."""

import json
import os
import pathlib
import pty
import random
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import typing
import unittest

PROGRAM = None
_models = None
SHIM = os.environ.get("FAILING_DISK", "")  # the library built from failing_disk.cpp
needs_failing_disk = unittest.skipUnless(SHIM, "the failing disk is not built for sanitizers")
SOURCE = pathlib.Path(__file__).resolve().parents[2]
MODULES = SOURCE / "build/npm/node_modules"
HERMES = SOURCE / "build/data/textured/Hermes/Hermes.obj"
# Hermes, or the scan of the repository where the models are not unpacked.
TEXTURED = HERMES if HERMES.exists() else SOURCE / "examples/models/textured/Gutenberg/Gutenberg.obj"


# Exit statuses (experiments/command_line/exit_status.h).
NEGATIVE, USAGE, INPUT, FILE, UNSUPPORTED, RESOURCE, INTERNAL = STATUSES = range(1, 8)


def main(document):
    """Runs the tests of the calling file. usage: FILE PROGRAM [unittest arguments]"""
    global PROGRAM, _models
    import command_case  # the module the tests see, not __main__

    if len(sys.argv) < 2:
        sys.exit(document)
    command_case.PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    with tempfile.TemporaryDirectory() as folder:
        command_case._models = pathlib.Path(folder)
        unittest.main(module="__main__", verbosity=2)


def call(*arguments, cwd=None, timeout=120, environment=None, preexec=None):
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, capture_output=True, timeout=timeout, check=False,
                          env={**os.environ, **environment} if environment else None, preexec_fn=preexec)


def on_disk(**disk):
    """The environment in which a program has a disk of this kind (failing_disk.cpp)."""
    return {"LD_PRELOAD": SHIM} | {name: str(value) for name, value in disk.items()}


def until(condition, what, timeout=30.0):
    """The first true value of a condition; an error after so many seconds."""
    end = time.monotonic() + timeout
    while not (value := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"not within {timeout} s: {what}")
        time.sleep(0.02)
    return value


def processor_seconds(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class End(typing.NamedTuple):
    output: bytes
    errors: bytes
    seconds: float
    processor_seconds: float  # which other work on the machine does not lengthen


def end_by(process, signal_number):
    """How a process ends after a signal."""
    before, sent = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    used = processor_seconds(process)
    process.send_signal(signal_number)
    output, errors = process.communicate(timeout=30)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return End(output, errors, time.monotonic() - sent,
               after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime - used)


def processes_in(folder, are_meant):
    """Numbers of the processes that work in a folder and whose command line, a list of words, is meant."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and are_meant(os.fsdecode((entry / "cmdline").read_bytes()).split("\0")) and (
                    (entry / "cwd").resolve() == pathlib.Path(folder).resolve()):
                found.append(int(entry.name))
        except OSError:
            pass  # it has ended meanwhile
    return found


class FolderCase(unittest.TestCase):
    """Each test works in an empty folder of its own."""

    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class CommandCase(FolderCase):
    def lodestone(self, *arguments):
        """Runs it, expects success and nothing on standard error; returns standard output."""
        done = call(*arguments, cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr.decode()), (0, ""), arguments)
        return done.stdout.decode()

    def results(self, *arguments):
        """Runs it with --json; returns what that holds."""
        self.lodestone(*arguments, "--json", "results.json")
        return json.loads((self.folder / "results.json").read_text(), parse_constant=self.fail)

    def failing(self, *arguments, names=(), output=None, **more):
        """Expects the status of an error and one line that names what is wrong; returns it. Standard output: `output`, or
        anything."""
        done = call(*arguments, cwd=self.folder, **more)
        line = done.stderr.decode(errors="replace")
        self.assertIn(done.returncode, STATUSES, (arguments, more, line))
        self.assertRegex(line, r"\Alodestone: [^\n]+\n\Z", arguments)
        for name in names:
            self.assertIn(name, line, (arguments, more))
        if output is not None:
            self.assertEqual(done.stdout.decode(), output, arguments)
        return line

    def refused(self, *arguments, **more):
        """As failing, without a word of output, and with a folder that nothing was added to or changed in."""
        before = self.listing()
        line = self.failing(*arguments, output="", **more)
        self.assertEqual(self.listing(), before, (arguments, more))
        return line

    def fails_on_disk(self, *arguments, names, **disk):
        """Expects a refusal on a disk of this kind (failing_disk.cpp)."""
        self.refused(*arguments, names=names, environment=on_disk(**disk))

    def interrupt(self, *arguments, after=None, sign="*", signal_number=signal.SIGINT):
        """Expects a prompt end with one line, and nothing left, from a signal after so many seconds or at a new file."""
        before, signs = self.listing().keys(), len(list(self.folder.rglob(sign)))
        for _ in range(5):  # for a machine that has more or less to do now and then
            process = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE)
            if after is None:
                while process.poll() is None and len(list(self.folder.rglob(sign))) <= signs:
                    time.sleep(0.01)
            else:
                time.sleep(after)
            if process.poll() is not None:  # faster than when `after` was measured
                process.communicate()
                for path in sorted((self.folder / name for name in self.listing().keys() - before), reverse=True):
                    path.rmdir() if path.is_dir() else path.unlink()
                after = after and after / 2
                continue
            end = end_by(process, signal_number)
            self.assertLess(end.processor_seconds, 1, arguments)
            self.assertEqual(process.returncode, 128 + signal_number, end.errors)
            self.assertRegex(end.errors.decode(), r"\Alodestone: interrupted[^\n]*\n\Z")
            self.assertEqual(end.output, b"")
            self.assertEqual(self.listing().keys(), before)
            if end.seconds < 2:  # a tenth of a second where cores are free
                return
        self.fail(f"{arguments}: no signal came in time and had a prompt end")

    def same_bytes(self, mesh, *options, ways):
        """Expects one file from builds in all these ways, and that it verifies against the mesh."""
        files = set()
        for way in ways:
            self.lodestone("build", mesh, "-o", "m.lode", "--quiet", *options, *way)
            files.add((self.folder / "m.lode").read_bytes())
        self.assertEqual(len(files), 1, options)
        self.assertTrue(self.results("verify", "m.lode", "--input", mesh)["valid"], options)

    def on_terminal(self, *arguments, interrupt_at=None, status=0):
        """What standard error and output show on one terminal. Ctrl-C comes when `interrupt_at` has been shown."""
        try:
            master, slave = pty.openpty()
        except OSError as error:
            self.skipTest(f"no terminal to be had here: {error}")
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=slave, stderr=slave, stdin=slave,
                                   cwd=self.folder)
        os.close(slave)
        shown = b""
        try:
            while block := os.read(master, 65536):
                shown += block
                if interrupt_at and re.search(interrupt_at, shown):
                    process.send_signal(signal.SIGINT)
                    interrupt_at = None
        except OSError:  # Linux: the other side was closed
            pass
        os.close(master)
        self.assertEqual(process.wait(timeout=60), status)
        return shown.decode()

    def needs_gl(self):
        probe = call("render", hierarchy(), "--frames", 1, "--size", "16x16", "--backend", "gl")
        if b"drawing with soft instead" in probe.stderr:
            self.skipTest(probe.stderr.decode().strip())

    def validate(self, folder, known=None):
        """Number of glTF files in a folder in which the public validator finds nothing but warnings of the known code."""
        if not (MODULES / "gltf-validator").is_dir():
            self.skipTest("gltf-validator is not installed: scripts/setup fetches it where node and npm are there and "
                          "npm reaches its registry")
        script = SOURCE / "tests/commands/validate_glb.cjs"
        done = subprocess.run(["node", script, MODULES, folder], capture_output=True, timeout=500, check=False)
        self.assertEqual((done.returncode, done.stderr.decode()), (0, ""))
        report = json.loads(done.stdout)
        self.assertGreater(report["files"], 0)
        self.assertEqual([issue for issue in report["issues"] if not known or f": {known}: " not in issue], [])
        return report["files"]

    def listing(self):
        return {
            str(path.relative_to(self.folder)): path.read_bytes() if path.is_file() else None
            for path in sorted(self.folder.rglob("*"))
        }

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path


def model(name, *arguments):
    """A file made once for all tests by `lodestone ARGUMENTS -o NAME`."""
    path = _models / name
    if not path.exists():
        done = call(*arguments, "-o", path)
        assert done.returncode == 0, done.stderr.decode()
    return path


def sphere():
    return model("sphere.ply", "generate", "sphere", "--triangles", 20000)


def hierarchy():
    return model("sphere.lode", "build", sphere(), "--levels", 3)


def ply_counts(path):
    """(vertices, triangles) that the header of a binary PLY declares, checked against the size of the file."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    counts = {line.split()[1]: int(line.split()[2]) for line in header.decode().splitlines() if "element" in line}
    assert len(body) == 12 * counts["vertex"] + 13 * counts["face"], path
    return counts["vertex"], counts["face"]


def ply(vertices, faces, vertex_count=None, face_count=None):
    """Text of an ASCII PLY; the declared counts may lie."""
    lines = ["ply", "format ascii 1.0", f"element vertex {vertex_count or len(vertices)}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {face_count or len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, v)) for v in vertices]
    lines += [" ".join(map(str, (len(f), *f))) for f in faces]
    return "\n".join(lines) + "\n"


def obj(vertices, faces):
    """Text of an OBJ."""
    lines = [" ".join(map(str, ("v", *v))) for v in vertices]
    lines += [" ".join(map(str, ("f", *(corner + 1 for corner in f)))) for f in faces]
    return "\n".join(lines) + "\n"


def dirty_mesh(seed):
    """(points, faces, repairs): a hilly sheet with every fault that is repaired, and how many there are of each."""
    chance, n = random.Random(seed), 30
    points = [(x, y, chance.random()) for y in range(n) for x in range(n)]
    squares = [(y * n + x, y * n + x + 1, (y + 1) * n + x + 1, (y + 1) * n + x)
               for y in range(n - 1) for x in range(n - 1)]
    chance.shuffle(squares)
    polygons, halved = squares[:40], squares[40:]
    sound = [triangle for a, b, c, d in halved for triangle in ((a, b, c), (a, c, d))]

    def add(point):
        points.append(point)
        return len(points) - 1

    copied = list(sound)
    for i in chance.sample(range(len(sound)), 50):  # a corner of its own, where others have one, too
        a, b, c = copied[i]
        copied[i] = (add(points[a]), b, c)
    degenerate = [(a, a, b) for a, b, _ in chance.sample(sound, 11)]
    degenerate += [(a, b, add(points[a])) for a, b, _ in chance.sample(sound, 12)]
    duplicate = [(b, c, a) for a, b, c in chance.sample(sound, 17)]
    non_finite = [(a, b, add((0, chance.choice(["nan", "inf", "-inf"]), 0))) for a, b, _ in chance.sample(sound, 19)]
    stubs = [(a, b) for a, b, _ in chance.sample(sound, 5)]
    faces = copied + polygons + degenerate + non_finite + stubs
    chance.shuffle(faces)
    for _ in range(23):
        add((chance.random(), 2 * n, 0))
    return points, faces + duplicate, {
        "polygons_triangulated": len(polygons), "faces_dropped": len(stubs), "non_finite_triangles": len(non_finite),
        "welded_vertices": 50 + 12, "degenerate_triangles": len(degenerate), "duplicate_triangles": len(duplicate),
        "unreferenced_vertices": len(non_finite) + 23}


def binary_stl(facets, declared=None):
    """Bytes of a binary STL of `facets` (three corners each)."""
    body = b"".join(struct.pack("<12fH", 0, 0, 1, *[x for corner in facet for x in corner], 0) for facet in facets)
    return bytes(80) + struct.pack("<I", len(facets) if declared is None else declared) + body


def glb(positions, triangles):
    """Bytes of a binary glTF of one primitive with 32-bit indices."""
    binary = b"".join(struct.pack("<3f", *p) for p in positions)
    views = [{"buffer": 0, "byteLength": len(binary)}, {"buffer": 0, "byteOffset": len(binary), "byteLength": 12 * len(triangles)}]
    binary += b"".join(struct.pack("<3I", *t) for t in triangles)
    accessors = [{"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3"},
                 {"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}]
    document = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(binary)}], "bufferViews": views,
                "accessors": accessors, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
