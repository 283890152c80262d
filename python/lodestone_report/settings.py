"""The rows of a sweep, joined with parameters and data and summarised over repetitions."""

import re
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Any

from .runs import Column, Run
from .text import dump, value_text
from .values import is_number, median


@dataclass
class Cell:
    """One value of a setting: the median of a cost, with the minimum and maximum of its repetitions (and within them,
    where there are columns NAME_min and NAME_max); anything else is the value of the first repetition that has it."""

    value: Any = None  # number, text, truth value; None: not measured
    least: float = 0
    most: float = 0
    count: int = 0  # repetitions that have it

    @property
    def is_number(self):
        return is_number(self.value)

    @property
    def values(self):
        return self.value, self.least, self.most

    @property
    def has_range(self):
        """True if repetitions differ."""
        return self.is_number and self.least != self.most


NOTHING = Cell()


@dataclass
class Setting:
    """A row of a run, over its repetitions: cells of "sweep", "data", all parameters and all columns by name."""

    run: Run
    row: int
    cells: dict[str, Cell]

    def at(self, name):
        """The cell of that name; an empty one where there is none."""
        return self.cells.get(name, NOTHING)

    def value(self, name):
        """The value of the cell of that name, or None."""
        return self.at(name).value

    def label(self, names):
        """ "kappa0 = 2, blend = step": the values of those names that the setting has."""
        return ", ".join(f"{n} = {value_text(self.value(n))}" for n in names if self.value(n) is not None)

    def record(self, table, parameters):
        """A flat dict for Study.settings; `parameters` gives the names of those that another sweep measures."""
        values = {"sweep": table.sweep, "run": self.run.id, "data": self.run.data}
        values |= {parameters[p.name]: self.value(p.name) for p in table.parameters if p.name in parameters}
        for column in table.columns:
            cell = self.at(column.name)
            values[column.name] = cell.value
            if column.kind == "cost" and cell.has_range:
                values |= {f"{column.name} least": cell.least, f"{column.name} most": cell.most}
        return values


@dataclass
class SettingTable:
    """The settings of a sweep whose runs are reported."""

    sweep: str
    parameters: list[Column]  # with "data", in the sweep's order
    columns: list[Column]  # without ranges NAME_min and NAME_max; with speedup ... where `threads` varies
    settings: list[Setting] = field(default_factory=list)
    varied: list[str] = field(default_factory=list)  # what tells settings apart: parameters, "data", labels of rows

    def find(self, name):
        """The parameter or column of that name, or None."""
        return next((c for c in self.parameters + self.columns if c.name == name), None)

    def values(self, name):
        """The different values of a column, as JSON."""
        return {dump(s.value(name)) for s in self.settings}

    def has_numbers(self, name):
        return any(s.at(name).is_number for s in self.settings)

    def parts_rows(self, name):
        """True if a column has several numbers or texts in one run, which tell its rows apart. Hashes tell nothing."""
        of_run = defaultdict(set)
        for setting in self.settings:
            value = setting.value(name)
            if isinstance(value, str) and re.fullmatch("[0-9a-f]{8,}", value):
                return False
            if isinstance(value, str) or is_number(value):
                of_run[setting.run.id].add(value)
        return any(len(values) > 1 for values in of_run.values())


def plain_cell(value, count=1):
    return Cell(value, float(value), float(value), count) if is_number(value) else Cell(value, count=count)


def cost_cell(rows, name):
    def numbers(column):
        return [float(row[column]) for row in rows if is_number(row.get(column))]

    values = numbers(name)
    if not values:
        return Cell()
    everything = values + numbers(name + "_min") + numbers(name + "_max")
    return Cell(median(values), min(everything), max(everything), len(values))


def join(column, rows):
    """The cell of a column over repetitions."""
    values = [row[column.name] for row in rows if row.get(column.name) is not None]
    if column.kind == "cost" and all(map(is_number, values)):
        return cost_cell(rows, column.name)
    return plain_cell(values[0], len(values)) if values else Cell()


def add_run(table, sweep, run):
    for i, rows in enumerate(zip(*(r.rows for r in run.good_repetitions))):
        cells = {"sweep": plain_cell(sweep.name), "data": plain_cell(run.data)}
        cells |= {name: plain_cell(value) for name, value in run.parameters.items()}
        cells |= {column.name: join(column, rows) for column in sweep.columns}
        table.settings.append(Setting(run, i, cells))


def without_ranges(columns):
    """Costs NAME_min and NAME_max are shown as the range of NAME."""
    costs = {c.name for c in columns if c.kind == "cost"}
    return [c for c in columns if not (c.name in costs and c.name.endswith(("_min", "_max")) and c.name[:-4] in costs)]


def varied_names(table):
    varied = [p.name for p in table.parameters if len(table.values(p.name)) > 1]

    def follows(label):
        """True if a label is known from the names before it."""
        known = {}
        return all(known.setdefault(s.label(varied), s.value(label)) == s.value(label) for s in table.settings)

    for column in table.columns:
        if column.kind == "label" and table.parts_rows(column.name) and not follows(column.name):
            varied.append(column.name)
    return varied


def scaling_of(one, rate, workers):
    """Speed-up, efficiency and the serial share that explains it (karp1990)."""
    speedup = rate / one
    return speedup, speedup / workers, (1 / speedup - 1 / workers) / (1 - 1 / workers) if workers > 1 else 0.0


def rates(setting):
    """Work per second: of the median time, of the slowest and of the fastest."""
    time, work = setting.at("seconds"), setting.value("work") or 1
    return (work / time.value, work / time.most, work / time.least) if time.is_number and time.least > 0 else None


def scaling_cells(one, own, workers, count):
    """Cells of speed-up, efficiency and serial share; their ranges are those of the least favourable pairs of repetitions."""
    middle = scaling_of(one[0], own[0], workers)
    slow, fast = scaling_of(one[2], own[1], workers), scaling_of(one[1], own[2], workers)
    if workers == 1:
        slow = fast = middle
    return {"speedup": Cell(middle[0], slow[0], fast[0], count), "efficiency": Cell(middle[1], slow[1], fast[1], count),
            "karp_flatt": Cell(middle[2], fast[2], slow[2], count) if workers > 1 else NOTHING}


def add_scaling(table):
    """Columns speedup, efficiency and karp_flatt against one thread of the same setting, from the medians of the repetitions.

    The threads are a parameter, `threads`, or a column of rows, `workers`; columns of an experiment that has them for each of
    its repetitions are computed anew.
    """
    own = table.find("speedup") is not None
    workers = "workers" if own else "threads"
    if table.find("seconds") is None or table.find(workers) is None or not (own or "threads" in table.varied):
        return

    def key(setting):
        return (setting.run.id if own else setting.row), *(dump(setting.value(name)) for name in table.varied if name != workers)

    timed = [(s, rates(s), s.value(workers)) for s in table.settings]
    ones = {}
    for setting, own_rates, count in timed:
        if own_rates and count == 1:
            ones.setdefault(key(setting), own_rates)
    percent = own and table.find("efficiency").unit == "%"
    for setting, own_rates, count in timed:
        one = ones.get(key(setting))
        if not own_rates or one is None or not is_number(count) or count < 1:
            continue
        cells = scaling_cells(one, own_rates, int(count), setting.at("seconds").count)
        if percent:
            cells["efficiency"] = Cell(*(100 * v for v in cells["efficiency"].values), cells["efficiency"].count)
        if own and setting.value("karp_flatt") is None:  # not of weak scaling
            del cells["karp_flatt"]
        setting.cells |= cells
    if not own:
        table.columns += [Column("speedup", "", "seconds of one thread over seconds", "cost"),
                          Column("efficiency", "", "speed-up over threads", "cost"),
                          Column("karp_flatt", "", "serial share that would explain the speed-up", "cost")]


def aggregate(sweep):
    """The SettingTable of a sweep. Rows of unverified, failed and missing runs are left out."""
    data = [Column("data", "", "what it ran on")] if any(run.data for run in sweep.runs) else []
    table = SettingTable(sweep.name, data + sweep.parameters, without_ranges(sweep.columns))
    for run in sweep.runs:
        if run.is_reported:
            add_run(table, sweep, run)
    table.varied = varied_names(table)
    add_scaling(table)
    return table
