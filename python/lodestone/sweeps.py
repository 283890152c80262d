"""One run of an experiment, and the rows of a sweep."""

from __future__ import annotations

import os
import tempfile
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Union

from . import _lodestone

if TYPE_CHECKING:
    import pandas


def run_experiment(
    name: str,
    parameters: Optional[Mapping[str, Any]] = None,
    *,
    input: Union[str, os.PathLike[str], None] = None,
    directory: Union[str, os.PathLike[str], None] = None,
    progress: Optional[Callable[[str, float], object]] = None,
) -> list[dict[str, Any]]:
    """One run of an experiment, as each of `lodestone sweep` is one, but in this process.

    name: one of experiments(); `lodestone experiments NAME` tells its parameters, units and columns. parameters: those
    that differ from their defaults, as in a sweep file; input: a mesh file, for the experiments that take one; directory:
    a folder that exists, for pictures; None: they are not kept. Returns the rows, a list of dicts. Raises NegativeResult
    when the rows do not verify, UsageError or InputError for an unknown or contradictory parameter, and what reading raises.
    """
    with tempfile.TemporaryDirectory() as scratch:
        return _lodestone.run_experiment(name, dict(parameters or {}), os.fspath(directory or scratch),
                                         input=None if input is None else os.fspath(input), progress=progress)


def load_sweep(folder: Union[str, os.PathLike[str]]) -> pandas.DataFrame:
    """The rows of a sweep's directory as a pandas DataFrame: parameters, columns, and the state of each run.

    lodestone_report.load has more: units, medians, manifests, figures. Raises InputError when the folder does not hold a
    sweep, UnsupportedError without pandas.
    """
    try:
        import pandas  # noqa: F401
    except ImportError:
        raise _lodestone.UnsupportedError("load_sweep needs pandas, Debian's python3-pandas") from None
    import lodestone_report

    try:
        return lodestone_report.load(folder).rows
    except lodestone_report.StudyError as error:
        raise _lodestone.InputError(str(error)) from None
