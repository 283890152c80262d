"""The report on one or several studies: a page, its data, and every figure in files of its own."""

import pathlib
import re

from . import files
from .page import PICTURE_BYTES, make_page
from .reading import load
from .study import Study
from .writing import write_all

WITHOUT_PLOTS = "without plots: there is no python3 with matplotlib (scripts/setup report installs python3-matplotlib)"


def draw(figures):
    """For each figure (wide, narrow) SVG for the page and the contents of its own files; and why there are no plots, if so:
    a report without plots is worth having."""
    plots, contents, note = [], [], ""
    try:
        from . import plot

        for k, figure in enumerate(figures):
            contents.append(figure.contents())
            wide, narrow = contents[-1][".svg"].decode(), plot.to_svg(figure.plot(narrow=True))
            plots.append((plot.for_page(wide, figure, f"f{k}w"), plot.for_page(narrow, figure, f"f{k}n")))
        return plots, contents, note
    except ImportError:
        note = WITHOUT_PLOTS
    except Exception as error:  # whatever matplotlib stumbles over
        note = f"matplotlib could not draw the plots: {error}"
    return [], [{".csv": figure.csv().encode()} for figure in figures], note


def figure_names(figures):
    """Names of files: the number of the figure and its title."""
    return [f"{n:02}-" + re.sub("[^a-z0-9]+", "-", figure.title.lower()).strip("-")[:60] for n, figure in enumerate(figures, 1)]


def remove_outdated(folder, current):
    """Figures of an earlier report that has more of them or other titles."""
    for path in folder.iterdir():
        if re.fullmatch(r"\d\d+-[a-z0-9-]*\.(svg|pdf|csv)", path.name) and path not in current:
            path.unlink()


def write_report(studies, output, csv=None, json=None, picture_bytes=PICTURE_BYTES):
    """Writes the report on studies (a Study, a folder, or a list of them) to `output`, FILE.html, and every figure as SVG, PDF
    and CSV to the folder FILE_figures beside it; with `csv` all rows, with `json` everything as data. `picture_bytes` is the
    limit of all pictures of runs together. Returns why there are no plots, or "". Raises StudyError and OSError; then nothing
    has been written."""
    studies = [s if isinstance(s, Study) else load(s) for s in (studies if isinstance(studies, (list, tuple)) else [studies])]
    figures = [figure for study in studies for figure in study.figures]
    plots, own, note = draw(figures) if figures else ([], [], "")
    contents = {pathlib.Path(output): files.encode(make_page(studies, plots, note, picture_bytes))}
    if csv:
        contents[pathlib.Path(csv)] = files.encode(files.to_csv(studies))
    if json:
        contents[pathlib.Path(json)] = files.encode(files.json_text(files.to_json(studies)))
    folder = pathlib.Path(output).with_suffix("")
    folder = folder.with_name(folder.name + "_figures")
    for name, figure_files in zip(figure_names(figures), own):
        contents |= {folder / (name + suffix): content for suffix, content in figure_files.items()}
    is_new = bool(figures) and not folder.exists()
    try:
        if is_new:
            folder.mkdir()
        write_all(contents)
    except BaseException:
        if is_new and folder.exists():
            folder.rmdir()
        raise
    if figures:
        remove_outdated(folder, contents)
    return note
