"""The pages of docs/results, written from the folders of the standard studies by scripts/results; no number is typed.

A table picks columns of sweeps and says which run made it: commit, machine, date and the command that repeats it.
"""

import pathlib

from . import costs, correlation, distributed, published_rows
from .reading import load
from .result_tables import PAGES
from .text import short_number, span
from .values import is_number

STUDIES = [page.study for page in PAGES]


# ---- values


def cell_text(cell, divisor=1):
    """The value of a setting, with the range of its repetitions or rounds where that shows."""
    if cell.value is None:
        return ""
    if isinstance(cell.value, bool):
        return "yes" if cell.value else "no"
    if not cell.is_number:
        return str(cell.value)
    median, least, most = (short_number(value / divisor) for value in (cell.value, cell.least, cell.most))
    dash = " to " if cell.least < 0 else "-"
    return median if median == least == most else f"{median} ({least}{dash}{most})"


def table_lines(headings, rows):
    return ["| " + " | ".join(map(str, row)) + " |" for row in [headings, ["---"] * len(headings), *rows]]


class Results:
    """A study's folder with its sweeps summarised: what pages and headlines are written from."""

    def __init__(self, folder, options):
        self.study, self.options = load(folder), options
        self.tables = {table.sweep: table for table in self.study.tables}

    def settings(self, *sweeps):
        """The settings of these sweeps, those of the same data together."""
        found = [setting for name in sweeps if name in self.tables for setting in self.tables[name].settings]
        order = list(dict.fromkeys(setting.value("data") for setting in found))
        return sorted(found, key=lambda setting: order.index(setting.value("data")))

    def find(self, sweeps, **where):
        """The settings whose values are as `where` says."""
        return [s for s in self.settings(*sweeps) if all(s.value(key) == value for key, value in where.items())]

    def values(self, sweeps, name, **where):
        """Numbers of a column in these settings."""
        return [s.value(name) for s in self.find(sweeps, **where) if is_number(s.value(name))]

    def runs(self, sweeps=None):
        return [run for sweep in self.study.sweeps if sweeps is None or sweep.name in sweeps for run in sweep.runs]

    def source(self, sweeps=None):
        """ "commit 12ab34c, AMD EPYC, 2 processors, 2026-01-31; repeat: `scripts/results build`" """
        manifests = [r.manifest for run in self.runs(sweeps) for r in run.good_repetitions if r.manifest]
        def known(facts):
            return " and ".join(sorted(set(filter(None, facts)))) or "unknown"
        commits = known(m.get("commit", "")[:7] + (" with changes" if m.get("dirty") else "") for m in manifests)
        machines = known(f"{m.get('cpu', 'unknown processor')}, {m.get('cores', '?')} cores, "
                         f"{m.get('memory_bytes', 0) / 2**30:.0f} GiB, {m.get('compiler', 'unknown compiler')}"
                         for m in manifests)
        days = sorted({str(m.get("start", ""))[:10] for m in manifests} - {""}) or ["unknown"]
        when = days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}"
        command = " ".join(filter(None, ["scripts/results", self.options, self.study.name]))
        return f"Commit {commits}; {machines}; {when}; `{command}`"

    def left_out(self):
        """A line for each run that the tables lack or that lacks repetitions."""
        lines = []
        for sweep in self.study.sweeps:
            for run in sweep.runs:
                if run.state != "complete":
                    messages = run.unsteady + [m for r in run.repetitions if r.fault for m in r.fault.messages]
                    lines.append(f"- {sweep.name}, {run.data}: {run.state}{': ' + messages[0] if messages else ''}")
        return lines


# ---- pages


def table_of(results, table):
    """A table's rows; a row that repeats the one before, as a level that is clamped does, is left out."""
    rows = []
    for setting in results.find(table.sweeps, **table.where):
        row = [cell_text(setting.at(column[1]), *column[2:]) for column in table.columns]
        if row not in rows:
            rows.append(row)
    used = [i for i in range(len(table.columns)) if any(row[i] for row in rows)]
    return table_lines([table.columns[i][0] for i in used], [[row[i] for i in used] for row in rows])


def meanings(results, page):
    """What the columns are, from the experiments themselves, in alphabetical order."""
    known = {}
    for table in page.tables:
        for name in table.sweeps:
            for heading, column, *_ in table.columns:
                found = results.tables[name].find(column) if name in results.tables else None
                if found and found.meaning and heading != "data":
                    known.setdefault(heading, found.meaning.split(" (set ")[0].removesuffix(", median"))
    return [f"- **{heading}**: {known[heading]}" for heading in sorted(known, key=str.lower)]


def correlation_lines(results, wanted):
    def path_of(setting):
        return setting.value("sweep"), *(setting.value(name) for name in wanted.path)

    headings, columns = zip(*wanted.columns)
    rows = correlation.matrix(results.settings(*wanted.sweeps), columns, path_of)
    if not any(any(row) for row in rows):
        return []
    return [f"## {wanted.title}", "", "Rank correlations (spearman1904) and numbers of pairs: above the diagonal over all "
            "settings, below it among the systems of one path alone, pooled, where the path itself tells nothing; paths of "
            "fewer than three systems are left out there.", "",
            *table_lines(["", *headings], [[heading, *row] for heading, row in zip(headings, rows)]), "",
            results.source(wanted.sweeps), ""]


def page_text(results, page, target):
    lines = [f"# {results.study.title}", "", results.study.question, ""]
    if page.notes:
        lines += [page.notes, ""]
    for table in page.tables:
        if results.tables.keys().isdisjoint(table.sweeps):
            continue                                   # not swept: `scripts/results STUDY/SWEEP`
        lines += [f"## {table.title}", ""]
        if table.note:
            lines += [table.note, ""]
        if results.settings(*table.sweeps):
            lines += [*table_of(results, table), "", results.source(table.sweeps), ""]
        else:
            lines += ["No run of this table has verified rows.", ""]
    if page.correlation:
        lines += correlation_lines(results, page.correlation)
    if page.model:
        lines += distributed.lines(results, target)
    if outcomes := [f"- {figure.title}: {figure.outcome}" for figure in results.study.figures if figure.outcome]:
        lines += ["## What the figures of the report show", "", *outcomes, ""]
    missing = [f"- {name}: {path} was missing (scripts/data)" for name, path in results.study.left_out.items()]
    if left_out := [*missing, *results.left_out()]:
        lines += ["## Left out", "", *left_out, ""]
    return "\n".join([*lines, "## Columns", "", "Times are medians with the range of rounds and repetitions.", "",
                      *meanings(results, page), ""])


# ---- what accuracy costs

COST_PAGE = "cost"
COST_QUESTION = "For an error that is asked for, what is the cheapest way, in time, triangles, bytes and memory?"


def cost_text(studies):
    """The page across all studies; empty if none of them has rows for it."""
    lines = []
    for part in costs.PARTS:
        results = studies.get(part.study)
        rows = costs.part_rows(part, results.settings(*part.sweeps)) if results else []
        if rows:
            note = [part.note, ""] if part.note else []
            lines += [f"## {part.title}", "", *note, *table_lines(costs.headings(part), rows), "",
                      results.source(part.sweeps), ""]
    if not lines:
        return ""
    return "\n".join(["# What accuracy costs", "", COST_QUESTION, "",
                      "Each cell has the least cost, from the model on which it is least to the one on which it is most, and the "
                      "setting that has it; where models or cameras differ in that, on how many of them. `or` separates "
                      "settings whose repetitions overlap. The settings are those of the studies' sweeps: a finer grid of them "
                      "may have a cheaper one.", "", *lines])


# ---- the first page


def largest(*sweeps, of, **where):
    """A function of Results: the largest value of a column, "" without any."""
    return lambda r: short_number(max(values)) if (values := r.values(sweeps, of, **where)) else ""


def spread(*sweeps, of, **where):
    return lambda r: span(values) if (values := r.values(sweeps, of, **where)) else ""


def derived(*sweeps, value, show=span, **where):
    """Of a value that `value` computes from a setting."""
    return lambda r: show([value(s) for s in found]) if (found := r.find(sweeps, **where)) else ""


def beside(*sweeps, of, over, **where):
    """A column's values over those of the settings that `over` names and that have equal data, level, path and tolerance."""
    def key(setting):
        return [setting.value(name) for name in ("data", "level", "camera", "pixel_error")]

    def make(results):
        others = [(key(s), s.value(of)) for s in results.find(sweeps, **over) if s.value(of)]
        shares = [s.value(of) / other for s in results.find(sweeps, **where) if is_number(s.value(of))
                  for at, other in others if at == key(s)]
        return f"{span(shares)} times" if shares else ""

    return make


def least_closed(results):
    """The least tried multiple of rho from which on no adversarial viewpoint cracks, on any model."""
    tried = results.find(["border"], camera="adversarial")
    cracked = [s.value("kappa0_over_rho") for s in tried if s.value("open_edges")]
    closed = [s.value("kappa0_over_rho") for s in tried if s.value("kappa0_over_rho") > max(cracked, default=0)]
    return short_number(min(closed)) if closed else ""


def quotient(above, below):
    return lambda setting: setting.value(above) / setting.value(below)


ADMISSIBLE, PATHS = ("one_pixel", "uniform", "least"), ("scans", "generated", "orbit")
SIZES = ("size_1", "size_2", "size_3", "size_4", "limits")
HEADLINES = [  # study, figure, and the function of its Results that gives the value
    ("guarantee", "flights at admissible radii", lambda r: str(len(r.settings(*ADMISSIBLE)))),
    ("guarantee", "residual edges in any of their frames", largest(*ADMISSIBLE, of="open_edges")),
    ("guarantee", "largest jump of a vertex over its bound", largest(*ADMISSIBLE, of="jump_over_bound")),
    ("guarantee", "residual edges below the border, at most", largest("below", of="open_edges")),
    ("guarantee", "jump over bound with a step, at most", largest("step", of="jump_over_bound")),
    ("ablation", "smallest kappa0 / rho without a crack, adversarial viewpoints", least_closed),
    ("build", "million triangles per core-second", spread("models", of="mtri_per_core_second")),
    ("build", "stored over input triangles, at most", largest("models", of="stored_ratio")),
    ("build", "bytes per stored triangle, plain", spread("compressed", of="bytes_per_stored_triangle", compress=False)),
    ("build", "bytes per stored triangle, compressed", spread("compressed", of="bytes_per_stored_triangle", compress=True)),
    ("published", "microseconds per triangle, file to file",
     derived(*SIZES, value=lambda s: 1e6 * quotient("file_seconds", "input_triangles")(s), memory_limit=0)),
    ("published", "peak bytes per triangle", derived(*SIZES, value=quotient("peak_bytes", "input_triangles"), memory_limit=0)),
    ("accuracy", "RMS of the hierarchy beside meshoptimizer's, equal triangles",
     beside("families", of="rms", over={"family": "meshoptimizer"}, family="hlod")),
    ("accuracy", "RMS of the hierarchy beside OpenMesh's",
     beside("families", of="rms", over={"family": "openmesh"}, family="hlod")),
    ("accuracy", "RMS of progressive meshes beside the hierarchy's",
     beside("families", of="rms", over={"family": "hlod"}, family="progressive")),
    ("accuracy", "RMS of reconstructions beside the hierarchy's",
     beside("families", of="rms", over={"family": "hlod"}, family="reconstructed")),
    ("progressive", "thousand triangles per core-second", spread("shapes", of="ktri_per_core_second")),
    ("progressive", "bytes per vertex", spread("shapes", of="bytes_per_vertex")),
    ("progressive", "residual edges of any level", largest("shapes", "textured", of="residual_edges")),
    ("spherical", "efficiency of the map, 1 without stretch", spread("models", of="efficiency")),
    ("spherical", "thousand triangles per core-second of the map", spread("models", of="map_ktri_per_core_second")),
    ("spherical", "triangles turned over", largest("models", of="flips")),
    ("spherical", "residual edges of any level", largest("models", of="residual_edges")),
    ("reconstruction", "coverage, %", spread("models", of="coverage")),
    ("reconstruction", "slivers, %, at most", largest("models", of="slivers")),
    ("rendering", "milliseconds a frame, soft", spread("tolerance", of="frame_ms", backend="soft")),
    ("rendering", "CPU time of gl beside soft",
     beside("tolerance", of="frame_cpu_ms", over={"backend": "soft"}, backend="gl")),
    ("rendering", "distance on the screen over the tolerance, at most",
     derived("screen", value=quotient("screen_error", "pixel_error"), show=lambda values: short_number(max(values)))),
    ("effects", "saved by planning on soft, % of a frame with everything",
     derived("soft", value=lambda s: -100 * quotient("gain_ms", "frame_ms")(s), effects="everything")),
    *(("scaling", f"efficiency of two workers, {task}, %", spread("strong", of="efficiency", task=task, workers=2))
      for task in ("build", "raster", "reconstruct", "progressive")),
    ("distributed", "rate of two ranks of one thread over that of one of two",
     spread("strong", of="over_one", ranks=2, rank_threads=1)),
    ("distributed", "imbalance of triangles, at most", largest(*distributed.JOBS, of="imbalance_triangles")),
    ("distributed", "bytes between ranks per triangle, at most", largest(*distributed.JOBS, of="bytes_per_triangle")),
    *(("systems", f"{what} with {system}", form(*PATHS, of=column, system=system))
      for system in ("morph", "discrete")
      for what, form, column in (("cracked frames, %,", spread, "cracked_frames"),
                                 ("jump over bound, at most,", largest, "jump_over_bound"))),
]


def first_page(studies):
    """The headline figures, and which pages there are."""
    lines = ["# Results", "", "`scripts/results` writes this page and the others from what it measures. Each page says what its "
             "columns are, and each table names the commit, the machine and the command that it is from. Runs that did not "
             "verify are in no table.", "",
             "Every row is in one file, with a [data sheet](rows.md). Benchmarks of single kernels, beside other libraries, are "
             "printed by `scripts/bench`.", ""]
    rows = [(f"[{study}]({study}.md)", what, value) for study, what, make in HEADLINES
            if study in studies and (value := make(studies[study]))]
    lines += [*table_lines(["page", "figure", "value"], rows), "", "## Pages", ""]
    page_rows = []
    for page in PAGES:
        if page.study not in studies:
            continue
        results = studies[page.study]
        runs = {run.id: run.state for run in results.runs()}
        complete = sum(state == "complete" for state in runs.values())
        page_rows.append((f"[{page.study}]({page.study}.md)", results.study.question, f"{complete} of {len(runs)}"))
    if cost_text(studies):
        page_rows.append((f"[{COST_PAGE}]({COST_PAGE}.md)", COST_QUESTION, "of the studies above"))
    lines += [*table_lines(["page", "question", "runs verified"], page_rows), "", "## Source", ""]
    by_source = {}
    for name, results in studies.items():
        by_source.setdefault(results.source().rsplit(";", 1)[0], []).append(name)
    lines += [f"- {', '.join(names)}: {source}" for source, names in by_source.items()]
    return "\n".join([*lines, ""])


def write_pages(folders, target, options=""):
    """Writes the pages of the studies' folders, {name: folder}, the first page and the rows; returns the studies.

    `options` are those of scripts/results that made them. A page of a study without a folder is taken away.
    """
    target = pathlib.Path(target)
    target.mkdir(parents=True, exist_ok=True)
    studies = {page.study: Results(folders[page.study], options) for page in PAGES if page.study in folders}
    texts = {page.study: page_text(studies[page.study], page, target) if page.study in studies else "" for page in PAGES}
    for name, text in {**texts, COST_PAGE: cost_text(studies)}.items():
        path = target / f"{name}.md"
        if text:
            path.write_text(text, encoding="utf-8")
        else:
            path.unlink(missing_ok=True)
    (target / "README.md").write_text(first_page(studies), encoding="utf-8")
    published_rows.write_rows([results.study for results in studies.values()], target)
    return studies
