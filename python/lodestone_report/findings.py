"""What to know about a study before reading its figures: what ran, on what, and what is odd about it."""

from collections import Counter, defaultdict

import json

from .text import counted, dump, shown_unit, value_text, with_unit
from .values import dotted, is_number

STATES = ("complete", "incomplete", "unverified", "failed", "missing")
# Manifest keys in which the repetitions of one study should agree.
ONE_OF_A_KIND = ("program", "commit", "compiler", "flags", "host", "cpu", "cores", "memory_bytes", "renderer")
FEW_VALUES = 4
FAULT_TEXTS = {"verify": "did not verify", "error": "ended in an error"}


def count_runs(sweeps):
    """The number of "runs", and of those in each state."""
    states = Counter(run.state for sweep in sweeps for run in sweep.runs)
    return {"runs": states.total(), **{state: states[state] for state in STATES}}


def reported(counts):
    """The number of runs that tables and figures show."""
    return counts["complete"] + counts["incomplete"]


def collect(study):
    """{key: {value as JSON: number of repetitions}} of all manifests."""
    values = defaultdict(Counter)
    for run in study.unique_runs():
        for repetition in run.repetitions:
            if repetition.rows is not None or repetition.fault:
                for key, value in dotted(repetition.manifest).items():
                    values[key][dump(value)] += 1
        if run.program and run.state != "missing":
            values["program"][dump(run.program)] += 1
    return {key: dict(sorted(values[key].items())) for key in sorted(values)}


def fact_text(key, value):
    """A value of a manifest: lists in a line, bytes as MiB."""
    if is_number(value) and key.endswith("bytes"):
        unit, divisor = shown_unit("bytes")
        return with_unit(value / divisor, unit)
    return ", ".join(map(value_text, value)) if isinstance(value, list) else value_text(value)


def values_text(key, counts):
    """One value, a few with how often they occur, or a range."""
    values = [json.loads(text) for text in counts]
    if len(values) == 1:
        return fact_text(key, values[0])
    if len(values) <= FEW_VALUES:
        return "; ".join(f"{fact_text(key, value)} ({count}×)" for value, count in zip(values, counts.values()))
    if all(map(is_number, values)):
        return f"{fact_text(key, min(values))} to {fact_text(key, max(values))}"
    return f"{len(values)} different, from {fact_text(key, values[0])} to {fact_text(key, values[-1])}"


def summarize_manifests(study):
    """[(key, text)] over the manifests of all repetitions."""
    return [(key, values_text(key, counts)) for key, counts in collect(study).items()]


def list_oddities(study):
    """In words: several machines or programs, sources that were changed, runs that lack repetitions, runs of other settings
    in the folder."""
    oddities = []
    for key, counts in collect(study).items():
        last = key.rpartition(".")[2].lower()
        if last in ONE_OF_A_KIND and len(counts) > 1:
            oddities.append(f"Mixed: {key} has {len(counts)} values: {values_text(key, counts)}")
        if last == "dirty" and "true" in counts:
            oddities.append(f"Sources were changed after the commit: {counted(counts['true'], 'repetition')}")
    for sweep in study.sweeps:
        if incomplete := count_runs([sweep])["incomplete"]:
            oddities.append(f"Sweep {sweep.name}: repetitions are missing of {counted(incomplete, 'run')}; the spread is of "
                            "those that are there")
    if study.other_runs:
        oddities.append(f"Left out: {counted(study.other_runs, 'run')} of other settings or of another program in the folder")
    return oddities


def run_label(sweep, run):
    """A run as people know it: data and the parameters that its sweep varies."""
    varied = [p.name for p in sweep.parameters if len({dump(other.parameters.get(p.name)) for other in sweep.runs}) > 1]
    return ", ".join(filter(None, [run.data, *(f"{name} = {value_text(run.parameters.get(name))}" for name in varied)]))


def list_problems(study):
    """A dict for each repetition that is left out or missing: sweep, run, setting, repetition, what, why."""
    problems = []
    for sweep in study.sweeps:
        for run in sweep.runs:
            def add(repetition, what, why=""):
                problems.append({"sweep": sweep.name, "run": run.id, "setting": run_label(sweep, run),
                                 "repetition": repetition, "what": what, "why": why})

            for r in run.repetitions:
                if r.fault:
                    add(str(r.number), FAULT_TEXTS.get(r.fault.kind, "crashed"), "; ".join(r.fault.messages))
            if run.unsteady:
                add("all", FAULT_TEXTS["verify"], "; ".join(run.unsteady))
            missing = [str(r.number) for r in run.repetitions if not r.fault and r.rows is None]
            if missing:
                add(", ".join(missing), "not yet run")
    return problems
