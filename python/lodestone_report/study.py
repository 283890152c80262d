"""A study: what the directory of a sweep holds, as DataFrames, figures and settings."""

import pathlib
from dataclasses import dataclass, field
from functools import cached_property

from .figures import make_figure
from .findings import list_oddities
from .runs import FigureRequest, Sweep
from .settings import aggregate
from .values import dotted


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
    left_out: dict[str, str] = field(default_factory=dict)  # data whose files were missing, and those files
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
        return list_oddities(self)

    @cached_property
    def tables(self):
        """A SettingTable for each sweep."""
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
