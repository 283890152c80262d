"""The documents tell the truth about the tree. usage: test_docs.py SOURCE_DIR [PROGRAM]"""

import pathlib
import re
import sys
import tempfile
import unittest

import docs

SOURCE_DIR = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = None


class Documents(unittest.TestCase):
    maxDiff = None

    def markdown(self):
        for path in docs.sources.files(SOURCE_DIR):
            if path.suffix == ".md":
                yield path, docs.sources.text(SOURCE_DIR, path)

    def test_commands_exist(self):
        help_of = docs.Help(PROGRAM) if PROGRAM else None
        found = [line for path, text in self.markdown() for line in docs.commands(SOURCE_DIR, path, text, help_of)]
        self.assertEqual(found, [])

    def test_readme_gives_the_two_commands(self):
        lines = list(docs.shell_lines((SOURCE_DIR / "README.md").read_text()))
        self.assertIn("scripts/demo", lines)
        self.assertIn("scripts/test", lines)

    def test_links_resolve(self):
        self.assertEqual([line for path, text in self.markdown() for line in docs.links(SOURCE_DIR, path, text)], [])

    def test_architecture_names_what_there_is(self):
        path = "docs/architecture.md"
        self.assertEqual(list(docs.names(SOURCE_DIR, path, (SOURCE_DIR / path).read_text())), [])

    def test_paths_exist(self):
        found = [line for path, text in self.markdown() if path.name != "CHANGELOG.md"  # which names what is gone, too
                 for line in docs.paths(SOURCE_DIR, path, text)]
        self.assertEqual(found, [])

    def test_decisions_have_numbers_of_their_own(self):
        numbers = [path.name[:4] for path in (SOURCE_DIR / "docs/decisions").glob("*.md")]
        self.assertEqual(sorted(numbers), sorted(set(numbers)))
        for path in (SOURCE_DIR / "docs/decisions").glob("*.md"):
            self.assertRegex(path.read_text(), rf"\A# {path.name[:4]} ")

    def test_changelog_is_by_version(self):
        headings = re.findall(r"(?m)^## (.*)$", (SOURCE_DIR / "CHANGELOG.md").read_text())
        self.assertRegex(headings[0], r"^\d+\.\d+\.\d+ \(Unreleased\)$|^\d+\.\d+\.\d+$")
        versions = [tuple(map(int, heading.split()[0].split("."))) for heading in headings]
        self.assertEqual(versions, sorted(versions, reverse=True))

    def test_one_version(self):
        header = (SOURCE_DIR / "core/base/version.h").read_text()
        version = ".".join(re.findall(r"(?m)^#define LODESTONE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)$", header))
        pattern = {"CITATION.cff": r"(?m)^version: ([\d.]+)$", "render/web/package.json": r'"version": "([\d.]+)"',
                   "render/web/README.md": r"lodestone-web-([\d.]+)\.tgz", "CHANGELOG.md": r"(?m)^## ([\d.]+)"}
        found = {name: re.search(text, (SOURCE_DIR / name).read_text())[1] for name, text in pattern.items()}
        self.assertEqual(set(found.values()), {version}, found)

    def test_files_have_their_size(self):
        for lines, path in docs.long_files(SOURCE_DIR):
            print(f"long: {lines} lines in {path}")
        self.assertEqual(list(docs.sizes(SOURCE_DIR)), [])

    def test_tests_are_named_alike(self):
        self.assertEqual(list(docs.test_names(SOURCE_DIR)), [])

    def test_no_path_of_one_machine(self):
        self.assertEqual(list(docs.local_paths(SOURCE_DIR)), [])

    def test_citations_are_in_the_bibliography(self):
        self.assertEqual(list(docs.citations(SOURCE_DIR)), [])


class Checks(unittest.TestCase):
    """Each check finds what it is there for, on a small tree made for the purpose."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write("CMakePresets.json", '{"configurePresets": [{"name": "release"}]}')
        self.write("docs/bibliography.bib", "@article{noether1918,\n title = {x}\n}\n")

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return pathlib.PurePosixPath(name)

    def test_links(self):
        self.write("docs/b.md", "# Some heading, here\n")
        path = self.write("a.md", "[x](docs/b.md) [y](docs/b.md#some-heading-here) [z](https://example.org) `[q](r)`\n")
        self.assertEqual(list(docs.links(self.root, path, (self.root / path).read_text())), [])
        for bad in ["[x](docs/c.md)", "![x](image.png)", "[x](docs/b.md#other)", "[x](#nowhere)"]:
            self.assertEqual(len(list(docs.links(self.root, path, bad))), 1, bad)

    def test_names(self):
        self.write("core/a.h", "struct Cell { int first_child; };\nvoid build_block(const Cell&);\n")
        good = "`build_block`, `Cell::first_child`, `core/a.h`, `core/a`, `word`, `build/PRESET`"
        self.assertEqual(list(docs.names(self.root, "a.md", good)), [])
        for bad in ["`build_blocks`", "`Cell::last_child`", "`core/b.h`", "`StarDistance`"]:
            self.assertEqual(len(list(docs.names(self.root, "a.md", bad))), 1, bad)

    def test_paths(self):
        self.write("core/mesh/weld.h", "")
        good = "the folder core/mesh, core/mesh/weld.h and core/mesh/weld, below scripts/, hardcore/x, [a](../core/link)"
        self.assertEqual(list(docs.paths(self.root, "a.md", good)), [])
        for bad in ["core/weld", "(core/mesh/welt.h)", "parallel/mesh."]:
            self.assertEqual(len(list(docs.paths(self.root, "a.md", bad))), 1, bad)

    def test_commands(self):
        answers = {(): "Subcommands:\n  build  Build it\n", ("fly",): "-o", ("build",): "-o FILE  --sigma0 FLOAT"}

        def check(line):
            markdown = f"```sh\n{line}\n```\n"
            return list(docs.commands(self.root, "a.md", markdown, lambda *subcommand: answers.get(subcommand)))

        script = self.root / self.write("scripts/demo", "")
        self.write("scripts/data", "")
        script.chmod(0o755)
        good = ["scripts/demo", "cmake --preset release", "lodestone build in.ply -o x.lode --sigma0 0.2  # why --not",
                "lodestone build in.ply \\\n  -o x.lode"]
        bad = ["scripts/none", "scripts/data", "cmake --preset fast", "lodestone fly x", "lodestone build --sigma1 2"]
        for line in good:
            self.assertEqual(check(line), [], line)
        for line in bad:
            self.assertEqual(len(check(line)), 1, line)

    def test_sizes(self):
        self.write("core/a.cpp", "\n" * docs.MAX_LINES)
        self.assertEqual(list(docs.sizes(self.root)), [])
        self.write("core/b.cpp", "\n" * (docs.MAX_LINES + 1))
        self.write("big.ply", "x" * (docs.MAX_BYTES + 1))
        found = list(docs.sizes(self.root))
        self.assertEqual([line.split(":")[0] for line in found], ["big.ply", "core/b.cpp"])
        self.assertEqual([path for _, path in docs.long_files(self.root)], ["core/b.cpp", "core/a.cpp"])

    def test_test_names(self):
        self.write("tests/core/test_a.cpp", "")
        self.write("tests/core/a_test.h", "")
        self.write("core/a_test.cpp", "")
        self.assertEqual(list(docs.test_names(self.root)), [])
        self.write("tests/core/b_test.cpp", "")
        self.assertEqual(list(docs.test_names(self.root)), ["tests/core/b_test.cpp: call it test_b.cpp"])

    def test_local_paths(self):
        top, home = "/" + "work", "/" + "root"
        self.write("a.md", f"core{top}, the {home}s, build{home}/x, https://example.org/home/x\n")
        self.assertEqual(list(docs.local_paths(self.root)), [])
        for bad in [f"see {top}/x", f'"{top}"', f"({top}/main)", f"cd {home}"]:
            self.write("a.md", bad)
            self.assertEqual(len(list(docs.local_paths(self.root))), 1, bad)

    def test_citations(self):
        self.write("a.md", "Noether 1918, Noether (1918), noether1918, in May 2020 and C++ 2020\n")
        self.assertEqual(list(docs.citations(self.root)), [])
        for bad in ["Gauss 1918", "Gauss et al. 1918", "Gauss & Weber 1918", "Noether 1919", "(gauss1918)"]:
            self.write("a.md", bad)
            self.assertEqual(len(list(docs.citations(self.root))), 1, bad)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        SOURCE_DIR = pathlib.Path(sys.argv.pop(1)).resolve()
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        PROGRAM = sys.argv.pop(1)
    unittest.main()
