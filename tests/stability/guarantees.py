"""Sections of docs/stability.md on views, guarantees and precision: what the tests promise, and what their programs find."""

import datetime
import os
import re
import subprocess

TRIALS = 10_000

VIEWS = """
## Views

The test `view_cases` draws a closed model on soft, gl and null: from a vertex, from inside, on faces and corners of cells,
with fields of view of 1 and 170 degrees, with the near plane through the surface, and from 1e2 to 1e12 times its size away.
Every depth is a number in [0, 1]; no pixel inside the silhouette of the finest level is empty; pictures are those of
soft within the tolerance of the conformance tests, and those of a new renderer bit by bit after the camera has jumped.
From far away pictures are alike; from 1e13 to 1e18 times its size the model is a point, and fields of view in which it would
fill the picture are refused by name, as no direction in double precision leads to a part of it. So are positions that are not
finite, or too far away for single precision. A model of a million units is drawn with one of a thousandth beside it and within
it, from near and through a telescope: alike on both, with no part of either beyond the far plane. At a uniform kappa0 around
the reach, from 1e-4 below to 1e-4 above, nothing cracks from where the radii are admissible on, and the adversary finds cracks
at 0.9999 of the largest reach of a vertex that it knows.
"""

FORCE = """
## Guarantees by force

The test `guarantees` makes random small models (spheres, boxes, tori, terrains whole, torn and with fins, soups of triangles),
builds them with random parameters and every simplifier, and looks at them along random segments of viewpoints. `verify`
passes; closed surfaces remain closed at every level, with the same Euler number (but for clustering); there is no residual
edge and no gap; no vertex jumps farther than its bound. Below the largest reach of a vertex that the adversary knows, at 0.99
of it, some view is cracked, in every model in which a shared vertex moves. A hundred models are tried with the other tests.
What the search has found is among the named cases of the test.

{trials:,} models each: {outcome}
"""

PRECISION = """
## Stored bounds

The test `stored_bounds` checks in rational arithmetic, on the catalogue: displacements, reaches of both metrics, diameters,
longest edges, measured errors of cells and of progressive levels, boxes and errors of tiles, errors of .lpm and .glb,
lattices, radii for a tolerance in pixels, and the ends of morph bands. What is stored as a bound is rounded up
(core/math/round_up.h).

## Rounding of the kernels

Against the same formulas in rational arithmetic, or in `long double` where roots of roots are taken, on triangles of the
catalogue in the unit cube; plain formulas in other precisions show what 64 bits cost and gain over 32. Nanoseconds are of one
core, the least of seven rounds. The test `rounding` derives the tolerances that the program relies on. Edge functions of the
software rasterizer are integers, and signs of orientation are exact.

{table}

Where the program computes in float it keeps numbers small (quadrics about their vertex) or selects both ends (lambda).
Closest points and stretch need 64 bits: in float the distance of a sliver keeps two digits and its stretch none, and at most
a fifth of the time is saved. Guarantees were tried and kernels measured on {date}.
"""


def run_trials(build):
    """The outcome of both properties, as one line."""
    start = os.times().children_user
    run = subprocess.run([build / "tests/stability/test_guarantees"], capture_output=True, text=True,
                         env=os.environ | {"RC_PARAMS": f"max_success={TRIALS}"})
    seconds = os.times().children_user - start
    if run.returncode:
        fault = re.search(r"Falsifiable.*?(?=\n\n)", run.stdout, re.DOTALL)
        return f"a counterexample: `{fault.group(0) if fault else run.stdout[-300:]}`"
    return f"no counterexample, in {seconds:.0f} s of processor time."


def sections(build):
    table = subprocess.run([build / "tests/stability/precision_table"], capture_output=True, text=True, check=True).stdout
    return VIEWS + FORCE.format(trials=TRIALS, outcome=run_trials(build)) + PRECISION.format(
        table=table.rstrip(), date=datetime.date.today())
