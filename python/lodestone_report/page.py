"""The report as one HTML file that needs nothing else: style, script, plots, pictures and data are in it."""

import base64
import pathlib
import re

from . import files, findings
from .reading import read_bytes
from .text import counted, number_text, shown_unit, value_text
from .values import is_number

TEMPLATES = pathlib.Path(__file__).with_name("templates")
KIND_WORDS = {"bar": "Bars", "scatter": "Points", "line": "Curves"}
PICTURE_BYTES = 16 << 20


def in_unit(value, unit):
    """A number as it is shown in that unit."""
    return value / shown_unit(unit)[1]


def cell_text(value, unit):
    return value_text(in_unit(value, unit) if is_number(value) else value)


def alternative(figure):
    """The text that replaces a plot: what is drawn, and what it shows."""
    columns = "; ".join(f"{panel.y_name} {panel.y_unit}".rstrip() for panel in figure.panels)
    over = f"{figure.x_name} {figure.x_unit}".rstrip()
    return f"{KIND_WORDS[figure.kind]} of {columns} over {over}, {figure.count} points. {figure.outcome}"


def wanted_columns(sweep, table):
    """The columns that the sweep lists, after those that tell rows apart; all where it lists none."""
    if not sweep.metrics:
        return table.columns
    parting = [c for c in table.columns
               if c.kind in ("label", "count") and c.name not in sweep.metrics and table.parts_rows(c.name)]
    columns = {c.name: c for c in sweep.columns + table.columns}  # ranges are columns of the sweep alone
    return parting + [columns[name] for name in sweep.metrics if name in columns]


def choose_columns(sweep, table):
    """Columns of the table, and those that are the same in all of its rows."""
    columns, same = [], []
    measured = [(c, bool(sweep.metrics) or c.kind not in ("label", "count")) for c in wanted_columns(sweep, table)]
    for column, is_measured in [(p, False) for p in table.parameters] + measured:
        first = table.settings[0].value(column.name)
        if len(table.values(column.name)) > 1 or (is_measured and first is not None):
            columns.append(column)
        elif first is not None:
            same.append(column)
    return columns, same


def wrong_rows(study):
    """[(run, label, columns that its rows have)] of the runs that did not verify."""
    wrong, seen = [], set()
    for sweep in study.sweeps:
        for run in sweep.runs:
            if run.state == "unverified" and run.id not in seen:
                seen.add(run.id)
                names = {name for r in run.repetitions for row in r.rows or [] for name, value in row.items() if value is not None}
                columns = [column for column in sweep.columns if column.name in names]
                if columns:
                    wrong.append((run, findings.run_label(sweep, run), columns))
    return wrong


def heads(columns, table=None):
    """Heads of columns for the templates: name, unit, true for numbers, meaning."""
    return [(c.name, shown_unit(c.unit)[0], table is not None and table.has_numbers(c.name), c.meaning) for c in columns]


def inputs(study):
    return sorted({(run.data, run.input, run.input_sha256) for run in study.unique_runs() if run.input_sha256})


def choose_pictures(studies, room):
    """For each study ([(run, label)], number left out): pictures of a run go together, since a picture without its difference
    map tells half; as many as there is room for, in bytes."""
    chosen, seen = [], set()
    for study in studies:
        groups, left_out = [], 0
        for sweep, table in zip(study.sweeps, study.tables):
            labels = {s.run.id: s.label(table.varied) for s in reversed(table.settings)}
            for run in sweep.runs:
                if not run.pictures or not run.is_reported or run.id in seen:
                    continue
                seen.add(run.id)
                size = sum(path.stat().st_size for path in run.pictures)
                if size > room:
                    left_out += len(run.pictures)
                else:
                    room -= size
                    groups.append((run, f"{sweep.name}: {labels.get(run.id, '')}"))
        chosen.append((groups, left_out))
    return chosen


def environment():
    """Jinja with the filters that the templates name."""
    import jinja2
    from markupsafe import Markup

    env = jinja2.Environment(loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, trim_blocks=True, lstrip_blocks=True,
                             undefined=jinja2.StrictUndefined)
    env.filters |= {
        "number": number_text, "value": cell_text, "in": in_unit, "unit": lambda unit: shown_unit(unit)[0],
        "is_number": is_number, "counted": counted, "alternative": alternative, "heads": heads, "inputs": inputs,
        "counts": lambda sweep: findings.count_runs([sweep]), "reported": findings.reported,
        "problems": findings.list_problems, "manifest": findings.summarize_manifests,
        "tables": lambda study: zip(study.sweeps, study.tables), "wrong_rows": wrong_rows,
        "base64": lambda path: base64.b64encode(read_bytes(path)).decode()}
    env.globals |= {"choose_columns": choose_columns, "asset": lambda name: Markup((TEMPLATES / name).read_text()),}
    return env


def make_page(studies, plots=(), note="", picture_bytes=PICTURE_BYTES):
    """The text of the page. `plots` are (wide, narrow) SVG of all figures in order, or none; then `note` says why. Equal
    studies give equal text. Raises StudyError when a picture cannot be read."""
    from markupsafe import Markup

    drawn = iter([{"wide": Markup(wide), "narrow": Markup(narrow)} for wide, narrow in plots])
    parts = [(study, [next(drawn, None) for _ in study.figures], pictures)
             for study, pictures in zip(studies, choose_pictures(studies, picture_bytes))]
    html = environment().get_template("page.html").render(
        parts=parts, title=studies[0].title if len(studies) == 1 else "Lodestone report",
        question=studies[0].question if len(studies) == 1 else "", note=note,
        counts=findings.count_runs(sweep for study in studies for sweep in study.sweeps),
        json=files.to_json(studies), csv=files.to_csv(studies))
    return re.sub("[\0-\x08\x0b-\x1f]", " ", html)  # control characters are not part of HTML
