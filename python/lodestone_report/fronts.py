"""What accuracy costs: the settings that no other one beats in both. Points are pairs (cost, error), less is better."""

import math


def pareto_front(points):
    """Indices of the points for which no other one is at most as expensive and at most as wrong, and better in one of the two, by
    rising cost; equal points stand side by side. Points that are not finite are left out. O(n log n)."""
    finite = [i for i, point in enumerate(points) if all(map(math.isfinite, point))]
    front = []
    for i in sorted(finite, key=lambda i: points[i]):
        if not front or points[i][1] < points[front[-1]][1] or points[i] == points[front[-1]]:
            front.append(i)
    return front


def cheapest_within(points, limit, costs):
    """Indices of the cheapest point with an error of at most limit and of those tied with it, by rising cost.

    `costs` are ranges (least, most) of what the points cost: two points are tied where these overlap.
    """
    kept = [i for i, point in enumerate(points) if all(map(math.isfinite, point)) and point[1] <= limit]
    kept.sort(key=lambda i: points[i])
    return [i for i in kept if costs[i][0] <= costs[kept[0]][1]]


def round_up(value):
    """The smallest of 1, 2, 5 times a power of ten that is not below value > 0."""
    power = math.floor(math.log10(value)) - 1
    while True:
        for digit in (1, 2, 5):
            limit = float(f"{digit}e{power}")
            if limit >= value:
                return limit
        power += 1


def error_limits(points):
    """Round limits to ask for the cheapest point of: from the first that some point keeps to the first that all of the
    front keep. Zero comes first where a point has no error at all; over many powers of ten these stand alone."""
    errors = [points[i][1] for i in pareto_front(points)]  # falling
    if not errors:
        return []
    zeros = [0.0] if errors[-1] <= 0 else []
    if errors[0] <= 0:
        return zeros
    limits = [round_up(min(error for error in errors if error > 0))]
    while limits[-1] < errors[0]:
        limits.append(round_up(limits[-1] * 1.5))
    if len(zeros + limits) > 9:
        powers = [limit for limit in limits[:-1] if abs(math.log10(limit) - round(math.log10(limit))) <= 1e-6]
        limits = powers + limits[-1:]
    return zeros + limits
