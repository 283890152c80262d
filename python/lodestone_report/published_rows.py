"""All rows of the standard studies as one compressed file with a data sheet (gebru2021), beside the pages of docs/results."""

import gzip

from . import files
from .study import column_names, row_records

ROWS, SHEET = "rows.csv.gz", "rows.md"

COMMON = {  # what every row begins with
    "study": "the file of experiments/studies/standard",
    "sweep": "the part of it",
    "experiment": "what was run; `lodestone experiments NAME` describes it",
    "run": "one setting on one input: rows of one run differ in what the experiment compares, and in `repetition`",
    "data": "the name of the input in the study's file",
    "repetition": "from 0",
    "state": "`verified`: the result was checked and right; anything else is in no table",
}

INTRODUCTION = """# Data sheet of the rows

[{rows}]({rows}) has every row of every run, {count:,} rows of {runs:,} runs, as CSV in UTF-8 with a line of names; the
pages beside it are made of the same rows.

```python
import pandas
rows = pandas.read_csv("{rows}", low_memory=False)
rows = rows[rows.state == "verified"]
```

- **A row** is what an experiment says of one setting on one input in one repetition. An empty field was not measured, or is
  not a matter of that experiment.
- **Where it is from**: `scripts/results` ran the studies, and [the first page](README.md) names commit, machine and date of
  each. Nothing was left out, rounded or mended by hand; runs that failed have no row, and the pages list them.
- **What it is for**: figures other than ours, other statistics, comparison with a machine or a method of your own.
  Times are of one machine, and differ less within a study, whose runs take turns, than between studies.
- **Inputs** are not in it: scripts/models.toml has the source, hash and licence of each, experiments/studies/standard the seed
  of what is generated.
- **Licence**: that of Lodestone. It is written anew as a whole, with the pages, when studies are run.

## Columns
"""


def column_rows(studies):
    """A row for each column: name, unit, what it is, and the studies that have it."""
    found = {}
    parameters, _ = column_names(studies)
    for study in studies:
        for sweep in study.sweeps:
            for name, about in [*((parameters[p.name], p) for p in sweep.parameters), *((c.name, c) for c in sweep.columns)]:
                unit, meaning, where = found.setdefault(name, (about.unit, about.meaning, {}))
                where[study.name] = True
    return [f"| {name} | {unit} | {meaning.replace('|', 'or')} | {', '.join(where)} |"
            for name, (unit, meaning, where) in sorted(found.items())]


def write_rows(studies, target):
    """Writes both files to the folder `target`; without a study there are none. The same rows make the same bytes."""
    if not studies:
        for name in (ROWS, SHEET):
            (target / name).unlink(missing_ok=True)
        return
    text = files.to_csv(studies)
    (target / ROWS).write_bytes(gzip.compress(files.encode(text), mtime=0))
    common = [f"| {name} | | {meaning} | all |" for name, meaning in COMMON.items()]
    runs = sum(len(study.unique_runs()) for study in studies)
    lines = [INTRODUCTION.format(rows=ROWS, count=len(row_records(studies)[1]), runs=runs),
             "| column | unit | what it is | studies |", "| --- | --- | --- | --- |", *common, *column_rows(studies), ""]
    (target / SHEET).write_text("\n".join(lines), encoding="utf-8")
