"""The report as files: markup of the page, figures beside it, all or nothing."""

import errno
import json
import os
import pathlib
import re
import unittest
from unittest import mock

from report_case import FolderCase
import sweep_folder
import lodestone_report as lr
from lodestone_report.writing import write_all
from lodestone_report.page import make_page
from sweep_folder import small_study


class Page(FolderCase):
    def study(self, **more):
        study = small_study(self.folder / "study", **more)
        study.figure("Time & cost", "border", "kappa0", "seconds")
        return study

    def test_nothing_of_the_data_is_markup(self):
        page = make_page([lr.load(self.study(gap="<b>'\"&", title="</script><script>&'", question="a\x07b").write())])
        self.assertNotIn("<b>", page)
        self.assertNotIn("</script><script>", page)
        self.assertIn("<h1>&lt;/script&gt;&lt;script&gt;&amp;&#39;</h1>", page)
        self.assertIn("a b", page, "control characters are not part of HTML")
        data = json.loads(re.search('id="data-json">(.*?)</script>', page)[1])
        self.assertEqual(data["studies"][0]["title"], "</script><script>&'")

    def test_figures_have_files_of_their_own_and_outdated_ones_go(self):
        study = self.study()
        lr.write_report(study.write(), self.folder / "page.html", json=self.folder / "page.json")
        names = [f"{stem}{suffix}" for stem in ("01-gaps", "02-time-cost") for suffix in (".csv", ".pdf", ".svg")]
        folder = self.folder / "page_figures"
        self.assertEqual(sorted(p.name for p in folder.iterdir()), names)
        (folder / "notes.svg").write_text("the reader's own")
        study.sheet["figures"].pop(0)
        lr.write_report([lr.load(study.write())], self.folder / "page.html")
        self.assertEqual(sorted(p.name for p in folder.iterdir()), ["01-time-cost.csv", "01-time-cost.pdf", "01-time-cost.svg", "notes.svg"])

    def test_after_an_error_nothing_has_been_written(self):
        self.study().write()
        real, room = os.pwrite, 0

        def pwrite(*arguments):
            nonlocal room
            room -= 1
            if room < 0:
                raise OSError(errno.ENOSPC, "No space left on device")
            return real(*arguments)

        (self.folder / "page.html").write_text("before")
        before = sorted(self.folder.iterdir())
        for files_written in range(3):
            room = files_written
            with mock.patch("os.pwrite", pwrite), self.assertRaises(OSError) as caught:
                lr.write_report(self.folder / "study", self.folder / "page.html", csv=self.folder / "rows.csv")
            self.assertTrue(caught.exception.filename.startswith(str(self.folder)), caught.exception.filename)
            self.assertEqual(sorted(self.folder.iterdir()), before)
            self.assertEqual((self.folder / "page.html").read_text(), "before")

    def test_links_are_followed_modes_kept_and_devices_written_to(self):
        target, link = self.folder / "target", self.folder / "link"
        target.write_text("before")
        target.chmod(0o640)
        link.symlink_to(target)
        write_all({link: b"after"})
        self.assertTrue(link.is_symlink())
        self.assertEqual((target.read_bytes(), target.stat().st_mode & 0o777), (b"after", 0o640))
        write_all({pathlib.Path("/dev/null"): b"gone"})
        self.assertFalse(os.path.isfile("/dev/null"))

    def test_drawing_that_fails_is_a_note_and_numbers_are_written(self):
        self.study().write()
        with mock.patch("lodestone_report.plot.draw", side_effect=RuntimeError("no font")):
            note = lr.write_report(self.folder / "study", self.folder / "page.html")
        self.assertEqual(note, "matplotlib could not draw the plots: no font")
        self.assertIn(note, (self.folder / "page.html").read_text())
        self.assertEqual(sorted(p.name for p in (self.folder / "page_figures").iterdir()), ["01-gaps.csv", "02-time-cost.csv"])

    def test_pictures_of_a_run_go_together_and_only_once(self):
        folder = sweep_folder.make(self.folder / "ablation")
        study = lr.load(folder)
        one = sum(path.stat().st_size for path in next(run for run in study.unique_runs() if run.pictures).pictures)
        for room, shown in ((0, 0), (one - 1, 0), (one, 3), (1 << 20, 12)):
            page = make_page([study], picture_bytes=room)
            self.assertEqual(page.count("<img"), shown)
            self.assertEqual("Left out for their size" in page, shown < 12)
        self.assertEqual(make_page([study, study]).count("<img"), 12)


if __name__ == "__main__":
    unittest.main()
