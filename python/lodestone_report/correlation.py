"""How far measures agree: rank correlations (spearman1904) between columns, over all settings and among those of one path."""

import math

from .values import is_number

FEWEST = 3


def ranks(values):
    """1 for the smallest; equal values share the mean of their ranks."""
    order = sorted(range(len(values)), key=lambda i: values[i])
    found = [0.0] * len(values)
    first = 0
    while first < len(order):
        last = first
        while last + 1 < len(order) and values[order[last + 1]] == values[order[first]]:
            last += 1
        for i in order[first:last + 1]:
            found[i] = (first + last) / 2 + 1
        first = last + 1
    return found


def centred(values):
    mean = sum(values) / len(values)
    return [value - mean for value in values]


def rank_correlation(groups):
    """Of pairs (x, y) in groups, none empty, each ranked by itself: -1 to 1; None where one side has no differences."""
    xs, ys = [], []
    for pairs in groups:
        xs += centred(ranks([x for x, _ in pairs]))
        ys += centred(ranks([y for _, y in pairs]))
    size = math.sqrt(sum(x * x for x in xs) * sum(y * y for y in ys))
    return sum(x * y for x, y in zip(xs, ys)) / size if size > 0 else None


def pairs_of(settings, a, b):
    pairs = [(s.value(a), s.value(b)) for s in settings if is_number(s.value(a)) and is_number(s.value(b))]
    return [pair for pair in pairs if all(map(math.isfinite, pair))]


def matrix(settings, columns, path_of):
    """Texts, a row for each column: above the diagonal over all settings, below it among those of one path, each as
    "correlation (pairs)". Groups of fewer than FEWEST pairs are left out: two always agree or disagree wholly."""
    paths = {}
    for setting in settings:
        paths.setdefault(path_of(setting), []).append(setting)

    def text(groups):
        groups = [pairs for pairs in groups if len(pairs) >= FEWEST]
        correlation = rank_correlation(groups)
        return "" if correlation is None else f"{correlation:.2f} ({sum(map(len, groups))})"

    return [["" if i == k else text([pairs_of(settings, a, b)]) if k > i else
             text([pairs_of(here, a, b) for here in paths.values()]) for k, b in enumerate(columns)]
            for i, a in enumerate(columns)]
