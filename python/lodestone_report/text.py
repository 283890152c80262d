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


def short_number(value):
    """1234567 -> "1,234,567", 0.012345 -> "0.0123": three digits, but whole numbers keep theirs."""
    if float(value).is_integer() and abs(value) >= 1000:
        return f"{int(value):,}"
    return f"{value:,.0f}" if abs(value) >= 999.5 else f"{value:.3g}"


def span(values):
    """ "1.2 to 3.4", or the one value that there is."""
    least, most = short_number(min(values)), short_number(max(values))
    return least if least == most else f"{least} to {most}"


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
