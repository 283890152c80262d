"""Sweeps in shards, and their folders brought together. usage: test_command_sweep_shards.py PROGRAM"""

import json

import command_case
from sweep_case import HEAD, SweepCase, section


class Shards(SweepCase):
    TEXT = HEAD + section("x = [1, 2, 3, 4, 5]", "repetitions = 2")

    def test_in_one_directory(self):
        counts = [self.sweep(self.TEXT, "--resume", "--shard", f"{i}/3")["ran"] for i in (1, 2, 3)]
        self.assertEqual((sum(counts), max(counts)), (10, 4))
        self.check_complete()

    def test_merged_from_several(self):
        for i in (1, 2, 3):
            self.sweep(self.TEXT, "--shard", f"{i}/3", output=f"part{i}")
        merged = self.results("merge", "part1", "part2", "part3", "-o", "all", "--quiet")
        self.assertEqual(merged, {"name": "test", "repetitions": 10, "done": 10, "taken": 10, "failed": 0, "missing": 0})
        self.check_complete("all")
        again = self.results("merge", "part1", "-o", "all", "--quiet")
        self.assertEqual(again["taken"], 0)
        self.sweep(self.TEXT.replace("x = [", "x = [7, "), output="other")
        self.refused("merge", "part1", "other", "-o", "both", names=["other", "not the same sweep"])
        self.refused("merge", "part1", "nowhere", "-o", "both", names=["nowhere", "holds no sweep"])

    def test_merging_keeps_failures_and_ends_with_them(self):
        self.write("sweep.toml", HEAD + section('failure = ["none", "error", "verify"]'))
        self.failing_sweep("sweep.toml", "-o", "part", names=["2 of 3"])
        self.failing("merge", "part", "-o", "all", "--quiet", "--json", "merged.json",
                     names=["all: of 3 repetitions, 2 failed and 0 are missing"])
        merged = json.loads((self.folder / "merged.json").read_text())
        self.assertEqual((merged["done"], merged["failed"], merged["taken"]), (2, 2, 3))
        self.check_clean("all")

    def test_merging_too_few_ends_with_what_is_missing(self):
        self.sweep(self.TEXT, "--shard", "1/3", output="part1")
        self.failing("merge", "part1", "-o", "all", names=["of 10 repetitions, 0 failed and 6 are missing"])
        self.sweep(self.TEXT, "--resume", output="all")
        self.check_complete("all")

    def test_dry_run_of_merging_counts_and_writes_nothing(self):
        for i in (1, 2):
            self.sweep(self.TEXT, "--shard", f"{i}/3", output=f"part{i}")
        before = self.listing()
        told = self.lodestone("merge", "part1", "part2", "part1", "-o", "all", "--dry-run")
        self.assertEqual(told, "all: 8 of 10 repetitions would be taken over, 8 have rows, 0 failed, 2 missing\n")
        self.assertEqual(self.listing(), before)

    def test_merging_refuses_what_does_not_go_with_it(self):
        self.sweep(self.TEXT, output="part")
        for option in (["--resume"], ["--shard", "1/2"], ["--small"], ["--jobs", 2], ["--prepare"]):
            self.refused("merge", "part", "-o", "all", *option, names=[option[0], "--help"])
        self.refused("sweep", "sweep.toml", "-o", "out", "--prepare", "--dry-run", names=["--prepare", "--dry-run"])

    def test_merging_into_something_else(self):
        self.sweep(self.TEXT, output="part")
        (self.folder / "home").mkdir()
        self.write("home/letter.txt", "dear")
        self.refused("merge", "part", "-o", "home", names=["home", "holds other files"])
        self.refused("merge", "part", "-o", "sweep.toml", names=["is a file"])
        self.sweep(self.TEXT.replace('"test"', '"other"'), output="other")
        self.refused("merge", "part", "-o", "other", names=["other", "holds the sweep 'other'"])

    def test_sweep_json_that_was_changed_is_named(self):
        self.sweep(self.TEXT, output="part")
        whole = self.plan("part")
        for change, says in ((lambda s: s.update(name=3), "'name' is not a text"),
                             (lambda s: s.update(sweeps=3), "'sweeps' is not a list"),
                             (lambda s: s.pop("sweeps"), "has no 'sweeps'"),
                             (lambda s: s["sweeps"].append(3), "has no 'runs'"),
                             (lambda s: s["sweeps"][0].update(repetitions="x"), "'repetitions' is not a count"),
                             (lambda s: s["sweeps"][0]["runs"][0].update(id="../x"), "'id' is not that of a run")):
            sheet = json.loads(json.dumps(whole))
            change(sheet)
            self.write("part/sweep.json", json.dumps(sheet))
            names = ["part/sweep.json", says, "--resume"]
            self.refused("merge", "part", "-o", "all", names=names)
            self.refused("sweep", "sweep.toml", "-o", "part", "--resume", names=names)
            self.refused("sweep", "sweep.toml", "-o", "part", "--dry-run", names=names)
        self.write("part/sweep.json", "[")
        self.refused("merge", "part", "-o", "all", names=["part/sweep.json", "is not a JSON object"])
        (self.folder / "part/sweep.json").unlink()
        self.assertEqual(self.sweep(self.TEXT, "--resume", output="part")["ran"], 0)

    def test_wrong_shard(self):
        self.write("sweep.toml", self.TEXT)
        for shard in ("0/2", "3/2", "x"):
            self.refused("sweep", "sweep.toml", "-o", "out", "--shard", shard, names=[shard, "2/8"])


if __name__ == "__main__":
    command_case.main(__doc__)
