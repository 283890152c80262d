"""The faults that scripts/mutate plants. usage: test_mutants.py SOURCE_DIR"""

import collections
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mutants  # noqa: E402

SOURCE_DIR = sys.argv.pop()


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
                     "static_assert(a == b);", "x = '\\'' ;"]:
            self.assertEqual(changed(text), set(), text)

    def test_lines_and_order(self):
        text = "a;\nb < c;\nd + e;\n"
        found = list(mutants.choose(mutants.mutants_of("x.cpp", text), 1))
        self.assertEqual({(m.kind, m.line) for m in found}, {("comparison", 2), ("sign", 3)})

    def test_the_sources_give_thousands_of_all_kinds(self):
        found = list(mutants.all_mutants(SOURCE_DIR))
        kinds = collections.Counter(mutant.kind for mutant in found)
        self.assertGreater(len(found), 2000)
        self.assertEqual(set(kinds), {kind for kind, _, _ in mutants.RULES})
        first = list(mutants.choose(found, 1))
        self.assertEqual(first, list(mutants.choose(found, 1)))
        self.assertEqual(len(first), len(found))
        self.assertEqual({mutant.kind for mutant in first[:len(kinds)]}, set(kinds))


if __name__ == "__main__":
    unittest.main()
