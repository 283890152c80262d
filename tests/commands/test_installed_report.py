"""lodestone report of an installed program: its package is the one below the prefix. usage: FILE PROGRAM"""

import pathlib

import command_case
import sweep_folder
from command_case import CommandCase


class Installed(CommandCase):
    def test_the_package_is_the_installed_one(self):
        python = self.write("python", '#!/bin/sh\necho "$PYTHONPATH"\n')
        python.chmod(0o755)
        done = command_case.call("report", "x", "-o", "x.html", cwd=self.folder, environment={"LODESTONE_PYTHON": str(python)})
        folder = pathlib.Path(done.stdout.decode().strip().split(":")[0])
        self.assertEqual(folder, pathlib.Path(command_case.PROGRAM).parents[1] / "share/lodestone/python")
        self.assertTrue((folder / "lodestone_report/templates/report.css").is_file())

    def test_a_report_is_written(self):
        sweep_folder.make(self.folder / "ablation")
        self.lodestone("report", "ablation", "-o", "report.html", "--quiet")
        self.assertIn("</html>", (self.folder / "report.html").read_text())


if __name__ == "__main__":
    command_case.main(__doc__)
