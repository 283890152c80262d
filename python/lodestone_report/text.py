"""Numbers and values for people: four digits, thousands apart, bytes as MiB."""

import json
import math

from .values import is_number


def number_text(value):
    """1234567 -> "1,234,567", 0.0123456 -> "0.01235", 1.5e-7 -> "1.5e-07". Whole numbers keep all their digits."""
    if not math.isfinite(value):
        return "not a number" if math.isnan(value) else "infinite" if value > 0 else "-infinite"
    size = abs(value)
    if size >= 1e15 or (value != round(value) and size < 9999.5):
        return f"{value:.4g}"
    return ("-" if value < 0 else "") + f"{math.floor(size + 0.5):,}"


def value_text(value):
    """number_text of numbers; texts as they are, "yes" and "no", and a dash for null."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return value
    return number_text(value) if is_number(value) else dump(value)


def counted(count, noun):
    """ "1 run", "2 runs" """
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def shown_unit(unit):
    """How values of a unit are shown: (name, divisor)."""
    return ("MiB", 2**20) if unit in ("bytes", "B") else (unit, 1)


def with_unit(value, unit):
    return f"{number_text(value)} {unit}".rstrip()


def plain(value):
    """A text as it is, anything else as JSON."""
    return value if isinstance(value, str) else dump(value)


# Compact JSON of a value: equal for equal values only, where 1 and 1.0 count as different.
dump = json.JSONEncoder(ensure_ascii=False, sort_keys=True, separators=(",", ":")).encode
