"""The section on scripts/fuzz, scripts/matrix and scripts/mutate in docs/stability.md."""

import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import searches  # noqa: E402

PAGE = "# Hard input\n\n## Views\n\nThe test.\n"
LOG = """#9	INITED cov: 12 ft: 1
#99	DONE   cov: 34 ft: 2
Done 1234 runs in 120 second(s)
stat::number_of_executed_units: 1234
fuzz: ply: 90 s of processor time
"""


class Searches(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.build = pathlib.Path(folder.name)

    def page(self, page):
        begin, end = searches.place(page)
        return page[:begin] + searches.section(self.build, page) + page[end:]

    def test_logs_make_the_section_and_without_them_it_remains(self):
        (self.build / "fuzz").mkdir()
        (self.build / "fuzz/ply.log").write_text(LOG)
        (self.build / "fuzz/off.log").write_text(LOG + "SUMMARY: AddressSanitizer: odd\n")
        (self.build / "fuzz/obj.log").write_text(LOG.split("Done")[0])  # still runs
        (self.build / "matrix").mkdir()
        (self.build / "matrix/asan").write_text("asan passed at abc1234: all but page and packages, 95 minutes, 2026-01-31\n")
        (self.build / "matrix/tsan").write_text("tsan FAILED at abc1234, changed: all, 5 minutes, 2026-01-31\n")
        (self.build / "matrix/clang").write_text("clang passed at abc1234: -R Image, 5 minutes, 2026-01-31\n")
        (self.build / "mutate").mkdir()
        rows = [{"kind": "sign", "caught": True}, {"kind": "bound", "caught": False}]
        (self.build / "mutate/abc-release-1-2-near.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        page = self.page(PAGE)
        self.assertIn("| ply | 1,234 | 12 | 34 | none | 90 | 20", page)
        self.assertIn("| off | 1,234 | 12 | 34 | AddressSanitizer: odd | 90 | 20", page)
        self.assertNotIn("| obj |", page)
        self.assertIn("| asan | all but page and packages | passed | abc1234 | 95 | 2026-01-31 |", page)
        self.assertNotIn("| tsan |", page)
        self.assertNotIn("| clang |", page)
        self.assertIn("Of 2 faults at commit abc (", page)
        self.assertIn("the tests of the nearest folder alone caught 1 (50.0 %): bound 0 of 1, sign 1 of 1.", page)
        self.assertTrue(page.endswith("\n## Views\n\nThe test.\n"))
        page = page.replace("\n## Views", "\n### What they found\n\nA fault.\n\n## Views")
        self.assertEqual(self.page(page), page)
        for file in (*self.build.glob("fuzz/*"), *self.build.glob("matrix/*"), *self.build.glob("mutate/*")):
            file.unlink()
        self.assertEqual(self.page(page), page)
        (self.build / "fuzz/off.log").write_text(LOG)
        page = self.page(page)
        self.assertIn("| off | 1,234 | 12 | 34 | none |", page)
        self.assertIn("| ply | 1,234 | 12 | 34 | none |", page)


if __name__ == "__main__":
    unittest.main()
