"""The words of a study's page: captions, and how it was measured."""

from __future__ import annotations

from collections.abc import Sequence

from ..studies.measure import REPEAT_S, REPEATS
from ..studies.row import Row
from .pareto import curves

LEAD = (
    "How exactly, and how fast, integrators solve one Foucault pendulum: every method over its ladder of settings, its "
    "error measured against a reference solution with a bound, its cost in CPU seconds of one core."
)
COSTS = (
    "CPU seconds at which a method reaches an error over the whole span. Between two settings the cost is "
    "interpolated in logarithms, never beyond the ladder; a method that is finer already at its loosest setting has "
    "the cost of that. Bold: the cheapest. ~ rests on a run over a part of the span. Empty: not reached. The methods "
    "stand in the order of their cost at the finest error that they reach."
)
FAMILIES = (
    "The same measurements in small multiples, so that each method can be told from its neighbours; behind each family "
    "all other methods in grey. Methods with more digits than long double stand below, under what digits cost."
)
RIGHT_HAND_SIDES = (
    "Error against evaluations of the right-hand side: the method's work without the machine. Taylor methods have no "
    "such evaluations and are not shown; where only a part of the span was run, its count is scaled to the whole."
)
TOLERANCE = (
    "What comes out for the tolerance that goes in. The tolerance is relative and holds for one step, the error is in "
    "metres and over the whole span; above the dotted line the error in metres is larger than the tolerance."
)
FORMULATIONS = (
    "One method, one system, several formulations of its equations: H = n × (n′ + Ω × n) and n (momentum), "
    "three coordinates (space), w = n × n′ and n (spin), the paper's x and y (plane), "
    "angles (angles), and what is derived from the Lagrangian by machine (lagrangian)."
)
PRECISION = (
    "CPU seconds against digits achieved, in numbers from double to many hundred bits. The broad grey line is the "
    "power law fitted to heyoka_real over the settings whose error is above the reference's own bound."
)
FRONT = "No other row is at once cheaper and more accurate than one of these. Cheapest first."
ROWS = (
    "● and shaded: on the Pareto front. ~ : the cost is extrapolated from a part of the span, the counts and errors "
    "are of that part. Spread: largest minus smallest CPU time of the repeats over their median. Compile: CPU seconds "
    "of imports and compilation, not in the cost."
)
FAILED = "A failed row keeps its place in the tables: nothing is left out, and no failed row is ever on the front."
NO_PICTURES = "The pictures need matplotlib: pip install 'foucault-reference[plot]'."


def overview(rows: Sequence[Row]) -> str:
    """Caption of the picture of all methods, with what it cannot show."""
    caption = (
        "Largest error of position over the grid against CPU seconds; down and to the left is better. The broad grey "
        "staircase is the Pareto front. Faint marks: the cost is extrapolated, the error is of the part that was run. "
        "Crosses along the top: failed runs at their cost. Below, with a scale of its own, what is finer than "
        "methods of fixed precision, and the bound of the reference as a band."
    )
    hidden = [one.label for one in curves(rows) if any(not row.measured and not row.cpu_s for row in one.rows)]
    return f"{caption} Failed without a cost, so not in the picture: {', '.join(hidden)}." if hidden else caption


def measured(limit_s: float | None) -> list[str]:
    """How a study measures, in paragraphs."""
    limit = f"{limit_s:g} CPU seconds" if limit_s else "the limit of a run"
    return [
        "Every method runs in a process of its own and in one thread. The cost is the CPU time of the integration "
        "alone, with output at every time of the grid, in the median of repeats: a run is repeated until "
        f"{REPEAT_S:g} CPU second is spent or it has run {REPEATS} times. Imports and compilation are timed apart. "
        "Before the timed runs a probe over a short span warms up and tells what the whole span will cost; where "
        f"that is beyond {limit}, a part of the span is run, its cost is scaled to the whole, and the row says so. The "
        "errors of such a row are those of the part: over the whole span they may be larger.",
        "All methods get the same numbers: those of the scene, each rounded to the nearest double, and they are scored "
        "against the reference solution of exactly these numbers. So the rounding of the inputs is nobody's error. The "
        "error is the largest distance from the reference over the grid, taken without cancellation in the "
        "method's own number type. Nothing is judged finer than the reference's bound, which the pictures show as "
        "a band.",
        "The error of a transit's time comes from the state at the true time by one Newton step; a transit that is "
        "more than half-way to its neighbour is missed, and fails the row. The drift of h is its largest change, "
        "divided by the largest kinetic energy. Absolute times belong to the machine named above; "
        "ratios hold elsewhere.",
    ]
