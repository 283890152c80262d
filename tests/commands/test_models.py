"""scripts/data and scripts/convert-model: models come from a folder or from a server, whole and verified, or are named.

usage: test_models.py PROGRAM [unittest arguments]
"""

import base64
import gzip
import hashlib
import http.server
import json
import lzma
import os
import pathlib
import re
import struct
import subprocess
import sys
import threading
import tomllib
import unittest
import urllib.parse
import zlib

import command_case
from command_case import SOURCE, FolderCase

CONTENT = bytes(range(256)) * 20
PLY_HEAD = ("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
            "element face {}\nproperty list uchar int vertex_indices\nend_header\n")


def digest(content):
    return hashlib.sha256(content).hexdigest()


class Server(http.server.ThreadingHTTPServer):
    """Serves `files` (path: content); ends connections after `cut` bytes; knows ranges unless told otherwise."""

    def __init__(self, files):
        super().__init__(("127.0.0.1", 0), Handler)
        self.files, self.cut, self.ranges, self.requests = files, None, True, []
        threading.Thread(target=self.serve_forever, args=(0.01,), daemon=True).start()

    @property
    def url(self):
        return f"http://127.0.0.1:{self.server_port}"


class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        begin = self.headers.get("Range", "")
        self.server.requests.append((self.path, begin))
        content = self.server.files.get(urllib.parse.unquote(self.path))
        if content is None:
            return self.send_error(404)
        begin = int(re.fullmatch(r"bytes=(\d+)-", begin)[1]) if begin and self.server.ranges else 0
        if begin > 0 and begin >= len(content):
            return self.send_error(416)
        self.send_response(206 if begin else 200)
        self.send_header("Content-Length", str(len(content) - begin))
        self.end_headers()
        self.wfile.write(content[begin:][:self.server.cut])
        return None

    def log_message(self, *_):
        pass


class DataCase(FolderCase):
    def setUp(self):
        super().setUp()
        self.server = Server({})
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)
        self.models = {}

    def serve(self, name, content=CONTENT, **entry):
        self.server.files[f"/someone/models/abc/some/{name}"] = content
        self.models[name] = {"path": f"some/{name}", "sha256": digest(content), **entry}

    def data(self, *arguments, status=0, server=None, environment=None):
        """Runs scripts/data with the table of self.models; returns what it says."""
        lines = ['[[origin]]', 'repository = "someone/models"', 'commit = "abc"', 'licence = "CC0"', '[origin.models]']
        for name, entry in self.models.items():
            lines.append(f'"{name}" = {{ ' + ", ".join(f"{key} = {json.dumps(value)}" for key, value in entry.items()) + " }")
        (self.folder / "table.toml").write_text("\n".join(lines))
        given = arguments or (self.folder / "none",)
        done = subprocess.run([sys.executable, SOURCE / "scripts/data", "--table", self.folder / "table.toml", "--into",
                               self.folder / "into", "--server", server or self.server.url, *given],
                              capture_output=True, text=True, timeout=60, check=False,
                              env={**os.environ, "no_proxy": "127.0.0.1", **(environment or {})})
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        return done.stderr + done.stdout

    def laid(self):
        into = self.folder / "into"
        return {path.relative_to(into).as_posix(): path.read_bytes() for path in into.rglob("*") if path.is_file()}


class Fetching(DataCase):
    def test_lays_good_files_under_their_names(self):
        self.serve("scans/a.ply")
        self.serve("b with space.obj", b"v 0 0 0\n")
        self.assertIn("fetched 2 models", self.data())
        self.assertEqual(self.laid(), {"scans/a.ply": CONTENT, "b with space.obj": b"v 0 0 0\n"})
        self.server.requests.clear()
        self.assertIn("is complete", self.data())
        self.assertEqual(self.server.requests, [])

    def test_refuses_files_of_another_hash(self):
        self.serve("a.ply", sha256=digest(b"something else"))
        said = self.data(status=1)
        self.assertIn(f"has the SHA-256 {digest(CONTENT)}, not {digest(b'something else')}", said)
        self.assertIn("1 models are missing", said)
        self.assertEqual(self.laid(), {})

    def test_names_files_that_are_gone_and_takes_the_others(self):
        self.serve("a.ply")
        self.serve("z.ply")
        del self.server.files["/someone/models/abc/some/a.ply"]
        said = self.data(status=1)
        self.assertIn("some/a.ply: 404", said)
        self.assertIn("correct scripts/models.toml", said)
        self.assertEqual(self.laid(), {"z.ply": CONTENT})

    def test_resumes_where_a_download_was_cut_off(self):
        self.serve("a.ply")
        self.server.cut = 2000
        self.assertIn("fetched 1 models", self.data())
        self.assertEqual([begin for _, begin in self.server.requests], ["", "bytes=2000-", "bytes=4000-"])
        self.assertEqual(self.laid(), {"a.ply": CONTENT})

    def test_resumes_in_the_next_call(self):
        self.serve("a.ply")
        self.server.cut = 1000
        said = self.data(status=1)
        self.assertIn("cut off after 4000 bytes; call scripts/data again to resume", said)
        self.assertEqual(self.laid(), {"a.ply.part": CONTENT[:4000]})
        self.server.requests.clear()
        self.data()
        self.assertEqual(self.server.requests[0][1], "bytes=4000-")
        self.assertEqual(self.laid(), {"a.ply": CONTENT})

    def test_begins_again_where_a_server_knows_no_ranges(self):
        self.serve("a.ply")
        self.server.cut = 1000
        self.data(status=1)
        self.server.cut, self.server.ranges = None, False
        self.data()
        self.assertEqual(self.laid(), {"a.ply": CONTENT})

    def test_discards_a_damaged_beginning(self):
        self.serve("a.ply")
        (self.folder / "into").mkdir()
        (self.folder / "into/a.ply.part").write_bytes(b"x" * (len(CONTENT) + 1))
        self.assertIn("has the SHA-256", self.data(status=1))
        self.data()
        self.assertEqual(self.laid(), {"a.ply": CONTENT})

    def test_says_what_is_missing_without_a_network(self):
        for name in "abcdefghij":
            self.serve(f"{name}.ply")
        self.server.shutdown()
        self.server.server_close()
        said = self.data(status=1)
        self.assertEqual(said.count("no network"), 1)
        self.assertIn("set LODESTONE_MODELS", said)
        self.assertIn("10 models are missing, and the tests that need them will be skipped: a.ply, b.ply", said)
        self.assertIn("scripts/data --list", said)

    def test_leaves_no_empty_folder(self):
        """Tests take the folder of a model of several files for the model, and would fail instead of being skipped."""
        self.serve("textured/tiles/a.glb")
        self.serve("textured/tiles/deep/b.glb")
        self.server.shutdown()
        self.server.server_close()
        source = self.folder / "models"
        (source / "scans").mkdir(parents=True)
        (source / "scans/own.ply").write_bytes(b"own")
        self.data(source, status=1)
        self.assertEqual([path.name for path in (self.folder / "into").iterdir()], ["scans"])


class Folders(DataCase):
    def test_come_before_the_network(self):
        self.serve("a.ply")
        self.serve("b.ply", b"b")
        source = self.folder / "models"
        source.mkdir()
        (source / "a.ply.xz").write_bytes(lzma.compress(CONTENT))
        (source / "own.ply").write_bytes(b"own")
        said = self.data(source)
        self.assertIn("unpacked 2 and fetched 1 models", said)
        self.assertEqual([path for path, _ in self.server.requests], ["/someone/models/abc/some/b.ply"])
        self.assertEqual(self.laid(), {"a.ply": CONTENT, "b.ply": b"b", "own.ply": b"own"})

    def test_are_named_by_the_environment(self):
        self.serve("a.ply")
        source = self.folder / "models"
        source.mkdir()
        (source / "a.ply").write_bytes(CONTENT)
        said = self.data("--list", environment={"LODESTONE_MODELS": str(source)})
        self.assertIn(f"a.ply: missing, in {source}; licence: CC0", said)

    def test_are_checked(self):
        self.serve("a.ply")
        source = self.folder / "models"
        source.mkdir()
        packed = lzma.compress(CONTENT)
        (source / "a.ply.xz").write_bytes(packed)
        (source / "SHA256SUMS").write_text(f"{digest(b'other')}  a.ply.xz\n")
        self.assertIn("differs from the SHA256SUMS beside it", self.data(source, status=1))
        (source / "SHA256SUMS").write_text(f"{digest(packed[:-9])}  a.ply.xz\n")
        (source / "a.ply.xz").write_bytes(packed[:-9])
        self.assertIn("a.ply.xz: Compressed file ended", self.data(source, status=1))
        (source / "SHA256SUMS").unlink()
        (source / "a.ply.xz").write_bytes(lzma.compress(b"other"))
        self.assertIn("gives another file than scripts/models.toml records", self.data(source, status=1))
        (source / "a.ply.xz").unlink()
        self.data(source)
        self.assertEqual(self.laid(), {"a.ply": CONTENT})

    def test_are_no_excuse_for_models_that_were_changed(self):
        self.serve("a.ply")
        (self.folder / "into").mkdir()
        (self.folder / "into/a.ply").write_bytes(b"edited")
        self.assertIn("differs from scripts/models.toml; remove it", self.data(status=1))
        self.assertEqual(self.laid(), {"a.ply": b"edited"})


class Entries(DataCase):
    def test_are_converted(self):
        packed = gzip.compress(CONTENT)
        self.serve("a.ply", packed, source=digest(packed), sha256=digest(CONTENT), convert="scripts/convert-model gunzip")
        self.data()
        self.assertEqual(self.laid(), {"a.ply": CONTENT})

    def test_report_conversions_that_fail(self):
        self.serve("a.ply", source=digest(CONTENT), convert="scripts/convert-model gunzip")
        self.serve("b.ply", source=digest(CONTENT), convert="no-such-program export")
        packed = gzip.compress(b"of another version")
        self.serve("c.ply", packed, source=digest(packed), sha256=digest(CONTENT), convert="scripts/convert-model gunzip")
        said = self.data(status=1)
        self.assertIn("'scripts/convert-model gunzip' failed: convert-model:", said)
        self.assertIn("needs the program no-such-program", said)
        self.assertIn("c.ply: scripts/convert-model gunzip gives another file", said)
        self.assertFalse([name for name in self.laid() if not name.endswith(".source")])

    def test_may_hold_their_text(self):
        self.models["a.mtl"] = {"text": "newmtl a\nKd 1 1 1\n", "sha256": digest(b"newmtl a\nKd 1 1 1\n")}
        self.data()
        self.assertEqual(self.laid(), {"a.mtl": b"newmtl a\nKd 1 1 1\n"})

    def test_without_a_source_are_named_and_are_no_failure(self):
        self.models["a.drc"] = {"unpublished": "ours alone", "sha256": digest(CONTENT)}
        self.assertIn("1 models are missing, and the tests that need them will be skipped: a.drc", self.data())
        self.assertIn("a.drc: missing, without a source: ours alone; licence: CC0", self.data("--list"))


class Table(unittest.TestCase):
    ORIGINS = tomllib.loads((SOURCE / "scripts/models.toml").read_text(encoding="utf-8"))["origin"]
    NAMES = {name for origin in ORIGINS for name in origin["models"]}

    def test_tells_all_of_every_model(self):
        for origin in self.ORIGINS:
            self.assertRegex(origin["repository"], r"^[\w.-]+/[\w.-]+$")
            self.assertRegex(origin["commit"], "^[0-9a-f]{40}$")
            self.assertTrue(origin["licence"])
            for name, entry in origin["models"].items():
                self.assertRegex(entry["sha256"], "^[0-9a-f]{64}$", name)
                self.assertEqual(len({"path", "text", "unpublished"} & set(entry)), 1, name)
                self.assertEqual("convert" in entry, "source" in entry, name)

    def test_has_every_model_that_is_named(self):
        files = [path for folder in ("tests", "experiments") for path in (SOURCE / folder).rglob("*")
                 if path.suffix in (".cpp", ".h", ".py", ".toml", ".mjs") and path.name != "test_models.py"]
        named = {}
        for path in files:
            for name in re.findall(r'(?:build/data/|")((?:scans|cad|hard|terrain|textured)/[\w./-]+\.\w{2,4})\b', path.read_text()):
                named.setdefault(name, path)
        examples = {"scans/statue.ply", *(name for name in named if name.endswith((".h", ".cpp")))}
        self.assertGreater(len(named), 30)
        self.assertEqual({name: named[name] for name in set(named) - examples - self.NAMES}, {})


def tiff(width, height, heights, tile=None):
    """A little-endian TIFF of 16-bit heights, in strips of two rows or in square tiles, as both sources are laid out."""
    rows = [heights[row * width:(row + 1) * width] for row in range(height)]
    pieces = []
    if tile:
        for top in range(0, height, tile):
            for left in range(0, width, tile):
                block = [(rows[top + y] if top + y < height else [0] * width)[left:left + tile] for y in range(tile)]
                pieces.append(b"".join(struct.pack(f"<{tile}h", *(line + [0] * (tile - len(line)))) for line in block))
    else:
        pieces = [b"".join(struct.pack(f"<{width}h", *row) for row in rows[top:top + 2]) for top in range(0, height, 2)]
    begins, at = [], 8
    for piece in pieces:
        begins.append(at)
        at += len(piece)
    sizes = [len(piece) for piece in pieces]
    tags = [(256, 3, [width]), (257, 3, [height]), (259, 3, [1])]
    tags += [(322, 3, [tile]), (323, 3, [tile]), (324, 4, begins)] if tile else [(273, 4, begins), (279, 4, sizes)]
    extra, entries = b"", b""
    end = at + 2 + 12 * len(tags) + 4
    for tag, kind, values in tags:
        content = struct.pack(f"<{len(values)}{'H' if kind == 3 else 'I'}", *values)
        if len(content) > 4:
            entries += struct.pack("<HHII", tag, kind, len(values), end + len(extra))
            extra += content
        else:
            entries += struct.pack("<HHI", tag, kind, len(values)) + content.ljust(4, b"\0")
    return b"II*\0" + struct.pack("<I", at) + b"".join(pieces) + struct.pack("<H", len(tags)) + entries + bytes(4) + extra


def vtk_array(name, content):
    blocks = [zlib.compress(content[at:at + 16]) for at in range(0, len(content), 16)]
    head = struct.pack(f"<{3 + len(blocks)}I", len(blocks), 16, len(content) % 16, *map(len, blocks))
    return f'<DataArray Name="{name}">{base64.b64encode(head).decode()}{base64.b64encode(b"".join(blocks)).decode()}</DataArray>'


class Conversions(FolderCase):
    POSITIONS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    TRIANGLES = struct.pack("<6i", 0, 1, 2, 0, 2, 3)
    PLY = PLY_HEAD.format(4, 2).encode() + POSITIONS + b"\3" + TRIANGLES[:12] + b"\3" + TRIANGLES[12:]

    def convert(self, kind, content, status=0):
        """The target, or the message where it fails."""
        source, target = self.folder / "source", self.folder / "target"
        source.write_bytes(content)
        done = subprocess.run([SOURCE / "scripts/convert-model", kind, source, target], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr if status else target.read_bytes()

    def test_take_heights_out_of_geotiff(self):
        heights = [7 * i - 300 for i in range(15)]
        for layout in ({}, {"tile": 4}):
            content = tiff(5, 3, heights, **layout)
            self.assertEqual(self.convert("geotiff-raw", content), struct.pack("<15h", *heights))
            self.assertEqual(self.convert("geotiff-hgt", content), struct.pack(">15h", *heights))
        self.assertIn("is not a little-endian TIFF", self.convert("geotiff-raw", b"MM\0*", status=1))

    def test_take_meshes_out_of_mz3(self):
        content = struct.pack("<HHIII", 0x5A4D, 3, 2, 4, 5) + b"extra" + self.TRIANGLES + self.POSITIONS
        self.assertEqual(self.convert("mz3-ply", gzip.compress(content)), self.PLY)
        self.assertIn("is not an mz3 file", self.convert("mz3-ply", gzip.compress(bytes(16)), status=1))

    def test_take_triangles_out_of_vtk(self):
        def file(ends):
            corners = struct.pack("<6q", *struct.unpack("<6i", self.TRIANGLES))
            return (f"<VTKFile><Points>{vtk_array('Points', self.POSITIONS)}</Points><Polys>{vtk_array('connectivity', corners)}"
                    f"{vtk_array('offsets', struct.pack(f'<{len(ends)}q', *ends))}</Polys></VTKFile>").encode()

        self.assertEqual(self.convert("vtp-ply", file([3, 6])), self.PLY)
        self.assertIn("not triangles", self.convert("vtp-ply", file([6]), status=1))

    def test_take_a_part_of_a_tileset(self):
        leaf = {"geometricError": 0, "content": {"uri": "b.glb"}}
        part = {"geometricError": 2, "content": {"uri": "a.glb"}, "children": [leaf]}
        whole = {"asset": {"version": "1.1", "extras": {}}, "geometricError": 50,
                 "root": {"geometricError": 9, "refine": "REPLACE", "transform": [1], "children": [part]}}
        taken = json.loads(self.convert("subtree:a.glb", json.dumps(whole).encode()))
        self.assertEqual(taken, {"asset": {"version": "1.1"}, "geometricError": 4,
                                 "root": {**part, "refine": "REPLACE", "transform": [1]}})
        self.assertIn("has no tile c.glb", self.convert("subtree:c.glb", json.dumps(whole).encode(), status=1))

    def test_are_known(self):
        self.assertIn("usage:", self.convert("geotiff-png", b"", status=2))


if __name__ == "__main__":
    command_case.main(__doc__)
