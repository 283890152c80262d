"""A study: what the directory of a sweep holds, as data and as DataFrames."""

from __future__ import annotations

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
    """Why a repetition is not reported."""

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
        """Those that verified."""
        return [r for r in self.repetitions if r.rows is not None and not r.fault]


@dataclass
class Sweep:
    """The runs of one experiment, with the columns of its rows."""

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
    """What load() returns: sweeps as they are stored, and DataFrames of them."""

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

    @cached_property
    def oddities(self):
        """What to know before reading figures, in words: several machines or programs, missing repetitions, ..."""
        from .findings import list_oddities

        return list_oddities(self)

    @cached_property
    def tables(self):
        """A SettingTable for each sweep."""
        from .settings import aggregate

        return [aggregate(sweep) for sweep in self.sweeps]

    @cached_property
    def settings(self):
        """DataFrame of the rows over repetitions, of runs that verified: sweep, run, data, parameters, columns, with speedup,
        efficiency and karp_flatt where `threads` varies. Costs are medians; where they have a range, "NAME least" and
        "NAME most" are there, too. A parameter that a sweep of the study measures is "parameter.NAME"."""
        import pandas

        parameters, _ = column_names([self])
        return pandas.DataFrame.from_records([setting.record(table, parameters) for table in self.tables
                                              for setting in table.settings])

    @cached_property
    def figures(self):
        """The Figures that the sweep's file asks for."""
        return [self.make_figure(request) for request in self.requests]

    def make_figure(self, request):
        """The Figure of a FigureRequest."""
        from .figures import make_figure

        return make_figure(request, [t for name in request.sweeps for t in self.tables if t.sweep == name])

    def figure(self, title, **request):
        """The figure of that title, or a new one: study.figure("Gaps", x="kappa0", y="gap_max", series=["data"],
        sweeps=["border"]), with the members of FigureRequest; all sweeps if none are named. A notebook shows it;
        .outcome says what it shows, .table is a DataFrame, .plot() a matplotlib figure, .save(path) writes SVG, PDF, CSV."""
        if not request:
            found = next((figure for figure in self.figures if figure.title == title), None)
            if found is None:
                raise KeyError(f"no figure '{title}'; there are: {', '.join(r.title for r in self.requests)}")
            return found
        for name in ("sweeps", "y", "series"):
            if isinstance(request.get(name), str):
                request[name] = [request[name]]
        return self.make_figure(FigureRequest(title, **{"sweeps": [sweep.name for sweep in self.sweeps]} | request))

    def unique_runs(self):
        """All runs, once each: a run may belong to several sweeps."""
        return list({run.id: run for sweep in reversed(self.sweeps) for run in reversed(sweep.runs)}.values())[::-1]


def is_number(value):
    """True for numbers of JSON, which truth values are not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


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
