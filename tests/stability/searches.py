"""What scripts/fuzz, scripts/matrix and scripts/mutate have found, from their logs, as a section of docs/stability.md."""

import collections
import datetime
import json
import re

HEAD = "## Searches for faults"
FOUND = "\n### What they found\n"  # written by hand

FUZZ = """
`scripts/fuzz` gives each reader, `simplify` and the selection of cells whatever libFuzzer makes of the corpus, under the
address and undefined-behaviour sanitizers: an input fails that ends the program, takes more than a minute or 2 GiB, or breaks
what the harness asserts. Edges are those of our code that the inputs reach before and after a search, which begins with the
corpus and with what earlier ones have kept. The last run of each, with its processor time:

| harness | inputs | edges before | edges after | failed | s | date |
| --- | ---: | ---: | ---: | --- | ---: | --- |
{rows}
"""

MATRIX = """
`scripts/matrix` runs the tests under each preset, built anew where it has changed. The last run of each:

| preset | tests | verdict | commit | minutes | date |
| --- | --- | --- | --- | ---: | --- |
{rows}
"""

MUTATE = """
`scripts/mutate` plants small faults, each of which a test should notice. Of {count} faults at commit {commit} ({date})
{tests}caught {caught} ({share:.1f} %): {kinds}.
"""


def date_of(files):
    return datetime.date.fromtimestamp(max(file.stat().st_mtime for file in files))


def fuzz_row(log):
    """None for a search that has not ended."""
    text = log.read_text(errors="replace")
    seconds = re.search(r"(\d+) s of processor time", text)
    failed = re.search(r"SUMMARY: (.*)", text)
    if not seconds and not failed:
        return None
    runs = re.search(r"stat::number_of_executed_units: (\d+)", text)
    edges = re.findall(r"cov: (\d+)", text)
    inited = re.search(r"INITED cov: (\d+)", text)
    return (f"| {log.stem} | {int(runs[1]) if runs else 0:,} | {inited[1] if inited else 0} | {edges[-1] if edges else 0} | "
            f"{failed[1] if failed else 'none'} | {seconds[1] if seconds else 0} | {date_of([log])} |")


def fuzzing(build, old):
    """A harness without a log keeps the row that it has in the old text."""
    rows = {row.split()[1]: row for row in re.findall(r"^\| \w+ \| [\d,]+ \|.*$", old, re.MULTILINE)}
    rows |= {log.stem: row for log in (build / "fuzz").glob("*.log") if (row := fuzz_row(log))}
    return FUZZ.format(rows="\n".join(rows[name] for name in sorted(rows))) if rows else ""


def presets(build, old):
    """From lines as `asan passed at 12ab34c: all, 95 minutes, 2026-01-31`; a preset without one keeps its row of the old text."""
    rows = {row.split()[1]: row for row in re.findall(r"^\| \w+ \| all.*$", old, re.MULTILINE)}
    for file in (build / "matrix").glob("*"):
        said = re.fullmatch(r"(\w+) (\w+) at (\w+): (all[^,]*), (\d+) minutes, ([\d-]+)\n", file.read_text())
        if said:                                       # of a commit, and not of some of the tests alone
            name, verdict, commit, tests, minutes, date = said.groups()
            rows[name] = f"| {name} | {tests} | {verdict} | {commit} | {minutes} | {date} |"
    return MATRIX.format(rows="\n".join(rows[name] for name in sorted(rows))) if rows else ""


def mutation(build):
    logs = sorted((build / "mutate").glob("*.jsonl"), key=lambda log: log.stat().st_mtime)
    if not logs:
        return ""
    rows = [json.loads(line) for line in logs[-1].read_text().splitlines()]
    kinds = collections.defaultdict(list)
    for row in rows:
        kinds[row["kind"]].append(row["caught"])
    caught = sum(row["caught"] for row in rows)
    return MUTATE.format(date=date_of(logs[-1:]), count=len(rows), commit=logs[-1].name.split("-")[0], caught=caught,
                         tests="the tests of the nearest folder alone " if logs[-1].stem.endswith("-near") else "the tests ",
                         share=100 * caught / max(1, len(rows)),
                         kinds=", ".join(f"{kind} {sum(k)} of {len(k)}" for kind, k in sorted(kinds.items())))


def place(page):
    """Where the section is, with the empty line before it; without one, where it belongs: before the views."""
    begin = page.find(f"\n{HEAD}\n")
    if begin < 0:
        begin = end = page.index("\n## Views\n")
        return begin, end
    return begin, page.index("\n## ", begin + 1)


def section(build, page):
    """From the logs below a folder `build`; where there are none, and for what was found, the text of the page remains."""
    begin, end = place(page)
    old, found = (page[begin:end][len(HEAD) + 2:] + FOUND).split(FOUND)[:2]
    at = old.find(MUTATE[:MUTATE.index(" plants")])
    listed, mutated = (old, "") if at < 0 else (old[:at], old[at:])
    return (f"\n{HEAD}\n" + fuzzing(build, listed) + presets(build, listed) + (mutation(build) or mutated) +
            (FOUND + found if found else ""))
