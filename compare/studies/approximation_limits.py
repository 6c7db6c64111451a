"""Where each approximation is good to 1 mm, 1 µm and 1 arcsecond: over time, amplitude, latitude and length."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import groupby

import numpy as np

from reference import FoucaultError, InputError, Scene, parse_scene
from reference.errors import Described
from reference.status import Status

from ..approximations.approximation import Motion
from ..approximations.case import PaperCase
from .approximation_errors import ReferenceMotion, TimeRow
from .row import failure

LIMITS = (
    ("1 mm", "error_m", 1e-3),
    ("1 µm", "error_m", 1e-6),
    ("1 arcsec", "plane_error_arcsec", 1.0),
)
SWEEP_S = 3600.0
_LENGTHS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)  # m, of a sweep
UNITS: dict[str, str] = {"time": "s", "amplitude": "m", "latitude": "degrees", "length": "m"}
_DIGITS = 40  # of a release as it is written into a scene
# Extra times in geometric progression: they locate a limit that is exceeded within the first swing.
_FIRST_S = 1e-3
_EXTRA_TIMES = 400


@dataclass(frozen=True)
class SweepRow(TimeRow):
    """Largest errors up to t in s with one quantity of the scene changed to `value` (unit: `UNITS`)."""

    over: str = field(kw_only=True)
    value: float = field(kw_only=True)


@dataclass(frozen=True)
class LimitRow:
    """Intervals of time in s, or of the varied quantity, in which an approximation is good to a limit; maybe none.

    `status` and `reason` say why it could not be tried anywhere.
    """

    approximation: str
    over: str
    unit: str
    limit: str
    good: tuple[tuple[float, float], ...]
    status: Status = Status.OK
    reason: str = ""


def sweep_values(scene: Scene, over: str) -> Sequence[float]:
    """Return a sweep's values: amplitudes of 1e-5 to 0.1 l, latitudes every 15°, or lengths of 1 to 200 m."""
    if over == "amplitude":
        return [float(v) for v in np.geomspace(1e-5, 0.1, 9) * float(scene.exact.length)]
    if over == "latitude":
        return [float(v) for v in range(-90, 91, 15)]
    return _LENGTHS


def sweep(scene: Scene, chosen: Sequence[Motion], over: str, t: float) -> list[SweepRow]:
    """Return the errors of approximations up to t in s as amplitude, latitude or length of the scene is `varied`."""
    rows = []
    for value in sweep_values(scene, over):
        truth = ReferenceMotion(varied(scene, over, value), t)
        largest = [row for motion in chosen for row in truth.largest(motion, [t])]
        rows += [SweepRow(**vars(row), over=over, value=value) for row in largest]
    return rows


def limits(
    scene: Scene,
    chosen: Sequence[Motion],
    over: str,
    t_end: float,
    swept: dict[str, list[SweepRow]] | None = None,
) -> list[LimitRow]:
    """Find where each approximation is good to 1 mm, 1 µm and 1 arcsecond of swing plane.

    Args:
        scene: to be approximated.
        chosen: the approximations.
        over: `time` up to t_end, or `amplitude`, `latitude`, `length` with all errors up to t_end.
            Between the values of a sweep the logarithm of the error is interpolated.
        t_end: in s.
        swept: where to keep the rows of a sweep, by what is varied; None for nowhere.
    """
    if over == "time":
        return _time_limits(scene, chosen, t_end)
    rows = sweep(scene, chosen, over, t_end)
    limit_rows = []
    if swept is not None:
        swept[over] = rows
    for motion in chosen:
        of_motion = [row for row in rows if row.approximation == motion.id]
        nowhere = all(row.error_m is None for row in of_motion)
        outcome = (of_motion[0].status, of_motion[0].reason) if nowhere else (Status.OK, "")
        for name, quantity, limit in LIMITS:
            errors = [getattr(row, quantity) for row in of_motion]
            good = _below(over, [row.value for row in of_motion], errors, limit)
            limit_rows.append(LimitRow(motion.id, over, UNITS[over], name, good, *outcome))
    return limit_rows


def _time_limits(scene: Scene, chosen: Iterable[Motion], t_end: float) -> list[LimitRow]:
    truth = ReferenceMotion(scene, t_end, np.geomspace(_FIRST_S, t_end, _EXTRA_TIMES))
    rows = []
    for motion in chosen:
        row = partial(LimitRow, motion.id, "time", "s")
        try:
            errors = truth.errors(motion)
        except FoucaultError as error:
            rows += [row(name, (), *failure(error)) for name, _, _ in LIMITS]
            continue
        for name, quantity, limit in LIMITS:
            within = np.logical_and.accumulate(errors[quantity] <= limit)
            last = int(within.sum()) - 1
            good = ((0.0, float(truth.times[last])),) if last > 0 else ()
            rows.append(row(name, good))
    return rows


def _below(
    over: str, values: Sequence[float], errors: Sequence[float | None], limit: float
) -> tuple[tuple[float, float], ...]:
    """Return the intervals of `values` with errors up to the limit.

    Their ends are interpolated in log(error).
    """
    scale, back = (float, float) if over == "latitude" else (np.log, np.exp)
    inside = [error is not None and error <= limit for error in errors]

    def crossing(i: int) -> float:
        """Return the value between values i and i + 1 at which the error equals the limit."""
        a = errors[i]
        b = errors[i + 1]
        if a is None:
            return values[i + 1]
        if b is None:
            return values[i]
        tiny = np.finfo(float).tiny
        log_a = np.log(max(a, tiny))
        log_b = np.log(max(b, tiny))
        fraction = (np.log(limit) - log_a) / (log_b - log_a)
        start = scale(values[i])
        end = scale(values[i + 1])
        return float(back(start + fraction * (end - start)))

    good = []
    for is_good, group in groupby(range(len(values)), inside.__getitem__):
        if not is_good:
            continue
        indices = list(group)
        first = indices[0]
        last = indices[-1]
        low = crossing(first - 1) if first > 0 else values[0]
        high = crossing(last) if last < len(values) - 1 else values[-1]
        good.append((low, high))
    return tuple(good)


def varied(scene: Scene, over: str, value: float) -> Scene:
    """Return the scene with one quantity changed.

    Args:
        scene: to start from.
        over: `latitude`: that field; `length`: of the cord, with the angle of release kept;
            `amplitude`: horizontal distance of the release from the rest position in m, with its
            direction kept, and the velocity of the release in proportion.
        value: its new value.

    Raises:
        InputError: no scene can have the value.
    """
    text = repr(float(value))
    if over == "latitude" or (over == "length" and scene.exact.position is None):
        return scene.with_values({over: text})
    case = PaperCase.of_scene(scene)
    x, y = case.position[:2]
    vx, vy = case.velocity[:2]
    target = case.ctx.mpf(text)
    document = scene.model_dump(exclude_none=True)
    if over == "length":
        document["pendulum"]["length"] = text
        centre_y = 0
        ratio = target / case.length
    else:
        centre_y = case.ctx.mpf(case.rest[1]) * case.length
        amplitude = case.ctx.hypot(x, y - centre_y)
        if not amplitude:
            got = Described(f"x = {scene.release.x}, y = {scene.release.y}")
            raise InputError("release", got, "a release away from the rest position")
        ratio = target / amplitude
    release = {
        "x": x * ratio,
        "y": centre_y + (y - centre_y) * ratio,
        "vx": vx * ratio,
        "vy": vy * ratio,
    }
    document["release"] = {
        name: str(case.ctx.nstr(number, _DIGITS)) for name, number in release.items()
    }
    return parse_scene(document)
