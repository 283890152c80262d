"""docs/schema.md against what runs print. usage: test_command_schema.py PROGRAM"""

import json
import re

import command_case
from command_case import CommandCase, hierarchy, sphere
from test_command_limit import BUILD, LIMIT, big


def keys_of(value, path=""):
    """Every key of a result as the schema writes it, without the names that depend on the run."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from keys_of(part, f"{path}.{name}" if path else name)
    elif isinstance(value, list):
        for part in value:
            yield from keys_of(part, path + "[]")
    else:
        yield path


class Schema(CommandCase):
    def setUp(self):
        super().setUp()
        text = self.lodestone("experiments", "--schema")
        self.listed = {title: set(re.findall(r"^\| `([^`]+)`", part, re.MULTILINE))
                       for title, part in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)}

    def compare(self, command, *runs):
        """Every key that the runs print is listed, and every listed one is printed by one of them."""
        listed = self.listed["Command " + command]
        patterns = {key: re.compile(re.escape(key).replace(r"\*", r"[^\[]+") + r"(\[\].*)?\Z") for key in listed}
        printed = set()
        for run in runs:
            for key in keys_of(run):
                matching = {name for name, pattern in patterns.items() if pattern.match(key)}
                self.assertTrue(matching, f"{command} prints {key}, which is not listed")
                printed |= matching
        self.assertEqual(listed - printed, set(), command)

    def test_build(self):
        self.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n")
        self.write("m.mtl", "newmtl a\nmap_Kd missing.jpg\n")
        self.compare("build",
                     self.results("build", sphere(), "-o", "a.lode", "--trace", "t.json", "--measure-error"),
                     self.results("build", "m.obj", "-o", "b.lode"),
                     self.results("build", big(), "-o", "c.lode", *BUILD, "--memory-limit", LIMIT))

    def test_compare(self):
        self.compare("compare", self.results("compare", sphere(), hierarchy()))

    def test_export(self):
        self.compare("export", self.results("export", hierarchy(), "-o", "m.ply"),
                     self.results("export", hierarchy(), "--tiles", "tiles"))

    def test_generate(self):
        self.compare("generate", self.results("generate", "box", "--triangles", 100, "-o", "m.ply"))

    def test_info(self):
        self.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n")
        self.write("m.mtl", "newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\n")
        self.write("a.png", b"\x89PNG\r\n\x1a\n...")
        self.lodestone("build", "m.obj", "-o", "m.lode")
        self.listed["Command info"].remove("warnings[]")  # only readers of attributes and of tilesets warn
        self.compare("info", self.results("info", hierarchy()), self.results("info", sphere()),
                     self.results("info", "m.lode"), self.results("info", "m.obj"))

    def test_progressive_and_lod(self):
        self.write("m.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
        self.compare("progressive", self.results("progressive", sphere(), "-o", "m.lpm", "--check-levels", 2),
                     self.results("progressive", "m.obj", "-o", "n.lpm"))
        self.compare("lod", self.results("lod", "m.lpm", "--triangles", 1000, "-o", "m.ply"))

    def test_spherical(self):
        self.write("m.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
        self.write("coloured.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 1 1 1 0\n"
                                   "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        self.compare("spherical", self.results("spherical", sphere(), "-o", "m.glb", "--texture", 64, "--maps",
                                  "colour,normal,geometry"),
                     self.results("spherical", "coloured.obj", "-o", "c.glb", "--texture", 64),
                     self.results("spherical", "m.obj", "-o", "n.glb", "--texture", 64))

    def test_reconstruct(self):
        self.compare("reconstruct",
                     self.results("reconstruct", sphere(), "-o", "m.ply", "--resolution", 32, "--measure"))

    def test_render(self):
        probe = self.results("render", hierarchy(), "--frames", 3, "--size", "64x48", "--screen-error", "--kappa0", 1)
        streamed = self.results("render", hierarchy(), "--frames", 2, "--size", "64x48", "--memory-budget", "1MiB",
                                "--backend", "null")
        scene = command_case.call("render", hierarchy(), "--frames", 2, "--size", "64x48", "--backend", "gl", "--json",
                                  "gl.json", cwd=self.folder)
        self.assertEqual(scene.returncode, 0)
        gl = json.loads((self.folder / "gl.json").read_text())
        self.listed["Command render"] -= {"fallback", "frames[].draw_calls"} - set(keys_of(gl))
        self.compare("render", probe, streamed, gl)

    def test_verify(self):
        self.compare("verify", self.results("verify", hierarchy()))

    def test_experiments_list_their_columns(self):
        for experiment in self.results("experiments"):
            self.assertEqual(self.listed["Experiment " + experiment["name"]],
                             {column["name"] for column in experiment["columns"]})

    def test_commands_and_experiments_agree(self):
        """A key that the command and the experiment of a subject share means the same in both."""
        text = self.lodestone("experiments", "--schema")
        rows = {title: dict(re.findall(r"^\| `([^`]+)` \| ([^|]*) \|", part, re.MULTILINE))
                for title, part in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)}
        for subject, other, shared in (("build", "build", 20), ("build", "table", 25), ("progressive", "progressive", 10),
                                       ("render", "flight", 15), ("reconstruct", "reconstruct", 25)):
            command = {name.removeprefix("levels[]."): unit for name, unit in rows["Command " + subject].items()}
            both = command.keys() & rows["Experiment " + other].keys()
            self.assertGreaterEqual(len(both), shared, (subject, both))
            for name in both:
                self.assertEqual(command[name], rows["Experiment " + other][name], (subject, name))


if __name__ == "__main__":
    command_case.main(__doc__)
