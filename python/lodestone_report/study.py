"""The directory of a sweep, read and checked against docs/decisions/0036-sweeps.md."""

from __future__ import annotations

import json
import pathlib
from dataclasses import dataclass, field
from functools import cached_property

COLUMN_KINDS = ("label", "accuracy", "quality", "cost", "count")
FIGURE_KINDS = ("line", "scatter", "bar")


class StudyError(Exception):
    """A folder that cannot be read or breaks the contract; its text is one line, FILE: PLACE: what is wrong; what to do."""


@dataclass
class Column:
    """A column of rows, or a parameter: then its kind is "label"."""

    name: str
    unit: str = ""
    meaning: str = ""
    kind: str = "label"  # of COLUMN_KINDS; of accuracy less is better, of quality more


@dataclass
class FigureRequest:
    """A figure as the sweep's file asks for it; fields as in docs/decisions/0036-sweeps.md."""

    title: str
    sweeps: list[str]
    x: str
    y: list[str]
    series: list[str] = field(default_factory=list)
    kind: str = "line"
    log: str = ""
    mark: str = ""
    pareto: bool = False


@dataclass
class Fault:
    kind: str  # "verify", "error", "crash"
    messages: list[str]


@dataclass
class Repetition:
    """Rows, or a fault, or both (rows that did not verify), or nothing yet (rows is None)."""

    number: int
    rows: list[dict] | None = None
    fault: Fault | None = None
    manifest: dict = field(default_factory=dict)


@dataclass
class Run:
    """One setting on one input, with all repetitions that its sweep asks for."""

    id: str
    data: str
    parameters: dict
    repetitions: list[Repetition] = field(default_factory=list)
    program: str = ""
    input: str = ""
    input_sha256: str = ""
    unsteady: list[str] = field(default_factory=list)  # results that differ between repetitions, in words
    pictures: list[pathlib.Path] = field(default_factory=list)

    @property
    def state(self):
        """ "complete", "incomplete" (repetitions are missing), "unverified" (results are wrong, or differ between
        repetitions), "failed" (every repetition ended in an error or a crash) or "missing" (not yet run)."""
        if self.unsteady or any(r.fault and r.fault.kind == "verify" for r in self.repetitions):
            return "unverified"
        good = len(self.good_repetitions)
        if good:
            return "complete" if good == len(self.repetitions) else "incomplete"
        return "failed" if any(r.fault for r in self.repetitions) else "missing"

    @property
    def is_reported(self):
        """True if tables and figures show the run."""
        return self.state in ("complete", "incomplete")

    @property
    def good_repetitions(self):
        return [r for r in self.repetitions if r.rows is not None and not r.fault]


@dataclass
class Sweep:
    name: str
    experiment: str
    question: str
    repetitions: int
    parameters: list[Column]
    columns: list[Column]
    metrics: list[str] = field(default_factory=list)  # columns that tables show beside parameters; empty: all
    runs: list[Run] = field(default_factory=list)


@dataclass
class Study:
    """What lodestone.load returns: sweeps as they are stored, and DataFrames of them."""

    folder: pathlib.Path
    name: str
    title: str = ""
    question: str = ""
    program: str = ""
    sweeps: list[Sweep] = field(default_factory=list)
    requests: list[FigureRequest] = field(default_factory=list)  # the figures that the sweep's file asks for
    other_runs: int = 0  # in the folder, but of no sweep: of other settings or another program

    @cached_property
    def rows(self):
        """DataFrame of every row of every repetition: study, sweep, experiment, run, data, repetition, state, parameters,
        columns. `state` is "verified", "unverified", or the kind of the repetition's fault; attrs["units"] holds units."""
        import pandas

        names, records = row_records([self])
        frame = pandas.DataFrame.from_records(records, columns=names)
        frame.attrs["units"] = self.units
        return frame

    @cached_property
    def units(self):
        """Unit of each parameter and column of `rows` and `settings`; "" for a number without a unit."""
        parameters, columns = column_names([self])
        units = {c.name: c.unit for sweep in self.sweeps for c in sweep.columns}
        return {parameters[p.name]: p.unit for sweep in self.sweeps for p in sweep.parameters} | units

    @cached_property
    def runs(self):
        """DataFrame of the verification: sweep, run, data, state, repetitions that verified, and what is wrong in words."""
        import pandas

        return pandas.DataFrame(
            [(sweep.name, run.id, run.data, run.state, len(run.good_repetitions), sweep.repetitions,
              "; ".join(run.unsteady + [m for r in run.repetitions if r.fault for m in r.fault.messages]))
             for sweep in self.sweeps for run in sweep.runs],
            columns=["sweep", "run", "data", "state", "verified", "repetitions", "problem"])

    @property
    def problems(self):
        """The part of `runs` that is left out or lacks repetitions."""
        return self.runs[self.runs.state != "complete"]

    @cached_property
    def manifests(self):
        """DataFrame of what each repetition ran on and with: run, repetition, program, and the keys of its manifest, those
        of nested objects with dots."""
        import pandas

        records = [{"run": run.id, "repetition": r.number, "program": run.program, **dotted(r.manifest)}
                   for run in self.unique_runs() for r in run.repetitions if r.manifest]
        return pandas.DataFrame.from_records(records)

    def unique_runs(self):
        """All runs, once each: a run may belong to several sweeps."""
        return list({run.id: run for sweep in reversed(self.sweeps) for run in reversed(sweep.runs)}.values())[::-1]


def dotted(tree, prefix=""):
    """{"gl": {"vendor": 1}} -> {"gl.vendor": 1}"""
    flat = {}
    for name, value in tree.items():
        flat.update(dotted(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value})
    return flat


def column_names(studies):
    """Names of parameters, by their own names, and of columns. A parameter that another sweep measures is
    "parameter.NAME"."""
    sweeps = [sweep for study in studies for sweep in study.sweeps]
    columns = list(dict.fromkeys(c.name for sweep in sweeps for c in sweep.columns))
    parameters = dict.fromkeys(p.name for sweep in sweeps for p in sweep.parameters)
    return {name: f"parameter.{name}" if name in columns else name for name in parameters}, columns


def row_records(studies):
    """Names of the columns, and every row of every repetition as a tuple of them."""
    parameters, columns = column_names(studies)
    names = ["study", "sweep", "experiment", "run", "data", "repetition", "state", *parameters.values(), *columns]
    records = []
    for study in studies:
        for sweep in study.sweeps:
            for run in sweep.runs:
                values = [run.parameters.get(name) for name in parameters]
                good = "unverified" if run.state == "unverified" else "verified"
                for r in run.repetitions:
                    state = good if not r.fault else "unverified" if r.fault.kind == "verify" else r.fault.kind
                    records += [(study.name, sweep.name, sweep.experiment, run.id, run.data, r.number, state, *values,
                                 *map(row.get, columns)) for row in r.rows or []]
    return names, records


# ---- reading


def refuse_constant(name):
    raise ValueError(f"{name} is not a number of JSON")


def fail(path, place, what):
    raise StudyError(": ".join(filter(None, (str(path), place, what))))


def read_bytes(path):
    try:
        return path.read_bytes()
    except OSError as error:
        fail(path, "", f"cannot be read: {error.strerror}")


def parse(content, path, place=""):
    try:
        return json.loads(content, parse_constant=refuse_constant)
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
        return [Entry(entry, self.path, f"{key}[{i}]") for i, entry in enumerate(value)]


def read_entry(path):
    return Entry(parse(read_bytes(path), path), path)


def read_figure(o):
    figure = FigureRequest(o.text("title"), o.texts("sweep"), o.text("x"), o.texts("y"), o.texts("series"),
                           o.text("kind", "") or "line", o.text("log", ""), o.text("mark", ""),
                           o.value.get("pareto") is True)
    if figure.kind not in FIGURE_KINDS:
        o.fail("'kind' is not line, scatter or bar")
    if not figure.sweeps or not figure.y:
        o.fail("names no sweep or no y")
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


def is_number(value):
    """True for numbers of JSON, which truth values are not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def agree(one, other):
    """Equal, but for the last digits of numbers, as of a sum in another order."""
    if is_number(one) and is_number(other):
        return abs(one - other) <= 1e-9 * abs(one)
    return type(one) is type(other) and one == other


def exact_text(value):
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def difference_in(name, repetitions):
    """The first two values of a column that differ between repetitions, in words; None if there are none."""
    for rows in zip(*(r.rows for r in repetitions)):
        values = [row[name] for row in rows if row.get(name) is not None]
        for value in values[1:]:
            if not agree(values[0], value):
                return f"{name} differs between repetitions: {exact_text(values[0])} and {exact_text(value)}"
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
    run.pictures = sorted(folder.glob("*.png"), key=lambda path: path.stem)  # a picture before its difference map
    return run


def read_sweep(o, runs):
    parameters = [Column(p.text("name"), p.text("unit", ""), p.text("description", "")) for p in o.entries("parameters")]
    sweep = Sweep(o.text("name"), o.text("experiment"), o.text("question", ""), o.count("repetitions"), parameters,
                  [read_column(c) for c in o.entries("columns")], o.texts("metrics"))
    sweep.runs = [read_run(r, runs, sweep.repetitions, sweep.columns) for r in o.entries("runs")]
    return sweep


def load(folder):
    """Reads what `lodestone sweep` wrote to a folder, finished or not, and returns a Study. Raises StudyError for a folder
    of something else and for content that breaks docs/decisions/0036-sweeps.md, with file and line."""
    folder = pathlib.Path(folder)
    if not folder.is_dir():
        fail(folder, "", "is not a folder" if folder.exists() else "cannot be opened: no such folder")
    path = folder / "sweep.json"
    if not path.exists():
        fail(folder, "", "is not the directory of a sweep: it has no sweep.json; `lodestone sweep FILE.toml -o DIR` makes one")
    o = read_entry(path)
    study = Study(folder, o.text("name"), o.text("title", "") or o.text("name"), o.text("question", ""), o.text("program", ""))
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
