"""Draws figures with matplotlib: for the page, where colours are variables of its style sheet and text is in its font, and as
SVG and PDF of their own. Everything that is shown has been computed in figures.py. Equal figures give equal bytes."""

import contextlib
import io
import math
import pathlib
import re
import xml.etree.ElementTree as ET

import matplotlib
from matplotlib import ticker
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as Sheet

SVG = "http://www.w3.org/2000/svg"
XLINK = "http://www.w3.org/1999/xlink"
ET.register_namespace("", SVG)
ET.register_namespace("xlink", XLINK)

# The colours of the page on light paper; in what is drawn for the page they become variables again.
STYLE = (pathlib.Path(__file__).with_name("templates") / "report.css").read_text()
COLOURS = {name: colour for name, colour in re.findall(r"--([a-z0-9-]+): (#[0-9a-f]{6})", STYLE[:STYLE.index("@media")])}
SERIES = [COLOURS[f"s{n}"] for n in range(8)]
INK, GRID, FAINT = COLOURS["ink"], COLOURS["line"], COLOURS["faint"]
VARIABLES = {COLOURS[name]: f"var(--{name})" for name in (*(f"s{n}" for n in range(8)), "ink", "line", "faint")}
SETTINGS = {
    "svg.hashsalt": "lodestone", "svg.fonttype": "none", "pdf.fonttype": 42, "font.family": "DejaVu Sans", "font.size": 9,
    "axes.edgecolor": FAINT, "axes.labelcolor": INK, "text.color": INK, "xtick.color": FAINT, "ytick.color": FAINT,
    "xtick.labelcolor": INK, "ytick.labelcolor": INK, "legend.fontsize": 8.5, "path.simplify": False}
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*"]
DASHES = ["-", (0, (4, 1.6)), (0, (1.2, 1.4)), (0, (5, 1.4, 1.2, 1.4))]
HATCHES = [None, "//////", "....", "xxxxx"]
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value, _=None):
    """A tick: powers of ten where decimals would be long."""
    size = abs(value)
    if size and not 1e-3 <= size < 1e7:
        power = math.floor(math.log10(size) + 1e-9)
        digits = f"{value / 10 ** power:g}"
        return ("" if digits == "1" else digits + "·") + "10" + str(power).translate(SUPERSCRIPT)
    return f"{value:,.10g}"


def label(name, unit):
    return f"{name} ({unit})" if unit else name


def ends(points, axis):
    return [getattr(p, axis + end) for p in points for end in ("", "_least", "_most")]


def few_whole(values):
    """True if there is room for a tick at every value; of whole numbers such as threads."""
    different = sorted(set(values))
    return (1 < len(different) <= 9 and all(v == round(v) for v in different) and
            min(b - a for a, b in zip(different, different[1:])) * 14 > different[-1] - different[0])


def room_for_all(places, span):
    """True if every place has room for a tick of its own on an axis over so many powers of ten: few, apart, and short."""
    apart = all(math.log10(b / a) > span / 12 for a, b in zip(places, places[1:]))
    return 1 < len(places) <= 9 and apart and all(len(number(v)) <= 6 for v in places)


def set_log(axis, set_scale, values, places=()):
    """A logarithmic axis over values, with ticks at the places if there is room; zeros get a linear piece below the smallest
    value that is above 0."""
    positive = [v for v in values if v > 0]
    if not positive or min(values) < 0:
        return
    low, high = math.log10(min(positive)), math.log10(max(positive))
    if min(values) == 0:
        threshold = 10 ** math.floor(low)
        set_scale("symlog", linthresh=threshold, linscale=0.5)
        step = max(1, math.ceil((high - low) / 5))
        powers = range(math.floor(low), math.ceil(high) + 1, step)
        axis.set_major_locator(ticker.FixedLocator([0, *(10.0 ** k for k in powers)]))
        axis.set_view_interval(-0.2 * threshold, 1.5 * max(values), ignore=True)
    else:
        set_scale("log")
        places = sorted(set(places))
        if room_for_all(places, high - low):
            axis.set_major_locator(ticker.FixedLocator(places))
            axis.set_minor_locator(ticker.NullLocator())
        elif high - low < 2.5:
            axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(ticker.FuncFormatter(number))
    axis.set_minor_formatter(ticker.NullFormatter())


def style(n):
    """From the ninth series on colours come again, with other marks and dashes."""
    return {"color": SERIES[n % 8], "marker": MARKERS[(n + n // 8) % 8], "linestyle": DASHES[n // 8 % 4]}


def fill(n):
    """Of bars, which have neither: from the ninth on they are hatched."""
    colour, hatch = SERIES[n % 8], HATCHES[n // 8 % 4]
    return {"facecolor": "none" if hatch else colour, "edgecolor": colour, "hatch": hatch}


def draw_points(axes, kind, series, n, name):
    points, look = series.points, style(n)
    x, y = [p.x for p in points], [p.y for p in points]
    if kind == "scatter":
        look["linestyle"] = "none"
    below_y, above_y = [p.y - p.y_least for p in points], [p.y_most - p.y for p in points]
    below_x, above_x = [p.x - p.x_least for p in points], [p.x_most - p.x for p in points]
    for keyword, below, above in (("yerr", below_y, above_y), ("xerr", below_x, above_x)):
        if any(v > 0 for v in below + above):
            axes.errorbar(x, y, **{keyword: [below, above]}, fmt="none", ecolor=look["color"], elinewidth=0.9, capsize=2,
                          alpha=0.6)
    axes.plot(x, y, **look, linewidth=1.5, markersize=4.5, markeredgewidth=0, label=series.name, gid=name, clip_on=False)


def draw_bars(axes, series, place, name):
    """The bars of a series; place is (n, count): the n-th of count at each x, the same one in all panels, where a series may
    be missing."""
    n, count = place
    width = 0.8 / count
    for k, p in enumerate(series.points):
        x = p.x - 0.4 + (n + 0.5) * width
        # The edge shows where the bar has no height.
        axes.bar(x, p.y, width * 0.92, **fill(n), linewidth=0.9, label=series.name if k == 0 else None, gid=f"{name}-{k}")
        if p.y_most > p.y_least:
            axes.errorbar(x, p.y, yerr=[[p.y - p.y_least], [p.y_most - p.y]], fmt="none", ecolor=INK, elinewidth=0.9, capsize=2)


def draw_front(axes, front, reach):
    x, y = [p.x for p in front.points], [p.y for p in front.points]
    axes.step([*x, max(reach, x[-1])], [*y, y[-1]], where="post", color=INK, linewidth=1, alpha=0.7, zorder=1)


def draw_marks(axes, marks):
    for k, mark in enumerate(marks):
        axes.axvline(mark.x, color=INK, linewidth=1, linestyle=(0, (3, 2)), alpha=0.8)
        axes.annotate(mark.label, (mark.x, 1), xycoords=axes.get_xaxis_transform(), xytext=(0, 3 + 10 * (k % 2)),
                      textcoords="offset points", ha="center", va="bottom", fontsize=8, color=INK)


def set_x_axis(axes, figure, points, narrow):
    x = [p.x for p in points]
    if figure.categories:
        long = max(map(len, figure.categories)) * len(figure.categories) > (34 if narrow else 90)
        axes.set_xticks(range(len(figure.categories)), figure.categories, rotation=30 if long else 0,
                        ha="right" if long else "center")
        axes.set_xlim(-0.6, len(figure.categories) - 0.4)
    elif len(set(x)) == 1:
        axes.set_xticks(x[:1])
    elif figure.log_x:
        set_log(axes.xaxis, axes.set_xscale, ends(points, "x"), x)
    elif few_whole(x):
        axes.set_xticks(sorted(set(x)))
    elif narrow:
        axes.xaxis.set_major_locator(ticker.MaxNLocator(5))


def finish_axes(axes, figure, panel, narrow):
    points = [p for series in panel.series for p in series.points]
    y = ends(points, "y")
    from_zero = figure.kind == "bar" or not panel.more_is_better  # similarities crowd below 1
    axes.set_xlabel(label(figure.x_name, figure.x_unit))
    axes.set_ylabel(label(panel.y_name, panel.y_unit))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(ticker.FuncFormatter(number))
    set_x_axis(axes, figure, points, narrow)
    if figure.log_y:
        set_log(axes.yaxis, axes.set_yscale, y)
    elif y and min(y) >= 0 and from_zero:
        axes.set_ylim(bottom=0, top=None if max(y) > 0 else 1)
    axes.grid(True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_panel(axes, figure, k, names):
    """Panel k; names are those of all series of the figure, which give a series its colour in every panel."""
    panel = figure.panels[k]
    for n, series in enumerate(panel.series):
        place = names.index(series.name) if series.name else n
        if figure.kind == "bar":
            draw_bars(axes, series, (place, max(1, len(names))), f"points-{k}-{n}")
        else:
            draw_points(axes, figure.kind, series, place, f"points-{k}-{n}")
    reach = max((p.x for series in panel.series for p in series.points), default=0)
    for front in panel.fronts:
        if front.points:
            draw_front(axes, front, reach)
    draw_marks(axes, figure.marks)


def add_legend(sheet, per_row):
    handles = {}
    for axes in sheet.axes:
        for handle, name in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(name, handle)
    sheet.legend(handles.values(), handles.keys(), loc="lower center", ncol=per_row, frameon=False, handlelength=2.2,
                 columnspacing=1.4, labelcolor=INK)


@contextlib.contextmanager
def settings():
    """The settings that every figure is drawn and written with, whatever those of the caller are."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(SETTINGS)
        yield


def draw(figure, narrow=False):
    """A matplotlib figure, for wide or narrow windows."""
    panels = figure.panels
    columns = 1 if narrow else min(2, len(panels))
    rows = math.ceil(len(panels) / columns)
    names = list(dict.fromkeys(s.name for panel in panels for s in panel.series if s.name))
    width = 3.9 if narrow else 8.4
    per_row = max(1, int((width - 0.2) / (0.5 + 0.072 * max(map(len, names), default=1))))
    legend = 0.2 * math.ceil(len(names) / per_row) + 0.05 if len(names) > 1 else 0
    height = rows * (2.7 if narrow else 3.3) + legend + (0.15 if len(figure.marks) > 1 else 0)
    with settings():
        sheet = Sheet(figsize=(width, height))
        FigureCanvasSVG(sheet)  # measures text for the layout
        for k, axes in enumerate(sheet.subplots(rows, columns, squeeze=False).flat):
            if k < len(panels):
                draw_panel(axes, figure, k, names)
                finish_axes(axes, figure, panels[k], narrow)
            else:
                axes.remove()
        sheet.tight_layout(rect=(0, legend / height, 1, 1), pad=0.4, h_pad=1.2)
        if legend:
            add_legend(sheet, per_row)
    return sheet


def write(sheet, form, metadata, transparent=True):
    file = io.BytesIO()
    with settings():
        sheet.savefig(file, format=form, transparent=transparent, metadata=metadata)
    return file.getvalue()


def to_svg(sheet, transparent=True):
    """The text of an SVG; on white where it is not transparent."""
    return write(sheet, "svg", {"Date": None, "Creator": None}, transparent).decode()


def to_pdf(sheet):
    """The bytes of a PDF."""
    return write(sheet, "pdf", {"CreationDate": None})


def add_titles(root, figure):
    """Each point tells its setting when the pointer rests on it."""
    groups = {group.get("id"): group for group in root.iter(f"{{{SVG}}}g")}
    for k, panel in enumerate(figure.panels):
        for n, series in enumerate(panel.series):
            name = f"points-{k}-{n}"
            if figure.kind == "bar":
                shapes = [groups.get(f"{name}-{i}") for i in range(len(series.points))]
            else:
                shapes = list(groups[name].iter(f"{{{SVG}}}use")) if name in groups else []
            if len(shapes) != len(series.points):
                continue
            for shape, point in zip(shapes, series.points):
                if shape is not None:
                    text = [series.name, point.label, f"{panel.y_name}: {number(point.y)} {panel.y_unit}"]
                    ET.SubElement(shape, f"{{{SVG}}}title").text = "\n".join(t.strip() for t in text if t)


def for_page(svg, figure, prefix):
    """The SVG of a figure as a part of the page: ids of its own, colours and fonts of the page."""
    root = ET.fromstring(svg)
    add_titles(root, figure)
    for parent in root.iter():
        for child in list(parent):
            if child.tag.endswith("}metadata"):
                parent.remove(child)
    for element in root.iter():
        for key, value in list(element.attrib.items()):
            if key == "id":
                value = f"{prefix}-{value}"
            elif key == f"{{{XLINK}}}href":
                value = value.replace("#", f"#{prefix}-")
            elif key == "clip-path":
                value = value.replace("url(#", f"url(#{prefix}-")
            elif key == "style":
                value = re.sub(r"font: ([\d.]+)px [^;]*", r"font-size: \1px", value)
                value = value.replace("url(#", f"url(#{prefix}-")  # hatches
                value = re.sub("#[0-9a-f]{6}", lambda colour: VARIABLES.get(colour[0], colour[0]), value)
            element.set(key, value)
    for size in ("width", "height"):
        root.attrib.pop(size, None)
    root.set("aria-hidden", "true")
    return ET.tostring(root, encoding="unicode")
