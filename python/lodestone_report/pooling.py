"""Finds what a curve would mix: settings that neither its x nor its series tells apart."""

from collections import defaultdict

from .text import dump

CHANCE = "seed"  # settings that differ in it alone are repetitions


def varied_names(tables):
    return list(dict.fromkeys(["sweep"] * (len(tables) > 1) + [name for table in tables for name in table.varied]))


def row_names(tables):
    """Numbers that part the rows of a run, as `workers`."""
    return list(dict.fromkeys(c.name for table in tables for c in table.columns if c.kind == "count" and table.parts_rows(c.name)))


def differing(samples, names):
    """The names of which the samples have several values."""
    return [name for name in names if len({dump(s.setting.value(name)) for s in samples}) > 1]


def pooled_at_places(samples, names):
    """Names in which points at one place differ; points with one y hide nothing."""
    places = defaultdict(list)
    for s in samples:
        places[s.point.x].append(s)
    mixed = [at_place for at_place in places.values() if len({s.point.y for s in at_place}) > 1]
    return [name for name in names if any(differing(at_place, [name]) for at_place in mixed)]


def pooled_along(samples, names):
    """An x that was measured may follow one thing, what the sweep varies or the rows of a run: names that this one does
    not tell are mixed."""
    left = differing(samples, names)
    keys = [lambda s, name=name: dump(s.setting.value(name)) for name in left]
    if len({s.setting.row for s in samples}) > 1:
        keys.append(lambda s: s.setting.row)
    combinations = {tuple(key(s) for key in keys) for s in samples}
    told = any(len({combination[k] for combination in combinations}) == len(combinations) for k in range(len(keys)))
    return left if left and not told else []


def pooled_names(request, tables, samples):
    """Names that have to join the series or be chosen by `where`, before curves or bars can be drawn; none: they can."""
    varied = [name for name in varied_names(tables) if name != CHANCE]
    curves = defaultdict(list)
    for s in samples:
        curves[s.panel, s.series].append(s)
    found = {}
    for curve in curves.values():
        pooled = pooled_at_places(curve, varied + row_names(tables)) if request.x in varied else pooled_along(curve, varied)
        found |= dict.fromkeys(pooled)
    return list(found)
