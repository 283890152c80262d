"""Files that are written as a whole or not at all, and the report as CSV and JSON."""

import contextlib
import csv
import io
import json
import os
import pathlib
import tempfile
from dataclasses import asdict

from .findings import count_runs, list_oddities
from .study import row_records


def write(path, content):
    """write_all() of a single file."""
    write_all({path: content})


def write_all(contents):
    """Writes files, {path: bytes}, aside and renames them when all are complete; after an error none has been touched.
    Raises OSError whose filename is the path."""
    temporaries = {}
    try:
        for path, content in contents.items():
            with named(path):
                temporaries[path] = write_aside(pathlib.Path(path), content)
        for path, temporary in list(temporaries.items()):
            with named(path):
                if temporary:
                    os.replace(temporary, pathlib.Path(path).resolve())
            del temporaries[path]
    finally:
        for temporary in filter(None, temporaries.values()):
            os.unlink(temporary)


@contextlib.contextmanager
def named(path):
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        raise


def write_aside(path, content):
    """The name of a complete temporary beside the file that `path` names, symbolic links followed; None where that is not a
    regular file (a pipe), which is written to."""
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return None
    target = path.resolve()
    descriptor, temporary = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    try:
        written = 0
        while written < len(content):
            written += os.pwrite(descriptor, content[written:written + 2**20], written)
        os.fchmod(descriptor, target.stat().st_mode & 0o777 if target.exists() else 0o666 & ~current_umask())
    except BaseException:
        os.unlink(temporary)
        raise
    finally:
        os.close(descriptor)
    return temporary


def current_umask():
    umask = os.umask(0)
    os.umask(umask)
    return umask


def encode(text):
    """UTF-8; names of files need not be, and lose what is not."""
    return text.encode(errors="replace")


def csv_text(value):
    return value if isinstance(value, str) else "" if value is None else json.dumps(value)


def to_csv(studies):
    """Every row of every repetition, with study, sweep, run, data, repetition, state and parameters: RFC 4180, lines end in
    LF, null is an empty field."""
    names, records = row_records(studies)
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([*map(csv_text, record)] for record in records)
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
            "oddities": list_oddities(study), "sweeps": [*map(sweep_json, study.sweeps, study.tables)],
            "figures": [*map(asdict, study.figures)]}


def to_json(studies):
    """Everything, as a tree for JSON: rows, faults and manifests by run, settings summarised over repetitions, figures."""
    return count_runs(sweep for study in studies for sweep in study.sweeps) | {"studies": [*map(study_json, studies)]}


def json_text(tree):
    """The text of a JSON file."""
    return json.dumps(tree, indent=2, sort_keys=True, ensure_ascii=False) + "\n"
