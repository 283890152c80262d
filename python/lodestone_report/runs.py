"""What the directory of a sweep holds, as plain records: sweeps, runs, repetitions and their faults."""

from __future__ import annotations

import pathlib
from dataclasses import dataclass, field
from typing import Any

COLUMN_KINDS = ("label", "accuracy", "quality", "cost", "count")
FIGURE_KINDS = ("line", "scatter", "bar")


class StudyError(Exception):
    """A folder that cannot be read or breaks the contract; its text is one line, FILE: PLACE: what is wrong; what to do."""


@dataclass
class Column:
    """A column of rows, or a parameter: then its kind is "label"."""

    name: str
    unit: str = ""
    meaning: str = ""
    kind: str = "label"  # of COLUMN_KINDS; of accuracy less is better, of quality more
    condition: bool = False  # of a parameter: what is measured, or how; settings compete only where conditions are equal


@dataclass
class FigureRequest:
    """A figure as the sweep's file asks for it; fields as in docs/format.md."""

    title: str
    sweeps: list[str]
    x: str
    y: list[str]
    series: list[str] = field(default_factory=list)
    kind: str = "line"
    log: str = ""
    mark: str = ""
    pareto: bool = False
    where: dict[str, Any] = field(default_factory=dict)


@dataclass
class Fault:
    """Why a repetition is not reported."""

    kind: str  # "verify", "error", "crash"
    messages: list[str]


@dataclass
class Repetition:
    """Rows, or a fault, or both (rows that did not verify), or nothing yet (rows is None)."""

    number: int
    rows: list[dict] | None = None
    fault: Fault | None = None
    manifest: dict = field(default_factory=dict)


@dataclass
class Run:
    """One setting on one input, with all repetitions that its sweep asks for."""

    id: str
    data: str
    parameters: dict
    repetitions: list[Repetition] = field(default_factory=list)
    program: str = ""
    input: str = ""
    input_sha256: str = ""
    unsteady: list[str] = field(default_factory=list)  # results that differ between repetitions, in words
    pictures: list[pathlib.Path] = field(default_factory=list)

    @property
    def state(self):
        """ "complete", "incomplete" (repetitions are missing), "unverified" (results are wrong, or differ between
        repetitions), "failed" (every repetition ended in an error or a crash) or "missing" (not yet run)."""
        if self.unsteady or any(r.fault and r.fault.kind == "verify" for r in self.repetitions):
            return "unverified"
        good = len(self.good_repetitions)
        if good:
            return "complete" if good == len(self.repetitions) else "incomplete"
        return "failed" if any(r.fault for r in self.repetitions) else "missing"

    @property
    def is_reported(self):
        """True if tables and figures show the run."""
        return self.state in ("complete", "incomplete")

    @property
    def good_repetitions(self):
        """Those that verified."""
        return [r for r in self.repetitions if r.rows is not None and not r.fault]


@dataclass
class Sweep:
    """The runs of one experiment, with the columns of its rows."""

    name: str
    experiment: str
    question: str
    repetitions: int
    parameters: list[Column]
    columns: list[Column]
    metrics: list[str] = field(default_factory=list)  # columns that tables show beside parameters; empty: all
    runs: list[Run] = field(default_factory=list)
