"""Values of rows as numbers."""


def is_number(value):
    """True for numbers of JSON, which truth values are not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def median(values):
    """The value in the middle, or between the two there."""
    ordered = sorted(values)
    lower, upper = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
    return lower + (upper - lower) / 2


def dotted(tree, prefix=""):
    """{"gl": {"vendor": 1}} -> {"gl.vendor": 1}"""
    flat = {}
    for name, value in tree.items():
        flat.update(dotted(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value})
    return flat
