"""What a figure shows: computed here, drawn in plot.py."""

import csv
import io
import math
import pathlib
from collections import defaultdict
from dataclasses import asdict, dataclass, field
from typing import Any

from .constraints import is_sound, keeps
from .fronts import cheapest_within, error_limits, pareto_front
from .outcome import describe_outcome
from .pooling import pooled_names, varied_names
from .settings import Setting
from .text import shown_unit, value_text
from .values import is_number, median
from .writing import write_all

MOST_MARKS = 6


@dataclass
class Point:
    """A point with its ranges, in the units of the axes."""

    x: float
    x_least: float
    x_most: float
    y: float
    y_least: float
    y_most: float
    label: str = ""  # the setting, in words
    settings: int = 1  # with other seeds that share the point: y is their median then, y_least and y_most their range


@dataclass
class Series:
    """A curve, or the bars of one colour."""

    name: str
    points: list[Point] = field(default_factory=list)  # by rising x; of a scatter plot in the order of the settings


@dataclass
class Choice:
    """The cheapest setting that keeps a limit of the error, and what is tied with it; of quality, any point of the front."""

    limit: float
    point: Point
    tied: list[Point]  # other settings that keep it, whose range of costs overlaps that of the cheapest


@dataclass
class Front:
    """The Pareto front of the settings that compete: those with equal conditions (input, camera, size of the picture ...)."""

    conditions: str
    candidates: int  # settings that it was chosen from
    points: list[Point]  # by rising cost
    choices: list[Choice]


@dataclass
class Panel:
    """Curves with a y axis in common: columns of the same unit."""

    y_name: str
    y_unit: str
    more_is_better: bool = False
    series: list[Series] = field(default_factory=list)
    fronts: list[Front] = field(default_factory=list)

    @property
    def limit_text(self):
        """How a limit of y is kept."""
        return "at least" if self.more_is_better else "at most"


@dataclass
class Mark:
    """A vertical line."""

    x: float
    label: str


@dataclass
class Figure:
    """A figure of a study: what it shows (panels, marks, outcome in words, notes) and ways to have it."""

    title: str
    kind: str
    x_name: str
    x_unit: str = ""
    log_x: bool = False
    log_y: bool = False
    categories: list[str] = field(default_factory=list)  # names at x = 0, 1, 2 ... where x is not a number, and of bars
    panels: list[Panel] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)
    outcome: str = ""
    notes: list[str] = field(default_factory=list)

    @property
    def count(self):
        """The number of points drawn."""
        return sum(len(series.points) for panel in self.panels for series in panel.series)

    def x_value(self, point):
        """The number or the category of a point."""
        return self.categories[int(point.x)] if self.categories else point.x

    def records(self):
        """A dict for each point: panel, unit, curve, the point's members, and whether it is on the Pareto front."""
        front = {id(p) for panel in self.panels for front in panel.fronts for p in front.points}
        return [{"panel": panel.y_name, "unit": panel.y_unit, "curve": series.name, **asdict(p), "x": self.x_value(p),
                 "front": id(p) in front}
                for panel in self.panels for series in panel.series for p in series.points]

    @property
    def table(self):
        """DataFrame of the points, as in records()."""
        import pandas

        return pandas.DataFrame(self.records())

    def csv(self):
        """The points as CSV."""
        file = io.StringIO()
        columns = ["panel", "unit", "curve", *Point.__dataclass_fields__, "front"]
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(self.records())
        return file.getvalue()

    def plot(self, narrow=False):
        """A figure of matplotlib."""
        from . import plot

        return plot.draw(self, narrow)

    def _repr_svg_(self):
        from . import plot

        return plot.to_svg(self.plot())

    def contents(self):
        """{".svg": bytes, ".pdf": bytes, ".csv": bytes}"""
        from . import plot

        sheet = self.plot()
        return {".svg": plot.to_svg(sheet).encode(), ".pdf": plot.to_pdf(sheet), ".csv": self.csv().encode()}

    def save(self, path):
        """Writes path.svg, path.pdf and path.csv; `path` has no suffix."""
        write_all({pathlib.Path(f"{path}{suffix}"): content for suffix, content in self.contents().items()})


@dataclass
class Sample:
    """A number of a setting that the figure shows."""

    panel: int
    series: str
    conditions: str
    x: Any  # as it is in the row
    point: Point
    setting: Setting
    mark: float | None = None
    competes: bool = True  # for a front


def find_column(tables, name):
    return next(filter(None, (table.find(name) for table in tables)), None)


def make_panels(request, tables):
    """Panels, and the one of each y. Columns of the same unit share a panel; not where fronts are drawn, since a front is
    that of one error."""
    panels, panel_of = [], []
    for name in request.y:
        column = find_column(tables, name)
        unit = shown_unit(column.unit if column else "")[0]
        same = next((i for i, p in enumerate(panels) if unit and p.y_unit == unit and not request.pareto), len(panels))
        if same == len(panels):
            panels.append(Panel(name, unit, column is not None and column.kind == "quality"))
        else:
            panels[same].y_name += ", " + name
        panel_of.append(same)
    return panels, panel_of


def divisor(table, name):
    column = table.find(name)
    return shown_unit(column.unit)[1] if column else 1


def series_name(setting, names):
    """ "sphere, step, kappa0 = 2": texts speak for themselves."""
    values = [(name, setting.value(name)) for name in names]
    return ", ".join(value if isinstance(value, str) else f"{name} = {value_text(value)}" for name, value in values)


def scaled(cell, by):
    return (cell.value / by, cell.least / by, cell.most / by) if cell.is_number else (0.0, 0.0, 0.0)


def make_sample(request, table, setting, name, panel):
    """The sample of y = name, or None where a number is missing."""
    x, y, mark = setting.at(request.x), setting.at(name), setting.at(request.mark)
    if x.value is None or not y.is_number or not math.isfinite(y.value):
        return None
    by = divisor(table, request.x)
    point = Point(*scaled(x, by), *scaled(y, divisor(table, name)))
    conditions = ["data", *(p.name for p in table.parameters if p.condition and p.name in table.varied)]
    return Sample(panel, series_name(setting, request.series), series_name(setting, conditions), x.value, point, setting,
                  mark.value / by if mark.is_number else None, is_sound(setting, request.where))


def make_samples(request, tables, figure):
    figure.panels, panel_of = make_panels(request, tables)
    names = [name for name in varied_names(tables) if name != request.x]
    samples, without = [], 0
    for table in tables:
        for setting in table.settings:
            if not keeps(setting, request.where):
                continue
            for name, panel in zip(request.y, panel_of):
                sample = make_sample(request, table, setting, name, panel)
                if sample is None:
                    without += 1
                    continue
                if panel_of.count(panel) > 1:
                    sample.series = f"{name}: {sample.series}" if sample.series else name
                sample.point.label = setting.label(names)
                samples.append(sample)
    if without:
        figure.notes.append(f"{without} of {without + len(samples)} points have no number and are left out")
    return samples


def set_categories(figure, samples):
    """Where x is not a number, and for bars, points are at 0, 1, 2 ...: numbers by size, anything else as it comes."""
    numbers = all(is_number(s.x) for s in samples)
    if numbers and figure.kind != "bar":
        return
    values = list(dict.fromkeys((type(s.x) is bool, s.x) for s in samples))  # True is not 1
    if numbers:
        values.sort()
    figure.categories = [value_text(value) for _, value in values]
    figure.log_x = False
    for s in samples:
        s.point.x = s.point.x_least = s.point.x_most = float(values.index((type(s.x) is bool, s.x)))


def merged(points):
    """Points of one curve at one place, which differ in the seed of chance alone: their median, and the range of all of them."""
    if len(points) == 1:
        return points[0]
    return Point(points[0].x, min(p.x_least for p in points), max(p.x_most for p in points), median(p.y for p in points),
                 min(p.y_least for p in points), max(p.y_most for p in points), f"median of {len(points)} seeds", len(points))


def add_series(figure, samples):
    for panel, samples_of in zip(figure.panels, samples):
        curves = defaultdict(list)
        for s in samples_of:
            curves[s.series].append(s.point)
        if figure.kind != "scatter":
            for name, points in curves.items():
                places = defaultdict(list)
                for p in points:
                    places[p.x].append(p)
                curves[name] = [merged(places[x]) for x in sorted(places)]
        panel.series = [Series(name, points) for name, points in curves.items()]
    if any(p.settings > 1 for panel in figure.panels for series in panel.series for p in series.points):
        figure.notes.append("Several seeds fall on one point: it is their median, and the whiskers are their range")


def make_front(conditions, points, more_is_better):
    costs = [(p.x, -p.y if more_is_better else p.y) for p in points]
    ranges = [(p.x_least, p.x_most) for p in points]
    front = pareto_front(costs)
    # Decibels and similarities have no scale of powers of ten.
    limits = sorted({costs[i][1] for i in front}, reverse=True) if more_is_better else error_limits(costs)
    choices = []
    for limit in limits:
        cheapest, *tied = (points[i] for i in cheapest_within(costs, limit, ranges))
        choices.append(Choice(-limit if more_is_better else limit, cheapest, tied))
    return Front(conditions, len(points), [points[i] for i in front], choices)


def add_fronts(figure, samples):
    if figure.categories:
        figure.notes.append("No Pareto front: the cost is not a number")
        return
    for panel, samples_of in zip(figure.panels, samples):
        competing = defaultdict(list)
        for s in samples_of:
            if s.competes:
                competing[s.conditions].append(s.point)
        panel.fronts = [make_front(name, competing[name], panel.more_is_better) for name in sorted(competing)]
    outside = sum(not s.competes for samples_of in samples for s in samples_of)
    if outside:
        figure.notes.append(f"{outside} of {sum(map(len, samples))} points crack or have inadmissible radii, and are on no front")


def add_marks(figure, samples, name):
    """A line for each different value; with several inputs it names them."""
    places = defaultdict(set)
    for s in samples:
        if s.mark is not None and math.isfinite(s.mark):
            places[s.mark].add(s.setting.value("data"))
    if figure.categories or len(places) > MOST_MARKS:
        why = "x is not a number" if figure.categories else f"it has {len(places)} values"
        figure.notes.append(f"{name} is not drawn: {why}")
        return
    inputs = len({s.setting.value("data") for s in samples})
    for x in sorted(places):
        of = "" if len(places[x]) == inputs else f" ({', '.join(map(value_text, sorted(places[x])))})"
        figure.marks.append(Mark(x, name + of))


def make_figure(request, tables):
    """The Figure that is asked for, of the SettingTables of its sweeps. Points without a number are left out and counted
    in a note."""
    x = find_column(tables, request.x)
    figure = Figure(request.title, request.kind, request.x, shown_unit(x.unit if x else "")[0], "x" in request.log,
                    "y" in request.log)
    samples = make_samples(request, tables, figure)
    set_categories(figure, samples)
    of_panel = [[s for s in samples if s.panel == i] for i in range(len(figure.panels))]
    if request.kind != "scatter" and (pooled := pooled_names(request, tables, samples)):
        figure.outcome = (f"Not drawn: settings that differ in {' and '.join(pooled)} fall on one curve; name "
                          f"{'it' if len(pooled) == 1 else 'them'} in series, or choose by where.")
        figure.panels = []
        return figure
    add_series(figure, of_panel)
    if request.pareto:
        add_fronts(figure, of_panel)
    if request.mark:
        add_marks(figure, samples, request.mark)
    figure.outcome = describe_outcome(figure, request.mark, of_panel)
    return figure
