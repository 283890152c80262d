"""The command `lodestone report`, which checks its options and calls this: python3 -m lodestone_report DIR... -o FILE.html"""

import argparse
import importlib.util
import os
import signal
import subprocess
import sys

from . import StudyError

SYSTEM_PYTHON = "/usr/bin/python3"  # the interpreter that sees Debian's packages


def parse_arguments():
    parser = argparse.ArgumentParser(prog="lodestone report", description="Write what sweeps have found as one web page")
    parser.add_argument("folders", metavar="DIR", nargs="+", help="directories that `lodestone sweep` wrote to; finished or not")
    parser.add_argument("-o", "--output", required=True, help="the page, FILE.html")
    parser.add_argument("--csv", help="also write every row, with parameters and data, as FILE.csv")
    parser.add_argument("--json", help="also write everything as JSON (- for standard output)")
    parser.add_argument("--pictures", type=int, default=16, help="MiB of the runs' pictures that the page may hold; 0: none")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    return parser.parse_args()


def system_has_modules():
    find = "import importlib.util as u, sys; sys.exit(not all(map(u.find_spec, ('jinja2', 'matplotlib'))))"
    return subprocess.run([SYSTEM_PYTHON, "-B", "-c", find], check=False).returncode == 0


def find_modules():
    """Goes on in the system's Python where this one lacks a module. Without jinja2 there is no page, without matplotlib there
    are not any plots."""
    missing = [module for module in ("jinja2", "matplotlib") if importlib.util.find_spec(module) is None]
    is_chosen = "LODESTONE_PYTHON" in os.environ or sys.executable == SYSTEM_PYTHON
    if missing and not is_chosen and os.path.exists(SYSTEM_PYTHON) and ("jinja2" in missing or system_has_modules()):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, "-B", "-m", __package__, *sys.argv[1:]])
    try:
        import jinja2  # noqa: F401
    except ImportError:
        raise ImportError(f"{sys.executable}: the report needs the module jinja2, which is missing; "
                          "apt-get install python3-jinja2 python3-matplotlib (scripts/setup report does)") from None


def print_summary(studies, output, note):
    from .findings import count_runs, reported

    for study in studies:
        counts = count_runs(study.sweeps)
        print(f"{study.title}: {counts['runs']} runs, {reported(counts)} verified, {counts['unverified']} not verified, "
              f"{counts['failed']} failed, {counts['missing']} missing")
        for oddity in study.oddities:
            print(f"note: {oddity}")
        for figure in study.figures:
            print(f"  {figure.title}: {figure.outcome}")
    if note:
        print(f"note: {note}")
    print(f"{output}: opens in any browser, from disk")


class NoRows(Exception):
    """The report is written, and nothing in it can be reported."""


def require_rows(studies, output):
    """The report tells why nothing is reported; a script that waits for figures learns it here."""
    from .findings import count_runs, reported

    counts = count_runs(sweep for study in studies for sweep in study.sweeps)
    if not reported(counts):
        raise NoRows(f"{output}: written, but no run has rows that verified: of {counts['runs']} runs, "
                     f"{counts['unverified']} did not verify, {counts['failed']} failed, {counts['missing']} are not yet run")


def run(arguments):
    find_modules()
    from . import files, load, write_report

    is_shown = sys.stderr.isatty() and not arguments.quiet
    print("    drawing\r" if is_shown else "", end="", file=sys.stderr, flush=True)
    studies = [load(folder) for folder in arguments.folders]
    note = write_report(studies, arguments.output, csv=arguments.csv, json=None if arguments.json == "-" else arguments.json,
                        picture_bytes=arguments.pictures << 20)
    print(" " * 11 + "\r" if is_shown else "", end="", file=sys.stderr, flush=True)
    if arguments.json == "-":
        print(files.json_text(files.to_json(studies)), end="")
    require_rows(studies, arguments.output)
    if not arguments.quiet and arguments.json != "-":
        print_summary(studies, arguments.output, note)
    sys.stdout.flush()


class Interrupted(BaseException):
    pass


def interrupt(number, _):
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise Interrupted(number)


def main():
    """Returns the status: 0, that of an error (`lodestone --help`) after one line on standard error, or 128 + signal."""
    signal.signal(signal.SIGINT, interrupt)
    signal.signal(signal.SIGTERM, interrupt)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(encoding="utf-8", errors="replace")
    try:
        run(parse_arguments())
        return 0
    except Interrupted as error:
        print("lodestone: interrupted; no unfinished file was left", file=sys.stderr)
        return 128 + error.args[0]
    except NoRows as error:
        status, message = 1, str(error)
    except OSError as error:
        status, message = 4, f"{error.filename or 'standard output'}: cannot write: {error.strerror}"
    except MemoryError:
        status, message = 6, "out of memory; close other programs or report on fewer folders"
    except ImportError as error:
        status, message = 5, str(error)
    except StudyError as error:
        status, message = 3, str(error)
    except Exception as error:
        status, message = 7, str(error) or type(error).__name__
    print("lodestone:", "".join(c if c.isprintable() else " " for c in message), file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
