"""What accuracy costs, across all parts: for an error asked for, the cheapest of the settings that were tried, by each cost.

The rows are those of the standard studies. Whether an answer depends on the model or the camera shows in how many of them
have the same cheapest way, and in how far the costs of the others lie apart.
"""

import math
from dataclasses import dataclass

from .fronts import cheapest_within, error_limits
from .text import counted, short_number, span, value_text
from .values import is_number

MB = 1e6
MOST_LIMITS = 5
SHOWN_WAYS = 3


@dataclass(frozen=True)
class Part:
    """`error`: heading and column. `ways`: the names of what tells the ways apart, and how their values are written.
    `costs`: heading, column, and what its numbers are divided by."""

    title: str
    study: str
    sweeps: tuple
    error: tuple
    ways: dict
    costs: tuple
    note: str = ""


RMS = ("RMS, % of the diagonal", "rms")
SCREEN = ("on the screen, pixels", "screen_error")
CPU, TRIANGLES = ("CPU seconds", "cpu_seconds", 1), ("triangles", "triangles", 1)
PEAK, FRAME = ("peak MB", "peak_bytes", MB), ("ms a frame", "frame_ms", 1)

PARTS = [
    Part("A level of a model", "accuracy", ("families",), RMS, {"family": "{}"}, (CPU, TRIANGLES),
         "`hlod` and `progressive` make all levels in the time given."),
    Part("A hierarchy: the level two above the finest", "accuracy", ("simplifiers", "optimal"), RMS,
         {"simplifier": "{}", "placement": "{}", "sigma0": "sigma0 {}"},
         (CPU, ("triangles", "level_triangles", 1), ("file MB", "file_bytes", MB), PEAK)),
    Part("A progressive mesh", "progressive", ("shapes", "textured"), RMS, {"metric": "{}"},
         (CPU, TRIANGLES, ("file MB", "file_bytes", MB), PEAK),
         "The seconds, bytes and memory are those of the whole ladder, whose level is taken."),
    Part("A reconstruction", "reconstruction", ("models", "settings"), RMS,
         {"resolution": "{} pixels", "view_count": "{} views", "merge": "{}", "detail": "detail {}"}, (CPU, TRIANGLES, PEAK)),
    Part("A geometry image over the sphere", "spherical", ("geometry",), ("RMS, % of the diagonal", "geometry_image_rms"),
         {"texture": "{} pixels"}, (CPU, ("kB", "geometry_image_bytes", 1e3))),
    Part("A frame", "rendering", ("tolerance",), SCREEN, {"backend": "{}", "pixel_error": "asked for {}"},
         (FRAME, ("CPU ms", "frame_cpu_ms", 1), TRIANGLES, PEAK)),
    Part("A frame, by system", "systems", ("scans", "others", "paths", "generated", "orbit", "terrain"), SCREEN, {"system": "{}"},
         (FRAME, ("surface triangles", "surface_triangles", 1), ("drawn MB", "drawn_bytes", MB), PEAK,
          ("CPU seconds to make", "make_cpu_seconds", 1)),
         "Cross-fade draws two levels at once; that systems crack or pop is not counted here, but on [their page](systems.md)."),
]


def places_of(settings):
    """The settings by what accuracy is asked for on: a model, and a camera where there are several, whose path a sweep may
    sample in its own way."""
    places = {}
    for setting in settings:
        camera = setting.value("camera")
        places.setdefault((setting.value("data"), camera, camera and setting.value("sweep")), []).append(setting)
    return list(places.values())


def way_text(part, setting):
    """ "quadric, sigma0 0.2" """
    return ", ".join(form.format(value_text(setting.value(name))) for name, form in part.ways.items()
                     if setting.value(name) is not None)


def points_of(part, settings, column):
    def number(value):
        return value if is_number(value) else math.nan

    return [(number(setting.value(column)), number(setting.value(part.error[1]))) for setting in settings]


def asked(part, places):
    """Round errors between the least and the most that places reach, at most MOST_LIMITS of them, evenly chosen."""
    limits = sorted({limit for settings in places for _, column, _ in part.costs
                     for limit in error_limits(points_of(part, settings, column))})
    if len(limits) <= MOST_LIMITS:
        return limits
    step = (len(limits) - 1) / (MOST_LIMITS - 1)
    return [limits[round(i * step)] for i in range(MOST_LIMITS)]


def cheapest(part, settings, column, limit):
    """(cost, ways) of the cheapest setting within the limit, with the ways that are tied with it; None if there is none."""
    ranges = [setting.at(column).values[1:] for setting in settings]
    found = cheapest_within(points_of(part, settings, column), limit, ranges)
    if not found:
        return None
    return settings[found[0]].value(column), list(dict.fromkeys(way_text(part, settings[i]) for i in found))


def shown(texts, between):
    """The first of them, and how many there are besides."""
    more = f" and {counted(len(texts) - SHOWN_WAYS, 'other')}" if len(texts) > SHOWN_WAYS else ""
    return between.join(texts[:SHOWN_WAYS]) + more


def answer(part, places, cost, limit):
    """ "0.02 to 0.05: hlod on 3; progressive on 1"; the number of places is left out where there is one way."""
    _, column, divisor = cost
    found = [best for settings in places if (best := cheapest(part, settings, column, limit))]
    if not found:
        return ""
    ways = {}  # those that are tied, in any order: as they are first met, and how often
    for _, tied in found:
        ways.setdefault(frozenset(tied), [tied, 0])[1] += 1
    texts = [shown(tied, " or ") + (f" on {count}" if len(ways) > 1 else "")
             for tied, count in sorted(ways.values(), key=lambda way: -way[1])]
    return f"{span([value / divisor for value, _ in found])}: {shown(texts, '; ')}"


def part_rows(part, settings):
    """A row for each error asked for: the error, on how many places it is reached, and the answer for each cost."""
    places = places_of(settings)
    rows = []
    for limit in asked(part, places):
        reached = sum(any(error <= limit for _, error in points_of(part, here, part.costs[0][1])) for here in places)
        rows.append([short_number(limit), f"{reached} of {len(places)}", *(answer(part, places, cost, limit) for cost in part.costs)])
    return rows


def headings(part):
    return [f"at most, {part.error[0]}", "reached on", *(heading for heading, *_ in part.costs)]
