"""Studies of `lodestone sweep` in Python: load one, look at its rows, draw its figures, write its report.

    import lodestone_report as lr
    study = lr.load("ablation")
    study.rows                                   # a DataFrame; study.settings has medians; study.units, study.runs
    study.figure("Cracks below and above the border")
    study.figure("Time", x="kappa0", y="seconds", series="blend", sweeps="border").save("time")
    lr.write_report(study, "ablation.html")

pandas, matplotlib and jinja2 (Debian: python3-pandas, python3-matplotlib, python3-jinja2) are imported when they are used.
"""

from .reading import load
from .report import write_report
from .runs import StudyError
from .study import Study

__all__ = ["Study", "StudyError", "load", "write_report"]
