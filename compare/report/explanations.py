"""Texts of a study's page: captions of tables and pictures, and how the study was measured."""

from __future__ import annotations

from collections.abc import Sequence

from ..studies.measure import REPEAT_S, REPEATS
from ..studies.row import Row
from .pareto import curves

LEAD = (
    "How accurate and how fast integrators are on one Foucault pendulum: every method at a range of settings, its "
    "error measured against a reference solution with a known bound, its cost in CPU seconds of one core."
)
COSTS = (
    "CPU seconds that a method needs to reach an error over the whole span. Between two settings the cost is "
    "interpolated in logarithms; it is never extrapolated beyond the settings that were run. If even the loosest "
    "setting of a method is more accurate, the cost of that setting is given. Bold: the cheapest method. ~: the cost "
    "is based on a run over a part of the span. Empty: not reached. The methods are sorted by their cost at the "
    "smallest error that they reach."
)
FAMILIES = (
    "The same measurements in one panel for each family, so that each method can be told from its neighbours; all "
    "other methods are drawn in grey behind them. Methods with more digits than long double are shown below, under "
    "“What digits cost”."
)
RIGHT_HAND_SIDES = (
    "Error against evaluations of the right-hand side: the work of a method, whatever the machine. Taylor methods have "
    "no such evaluations and are not shown. Where only a part of the span was run, the count is scaled to the whole "
    "span."
)
TOLERANCE = (
    "The error that a method achieves for the tolerance that it is given. The tolerance is relative and applies to one "
    "step; the error is in metres and over the whole span. Above the dotted line the error in metres is larger than "
    "the tolerance."
)
FORMULATIONS = (
    "One method and one system, with its equations in several formulations: H = n × (n′ + Ω × n) and n (momentum), "
    "three coordinates (space), w = n × n′ and n (spin), the paper's x and y (plane), two angles (angles), and the "
    "equations that the computer derives from the Lagrangian (lagrangian)."
)
PRECISION = (
    "CPU seconds against digits achieved, in numbers from double precision to many hundred bits. A broad grey line is "
    "the power law fitted to those settings of a method whose error is above the bound of the reference."
)
FRONT = "No other row is both cheaper and more accurate than one of these. Cheapest first."
ROWS = (
    "● and shaded: on the Pareto front. ~: the cost is extrapolated from a part of the span; counts and errors are "
    "those of that part. Spread: the difference between the largest and the smallest CPU time of the repeats, divided "
    "by their median. Compile: CPU seconds of imports and compilation, which are not part of the cost. <: the error "
    "of transits is not resolved, because it is measured from the doubles next to their true times; it is below this."
)
ORDERS = (
    "Order: as the method declares it; – where it chooses its order itself. Observed: the power with which its error "
    "falls as it takes more steps (evaluations where it does not tell steps), fitted to at least three settings, with "
    "the standard error of the fit; – where that is above 0.25, because too few settings lie between a step that is "
    "too long and rounding."
)
FAILED = "Failed rows keep their place in the tables: nothing is left out. A failed row is never on the Pareto front."
NO_PICTURES = "The pictures need matplotlib: pip install 'foucault-reference[plot]'."


def overview(rows: Sequence[Row]) -> str:
    """Return the caption of the picture of all methods, with a list of the methods that it cannot show."""
    caption = (
        "Largest error of position over the grid against CPU seconds; down and to the left is better. The broad grey "
        "staircase is the Pareto front. Faint marks: the cost is extrapolated, and the error is that of the part that "
        "was run. Crosses along the top: failed runs, at their cost. Errors below those of the methods of fixed "
        "precision have a panel of their own, with its own scale; the grey band is the bound of the reference."
    )
    hidden = [one.label for one in curves(rows) if any(not row.cpu_s for row in one.rows)]
    return f"{caption} Without a cost, and therefore not in the picture: {', '.join(hidden)}." if hidden else caption


def measured(limit_s: float | None) -> list[str]:
    """Return paragraphs that describe how a study measures."""
    limit = f"{limit_s:g} CPU seconds" if limit_s else "the limit of a run"
    return [
        "Every method runs in a process of its own and in one thread. The cost is the CPU time of the integration "
        "alone, with output at every time of the grid; it is the median of repeated runs. A run is repeated until "
        f"{REPEAT_S:g} CPU second is spent or it has run {REPEATS} times. Imports and compilation are timed apart. "
        "Before the timed runs, a run over a short span warms up the method and shows how much the whole span will "
        f"cost. If that exceeds {limit}, only a part of the span is run and its cost is scaled to the whole; the row "
        "says so. The errors of such a row are those of the part: over the whole span they may be larger.",
        "All methods get the same numbers: those of the scene, each rounded to the nearest double. They are compared "
        "with the reference solution of exactly these numbers, so that the rounding of the inputs does not count as an "
        "error of a method. The error is the largest distance from the reference over the grid, computed without "
        "cancellation in the method's own number type. No error counts as smaller than the bound of the reference, "
        "which the pictures show as a band.",
        "The error of a transit's time is computed from the state at the true time by one Newton step. A transit that "
        "is off by more than half the time to its neighbour counts as missed, and the row fails. The drift of the "
        "invariant h is its largest change, divided by the largest kinetic energy. Absolute times are those of the "
        "machine named above; their ratios hold elsewhere too.",
    ]
