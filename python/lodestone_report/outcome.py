"""What a figure shows, in a line of text."""

from .text import counted, number_text, with_unit

SHOWN_FRONTS = 2


def extremes(samples):
    """The first of the smallest and the last of the largest y."""
    return min(samples, key=lambda s: s.point.y).point, max(reversed(samples), key=lambda s: s.point.y).point


def range_text(samples, unit):
    least, most = extremes(samples)
    first, last = number_text(least.y), with_unit(most.y, unit)
    return last if first == number_text(most.y) else f"{first} to {last}"


def place_text(figure, point):
    x = figure.x_value(point)
    text = x if figure.categories else with_unit(x, figure.x_unit)
    return f"{figure.x_name} = {text}" + (f", {point.label}" if point.label else "")


def describe_choice(choice):
    """ " (kappa0 = 2; tied with kappa0 = 4 and 3 more)" """
    texts = [choice.point.label] if choice.point.label else []
    if choice.tied:
        more = f" and {len(choice.tied) - 1} more" if len(choice.tied) > 1 else ""
        texts.append(f"tied with {choice.tied[0].label}{more}")
    return f" ({'; '.join(texts)})" if texts else ""


def describe_front(figure, panel, front):
    """The limit in the middle: neither the trivial nor the most expensive."""
    choice = front.choices[len(front.choices) // 2]
    return ((f"{front.conditions}: " if len(panel.fronts) > 1 else "") +
            f"{len(front.points)} of {front.candidates} settings on the front; {panel.y_name} of {panel.limit_text} "
            f"{with_unit(choice.limit, panel.y_unit)} costs {with_unit(choice.point.x, figure.x_unit)}{describe_choice(choice)}")


def describe_fronts(figure, panel):
    texts = [describe_front(figure, panel, front) for front in panel.fronts[:SHOWN_FRONTS]]
    if len(panel.fronts) > SHOWN_FRONTS:
        texts.append(f"{len(panel.fronts) - SHOWN_FRONTS} more fronts below")
    return ". ".join(texts)


def describe_side(where, mark, samples, unit):
    if not samples:
        return f"no setting {where} {mark}"
    above = sum(s.point.y > 0 for s in samples)
    some = f", above 0 at {above}" if 0 < above < len(samples) else ""
    return f"{where} {mark} ({counted(len(samples), 'setting')}) {range_text(samples, unit)}{some}"


def describe_sides(panel, mark, samples):
    marked = [s for s in samples if s.mark is not None]
    right, left = ([s for s in marked if (s.point.x < s.mark) == below] for below in (False, True))
    return (f"{panel.y_name}: {describe_side('from', mark, right, panel.y_unit)}; "
            f"{describe_side('below', mark, left, panel.y_unit)}")


def describe_range(figure, panel, samples):
    least, most = extremes(samples)
    if number_text(least.y) == number_text(most.y):
        return f"{panel.y_name} is {with_unit(least.y, panel.y_unit)} at all {len(samples)} points"
    return (f"{panel.y_name} from {with_unit(least.y, panel.y_unit)} ({place_text(figure, least)}) to "
            f"{with_unit(most.y, panel.y_unit)} ({place_text(figure, most)})")


def describe_panel(figure, panel, mark, samples):
    if not samples:
        return f"No setting that verified has numbers for {panel.y_name}"
    if any(front.choices for front in panel.fronts):
        return describe_fronts(figure, panel)
    if mark and any(s.mark is not None for s in samples):
        return describe_sides(panel, mark, samples)
    return describe_range(figure, panel, samples)


def describe_outcome(figure, mark, samples):
    """For a front: how many settings are on it, and what accuracy costs. Where settings have a mark: y on either side of
    it. Otherwise the minimum and maximum of y, and where. `samples` are lists by panel."""
    return ". ".join(describe_panel(figure, panel, mark, of_panel) for panel, of_panel in zip(figure.panels, samples)) + "."
