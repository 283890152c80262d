"""The packages of Debian, unpacked: they hold what they should, and the program runs. usage: test_packages.py FOLDER VERSION"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

FOLDER, VERSION = None, None


def run(*arguments, **more):
    return subprocess.run([*map(str, arguments)], capture_output=True, text=True, check=True, **more).stdout


def package(name):
    found, = pathlib.Path(FOLDER).glob(f"{name}_*.deb")
    return found


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name)
        cls.names = {path.name.split("_")[0] for path in pathlib.Path(FOLDER).glob("*.deb")}
        for name in cls.names:
            run("dpkg-deb", "-x", package(name), cls.root / name)
        cls.program = cls.root / "lodestone/usr/bin/lodestone"

    def test_depend_on_what_they_link(self):
        depends = run("dpkg-deb", "-f", package("lodestone"), "Depends")
        for library in ("libtbb12", "libc6", "libpng16-16", "libfmt9"):
            self.assertIn(library, depends)
        depends = run("dpkg-deb", "-f", package("lodestone-dev"), "Depends")
        for library in ("libtbb-dev", "libopenmesh-dev", "libmeshoptimizer-dev"):
            self.assertIn(library, depends)
        self.assertEqual(run("dpkg-deb", "-f", package("lodestone"), "Version").strip(), VERSION)
        self.assertLessEqual({"lodestone", "lodestone-dev"}, self.names)

    def test_hold_a_program_that_runs(self):
        self.assertEqual(run(self.program, "--version").strip(), VERSION)
        run(self.program, "generate", "sphere", "--triangles", 2000, "-o", "m.ply", cwd=self.root)
        run(self.program, "build", "m.ply", "-o", "m.lode", cwd=self.root)
        self.assertIn("valid", run(self.program, "verify", "m.lode", "--input", "m.ply", cwd=self.root))

    def test_hold_manual_and_completions(self):
        share = self.root / "lodestone/usr/share"
        self.assertTrue((share / "man/man1/lodestone-build.1.gz").is_file())
        for name in ("bash-completion/completions/lodestone", "zsh/vendor-completions/_lodestone",
                     "fish/vendor_completions.d/lodestone.fish", "doc/lodestone/copyright",
                     "lodestone/python/lodestone_report/__init__.py"):
            self.assertTrue((share / name).is_file(), name)
        # bash finds it under the name of the command.
        offered = run("bash", "--norc", "-ec", f". {share}/bash-completion/completions/lodestone; COMP_WORDS=(lodestone re); "
                      "COMP_CWORD=1; _lodestone; echo ${COMPREPLY[@]}")
        self.assertEqual(offered.split(), ["render", "reconstruct", "report"])

    def test_hold_the_page(self):
        page = self.root / "lodestone/usr/share/lodestone/page"
        if not (page / "page.js").exists():
            self.skipTest("the page is not built")
        (page / "page.js").write_text("the installed page")  # not the one that was built
        run(self.program, "generate", "sphere", "--triangles", 200, "-o", "p.ply", cwd=self.root)
        run(self.program, "page", "p.ply", "-o", "page", cwd=self.root, env={"PATH": ""})  # neither node nor npm
        self.assertEqual((self.root / "page/page.js").read_text(), "the installed page")
        self.assertTrue((self.root / "page/models/p.lpm").is_file())

    def test_hold_the_command_of_mpi_jobs(self):
        if "lodestone-mpi" not in self.names:
            self.skipTest("lodestone-mpi is not built")
        self.assertIn("libopenmpi", run("dpkg-deb", "-f", package("lodestone-mpi"), "Depends"))
        root = self.root / "lodestone-mpi/usr"
        run(root / "bin/lodestone-mpi", "build", "--generate", "sphere:2000", "-o", "mpi.lode", cwd=self.root)
        self.assertIn("valid", run(self.program, "verify", "mpi.lode", cwd=self.root))
        self.assertTrue((root / "share/lodestone/lodestone-mpi.sbatch").is_file())

    def test_hold_a_package_for_python(self):
        if "python3-lodestone" not in self.names:
            self.skipTest("the Python package is not built")
        self.assertIn("python3-numpy", run("dpkg-deb", "-f", package("python3-lodestone"), "Depends"))
        modules = self.root / "python3-lodestone/usr/lib/python3/dist-packages"
        script = ("import lodestone, lodestone_report; print(lodestone.__version__, lodestone.__file__); "
                  "print(lodestone.verify(lodestone.build(lodestone.generate('box', triangles=12)))['valid'])")
        said = run("/usr/bin/python3", "-B", "-c", script, env={"PYTHONPATH": str(modules)})
        self.assertEqual(said.split(), [VERSION, str(modules / "lodestone/__init__.py"), "True"])
        self.assertTrue((modules / "lodestone/_lodestone.pyi").is_file())

    def test_hold_libraries_that_are_found(self):
        libraries = self.root / "lodestone-dev/usr/lib"
        for name in ("cmake/lodestone/lodestoneConfig.cmake", "pkgconfig/lodestone-core.pc", "liblodestone_core.a"):
            self.assertEqual(len(list(libraries.rglob(name))), 1, name)
        for config in (self.root / "lodestone-dev").rglob("*.cmake"):
            self.assertNotIn(str(pathlib.Path(FOLDER).parents[2]), config.read_text(), config)


if __name__ == "__main__":
    FOLDER, VERSION = sys.argv[1:3]
    del sys.argv[1:3]
    unittest.main(verbosity=2)
