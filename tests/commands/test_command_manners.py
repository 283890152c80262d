"""Manners of the command: exit statuses, suggestions, the completion of shells, the manual. usage: test_command_manners.py PROGRAM"""

import os
import re
import shutil
import signal
import subprocess
import unittest

import command_case
from command_case import FILE, INPUT, NEGATIVE, RESOURCE, UNSUPPORTED, USAGE, CommandCase, hierarchy, sphere

MANDOC = shutil.which("mandoc")
MAN = shutil.which("man")


def subcommands():
    overview = command_case.call("--help").stdout.decode()
    return re.findall(r"^  ([a-z]+) ", overview.split("Subcommands:")[1].split("Exit status:")[0], re.MULTILINE)


def long_options(name):
    text = command_case.call(name, "--help").stdout.decode().split("Options:\n")[1].split("Examples:")[0]
    return set(re.findall(r"^  (?:-\w,)?(--[a-z0-9-]+)", text, re.MULTILINE))


class Statuses(CommandCase):
    def expect(self, status, *arguments, **more):
        done = command_case.call(*arguments, cwd=self.folder, **more)
        self.assertEqual(done.returncode, status, (arguments, done.stderr.decode()))
        return done

    def test_are_told_by_the_help(self):
        listed = re.findall(r"^  (\d+) +\w", self.lodestone("--help").split("Exit status:")[1], re.MULTILINE)
        self.assertEqual([int(status) for status in listed], [0, 1, 2, 3, 4, 5, 6, 7, 128 + signal.SIGINT])

    def test_of_a_negative_result(self):
        self.lodestone("generate", "box", "--triangles", 100, "-o", "box.ply")
        done = self.expect(NEGATIVE, "verify", hierarchy(), "--input", "box.ply")
        self.assertIn(b"FAILS", done.stdout)

    def test_of_a_wrong_command_line(self):
        for arguments in ((), ("biuld",), ("build",), ("build", "a", "-o", "b.lode", "--sigma1", 2),
                          ("build", "a", "-o", "b.lode", "--levels", 16), ("build", "a", "-o", "b.ply"),
                          ("build", "a", "-o", "b.lode", "--memory-limit", "much"), ("lod", sphere(), "-o", "b.ply"),
                          ("build", "a", "-o", "b.lode", "--grid", "big"), ("render", hierarchy(), "--size", "big", "-o", "b")):
            self.expect(USAGE, *arguments)

    def test_of_wrong_content(self):
        self.write("m.ply", "no mesh at all")
        self.expect(INPUT, "build", "m.ply", "-o", "m.lode")
        self.expect(INPUT, "export", hierarchy(), "--level", 14, "-o", "m.ply")

    def test_of_files(self):
        self.expect(FILE, "build", "none.ply", "-o", "m.lode")
        self.expect(FILE, "generate", "box", "-o", "none/m.ply")

    def test_of_what_is_not_supported(self):
        self.write("m.fbx", "Kaydara FBX Binary  ")
        self.expect(UNSUPPORTED, "build", "m.fbx", "-o", "m.lode")
        self.expect(UNSUPPORTED, "info", "m.fbx")
        self.expect(UNSUPPORTED, "view", hierarchy(), environment={"DISPLAY": ":987", "WAYLAND_DISPLAY": ""})

    def test_of_limits(self):
        self.expect(RESOURCE, "build", sphere(), "-o", "m.lode", "--memory-limit", "1MB")


class Suggestions(CommandCase):
    def test_name_what_was_meant(self):
        for arguments, meant in ((("biuld",), "build"), (("veryfi", "m.lode"), "verify"), (("recons",), "reconstruct"),
                                 (("build", "a", "-o", "b.lode", "--sigma", 1), "--sigma0"),
                                 (("build", "a", "-o", "b.lode", "--mesure-error"), "--measure-error"),
                                 (("render", "a", "--cemara", "orbit"), "--camera")):
            self.assertTrue(self.refused(*arguments).endswith(f"; did you mean {meant}?\n"), arguments)

    def test_are_not_guessed(self):
        for arguments in (("quux",), ("sweep-ru",), ("build", "a", "-o", "b.lode", "--quux")):
            line = self.refused(*arguments)
            self.assertNotIn("did you mean", line)
            self.assertIn("--help", line)


class Completion(CommandCase):
    def bash(self, line):
        """What bash offers after this beginning of a line."""
        script = self.lodestone("completion", "bash")
        words = line.split(" ")
        driver = script + f"""
COMP_WORDS=({' '.join(f"'{word}'" for word in words)})
COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_lodestone
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
        done = subprocess.run(["bash", "--norc", "-euc", driver], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""), line)
        return done.stdout.split()

    def test_of_bash_knows_subcommands_options_and_choices(self):
        self.assertEqual(self.bash("lodestone "), [*subcommands(), "--help", "--version"])
        self.assertEqual(self.bash("lodestone re"), ["render", "reconstruct", "report"])
        for name in subcommands():
            self.assertEqual(set(self.bash(f"lodestone {name} --")), long_options(name), name)
        self.assertEqual(self.bash("lodestone spherical --eff"), ["--effort"])
        self.assertEqual(self.bash("lodestone spherical --effort "), ["fast", "normal", "best"])
        self.assertEqual(self.bash("lodestone spherical --effort = n"), ["normal"])
        self.assertEqual(self.bash("lodestone completion "), ["bash", "zsh", "fish"])

    def test_of_bash_leaves_files_to_the_shell(self):
        script = self.lodestone("completion", "bash")
        self.assertIn("complete -o bashdefault -o default -F _lodestone lodestone\n", script)
        for line in ("lodestone build ", "lodestone build scan", "lodestone build scan.ply -o ", "lodestone build --sigma0 "):
            self.assertEqual(self.bash(line), [], line)

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_of_fish(self):
        self.write("lodestone.fish", self.lodestone("completion", "fish"))

        def offered(line):
            done = subprocess.run(["fish", "--no-config", "-c", f"source lodestone.fish; complete -C '{line}'"], cwd=self.folder,
                                  capture_output=True, text=True, check=True, env={**os.environ, "HOME": str(self.folder)})
            self.assertEqual(done.stderr, "")
            return [words.split("\t")[0] for words in done.stdout.splitlines()]

        self.assertEqual(set(offered("lodestone ")), set(subcommands()))
        for name in subcommands():
            self.assertEqual({word for word in offered(f"lodestone {name} --")}, long_options(name), name)
        self.assertEqual(sorted(offered("lodestone spherical --effort ")), ["best", "fast", "normal"])

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_of_zsh(self):
        self.write("_lodestone", self.lodestone("completion", "zsh"))
        for name in subcommands():
            # The arguments that the shell's own function gets: each option, and what may follow it.
            script = (f"_arguments() {{ print -rl -- \"$@\" }}; _describe() {{ print -rl -- $commands }}; "
                      f"words=(lodestone {name} ''); CURRENT=3; source ./_lodestone")
            done = subprocess.run(["zsh", "-fc", script], cwd=self.folder, capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            specs = done.stdout.splitlines()
            named = {word for spec in specs for word in re.findall(r"^(?:\([^)]*\))?(--[a-z0-9-]+)", spec)}
            self.assertEqual(named, long_options(name), name)
        self.assertIn("(fast normal best)", (self.folder / "_lodestone").read_text())


class Manual(CommandCase):
    def setUp(self):
        super().setUp()
        self.lodestone("manual", "-o", "pages")
        self.pages = {path.name: path for path in (self.folder / "pages").iterdir()}

    def test_has_a_page_for_each_subcommand(self):
        self.assertEqual(set(self.pages), {"lodestone.1", *(f"lodestone-{name}.1" for name in subcommands())})
        overview = self.pages["lodestone.1"].read_text()
        for name in subcommands():
            self.assertIn(f"lodestone\\-{name} (1)", overview)
            text = self.pages[f"lodestone-{name}.1"].read_text().replace("\\-", "-")
            for option in long_options(name):
                self.assertIn(option, text, name)
            for section in ("NAME", "SYNOPSIS", "OPTIONS", "EXAMPLES", "EXIT STATUS", "SEE ALSO"):
                self.assertIn(f".SH {section}\n", text)

    @unittest.skipUnless(MANDOC, "mandoc is not installed")
    def test_is_what_mandoc_takes(self):
        done = subprocess.run([MANDOC, "-T", "lint", "-W", "warning", *self.pages.values()], capture_output=True, text=True,
                              check=False)
        # Pages of one version are the same whenever they are written.
        self.assertEqual([line for line in done.stdout.splitlines() if "missing date" not in line], [])

    @unittest.skipUnless(MAN, "man is not installed")
    def test_is_what_man_takes(self):
        for path in self.pages.values():
            done = subprocess.run([MAN, "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", path], capture_output=True, text=True,
                                  check=False, env={**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "80"})
            self.assertEqual((done.returncode, done.stderr), (0, ""), path)

    @unittest.skipUnless(MANDOC, "mandoc is not installed")
    def test_keeps_every_character(self):
        """Backslashes and dots at the beginning of a line are not taken for commands."""
        text = subprocess.run([MANDOC, "-T", "ascii", "-O", "width=1000", self.pages["lodestone-spherical.1"]], capture_output=True,
                              text=True, check=True).stdout
        text = re.sub(".\b", "", text)
        for piece in (".glb (every viewer shows it) or .lpm (small)", "--effort fast|normal|best", "Default: normal",
                      "lodestone spherical statue.obj -o statue.glb"):
            self.assertIn(piece, text)


if __name__ == "__main__":
    command_case.main(__doc__)
