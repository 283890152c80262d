"""The directory of a sweep, read and checked against docs/format.md."""

import json
import math
import pathlib

from .runs import COLUMN_KINDS, FIGURE_KINDS, Column, Fault, FigureRequest, Repetition, Run, StudyError, Sweep
from .study import Study
from .text import plain
from .values import is_number


def refuse_constant(name):
    raise ValueError(f"{name} is not a number of JSON")


def parse_float(text):
    value = float(text)
    return value if math.isfinite(value) else refuse_constant(text)


def fail(path, place, what):
    raise StudyError(": ".join(filter(None, (str(path), place, what))))


def read_bytes(path):
    try:
        return path.read_bytes()
    except OSError as error:
        fail(path, "", f"cannot be read: {error.strerror}")


def parse(content, path, place=""):
    try:
        return json.loads(content, parse_constant=refuse_constant, parse_float=parse_float)
    except (ValueError, RecursionError) as error:
        position = getattr(error, "pos", getattr(error, "start", 0))
        fail(path, place, f"is not JSON, from character {position + 1} on")


class Entry:
    """An object of a file, whose members are asked for by name and kind."""

    def __init__(self, value, path, place=""):
        self.value, self.path, self.place = value, path, place
        if not isinstance(value, dict):
            self.fail("is not an object")

    def fail(self, what):
        fail(self.path, self.place, what)

    def member(self, key):
        if key not in self.value:
            self.fail(f"has no '{key}'")
        return self.value[key]

    def text(self, key, *default):
        """A text; one that is missing or null is the default, where there is one."""
        if default and self.value.get(key) is None:
            return default[0]
        if not isinstance(self.member(key), str):
            self.fail(f"'{key}' is not a text")
        return self.value[key]

    def count(self, key):
        value = self.member(key)
        if type(value) is not int or not 0 <= value <= 1000000:
            self.fail(f"'{key}' is not a count")
        return value

    def texts(self, key):
        """One text stands for a list of one."""
        value = self.value.get(key, [])
        value = value if isinstance(value, list) else [value]
        if not all(isinstance(entry, str) for entry in value):
            self.fail(f"'{key}' holds something else than texts")
        return value

    def entries(self, key):
        value = self.member(key)
        if not isinstance(value, list):
            self.fail(f"'{key}' is not a list")
        prefix = f"{self.place}." if self.place else ""
        return [Entry(entry, self.path, f"{prefix}{key}[{i}]") for i, entry in enumerate(value)]


def read_entry(path):
    return Entry(parse(read_bytes(path), path), path)


def read_figure(o):
    figure = FigureRequest(o.text("title"), o.texts("sweep"), o.text("x"), o.texts("y"), o.texts("series"),
                           o.text("kind", "") or "line", o.text("log", ""), o.text("mark", ""),
                           o.value.get("pareto") is True, o.value.get("where", {}))
    if figure.kind not in FIGURE_KINDS:
        o.fail("'kind' is not line, scatter or bar")
    if not figure.sweeps or not figure.y:
        o.fail("names no sweep or no y")
    if not isinstance(figure.where, dict):
        o.fail("'where' is not an object")
    return figure


def read_column(o):
    if o.text("kind") not in COLUMN_KINDS:
        o.fail("'kind' is not label, accuracy, quality, cost or count")
    return Column(o.text("name"), o.text("unit", ""), o.text("meaning", ""), o.text("kind"))


def read_rows(path, columns, verified):
    """Rows as JSON lines, each a flat object with columns of the experiment. Rows that did not verify need not be: what is
    wrong with them has been said."""
    lines, rows = read_bytes(path).split(b"\n"), []
    for number, line in enumerate(lines if lines[-1] else lines[:-1], 1):
        place = f"line {number}"
        row = parse(line, path, place)
        if verified:
            entry = Entry(row, path, place)
            for name, value in row.items():
                if name not in columns:
                    entry.fail(f"'{name}' is not a column of the experiment")
                if isinstance(value, (dict, list)):
                    entry.fail(f"'{name}' is neither number, text nor truth value")
        if isinstance(row, dict):
            rows.append(row)
    return rows


def read_repetition(folder, number, columns):
    repetition = Repetition(number)
    fault, rows, manifest = (folder / f"{name}" for name in
                             (f"fault.{number}.json", f"rows.{number}.jsonl", f"manifest.{number}.json"))
    if fault.exists():
        entry = read_entry(fault)
        repetition.fault = Fault(entry.text("kind"), entry.texts("messages"))
    if rows.exists():
        repetition.rows = read_rows(rows, columns, repetition.fault is None)
    if manifest.exists():
        repetition.manifest = read_entry(manifest).value
    return repetition


def agree(one, other):
    """Equal, but for the last digits of numbers, as of a sum in another order."""
    if is_number(one) and is_number(other):
        return abs(one - other) <= 1e-9 * abs(one)
    return type(one) is type(other) and one == other


def difference_in(name, repetitions):
    """The first two values of a column that differ between repetitions, in words; None if there are none."""
    for rows in zip(*(r.rows for r in repetitions)):
        values = [row[name] for row in rows if row.get(name) is not None]
        for value in values[1:]:
            if not agree(values[0], value):
                return f"{name} differs between repetitions: {plain(values[0])} and {plain(value)}"
    return None


def unsteady_results(run, columns):
    """Differences between repetitions without a fault, in words, for every column but costs: equal settings on equal input
    give equal results."""
    repetitions = run.good_repetitions
    counts = [len(r.rows) for r in repetitions]
    for count in counts[1:]:
        if count != counts[0]:
            return [f"the number of rows differs between repetitions: {counts[0]} and {count}"]
    return list(filter(None, (difference_in(c.name, repetitions) for c in columns if c.kind != "cost")))


def read_run(o, runs, repetitions, columns):
    run = Run(o.text("id"), o.text("data", ""), o.member("parameters"))
    if not isinstance(run.parameters, dict):
        o.fail("'parameters' is not an object")
    if not run.id or "/" in run.id or run.id.startswith("."):
        o.fail("'id' is not the name of a folder")
    folder = runs / run.id
    if (folder / "parameters.json").exists():
        stored = read_entry(folder / "parameters.json")
        run.program, run.input, run.input_sha256 = (stored.text(key, "") for key in ("program", "input", "input_sha256"))
    names = {c.name for c in columns}
    run.repetitions = [read_repetition(folder, number, names) for number in range(repetitions)]
    run.unsteady = unsteady_results(run, columns)
    run.pictures = sorted((path for path in folder.glob("*") if path.suffix in (".png", ".webp")),
                          key=lambda path: path.stem)  # a picture before its difference map
    return run


def read_sweep(o, runs):
    parameters = [Column(p.text("name"), p.text("unit", ""), p.text("description", ""), condition=p.value.get("condition") is True)
                  for p in o.entries("parameters")]
    sweep = Sweep(o.text("name"), o.text("experiment"), o.text("question", ""), o.count("repetitions"), parameters,
                  [read_column(c) for c in o.entries("columns")], o.texts("metrics"))
    sweep.runs = [read_run(r, runs, sweep.repetitions, sweep.columns) for r in o.entries("runs")]
    return sweep


def load(folder):
    """Reads what `lodestone sweep` wrote to a folder, finished or not, and returns a Study. Raises StudyError for a folder
    of something else and for content that breaks docs/format.md, with file and line."""
    folder = pathlib.Path(folder)
    if not folder.is_dir():
        fail(folder, "", "is not a folder" if folder.exists() else "cannot be opened: no such folder")
    path = folder / "sweep.json"
    if not path.exists():
        fail(folder, "", "is not the directory of a sweep: it has no sweep.json; `lodestone sweep FILE.toml -o DIR` makes one")
    o = read_entry(path)
    study = Study(folder, o.text("name"), o.text("title", "") or o.text("name"), o.text("question", ""), o.text("program", ""))
    study.left_out = o.value.get("left_out", {})
    if not isinstance(study.left_out, dict) or not all(isinstance(path, str) for path in study.left_out.values()):
        o.fail("'left_out' holds something else than names and files")
    study.sweeps = [read_sweep(s, folder / "runs") for s in o.entries("sweeps")]
    study.requests = [read_figure(f) for f in o.entries("figures")]
    names = {sweep.name for sweep in study.sweeps}
    for figure in study.requests:
        for name in figure.sweeps:
            if name not in names:
                o.fail(f"figure '{figure.title}' is of a sweep '{name}' that is not there")
    listed = {run.id for run in study.unique_runs()}
    study.other_runs = sum(entry.is_dir() and entry.name not in listed for entry in (folder / "runs").glob("*"))
    return study
