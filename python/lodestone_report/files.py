"""Files that are written as a whole or not at all, and the report as CSV and JSON."""

import csv
import io
import json
from dataclasses import asdict

from .findings import count_runs
from .study import row_records
from .text import plain


def encode(text):
    """UTF-8; names of files need not be, and lose what is not."""
    return text.encode(errors="replace")


def to_csv(studies):
    """Every row of every repetition, with study, sweep, run, data, repetition, state and parameters: RFC 4180, lines end in
    LF, null is an empty field."""
    names, records = row_records(studies)
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(["" if value is None else plain(value) for value in record] for record in records)
    return file.getvalue()


def cell_json(cell):
    if not cell.is_number or (cell.count < 2 and cell.least == cell.most):
        return cell.value
    return {"median": cell.value, "least": cell.least, "most": cell.most, "count": cell.count}


def repetition_json(r):
    members = {"repetition": r.number, "manifest": r.manifest, "rows": r.rows, "fault": r.fault and asdict(r.fault)}
    return {key: value for key, value in members.items() if value is not None}


def run_json(run):
    return {"id": run.id, "data": run.data, "parameters": run.parameters, "program": run.program, "input": run.input,
            "input_sha256": run.input_sha256, "state": run.state, "unsteady": run.unsteady,
            "repetitions": [*map(repetition_json, run.repetitions)]}


def sweep_json(sweep, table):
    settings = [{"run": s.run.id, "values": {name: cell_json(cell) for name, cell in s.cells.items()}} for s in table.settings]
    return {"name": sweep.name, "experiment": sweep.experiment, "question": sweep.question,
            "runs": [*map(run_json, sweep.runs)], "settings": settings}


def study_json(study):
    return {"name": study.name, "title": study.title, "question": study.question, "program": study.program,
            "oddities": study.oddities, "sweeps": [*map(sweep_json, study.sweeps, study.tables)],
            "figures": [*map(asdict, study.figures)]}


def to_json(studies):
    """Everything, as a tree for JSON: rows, faults and manifests by run, settings summarised over repetitions, figures."""
    return count_runs(sweep for study in studies for sweep in study.sweeps) | {"studies": [*map(study_json, studies)]}


def json_text(tree):
    """The text of a JSON file."""
    return json.dumps(tree, indent=2, sort_keys=True, ensure_ascii=False) + "\n"
