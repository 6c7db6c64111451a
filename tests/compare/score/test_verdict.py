"""The lines that people read, word by word, of a score that has them all and of one that has few."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace as Made

import numpy as np
import pytest

from compare.candidates.candidate import Deviation
from compare.diagnosis.case import Explanation, Model
from compare.diagnosis.since import Since
from compare.score.document import document
from compare.score.errors import Worst
from compare.score.transit_matching import TransitErrors
from compare.score.verdict import lines, percent

WIND = Explanation(causes=(Deviation("wind", "leaves out the wind", 0.25, "input"),), corrected_m=1e-9, allowed_m=5e-7)
RUN = Made(id="paris", run=Made(t_end="86400"), inputs="binary64")
ERRORS = Made(
    max_m=2e-3, rms_m=1e-3, end_m=5e-4, growth_exponent=1.5, amplitude_m=0.5, digits=2.39794, scd=1.04, mescd=-0.04,
    speed_m_s=0.2, bound_m=3e-30, t=np.array([0.0, 10.0, 3600.0]),
)  # fmt: skip
SHIFTED = TransitErrors(
    errors_s=np.array([0.5, 0.0, -0.25]), conditioned_m=np.array([0.05, 0.0, -0.025]), missed=[1.0, 2.0, 3.0, 4.0],
    extra=[5.0, 6.0, 7.0], at=np.array([8.0, 16.0, 24.0]), undecided=[42.0],
)  # fmt: skip


def score(**changes):
    most = {
        "candidate": Made(name="mine.csv", positions=True, conventions=[Made(text="t is in ms")]),
        "covered": 1 / 24, "covers": 0.0, "falls_short": False,
        "verdict": "disagrees", "grade": "disagrees", "scene": RUN, "errors": ERRORS, "at_bound": False,
        "tolerance_m": 5e-7, "allowed_m": 1e-3, "input_floor_m": 1e-12, "why_inputs": "as asked",
        "worst": Made(component="y", t=10.0, expected=0.25, got=0.252, difference=0.002),
        "worst_of_each": {"x": Made(difference=-0.001), "y": Made(difference=0.002), "vx": Made(difference=3e-5)},
        "swing": Made(largest_turn=math.pi / 180, largest_delay=0.5), "drifts": {"h_m2_s2": 1e-9, "length_m": 2e-9},
        "transits": SHIFTED, "timing": Made(runs=3, warm=True, cpu_s=1.5, wall_s=2.5),
        "golden": Made(level="confirmed"), "explanation": WIND, "since": None, "notes": ("late",),
        "experiments": None,
    }  # fmt: skip
    return Made(**most | changes)


def test_every_line_is_said():
    assert (
        "\n".join(lines(score()))
        == """\
mine.csv disagrees with paris (3 rows, t = 0 to 3600 of 86400 s: 4.16 %)
  largest error       0.002 m  (tolerance 5e-07 m; 2e+09 times the input floor of 1e-12 m)
  rms, at the end     0.001 m, 0.0005 m  (grows like t^1.50)
  digits              2.4  (largest error over the amplitude 0.5 m)
  scd, mescd at end   1.0, 0.0  (relative to the truth; to 0.5 m, 0.2 m/s + |truth|)
  worst               y at t = 10 s  (expected 0.25, got 0.252)
  worst of each       x 0.001 m, y 0.002 m, vx 3e-05 m/s
  swing plane, phase  1 degrees, 0.5 s  (fitted)
  drifts              h by 1e-09 m²/s², |r| - l by 2e-09 m
  transits            3 matched (2 shifted), 4 missed, 3 extra  (largest error 0.5 s, weighted by |ax|: 0.05 m)
    missed at         1.000000, 2.000000, 3.000000 … s
    extra at          5.000000, 6.000000, 7.000000 s
    undecided at      42.000000 s  (a motion within the tolerance may or may not have them)
    shifted           8.000000 s by 0.5 s, 24.000000 s by -0.25 s
  took                1.5 CPU s, 2.5 s  (median of 3 after a warm-up)
  inputs read as      binary64  (as asked)
  reference           confirmed  (within 3e-30 m at these times)
It seems that your program leaves out the wind: 0.25 m
With this put right, 1e-09 m are left.
Reading: t is in ms.
Note: late."""
    )


def test_what_a_score_has_not_is_not_said():
    few = Made(**vars(ERRORS) | {"growth_exponent": None, "scd": None, "t": np.array([60.0])})
    shorter = score(
        errors=few, at_bound=True, swing=Made(largest_turn=None, largest_delay=0.5), drifts={}, notes=(),
        transits=TransitErrors(np.array([]), np.array([]), [], [], np.array([])), explanation=Explanation(),
        timing=Made(runs=1, warm=False, cpu_s=1.5, wall_s=2.5),
    )  # fmt: skip
    assert (
        "\n".join(lines(shorter))
        == """\
mine.csv disagrees with paris (1 row, t = 60 to 60 of 86400 s: 4.16 %)
  largest error       0.002 m  (at or below the reference's bound)
  rms, at the end     0.001 m, 0.0005 m
  digits              at least 2.4  (the reference's bound over the amplitude 0.5 m)
  scd, mescd at end   none, 0.0  (relative to the truth; to 0.5 m, 0.2 m/s + |truth|)
  worst               y at t = 10 s  (expected 0.25, got 0.252)
  worst of each       x 0.001 m, y 0.002 m, vx 3e-05 m/s
  transits            0 matched, 0 missed, 0 extra  (largest error 0 s, weighted by |ax|: 0 m)
  took                1.5 CPU s, 2.5 s  (one run, no warm-up)
  inputs read as      binary64  (as asked)
  reference           confirmed  (within 3e-30 m at these times)
No mistake known to foucault explains the error.
Reading: t is in ms."""
    )
    none = list(lines(score(transits=None, timing=None, input_floor_m=0.0, explanation=None)))
    assert not any(line.startswith(("  transits", "  took", "No mistake")) for line in none)
    assert "tolerance 5e-07 m; the inputs are doubles as they stand" in none[1]
    no_delay = list(lines(score(swing=Made(largest_turn=1.0, largest_delay=None))))
    assert not any("swing plane" in line for line in no_delay)


def test_a_model_is_said_with_how_exact_it_is_and_what_it_costs():
    model = Explanation(causes=WIND.causes, model=Model("still", "still air", 1e-9, 0.25))
    said = list(lines(score(explanation=model)))
    assert "As that model it is exact to 1e-09 m; against the full Lagrangian it is 0.25 m off:" in said
    assert not any(line.startswith("As that model") for line in lines(score()))


def test_the_document_says_what_was_measured_and_null_what_was_not():
    errors = Made(**vars(ERRORS) | {"mescd": 0.5})
    measured = {
        "errors": errors, "problem": {}, "transits": None,
        "worst": Worst(10.0, "y", 0.25, 0.252, 0.002), "worst_of_each": {"x": Worst(0.0, "x", 1.0, 2.0, 1.0)},
        "candidate": Made(name="mine.csv", conventions=[Made(id="ms", text="t is in ms")]),
        "explanation": replace(WIND, model=Model("still", "still air", 1e-9, 0.25)),
    }  # fmt: skip
    found = document(score(**measured))
    picked = ("rows", "covered_s", "error_over_floor", "swing_plane_error_deg", "phase_error_s", "h_drift_m2_s2")
    assert [found[key] for key in picked] == [3, [0.0, 3600.0], 2e-3 / 1e-12, 1.0, 0.5, 1e-9]
    assert (found["worst"]["component"], found["worst_of_each"]["x"]["got"]) == ("y", 2.0)
    assert found["model"] == vars(Model("still", "still air", 1e-9, 0.25))
    assert (found["corrected"], found["timing"]["runs"]) == ({"max_error_m": 1e-9}, 3)
    (cause,) = found["causes"]
    assert cause == {"id": "wind", "text": "your program leaves out the wind", "size_m": 0.25} | cause
    assert found["conventions"] == [{"id": "ms", "text": "t is in ms"}]
    none = document(
        score(
            **measured | {"explanation": Explanation(), "timing": None}, input_floor_m=0.0, drifts={},
            swing=Made(largest_turn=None, largest_delay=None), since=Made(text="better", better=True),
        )
    )  # fmt: skip
    unknown = (*picked[2:], "model", "corrected", "slip", "diagnosis", "transits", "length_drift_m")
    assert [none[key] for key in unknown] == [None] * len(unknown)
    assert (none["baseline"], none["causes"], "timing" in none) == ({"text": "better", "better": True}, [], False)


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.0, "0 %"), (0.29, "29 %"), (1.0, "100 %"), (1 - 1.5e-9, "99.9 %"), (1 - 0.5e-9, "100 %"), (0.012345, "1.23 %")],
)
def test_a_share_is_rounded_down_to_three_digits_but_for_rounding_errors(share, said):
    assert percent(share) == said


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, "Since v1: no position changed, 1 → 2 m"),
        ({"changes": ("g came", "h went")}, "Since v1: g came; h went: 1 → 2 m; that explains not all of it"),
        ({"changes": ("g came",), "gains": ("0.5 m less",), "left_m": 0.25},
         "Better since v1: g came: 1 → 2 m; that explains all but 0.25 m; 0.5 m less"),
        ({"changes": ("g came",), "complete": True, "left_m": 0.0}, "Since v1: g came: 1 → 2 m; nothing else"),
        ({"apart_m": 0.5, "worse": ("x grew", "y too")},
         "Worse since v1: 1 → 2 m; what lies between them, 0.5 m, is no known mistake; x grew; y too"),
    ],
)  # fmt: skip
def test_what_changed_since_a_baseline_is_said_in_a_line(changes, said):
    assert Since(**{"name": "v1", "before_m": 1.0, "after_m": 2.0, "apart_m": 0.0} | changes).text == said
    assert list(lines(score(since=Made(text=said))))[1] == f"{said}."
