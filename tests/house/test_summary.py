"""The page and the text of scripts/summary.py show what the files of a folder say. usage: test_summary.py SOURCE_DIR"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE_DIR = pathlib.Path(__file__).resolve().parents[2]
BUILD = {"input_triangles": 1000, "stored_triangles": 1500, "levels": 3, "sigma0": 0.2, "file_seconds": 1.25,
         "mtri_per_core_second": 2.5, "peak_bytes": 2**20}
VERIFY = {"valid": True, "checks": [{"name": "a<b", "passed": True, "detail": "7 examined"}]}
RENDER = {"frames": [{"triangles": 10}, {"triangles": 2000}], "frame_ms_median": 1.5, "open_edges": 0, "gap_max": 0,
          "jump_pixels": 0.5, "viewpoint_step": 3, "jump_over_bound": 0.9}


class Summary(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, **files):
        for name, content in files.items():
            (self.folder / f"{name.replace('_', '-')}.json").write_text(json.dumps(content))

    def run_script(self, *arguments):
        return subprocess.run([sys.executable, "-B", SOURCE_DIR / "scripts/summary.py", *arguments], capture_output=True,
                              text=True, timeout=60)

    def test_text_and_page_agree(self):
        self.write(build_ball=BUILD, verify_ball=VERIFY, render_soft=RENDER, render_scan=RENDER)
        done = self.run_script(self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        page = (self.folder / "summary.html").read_text()
        for fact in ("1,500 (1.50 of the input)", "10 - 2,000", "The hierarchy of ball is valid: 1 checks.", "0.900"):
            self.assertIn(fact, done.stdout)
            self.assertIn(fact, page)
        self.assertIn("a<b", done.stdout)
        self.assertIn("a&lt;b", page)
        self.assertLess(page.index('src="scan/contact.png"'), page.index('src="soft/contact.png"'))

    def test_failures_are_shown(self):
        failed = {"valid": False, "checks": [{"name": "reach", "passed": False, "detail": "cell 3"}]}
        self.write(build_ball=BUILD, verify_ball=failed, render_soft=RENDER)
        done = self.run_script(self.folder)
        for text in (done.stdout, (self.folder / "summary.html").read_text()):
            self.assertIn("NOT VALID", text)
            self.assertIn("FAILED", text)

    def test_errors(self):
        self.assertIn("usage", self.run_script().stderr)
        self.write(build_ball=BUILD, verify_ball=VERIFY)
        self.assertIn("needs build-*.json", self.run_script(self.folder).stderr)
        (self.folder / "render-soft.json").write_text("{")
        self.assertIn("render-soft.json", self.run_script(self.folder).stderr)


if __name__ == "__main__":
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        SOURCE_DIR = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
