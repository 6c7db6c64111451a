"""The names and sizes of the causes that the best reading of a fit holds, and the model that they make up."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from reference.numbers.precision import Array

from .causes import Cause
from .families import positions_of
from .findings import Model, SizedCause
from .pendulum import Pendulum
from .programs import Program
from .readings import SAME, Reader, Reading
from .rows import Rows, largest

ORDER = ("gravity", "model", "input", "release", "frame", "clock", "integrator")
LOOSE = "has a step error: too loose a tolerance or too large a step (phase and amplitude drift)"
STEP_LIKE = 1e-4  # of a frequency: errors of a step that a program may well have
CLEAN = 1e-3  # of what an integrator does: a named one leaves less
WIDE = 2.0  # times the square of the swing: what the leading error of a step leaves of the whole one
APART = 0.02  # of a step: how far a whole number of them may be from the spacing of the rows
MODELS = {
    "linear": ("linear_g", "is the linear two-dimensional model: its period does not grow with the amplitude"),
    "angle": ("linear_in_angle", "is linear in the angle of the cord: its period does not grow with the amplitude"),
}


def sized(
    best: Reading, reader: Reader, right: Program, pendulum: Pendulum, rows: Rows, truth: Array
) -> Iterator[SizedCause]:
    """Yield the causes in their order, each with the distance by which it moves the bob."""
    changes: list[tuple[str, str, str, object]] = [(cause.stage, cause.id, cause.text, cause) for cause in best.causes]
    kind = reader.right.kind
    if kind != "sphere":
        changes.append(("model", *MODELS[kind], None))
    changes.sort(key=lambda one: ORDER.index(one[0]))
    program, before = right, truth
    for stage, word, text, cause in changes:
        value = shift = uncertainty = None
        sentence = text
        if isinstance(cause, Cause):
            program = cause.change(program)
            if cause.free:
                value = best.value(cause)
                program = program.with_input(cause.free, value)
                shift = value - float(getattr(right, cause.free))
                uncertainty = reader.uncertainty(best, cause)
                sentence = text.format(value=_number(cause, value, right))
        else:
            program = replace(program, kind=kind)
        after = positions_of(program, pendulum, rows)
        yield SizedCause(word, sentence, largest(after - before), stage, value, shift, uncertainty)
        before = after


def in_whole_steps(named: list[SizedCause], spacing: float, share: float) -> Iterator[SizedCause]:
    """Yield the causes, a step that the rows' spacing holds a whole number of times put in place of the fitted one.

    Args:
        named: the causes.
        spacing: of the rows in s.
        share: of the step, within which it is known.
    """
    for cause in named:
        if cause.stage != "integrator" or not cause.value or cause.uncertainty is None:
            yield cause
            continue
        many = round(spacing / cause.value)
        known = share * many
        if many and known < 0.5 and abs(spacing / cause.value - many) <= max(known, APART):
            step = spacing / many
            text = cause.text.replace(f"about {cause.value:.3g} s", f"{step:.3g} s")
            yield replace(cause, value=step, shift=step, text=text)
        else:
            yield replace(cause, uncertainty=max(cause.uncertainty, share * cause.value))


def told_as_loose(named: list[SizedCause], left: float, frequency: float, clean: float = CLEAN) -> Iterator[SizedCause]:
    """Call an integrator by its name only where that leaves next to nothing; else say that its error is like it.

    An integrator with a variable step moves the frequency and the amplitude as no fixed step does: numbers that were
    fitted beside it and do less than it are part of the same error.

    Args:
        named: the causes.
        left: the largest distance in m that they leave.
        frequency: of the swing in rad/s.
        clean: share of what an integrator does that it may leave.
    """
    fitted = {cause.id: cause for cause in named if cause.shift is not None}
    drag = fitted.get("pendulum.drag")
    for word in ("site.gravity", "pendulum.length"):
        other = fitted.get(word)
        if drag is None or other is None or other.shift is None or drag.shift is None or other.value is None:
            continue
        if abs(other.shift) < STEP_LIKE * abs(other.value) and abs(drag.shift) < 0.1 * STEP_LIKE * frequency:
            # frequency and amplitude off together and by this little: no input does that, a step does
            size = drag.size_m + other.size_m
            named = [cause for cause in named if cause not in (drag, other)]
            named.append(SizedCause("integrator_loose", LOOSE, size, "integrator"))
            yield from named
            return
    size = max((cause.size_m for cause in named if cause.stage == "integrator"), default=0.0)
    loose = size > 0 and left > clean * size
    for cause in named:
        if cause.id in ("site.gravity", "pendulum.length") and _like_a_step(cause) and left > CLEAN * cause.size_m:
            if not size:
                yield replace(cause, id="integrator_loose", text=LOOSE, value=None, shift=None, uncertainty=None)
            continue
        if loose and cause.stage == "integrator":
            yield replace(cause, id="integrator_loose", text=LOOSE, value=None, shift=None, uncertainty=None)
        elif not (loose and cause.value is not None and cause.size_m < size):
            yield cause


def _like_a_step(cause: SizedCause) -> bool:
    return cause.value is not None and cause.shift is not None and abs(cause.shift) < STEP_LIKE * abs(cause.value)


def trifling(cause: SizedCause, allowed_m: float) -> bool:
    """Return whether a cause moves nothing that counts: a small step, or the scene's own number but for such a step."""
    if cause.stage == "integrator":
        return cause.size_m <= allowed_m
    if cause.value is None or cause.shift is None:
        return False
    return abs(cause.shift) < SAME * abs(cause.value) and cause.size_m < 10 * allowed_m


def _number(cause: Cause, value: float, right: Program) -> str:
    unit = {"g": " m/s²", "length": " m", "latitude": " degrees", "drag": " 1/s", "step": " s", "x": " m", "y": " m",
            "altitude": " m", "vx": " m/s", "vy": " m/s"}.get(cause.free, "")  # fmt: skip
    if cause.free == "rate":
        return f"{value / right.rate:.8g}"
    if cause.free == "step":
        return f"{value:.3g}{unit}"
    return f"{value:.10g} and not {getattr(right, cause.free):.10g}{unit}"


def model_of(kind: str, named: Sequence[SizedCause], exact: float, costs: float) -> Model | None:
    """Return the model that causes make up; None if one of them is no simplification with a name."""
    words = [cause.id for cause in named]
    if kind != "sphere":
        words = [MODELS[kind][0], *(word for word in words if word != MODELS[kind][0])]
    names = {
        "linear_g": "the linear two-dimensional model", "linear_in_angle": "the model linear in the angle",
        "no_centrifugal": "no centrifugal force (g effective)", "effective_gravity": "g effective",
        "uniform_gravity": "a centrifugal force constant along the swing", "no_tilt": "no horizontal centrifugal force",
        "point_mass": "gravity of a point mass", "sphere": "a spherical Earth", "mean_sphere": "a spherical Earth",
        "turned_plane": "a plane turned by hand", "turned_plane_sign": "a plane turned by hand, the wrong way",
    }  # fmt: skip
    if any(word not in names for word in words) or not words:
        return None
    return Model("+".join(words), ", ".join(names[word] for word in words), exact, costs)
