"""The layering holds, and the check that says so finds what breaks it. usage: test_layering.py SOURCE_DIR"""

import pathlib
import sys
import tempfile
import unittest
import unittest.mock

import layering

SOURCE_DIR = pathlib.Path(__file__).resolve().parents[2]


class SourceTree(unittest.TestCase):
    maxDiff = None

    def test_has_no_violation(self):
        self.assertEqual(list(layering.violations(SOURCE_DIR)), [])

    def test_was_looked_at(self):
        """An empty listing would pass the test above, too."""
        paths = [str(path) for path in layering.sources.files(SOURCE_DIR)]
        for known in ["core/math/vec3.h", "parallel/scheduler/tbb_scheduler.cpp", "render/frame/renderer.h", "experiments/command_line/version.h"]:
            self.assertIn(known, paths)


class Checker(unittest.TestCase):
    """On small trees made for the purpose."""

    def found(self, files):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = pathlib.Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
                if path.suffix in {".h", ".cpp"} and not (path.parent / "CMakeLists.txt").exists():
                    (path.parent / "CMakeLists.txt").write_text("# A folder.\n")
            return list(layering.violations(folder))

    def assert_refused(self, files, *words):
        found = self.found(files)
        self.assertEqual(len(found), 1, found)
        for word in words:
            self.assertIn(word, found[0])

    def test_accepts_includes_along_the_arrow(self):
        self.assertEqual(self.found({
            "core/a.h": "#include <vector>\n",
            "parallel/b.h": '#include "core/a.h"\n',
            "parallel/b.cpp": '#include <oneapi/tbb/task_arena.h>\n#include "parallel/b.h"\n',
            "render/backends/gl/c.cpp": '#include <epoxy/gl.h>\n#include "parallel/b.h"\n',
            "experiments/d.h": '#include "core/a.h"\n',
            "tests/core/t.cpp": '#include <gtest/gtest.h>\n#include "experiments/d.h"\n',
        }), [])

    def test_refuses_includes_against_the_arrow(self):
        folders = layering.LAYERS
        for i, lower in enumerate(folders):
            for upper in [*folders[i + 1:], *layering.SEES_ALL]:
                with self.subTest(lower=lower, upper=upper):
                    self.assert_refused({f"{upper}/a.h": "", f"{lower}/b.h": f'#include "{upper}/a.h"\n'},
                                        f"{lower}/b.h", f"{upper}/a.h")

    def test_refuses_includes_between_bench_and_tests(self):
        self.assert_refused({"tests/a.h": "", "bench/b.cpp": '#include "tests/a.h"\n'}, "bench/b.cpp")

    def test_refuses_relative_and_unknown_includes(self):
        self.assert_refused({"core/a.h": "", "core/b.h": '#include "a.h"\n'}, "core/b.h", "path from its root")
        self.assert_refused({"core/b.h": '# include "core/none.h"\n'}, "core/none.h")

    def test_refuses_circles_between_folders(self):
        """Each case closes its circle at another depth, and nowhere else."""
        cases = {
            "core/x:": ["core/x/a/1.h core/x/b/1.h", "core/x/b/2.h core/x/a/2.h"],
            "core:": ["core/x/a/1.h core/y/a/1.h", "core/y/b/1.h core/x/b/1.h"],
            "core/x: includes form a circle: core/x/": ["core/x/1.h core/x/a/b/1.h", "core/x/a/2.h core/x/2.h"],
        }
        for parent, includes in cases.items():
            files = {file: f'#include "{name}"\n' for file, name in map(str.split, includes)}
            files.update({name: "" for _, name in map(str.split, includes) if name not in files})
            with self.subTest(parent=parent):
                self.assertTrue(any(line.startswith(parent) for line in self.found(files)), self.found(files))

    def test_accepts_includes_along_a_chain_of_folders(self):
        self.assertEqual(self.found({
            "core/x/a/1.h": '#include "core/x/b/1.h"\n#include "core/x/a/2.h"\n', "core/x/a/2.h": "",
            "core/x/b/1.h": '#include "core/y/1.h"\n', "core/y/1.h": '#include "core/0.h"\n', "core/0.h": "",
        }), [])

    def test_refuses_types_of_one_name(self):
        tile = "namespace lodestone {\nstruct Tile {\n};\n}\n"
        self.assertEqual(self.found({"core/a/a.h": tile, "core/b/b.h": tile.replace("lodestone", "lodestone::b"),
                                     "core/b/c.cpp": tile, "core/b/d.h": "namespace lodestone {\nstruct Tile;\n}\n"}), [])
        self.assert_refused({"core/a/a.h": tile, "render/b.h": tile.replace("struct Tile", "class Tile final : public A")},
                            "lodestone::Tile", "core/a/a.h and render/b.h")

    def test_refuses_folders_that_are_full_or_do_not_say_what_they_are(self):
        files = {f"core/a{i}.{kind}": "" for i in range(layering.MAX_SUBJECTS) for kind in ["h", "cpp"]}
        self.assertEqual(self.found(files), [])
        self.assert_refused({**files, "core/b.h": ""}, "core", "26 subjects")
        for text in ["", "project(x)\n", "# No full stop\n", "# Two lines.\n# And more.\n"]:
            with self.subTest(text=text):
                self.assert_refused({"core/a/CMakeLists.txt": text, "core/a/b.h": ""}, "core/a/CMakeLists.txt")

    def test_refuses_libraries_out_of_their_place(self):
        cases = {
            "parallel/a.h": "#include <oneapi/tbb/flow_graph.h>\n",
            "core/b.cpp": "#include <tbb/parallel_for.h>\n",
            "render/c.cpp": "void f() { oneapi::tbb::this_task_arena::max_concurrency(); }\n",
            "render/backends/soft/d.cpp": "#include <GL/gl.h>\n",
            "experiments/e.cpp": "#include <epoxy/egl.h>\n",
            "tests/f.cpp": "#include <GLFW/glfw3.h>\n",
            "render/backends/gl/g.cpp": "#include <imgui.h>\n",
            "core/h.cpp": "#include <glm/glm.hpp>\n",
            "core/simplify/i.cpp": "#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>\n",
            "render/j.cpp": "#include <CLI/CLI.hpp>\n",
            "core/k.cpp": "#include <thread>\n",
            "core/l.cpp": "#include <mutex>\n",
            "core/m.cpp": "#include <gtest/gtest.h>\n",
            "core/n.cpp": "#include <iostream>\n",
            "experiments/o.cpp": "#include <benchmark/benchmark.h>\n",
            "core/CMakeLists.txt": "target_link_libraries(lodestone_core PRIVATE TBB::tbb)\n",
            "experiments/CMakeLists.txt": "target_link_libraries(lodestone_experiments PRIVATE OpenGL::EGL)\n",
            "render/CMakeLists.txt": "target_link_libraries(lodestone_render PRIVATE OpenMeshCore)\n",
        }
        for name, text in cases.items():
            with self.subTest(name=name):
                self.assert_refused({name: text}, name)

    def test_ignores_comments_but_not_what_follows_them(self):
        self.assertEqual(self.found({"core/a.h": '// #include "render/a.h"\n/* tbb::flow\n#include <thread> */\n'}), [])
        self.assert_refused({"core/a.h": 'const char* url = "http://x"; /* */ int y = tbb::z;\n'}, "oneTBB")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        SOURCE_DIR = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
