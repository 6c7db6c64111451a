"""Parts of the atlas's pages: flags, pictures, certified state, certificate, files, inputs, results of methods.

Besides: the numbers and words by which the script of a page judges a file in the browser.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from reference import Golden
from reference.dataset.manifest import FUNCTION
from reference.dataset.render import MEANING
from reference.dataset.sheets import by_field
from reference.numbers.columns import STATE
from reference.numbers.precision import DOUBLE_BITS, Array
from reference.solver.doubles import TOLERANCE
from reference.status import Status

from ...candidates import candidate, clock, header, names, read
from ...candidates import text as text_reader
from ...candidates.candidate import Deviation
from ...diagnosis import AXES_SAID, LENGTHS_SAID, TIMES_SAID
from ...score.clock_start import SUBTRACT
from ...score.errors import swing_rate
from ...score.judge import SMALL
from ...score.time_span import FAR, FINER, SAME
from ...score.transit_matching import unjudged_transits
from ...score.verdict import WHOLE
from ...studies.stability import SWINGS, WRONG, Cell
from ..page import Html, PageTable, facts, text
from .entry import Entry, StudyResults, run_name

# of the proof's THEOREM.md
_THEOREMS = {"radius": "by one radius, Theorem C", "columns": "by six columns, Theorem E"}
_RULE = (
    f"The most accurate runs first, over {SWINGS} small swings at most (docs/studies.md). A run is ok if its error "
    f"is at most {WRONG} times what was asked for. It is silently wrong if it reports success with an error above "
    "that, and above what the motion makes of an error as asked for at the release. Runs that are not ok are coloured."
)
_IMPORTED = {"IO", "UTC"}  # names in capitals that the modules of the vocabulary import


def pictures(svgs: Sequence[str]) -> Html:
    """Return pictures side by side, or below each other on a narrow screen."""
    return Html('<div class="pictures">\n' + "".join(svgs) + "</div>")


def flags(entry: Entry) -> Html:
    """Return why a scene is difficult: each flag with its sentence."""
    notes = entry.golden.manifest.notes
    items = "".join(
        f"<li><b>{text(flag.replace('_', ' '))}</b>: {text(notes[flag])}</li>"
        for flag in entry.flags
    )
    if not items:
        return Html("")
    return Html(f'<ul class="flags">{items}</ul>')


def state(golden: Golden) -> Html:
    """Return the state at the end, as printed, with the bound of each number."""
    bounds = golden.manifest.bounds.grid
    rows = []
    for name in STATE:
        digits = Html(f'<span class="digits">{golden.decimals(name)[-1]}</span>')
        unit = "m/s" if name.startswith("v") else "m"
        rows.append((name, digits, unit, bounds[name]))
    heading = f"state at t = {golden.t[-1]:.15g} s"
    return PageTable({"": "", heading: "value", "in": "", "within": "number"}, rows).html()


def certificate(golden: Golden) -> Mapping[str, str]:
    """Return bound, level, the evidence for it, and the transits, by name."""
    manifest = golden.manifest
    bounds = manifest.bounds
    evidence = [MEANING[manifest.level]]
    if manifest.enclosure is not None:
        proof = manifest.enclosure
        theorem = _THEOREMS.get(proof.method, proof.method)
        evidence.append(
            f"Before rounding every position is known to {proof.position_radius_m} m ({theorem}); "
            f"the run agrees with it to {proof.agreement_bits} bits."
        )
    evidence += [
        f"A run in {check.number}, formulation {check.formulation}, differs by {check.position_m} m at most."
        for check in manifest.cross_checks
    ]
    count = manifest.counts.transits
    if count:
        transits = f"{count} ({manifest.transits})"
        if bounds.transit_s:
            transits += f", each within {bounds.transit_s} s"
    else:
        transits = f"none: {manifest.transits}".removesuffix(": complete")
    return {
        "inputs": f"read as {manifest.inputs}",
        "level": f"{manifest.level}, {manifest.digits} digits",
        "behind it": " ".join(evidence),
        "bounds": f"positions {bounds.position_m} m, velocities {bounds.velocity_m_s} m/s",
        "rows": f"{manifest.counts.grid} golden times",
        "transits": transits,
        "made by": manifest.command,
        "seal": manifest.seal,
    }


def dataset(golden: Golden, base: str) -> Html:
    """Return the description of a dataset: its certificate, and its files with sizes and hashes."""
    rows = [
        (linked(golden, name, base), f"{record.bytes:,}", record.sha256)
        for name, record in golden.manifest.files.items()
    ]
    files = PageTable({"file": "", "bytes": "number", "sha256": "digest"}, rows)
    return Html(f"{facts(certificate(golden))}\n{files.html()}")


def linked(golden: Golden, name: str, base: str) -> Html:
    """Return the name of a file, linked to its location if that is known."""
    target = f"{base.rstrip('/')}/{golden.manifest.id}/{name}"
    return Html(f'<a href="{text(target)}">{text(name)}</a>') if base else text(name)


def inputs(golden: Golden) -> Html:
    """Return the scene's inputs as in the manifest."""
    return facts(
        by_field({name: table for name, table in golden.manifest.scene.items() if name != "run"})
    )


def methods(studied: StudyResults) -> list[Html]:
    """Return tables of the results of methods, from the studies that are kept: none, one or two."""
    parts = []
    if studied.same_digits:
        parts.append(_same_digits(studied.same_digits))
    if studied.least:
        runs = [(run_name(row), f"{row.error_m:.2g} m", _cpu(row.cpu_s)) for row in studied.least]
        least = PageTable({"method": "", "least error": "number", "its CPU s": "number"}, runs)
        caption = f"Of all settings of a method that were run over {studied.span_s:g} s, the most accurate"
        parts.append(least.html(caption))
    return parts


def _same_digits(cells: Mapping[str, Cell]) -> Html:
    """Return a table of runs that were asked for digits, the most accurate first, and the rule that judges them."""
    columns = {"method": "", "outcome": ""}
    columns |= dict.fromkeys(("asked for", "digits kept", "CPU s"), "number")

    def digits(name: str) -> float:
        kept = cells[name].digits
        return -1.0 if kept is None else kept

    rows = []
    row_classes = []
    for name in sorted(cells, key=digits, reverse=True):
        cell = cells[name]
        numbers = (_tenths(cell.asked), _tenths(cell.digits), _cpu(cell.cpu_s))
        rows.append((name, cell.status.words, *numbers))
        row_classes.append("" if cell.status is Status.OK else "failed")
    return PageTable(columns, rows, row_classes).html(_RULE)


def _tenths(digits: float | None) -> str:
    """Return digits with one decimal, at least 0; empty for None."""
    return "" if digits is None else f"{max(digits, 0.0):.1f}"


def _cpu(seconds: float | None) -> str:
    """Return CPU seconds with two significant digits; empty for None."""
    return "" if seconds is None else f"{seconds:.2g}"


def golden_function(golden: Golden) -> dict[str, Any] | None:
    """Return what `evaluator` in docs/readers/function.mjs needs of the golden function.

    None if there is none.
    """
    if golden.function is None:
        return None
    record, numbers = (golden.path.joinpath(name).read_bytes() for name in FUNCTION)
    return {
        "record": json.loads(record),
        "coefficients": base64.b64encode(numbers).decode(),
        "end": float(golden.function.times[-1]),
    }


def page_data(
    golden: Golden, function: dict[str, Any] | None = None, beside: str | None = None
) -> dict[str, Any]:
    """Return what `judging.js` needs of a dataset: grid and transits in base64, bounds, vocabulary.

    Each transit has a weight |ax|/ω in m/s, which turns an error of time into one of position. The
    golden function is `function`, or in a file `beside` the page.
    """
    inputs = golden.scene.exact
    length = float(inputs.length)
    velocities = (golden.vx, golden.vy, golden.vz)
    fastest = float(np.linalg.norm(velocities, axis=0).max())
    omega = swing_rate(golden.scene, fastest)
    reason = unjudged_transits(golden)
    transits = golden.transits
    weight = np.abs(transits["ax"]) / omega if omega else np.zeros(len(transits))
    return {
        "id": golden.manifest.id,
        "t_end": float(inputs.t_end),
        "grid_step": float(inputs.grid_step),
        "length_m": length,
        "amplitude_m": float(np.hypot(golden.x, golden.y).max()) or length,
        "bound_m": float(golden.manifest.bounds.position_m) + length * 2.0**-DOUBLE_BITS,
        "omega": omega,
        "grid": {name: _doubles(golden.grid[name]) for name in ("t", *STATE)},
        "transits": None if reason else {"t": _doubles(transits["t"]), "weight": _doubles(weight)},
        "no_transits": reason,
        "possible": [[float(span.from_s), float(span.to_s)] for span in golden.manifest.possible],
        "function": function,
        "beside": beside,
        "words": vocabulary(),
    }


def vocabulary() -> dict[str, Any]:
    """Return the tables, patterns and limits that the page's scripts share with the package."""
    tables: dict[str, Any] = {}
    for module in (names, text_reader, header, clock, read, candidate):
        for name, value in vars(module).items():
            if name.isupper() and not name.startswith("_") and name not in _IMPORTED:
                tables[name] = value
    sentences = {"LENGTHS_SAID": LENGTHS_SAID, "TIMES_SAID": TIMES_SAID}
    limits = {
        "TOLERANCE": TOLERANCE,
        "SUBTRACT": SUBTRACT,
        "FINER": FINER,
        "FAR": FAR,
        "SAME": SAME,
        "SMALL": SMALL,
    }
    axes = [[*order, *signs, text] for (order, signs), (_, text) in AXES_SAID.items()]
    return tables | sentences | limits | {"WHOLE": WHOLE, "AXES_SAID": axes}


def plain(value: object) -> Any:
    """Return a set, pattern, fraction or deviation as `json.dumps` can write it.

    Raises:
        TypeError: it is none of these.
    """
    if isinstance(value, Fraction):
        return [value.numerator, value.denominator]
    if isinstance(value, set | frozenset):
        return sorted(value)
    if isinstance(value, re.Pattern):
        return value.pattern
    if isinstance(value, Deviation):
        return value.text
    raise TypeError(f"{value!r} cannot be written as JSON")


def _doubles(values: Array) -> str:
    """Return doubles, least significant byte first, in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()
