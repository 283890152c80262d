"""Studies of `lodestone sweep` in Python: load one, look at its rows, draw its figures, write its report.

    import lodestone_report as lr
    study = lr.load("ablation")
    study.rows                  # a DataFrame; study.units, study.runs, study.problems, study.manifests
"""

from .study import Study, StudyError, load

__all__ = ["Study", "StudyError", "load"]
