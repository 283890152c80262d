"""Which settings a figure shows (`where`), and which of them compete for its fronts."""

import operator
import re

from .text import dump
from .values import is_number

COMPARE = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
# A surface without a crack, and radii that promise so: what breaks is not cheap.
SOUND = {"admissible": True, "open_edges": 0, "torn_pixels": 0, "residual_edges": 0}


def holds(value, wanted):
    """True if a value of a row is as wanted: equal, or as a text like "<= 0.5" says."""
    comparison = re.fullmatch(r"(<=|>=|<|>)\s*(\S+)", wanted) if isinstance(wanted, str) else None
    if comparison:
        return is_number(value) and COMPARE[comparison[1]](value, float(comparison[2]))
    if is_number(value) and is_number(wanted):
        return value == wanted
    return dump(value) == dump(wanted)


def keeps(setting, where):
    """True if the setting is as `where` {name: value} wants it."""
    return all(holds(setting.value(name), wanted) for name, wanted in where.items())


def is_sound(setting, where):
    """True if the setting neither cracks nor has inadmissible radii, as far as it was measured; what `where` names has been
    asked for already."""
    return all(setting.value(name) is None or holds(setting.value(name), wanted)
               for name, wanted in SOUND.items() if name not in where)
