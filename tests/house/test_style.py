"""Functions have their size and clear parameters, comments and messages are plain English. usage: test_style.py SOURCE_DIR"""

import pathlib
import sys
import tempfile
import unittest

import style

SOURCE_DIR = pathlib.Path(__file__).resolve().parents[2]


class SourceTree(unittest.TestCase):
    maxDiff = None

    def test_functions_have_their_size(self):
        self.assertEqual(list(style.large_functions(SOURCE_DIR)), [])

    def test_no_bools_side_by_side(self):
        self.assertEqual(list(style.adjacent_bools(SOURCE_DIR)), [])

    def test_ids_have_types(self):
        self.assertEqual(list(style.bare_ids(SOURCE_DIR)), [])

    def test_english_is_plain(self):
        found = list(style.plain_english(SOURCE_DIR))
        print(f"not plain English: {len(found)} places; at most {style.MAX_NOT_PLAIN}")
        self.assertLessEqual(len(found), style.MAX_NOT_PLAIN, "\n".join(found))


class Checks(unittest.TestCase):
    """Each check finds what it is there for."""

    def test_functions(self):
        cases = {
            "int f();": ("f", 0, 0),
            "int f(std::map<int, int> a, F (*g)(int, int), int b = {1, 2}) { return 1; }": ("f", 1, 3),
            "template <class T>\nT C::f(T a,\n       T b) const noexcept -> T {\n  if (a) { b; }\n}": ("C::f", 5, 2),
            "C::C(int a) : a_{a}, b_(2) {\n}": ("C::C", 2, 1),
            "TEST(A, B) {\n  // }\n  f(\"}\", '{');\n}": ("TEST", 4, 0),
        }
        for code, expected in cases.items():
            for before, after in [("", ""), ("namespace n {\nstruct S {\n", "};\n}\n"), ("// {\n#define X {\n", "")]:
                with self.subTest(code=before + code):
                    found = [entry[1:] for entry in style.functions(before + code + "\n" + after)]
                    self.assertIn(expected, found)

    def test_large_functions(self):
        with tempfile.TemporaryDirectory() as folder:
            lines = "\n" * (style.MAX_LINES - 2)
            (pathlib.Path(folder) / "a.cpp").write_text(
                f"void fits(int, int, int, int, int, int) {{{lines}\n}}\nvoid no() {{{lines}\n\n}}\n"
                "void many(int, int, int, int, int, int, int);\n")
            found = list(style.large_functions(folder))
            self.assertEqual([line.split()[1:4] for line in found], [["no", "has", "61"], ["many", "takes", "7"]])

    def test_adjacent_bools(self):
        clear = ["void f(bool a, int b, bool c);", "f(true, 1, false);", "for (const bool a : {false, true}) f(a);",
                 "f({.a = true, .b = false});", "bool a = true, b = false;", 'f("true, false");  // true, false']
        unclear = ["void f(bool a, bool b);", "void f(bool a = true,\n       const bool b = false);",
                   "std::function<void(bool, bool)> f;", "f(true, false);", "S s{1, true, true};"]
        with tempfile.TemporaryDirectory() as folder:
            for text in clear + unclear:
                (pathlib.Path(folder) / "a.cpp").write_text(text + "\n")
                with self.subTest(text=text):
                    self.assertEqual(len(list(style.adjacent_bools(folder))), text in unclear)

    def test_bare_ids(self):
        clear = ["void f(CellId cell);", "std::uint32_t f(std::uint32_t group);", "std::uint32_t cell = 0;"]
        bare = ["void f(std::uint32_t cell);", "void f(std::size_t vertex,\n       int level);"]
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "render").mkdir()
            for text in clear + bare:
                (pathlib.Path(folder) / "render" / "a.h").write_text(text + "\n")
                with self.subTest(text=text):
                    self.assertEqual(len(list(style.bare_ids(folder))), text in bare)

    def test_plain_english(self):
        plain = ["// Whatever it is.", "// The largest one.\n// Of two equal ones the first.", "x;  // offset",
                 "// There is no more.", "// Where it is flat, nothing moves.", '"there is no file"', "// it is no longer"]
        not_plain = ["// Of two equal ones the first.", "int x = 0;  // Whether it is so", "# What runs prints",
                     'fail("is no number");', "// whoever calls", "# How far it is", "// Where it is."]
        with tempfile.TemporaryDirectory() as folder:
            for text in plain + not_plain:
                (pathlib.Path(folder) / "a.cpp").write_text(text + "\n")
                with self.subTest(text=text):
                    self.assertEqual(len(list(style.plain_english(folder))), text in not_plain)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        SOURCE_DIR = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
