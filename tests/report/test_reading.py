"""Folders that break the contract of sweeps are refused, with file, line and fault."""

import json
import unittest

from report_case import FolderCase
import lodestone_report as lr
from sweep_folder import small_study


class Reading(FolderCase):
    def setUp(self):
        super().setUp()
        self.study = small_study(self.folder / "study")
        self.study.write()
        self.run = self.study.path / "runs" / self.study.sheet["sweeps"][0]["runs"][1]["id"]

    def refused(self, path, says):
        with self.assertRaises(lr.StudyError) as caught:
            lr.load(self.study.path)
        message = str(caught.exception)
        self.assertTrue(message.startswith(f"{path}: "), message)
        self.assertIn(says, message)
        self.assertNotIn("\n", message)

    def test_broken_lines_are_named(self):
        path = self.run / "rows.1.jsonl"
        for line, says in (('{"seconds": 1', "is not JSON"), ("3", "is not an object"), ('{"length": 2}', "'length' is not a column"),
                           ('{"seconds": [1]}', "'seconds' is neither"), ('{"seconds": NaN}', "is not JSON"), ("", "is not JSON"),
                           ('{"seconds": 1e999}', "is not JSON"), ("[" * 9999, "is not JSON"), ('{"gap": "\udcff"}', "is not JSON")):
            path.write_bytes(('{"seconds": 1}\n' + line + "\n").encode(errors="surrogateescape"))
            self.refused(f"{path}: line 2", says)

    def test_broken_files_are_named(self):
        for name in ("fault.0.json", "manifest.0.json", "parameters.json"):
            path = self.run / name
            whole = path.read_bytes() if path.exists() else None
            for text, says in (("{", "is not JSON"), ("[]", "is not an object")):
                path.write_text(text)
                self.refused(path, says)
            path.unlink() if whole is None else path.write_bytes(whole)
        lr.load(self.study.path)

    def test_broken_sheets_are_named(self):
        path = self.study.path / "sweep.json"
        for change, says in ((lambda s: s.pop("sweeps"), "has no 'sweeps'"),
                             (lambda s: s.update(name=3), "'name' is not a text"),
                             (lambda s: s.update(figures=3), "'figures' is not a list"),
                             (lambda s: s["figures"][0].update(sweep=["x"]), "a sweep 'x' that is not there"),
                             (lambda s: s["figures"][0].update(kind="pie"), "figures[0]: 'kind' is not line, scatter or bar"),
                             (lambda s: s["figures"][0].update(y=[]), "names no sweep or no y"),
                             (lambda s: s["figures"][0].update(series=[1]), "'series' holds something else than texts"),
                             (lambda s: s["sweeps"][0].update(repetitions=-1), "sweeps[0]: 'repetitions' is not a count"),
                             (lambda s: s["sweeps"][0].update(repetitions=True), "'repetitions' is not a count"),
                             (lambda s: s["sweeps"][0]["columns"][0].update(kind="x"), "label, accuracy, quality, cost or count"),
                             (lambda s: s["sweeps"][0]["runs"][0].update(id="../x"), "runs[0]: 'id' is not the name of a folder"),
                             (lambda s: s["sweeps"][0]["runs"][0].update(parameters=[]), "'parameters' is not an object")):
            sheet = json.loads(json.dumps(self.study.sheet))
            change(sheet)
            path.write_text(json.dumps(sheet))
            self.refused(path, says)
        path.write_text("{")
        self.refused(path, "is not JSON")

    def test_folders_of_something_else_are_refused(self):
        path = self.study.path / "sweep.json"
        path.unlink()
        self.refused(self.study.path, "has no sweep.json; `lodestone sweep")
        for name, says in (("none", "no such folder"), ("file", "is not a folder")):
            (self.folder / "file").write_text("")
            with self.assertRaisesRegex(lr.StudyError, says):
                lr.load(self.folder / name)


if __name__ == "__main__":
    unittest.main()
