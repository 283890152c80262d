"""The faults that scripts/mutate plants. usage: test_mutants.py SOURCE_DIR COMPILER"""

import collections
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mutants  # noqa: E402
import trials  # noqa: E402

COMPILER = sys.argv.pop()
SOURCE_DIR = sys.argv.pop()

# Each function holds a fault, of those in it the last one by the order of the rules: (body, x and y, what it gives without
# and with it; None: not tried).
FUNCTIONS = [
    ("return x < y;", (2, 2), 0, 1), ("return x <= y;", (2, 2), 1, 0),
    ("return x > y;", (2, 2), 0, 1), ("return x >= y;", (2, 2), 1, 0),
    ("return x == y;", (2, 3), 0, 1), ("return x != y;", (2, 3), 1, 0),
    ("return x + y;", (2, 3), 5, -1), ("return x - y;", (2, 3), -1, 5),
    ("x += y; return x;", (2, 3), 5, -1),
    ("return x * (y + 1);", (2, 3), 8, 6), ("return x * (y - 1);", (2, 3), 4, 6),
    ("return std::min(x, y);", (2, 3), 2, 3), ("return std::max({x, y, 1});", (2, 3), 3, 1),
    ("return int(std::ceil(x / 2.0));", (3, 0), 2, 1), ("return int(std::floor(x / 2.0));", (3, 0), 1, 2),
    ("return x && y;", (0, 3), 0, 1), ("return x || y;", (2, 0), 1, 0),
    ("if (!x) return y; return 7;", (0, 3), 3, 7),
    ("const auto f = [] { return true; }; return f() * x;", (2, 0), 2, 0),
    ("for (int i = 0; i != x;) { ++i, ++y; continue; }  return y;", (2, 3), 5, None),
    ("while (true) { if (x++ * x) break; return 9; } return 4;", (1, 0), 4, 9),
    ("static std::mutex m; const std::lock_guard lock(m); return x * m.try_lock();", (2, 0), None, 2),
]


def changed(text):
    return {mutant.apply(text) for mutant in mutants.mutants_of("x.cpp", text)}


class Mutants(unittest.TestCase):
    def test_each_kind(self):
        for text, expected in [
            ("if (a < b) c;", {"if (a <= b) c;"}),
            ("a == b", {"a != b"}),
            ("x = a + b;", {"x = a - b;"}),
            ("x = a + 1;", {"x = a;"}),
            ("x = a - 1.5;", {"x = a + 1.5;"}),
            ("x += a;", {"x -= a;"}),
            ("std::min(a, b)", {"std::max(a, b)"}),
            ("if (!a || b) c;", {"if (a || b) c;", "if (!a && b) c;"}),
            ("return true;", {"return false;"}),
            ("if (a) continue;", {"if (a) ;"}),
            ("const std::scoped_lock lock(m);", {""}),
        ]:
            self.assertEqual(changed(text), expected, text)

    def test_what_is_not_code_is_left_alone(self):
        for text in ["// a < b", "/* a\n < b */", 'f("a < b");', "#if a < b", "assert(a < b);", "std::vector<int> v;",
                     "static_assert(a == b);", "x = '\\'' ;", "constexpr int n = a + b;", "if constexpr (!a) b;"]:
            self.assertEqual(changed(text), set(), text)

    def test_operands_of_logical_operators(self):
        for text, left, right in [
            ("x = f(a, b) && c[d, e] || g;", "f(a, b)", "c[d, e]"),
            ("return a == b && !c;", "a == b", "!c"),
            ("if (a || b && (c || d)) e;", "b", "(c || d)"),
            ("f(a, b && c ? d : e)", "b", "c"),
        ]:
            found = [m for m in mutants.mutants_of("x.cpp", text) if "both" in m.planted]
            self.assertEqual([m.planted for m in found], [
                f"planted::both<#>([&] {{ return bool({left}); }}, [&] {{ return bool({right}); }})"], text)

    def test_planted_faults_do_what_they_say_when_they_are_on(self):
        text = "#include <algorithm>\n#include <cmath>\n#include <cstdio>\n#include <cstdlib>\n#include <mutex>\n"
        calls, faults = "", {}
        for k, (body, (x, y), _, _) in enumerate(FUNCTIONS):
            function = f"int f{k}(int x, int y) {{ {body} }}\n"
            found = list(mutants.mutants_of("x.cpp", function))
            text += mutants.plant(function, {k: found[-1]}).split("\n", 1)[1]
            calls += f"case {k}: return std::printf(\"%d\", f{k}({x}, {y})), 0;\n"
        text += f"int main(int, char** a) {{ switch (std::atoi(a[1])) {{ {calls} }} }}\n"
        with tempfile.TemporaryDirectory() as folder:
            source, program, seen = (pathlib.Path(folder) / name for name in ("x.cpp", "x", "seen"))
            source.write_text(f'#include "{mutants.HEADER}"\n' + text)
            subprocess.run([COMPILER, "-std=c++20", "-w", source, "-o", program], check=True)
            for k, (body, _, right, wrong) in enumerate(FUNCTIONS):
                seen.write_bytes(bytes(2 * len(FUNCTIONS)))
                for environment, expected in [({"PLANTED_SEEN": str(seen)}, right), ({"PLANTED": str(k)}, wrong),
                                              ({"PLANTED": str(k + 1)}, right)]:
                    if expected is None:
                        continue
                    done = subprocess.run([program, str(k)], env=environment, capture_output=True, text=True, timeout=20)
                    self.assertEqual(done.stdout, str(expected), f"{body} {environment}")
                if right is not None:
                    marks = seen.read_bytes()
                    self.assertEqual([n for n in range(len(FUNCTIONS)) if marks[2 * n]], [k], body)
                    self.assertEqual(marks[2 * k + 1], 1, body)

    def test_those_planted_together_do_not_touch(self):
        found = list(mutants.mutants_of("x.cpp", "a < b && c;\nd + e;\n"))
        self.assertEqual(len(found), 3)
        kept = list(mutants.apart(found))
        self.assertEqual([m.kind for m in kept], ["comparison", "sign"])
        self.assertIn("planted::less<4>{} < b && c", mutants.plant("a < b && c;\nd + e;\n", {4: kept[0], 5: kept[1]}))

    def test_files_of_a_folder_may_be_compiled_together(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            build = root / "build/release"
            part = build / "merged/core/mesh/part__1.cpp"
            part.parent.mkdir(parents=True)
            part.write_text('#include "core/mesh/a.cpp"\n#include "core/mesh/b.cpp"\n')
            (root / "alone.cpp").write_text('#include "alone.h"\n')
            entries = [{"file": str(part)}, {"file": str(root / "alone.cpp")}]
            (build / "compile_commands.json").write_text(json.dumps(entries))
            self.assertEqual(mutants.commands_by_source(build, root), {
                "core/mesh/a.cpp": entries[0], "core/mesh/b.cpp": entries[0], "alone.cpp": entries[1]})

    def test_near_and_quick_tests_come_first(self):
        def trial(name, folder, seconds, sees):
            made = trials.Trial(name, [f"/b/tests/{folder}/{name}"], "", {}, True)
            made.seconds, made.sees = seconds, sees
            return made
        tests = [trial("far", "render", 1, {3: "changed"}), trial("quick", "render", 0.1, {3: "changed"}),
                 trial("near", "core/mesh", 2, {3: "changed"}), trial("blind", "core/mesh", 0.1, {3: "reached"})]
        self.assertEqual([t.name for t in trials.in_order(tests, 3, "core/mesh/clean.cpp")], ["near", "quick", "far"])

    def test_what_a_test_sees_outlives_a_run(self):
        first, second = (trials.Trial("t", ["/b/tests/core/t"], "", {}, True) for _ in range(2))
        first.seconds, first.sees = 1.5, {3: "changed", 7: "reached"}
        second.recall(json.loads(json.dumps(first.recorded())))
        self.assertEqual((second.seconds, second.sees), (1.5, first.sees))

    def test_lines(self):
        self.assertEqual({(m.kind, m.line) for m in mutants.mutants_of("x.cpp", "a;\nb < c;\nd + e;\n")},
                         {("comparison", 2), ("sign", 3)})

    def test_the_sources_give_thousands_of_all_kinds(self):
        found = list(mutants.all_mutants(SOURCE_DIR))
        kinds = collections.Counter(mutant.kind for mutant in found)
        self.assertGreater(len(found), 2000)
        self.assertEqual(set(kinds), {kind for kind, *_ in mutants.RULES})
        chosen = list(mutants.choose(found, 1))
        self.assertEqual(chosen, list(mutants.choose(found, 1)))
        self.assertNotEqual(chosen, list(mutants.choose(found, 2)))
        self.assertEqual(len({m.file for m in chosen[:40]}), 10)
        self.assertEqual({m.file for m in chosen}, {m.file for m in found})

    def test_large_files_are_drawn_more_often(self):
        found = [mutants.Mutant(file, n, "sign", n, n + 1, "", n, n + 1, "") for file, n in
                 [("large", n) for n in range(300)] + [("small", n) for n in range(100)]]
        first = sum(next(mutants.choose(found, seed)).file == "large" for seed in range(400))
        self.assertAlmostEqual(first / 400, 0.75, delta=0.07)


if __name__ == "__main__":
    unittest.main()
