"""The model of many ranks on the page of the study `distributed`: what it rests on, how near it comes to every job that was
run, what it says of 10^9 to 10^12 triangles, and what breaks first."""

import math
import os
import pickle
import subprocess
import sys

from .figures import Figure, Panel, Point, Series
from .rank_model import HEAD, MOST_DIRECT, NETWORKS, PARCEL, Job, Model
from .result_tables import STAGES
from .text import short_number
from .values import is_number, median

JOBS, PLANS = ("strong", "weak_1", "weak_2", "weak_4"), ("plans",)
TRIANGLES, RANKS = (1e9, 1e10, 1e11, 1e12), (16, 64, 256, 1024, 4096)
ALL_RANKS = [2**k for k in range(1, 13)]
USUAL = NETWORKS[1]
MOST_TRIANGLES = 2**32          # numbers of triangles have 32 bits, and there are about half as many vertices, of 31
MACHINE_MEMORY = 256e9
MOST_BYTES, MOST_IMBALANCE = 60, 1.15     # that the study is to keep
PICTURE = "distributed.svg"
SYSTEM_PYTHON = "/usr/bin/python3"  # the interpreter that sees Debian's packages
FEWEST_JOBS = 4
FEWEST_BLOCKS = 4               # of a rank, where a sample makes a difference that is not one of whole blocks


def power(value):
    """1e9 -> "10^9" """
    return f"10^{round(math.log10(value))}"


def table(headings, rows):
    return ["| " + " | ".join(map(str, row)) + " |" for row in [headings, ["---"] * len(headings), *rows]]


def pair(predicted, measured):
    """ "1.2 / 1.3 (-8 %)" """
    error = f" ({100 * (predicted / measured - 1):+.0f} %)" if measured else ""
    return f"{short_number(predicted)} / {short_number(measured)}{error}"


# ---- beside what was run


def key_of(setting):
    return tuple(setting.value(name) for name in ("data", "ranks", "rank_threads"))


def beside_runs(jobs, plans):
    """A row for each job that was run, predicted by a model that has not seen it."""
    rows = []
    for s in {key_of(s): s for s in jobs}.values():
        others = [other for other in jobs if key_of(other) != key_of(s)]
        if not any(other.value("rank_threads") == 1 for other in others):
            continue
        job = Model.job(s)
        found = Model(others, plans).predict(job)
        several = is_number(s.value("peak_bytes"))
        rows.append([*key_of(s), pair(found.cpu_seconds, s.value("cpu_seconds")), pair(found.seconds, s.value("seconds")),
                     pair(found.bytes / job.triangles, s.value("bytes_per_triangle")) if several else "",
                     pair(found.rounds, s.value("rounds_of_messages")),
                     pair(found.imbalance, s.value("imbalance_triangles")) if several else "",
                     pair(found.peak_bytes / 1e6, s.value("peak_bytes") / 1e6) if several else "",
                     pair(found.first_peak_bytes / 1e6, s.value("first_peak_bytes") / 1e6) if several else ""])
    return rows


def beside_samples(model, plans):
    """Imbalance where borders follow from triangles drawn at random: the formula, and the plans that were drawn."""
    fine = min(s.value("cell_triangles") for s in plans)
    rows = []
    for ranks in sorted({s.value("ranks") for s in plans}):
        def of(seeded, ranks=ranks):
            return [s.value("level_imbalance") for s in plans if s.value("ranks") == ranks and s.value("coarser") == 0 and
                    bool(s.value("seed")) == seeded and s.value("cell_triangles") == fine and
                    s.value("level_blocks") >= FEWEST_BLOCKS * ranks]
        even, drawn = of(False), of(True)
        if even and drawn:
            predicted = median(even) * model.dealt.sample_imbalance(Job(1, ranks))
            rows.append([short_number(ranks), short_number(median(even)), pair(predicted, median(drawn))])
    return rows


def costs(model):
    rows = []
    for stage in STAGES:
        triangle, byte, message = model.cost[stage] or (0, 0, 0)
        fixed, growing = model.rounds[stage] or (0, 0)
        rows.append([stage, *map(short_number, (1e9 * triangle, 1e9 * byte, 1e6 * message, fixed, growing, model.sent[stage][""],
                                                model.gain[stage]))])
    return rows


# ---- larger jobs


def predicted(model):
    """A row for each size and number of ranks."""
    rows = []
    for triangles in TRIANGLES:
        for ranks in RANKS:
            job = Job(triangles, ranks)
            usual = model.predict(job, USUAL)
            seconds = [f"{short_number(model.predict(job, network).seconds)} / "
                       f"{short_number(model.predict(job, network, direct=True).seconds)}" for network in NETWORKS]
            rows.append([power(triangles), short_number(ranks), *seconds,
                         *(f"{100 * part / usual.seconds:.0f}" for part in (usual.first_seconds, usual.rounds_seconds)),
                         *map(short_number, (usual.bytes / triangles, usual.heads / triangles, usual.imbalance,
                                             model.uneven("levels", job, False),
                                             model.predict(job, USUAL, sampled=True).imbalance,
                                             usual.peak_bytes / 1e9, usual.first_peak_bytes / 1e9))])
    return rows


def first_rank_count(holds):
    return next((ranks for ranks in ALL_RANKS if holds(ranks)), None)


def breaks(model, triangles=TRIANGLES[0]):
    """(ranks, name, sentence) of what breaks by ranks on the usual network, the first one first; None: not up to the most."""
    def at(ranks, **more):
        return model.predict(Job(triangles, ranks), USUAL, **more)

    work = sum((model.cost[stage] or [0])[0] * model.work(stage, triangles) for stage in STAGES)
    found = [
        (first_rank_count(lambda r: at(r).first_seconds > at(r).seconds / 2), "rank 0's tables",
         "rank 0 alone, which numbers signatures and makes the tables, takes more time than all that is done side by side: more ranks than "
         f"that gain less than a factor of two, and {short_number(work / at(ALL_RANKS[-1]).first_seconds)} is the largest "
         "speed-up of any number of them"),
        (first_rank_count(lambda r: model.dealt.sample_imbalance(Job(triangles, r)) > MOST_IMBALANCE), "splitters",
         f"borders between ranks, chosen by 2^16 triangles, are uneven by more than {MOST_IMBALANCE} in an input without order"),
        (first_rank_count(lambda r: at(r).bytes / triangles > MOST_BYTES), "traffic",
         f"ranks send more than {MOST_BYTES} bytes for each triangle"),
        (first_rank_count(lambda r: at(r).heads > at(r).bytes / 2), "heads of messages",
         f"the {HEAD} bytes before each message, and the {PARCEL} before each part of one that goes by way of others, are more than "
         "the content"),
        (first_rank_count(lambda r: at(r).rounds_seconds > work / r), "rounds",
         "messages and their latency take longer than the work that they are for"),
        (first_rank_count(lambda r: model.uneven("levels", Job(triangles, r), False) > 2), "coarse levels",
         "the levels take twice as long as they would if their blocks were dealt out evenly"),
    ]
    return sorted(found, key=lambda one: one[0] or math.inf)


def breaking_lines(model):
    per_triangle = model.dealt.tables
    found = breaks(model)
    order = ", ".join(f"{name} ({ranks:,})" for ranks, name, _ in found if ranks)
    large = Job(TRIANGLES[0], RANKS[-1])
    built, direct = (model.predict(large, USUAL, direct=direct) for direct in (False, True))
    lines = [f"The order, with the ranks from which each holds: {order}.", "",
             f"- Above {MOST_TRIANGLES / 1e9:.1f} 10^9 triangles the program refuses the input, and above a sixth of that from STL, which "
             "has three vertices for each: numbers of triangles and vertices have 32 and 31 bits. Predictions beyond that are of a program with longer ones, whose messages would be larger by up to a "
             "half.",
             f"- Metadata of cells: rank 0 holds up to {short_number(per_triangle)} bytes for each triangle of the input, which is "
             f"{short_number(MACHINE_MEMORY / 1e9)} GB at {short_number(MACHINE_MEMORY / per_triangle / 1e9)} 10^9 triangles, "
             "whatever the number of ranks."]
    for ranks, name, sentence in found:
        limit = f"from {ranks:,} ranks on" if ranks else f"not up to {ALL_RANKS[-1]:,} ranks"
        lines.append(f"- {name[0].upper()}{name[1:]}: {limit}, {sentence}.")
    return [*lines, f"- With a message between any two ranks in every round, {large.ranks:,} ranks would take "
            f"{short_number(direct.seconds / built.seconds)} times as long, and send {short_number(direct.bytes / large.triangles)} "
            f"bytes for each triangle instead of {short_number(built.bytes / large.triangles)}."]


# ---- the picture


def series(name, xs, y_of):
    return Series(name, [Point(x, x, x, y, y, y) for x, y in ((x, y_of(x)) for x in xs) if y > 0])


def picture(model):
    """Time, its parts, traffic and memory over ranks."""
    def of(triangles, ranks, **more):
        return model.predict(Job(triangles, ranks), USUAL, **more)

    one = TRIANGLES[0]
    parts = [("the slowest rank's work", lambda p: p.seconds - p.first_seconds - p.rounds_seconds),
             ("rank 0's tables", lambda p: p.first_seconds), ("messages and latency", lambda p: p.rounds_seconds)]
    figure = Figure("Predicted jobs", "line", "ranks", log_x=True, log_y=True)
    figure.panels = [
        Panel("time", "s", series=[series(f"{power(n)} triangles", RANKS, lambda r, n=n: of(n, r).seconds) for n in TRIANGLES]),
        Panel(f"parts of it at {power(one)}", "s", series=[series(name, ALL_RANKS, lambda r, part=part: part(of(one, r)))
                                                           for name, part in parts]),
        Panel(f"sent at {power(one)}", "bytes per triangle", series=[
            series("all", ALL_RANKS, lambda r: of(one, r).bytes / one),
            series("before messages", ALL_RANKS, lambda r: of(one, r).heads / one)]),
        Panel(f"memory at {power(one)}", "GB", series=[
            series("rank 0", ALL_RANKS, lambda r: of(one, r).first_peak_bytes / 1e9),
            series("another rank", ALL_RANKS, lambda r: of(one, r).peak_bytes / 1e9)])]
    return figure


def draw(figure):
    """The text of an SVG, on white; "" without matplotlib in this Python and the system's."""
    try:
        from .plot import draw as sheet_of
        from .plot import to_svg
    except ImportError:
        if sys.executable == SYSTEM_PYTHON or not os.path.exists(SYSTEM_PYTHON):
            return ""
        package = os.path.dirname(os.path.dirname(__file__))
        done = subprocess.run([SYSTEM_PYTHON, "-B", "-m", f"{__package__}.distributed"], input=pickle.dumps(figure),
                              capture_output=True, env={**os.environ, "PYTHONPATH": package}, check=False)
        return done.stdout.decode() if done.returncode == 0 else ""
    return to_svg(sheet_of(figure), transparent=False)


# ---- the page


def model_of(results):
    """From the verified rows of the study; None where they are too few."""
    jobs, plans = results.settings(*JOBS), results.settings(*PLANS)
    singles = {key_of(s) for s in jobs if s.value("rank_threads") == 1}
    return Model(jobs, plans) if plans and len(singles) >= FEWEST_JOBS else None


def lines(results, target):
    """The part of the page that the model makes, and its picture in the folder `target`."""
    (target / PICTURE).unlink(missing_ok=True)
    model = model_of(results)
    if not model:
        return []
    jobs, plans = results.settings(*JOBS), results.settings(*PLANS)
    drawn = draw(picture(model))
    if drawn:
        (target / PICTURE).write_text(drawn, encoding="utf-8")
    source = ["", results.source((*JOBS, *PLANS)), ""]
    return [
        "## The model", "",
        "A stage takes the slowest rank its share of triangles and bytes, and for each round of messages a latency and, at both "
        "ends, the time of each message (LogGP, alexandrov1995). The factors are fits to the processor time of all jobs of one "
        "thread a rank; none is below 0. `rounds` are those of any job; those `by piece` come for every "
        "2^18 triangles, and for every 2^10 of a rank from 256 ranks on. `bytes` are the content for each triangle that could "
        "move, of the model that sends the most; of `finest` for each vertex between ranks, of `levels` over those that the plans "
        "say. `gain` is that of a second thread, by wall. Rank 0's tables take "
        f"{short_number(1e9 * model.first[''])} ns for each triangle of all ranks, on the model where they take the longest, and "
        "the others wait.", "",
        *table(["stage", "ns per triangle", "ns per byte", "µs per message", "rounds", "by piece", "bytes", "gain"], costs(model)),
        *source,
        "## Predicted and measured", "",
        "Each job is predicted from the others. Predicted / measured, and by how much the first is off. The processors are shared "
        "by ranks and by whatever else the machine does, which seconds show and processor seconds hardly do. Memory of rank 0 is "
        "predicted as that of another rank and its tables, an upper estimate.", "",
        *table(["data", "ranks", "threads of each", "CPU seconds", "seconds", "bytes per triangle", "rounds", "imbalance",
                "peak MB", "peak MB at rank 0"], beside_runs(jobs, plans)), *source,
        "Imbalance where the triangles that choose the ranks' borders are drawn at random, from four blocks a rank on: "
        "1 + sqrt(2 R ln R / 2^16) times that of an even sample.", "",
        *table(["virtual ranks", "even", "drawn"], beside_samples(model, plans)), *source,
        "## From 10^9 to 10^12 triangles", "",
        "Assumed: ranks of one thread, each on a processor like the one measured, of the shape and with the cells of the models "
        "that were dealt out; each level has a quarter of the triangles and blocks of the next finer one; a file system that "
        "keeps up. Networks are not measured but parameters, for each rank: "
        + "; ".join(f"{n.name}, latency {1e6 * n.latency:g} µs, message {1e6 * n.message:g} µs at either end, "
                    f"{n.bandwidth / 1e9:g} GB/s" for n in NETWORKS)
        + ". The topology of the last one (kim2008) shows in its latency alone. Seconds are given for rounds as they are, where "
        f"what all ranks have to know takes log2 R steps (thakur2005) and what moves goes by way of a square beyond {MOST_DIRECT} "
        "ranks, and for rounds that all have a message between any two ranks. The columns after the seconds are those of "
        f"{USUAL.name}, as they are.", "",
        *([f"![Time, its parts, bytes and memory of predicted jobs over ranks, {USUAL.name}]({PICTURE})", ""] if drawn else []),
        *table(["triangles", "ranks", *(f"s, {n.name}" for n in NETWORKS), "rank 0's tables, %", "messages, %", "bytes per triangle",
                "before messages", "imbalance", "of levels", "of an input without order", "peak GB", "peak GB at rank 0"],
               predicted(model)), *source,
        "## What breaks first", "",
        f"At {power(TRIANGLES[0])} triangles with {USUAL.name}, by number of ranks, after two limits that more ranks do not move.",
        *breaking_lines(model), ""]


if __name__ == "__main__":
    sys.stdout.write(draw(pickle.loads(sys.stdin.buffer.read())))
