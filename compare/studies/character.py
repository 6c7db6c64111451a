"""The difficulty of a scene, measured on the true trajectory, and the likely reason why a method failed on it.

Rates are eigenvalues of the equations' Jacobian on the tangent space of the sphere: the four that
belong to the motion, without those that a formulation adds off the sphere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from reference import Scene, UnreachableError
from reference.model.constants import Constants, constants_in_double
from reference.model.force import tension
from reference.model.formulations import FORMULATIONS
from reference.numbers.precision import Array
from reference.solver.sensitivity import Sensitivity, digits_lost
from reference.status import Status

from .row import Row
from .users_program import NUMBER

# rate times step up to which an explicit method of order 5 to 8 is stable, about
_EXPLICIT_REACH = 3.3
_SAMPLES = 64  # states of the trajectory at which rates are measured
_IN_DOUBLE = 1e6  # what is magnified no more than this is followed in double
_NUDGE = 1e-6  # relative displacement of the central differences


@dataclass(frozen=True)
class Character:
    """The difficulty of a scene.

    Attributes:
        fastest: largest size of a rate along the trajectory, 1/s.
        damping: largest rate of decay, 1/s.
        ratio: largest over smallest size of the rates that are not zero.
        magnified: largest factor by which the flow amplifies a displacement at the release.
        least_tension: least tension of the cord per mass and length, 1/s²; below zero a rod is
            pushed.
        nearest: least distance from the vertical through the suspension, over the length.
        amplitude: largest distance from it, over the length.
        span: t_end in s.
    """

    fastest: float
    damping: float
    ratio: float
    magnified: float
    least_tension: float
    nearest: float
    amplitude: float
    span: float

    @property
    def stiff(self) -> bool:
        """True if decay limits the step of an explicit method although the motion is slow."""
        return self.damping * self.span > 1e3 and self.ratio > 1e3

    @property
    def digits_lost(self) -> float:
        """Decimal digits of the input that error amplification costs between release and end."""
        return max(0.0, math.log10(self.magnified)) if self.magnified > 0 else 0.0


def character(scene: Scene, times: Array, states: Array) -> Character:
    """Measure how hard a scene is.

    Args:
        scene: for its constants.
        times: increasing, from 0, in s.
        states: the true x, y, z, vx, vy, vz in m and m/s at these times, shape (times, 6).
    """
    k = constants_in_double(scene.exact)
    length = float(k.length)
    chosen = np.unique(np.linspace(0, len(times) - 1, _SAMPLES).astype(int))
    scaled = states / length
    rates = np.array([np.linalg.eigvals(_tangent_jacobian(state, k)) for state in scaled[chosen]])
    sizes = np.abs(rates)
    largest = np.maximum(sizes.max(axis=1, keepdims=True), 1e-300)  # at each state
    least = np.where(sizes > 1e-12 * largest, sizes, largest)  # without the rates that are zero
    columns = tuple(scaled[chosen].T)
    aside = np.hypot(scaled[:, 0], scaled[:, 1])
    return Character(
        fastest=float(sizes.max()),
        damping=max(0.0, float(-rates.real.min())),
        ratio=float((largest / least).max()),
        magnified=_magnified(scene, times[chosen], length),
        least_tension=float(tension(columns[:3], columns[3:], k).min()),
        nearest=float(aside.min()),
        amplitude=float(aside.max()),
        span=float(times[-1]),
    )


def _tangent_jacobian(state: Array, k: Constants) -> Array:
    """Return the 4 by 4 Jacobian of n'' = F - n (v·v + n·F) on the tangent space of |n| = 1, n·v = 0."""
    model = FORMULATIONS["space"]
    n = state[:3]
    v = state[3:]
    fastest = max(1.0, float(np.abs(v).max()))
    size = np.array([1.0] * 3 + [fastest] * 3)
    nudges = np.diag(_NUDGE * size)  # a column for each displacement

    def rates(displacements: Array) -> Array:
        displaced = tuple(state[:, None] + displacements)
        return np.array(model.derivatives(displaced, k, math))

    ahead = rates(nudges)
    behind = rates(-nudges)
    jacobian = (ahead - behind) / (2 * _NUDGE * size)
    normals = np.array([np.concatenate([n, np.zeros(3)]), np.concatenate([v, n])])
    _, _, basis = np.linalg.svd(normals * size)  # positions and rates in comparable units
    tangent = basis[2:].T
    return np.asarray(tangent.T @ (jacobian * size / size[:, None]) @ tangent)


def _magnified(scene: Scene, times: Array, length: float) -> float:
    """Return the largest response of the position to a displacement of the release, by the variational equations.

    They follow a trajectory in double, which leaves the true one where little more than its errors
    is left; then runs from neighbouring releases are compared in as many bits as that takes, and a
    relative change counts.
    """
    response = Sensitivity(scene, times)
    factors = [1.0]
    of_release = {"release.x", "release.y", "release.angle", "release.azimuth"}
    for name in scene.exact.by_name.keys() & of_release:
        displacement = response.derivative(name)[:, :3]
        sizes = np.linalg.norm(displacement, axis=1)
        at_release = 1.0 if name in ("release.x", "release.y") else float(sizes[0])
        if at_release > 1e-12 * length:
            factors.append(float(sizes.max()) / at_release)
    if max(factors) <= _IN_DOUBLE:
        return max(factors)
    try:
        digits = digits_lost(scene.exact, tuple(scene.exact.grid), constants=False)
    except UnreachableError:
        return math.inf
    return max(*factors, 10**digits)


def reason_of(
    row: Row,
    status: Status,
    traits: Character,
    digits: float | None,
    requested: float,
    limit_s: float,
) -> str:
    """Return the causes that the numbers suggest, the strongest first.

    Empty if the run is right.
    """
    if status == Status.OK:
        return ""
    if status in (Status.NOT_INSTALLED, Status.REFUSED):
        return row.reason
    causes = list(_causes(row, status, traits))
    possible = list(_possible_causes(traits)) if row.formulation == NUMBER else []
    reported = (
        f" It reported: {row.reason.rstrip('.')}."
        if row.reason and status != Status.OUT_OF_TIME
        else ""
    )
    if status == Status.OUT_OF_TIME:
        cost = (
            f"the whole span would take about {row.cpu_s:.2g} s; the limit is {limit_s:g} s"
            if row.cpu_s
            else ""
        )
        return _sentence([cost or row.reason, *causes, *possible])
    if status == Status.ILL_CONDITIONED and digits is not None:
        magnified = f"the flow magnifies an error at the release {traits.magnified:.1g} times"
        return _sentence(
            [
                magnified,
                f"the result is off by {10 ** (requested - digits):.1g} times what was asked for",
            ]
        )
    if status == Status.SILENTLY_WRONG and digits is not None:
        head = f"success was reported with {digits:.1f} digits where {requested:.1f} were asked for"
        return _sentence([head, *(causes or [_accumulated(row)]), *possible])
    unexplained = "no measured property of the scene explains it"
    return _sentence([*causes, *possible] or [unexplained]) + reported


def _causes(row: Row, status: Status, traits: Character) -> Iterator[str]:
    if traits.stiff:
        steps = traits.damping * traits.span / _EXPLICIT_REACH
        text = f"stiff: rates up to {traits.damping:.2g}/s, a factor of {traits.ratio:.1g} apart"
        yield f"{text}, so that a method whose step is bound by the fastest rate needs about {steps:.1g} steps"
    for difficulty in _difficulties(traits):
        if row.formulation in difficulty.formulations:
            yield difficulty.text
    if status != Status.OUT_OF_TIME and traits.magnified > 1e3:
        yield f"the flow amplifies an error at the release {traits.magnified:.1g} times"
    if status == Status.SILENTLY_WRONG and 0 < traits.amplitude < 1e-5 and row.kind != "precision":
        cancelled = f"cancellation against z ≈ −l costs {-math.log10(traits.amplitude):.0f} digits"
        yield f"the amplitude is {traits.amplitude:.1g} of the length: {cancelled}"


@dataclass(frozen=True)
class _Difficulty:
    """A property of the motion that is hard for certain variables.

    Attributes:
        formulations: those with these variables.
        variables: the variables in words.
        text: the property, and what follows from it.
    """

    formulations: tuple[str, ...]
    variables: str
    text: str


def _difficulties(traits: Character) -> Iterator[_Difficulty]:
    """Yield what is hard for some variables on this trajectory."""
    if traits.least_tension < 0:
        tension_words = f"least tension {traits.least_tension:.2g}/s²"
        yield _Difficulty(
            ("space",),
            "x, y, z and their rates",
            f"the rod is pushed ({tension_words}): |r| - l grows exponentially",
        )
    if traits.amplitude > 0.99:
        yield _Difficulty(
            ("plane",),
            "x and y alone",
            "the path reaches the height of the suspension, where x and y do not determine the state",
        )
    if traits.nearest < 1e-3:
        yield _Difficulty(
            ("angles", "lagrangian"),
            "angles of the cord",
            f"the path passes the vertical within {traits.nearest:.1g} of the length, where the azimuth jumps",
        )


def _possible_causes(traits: Character) -> Iterator[str]:
    """Yield what is hard for a program, whose variables are not known."""
    for difficulty in _difficulties(traits):
        yield f"if it integrates {difficulty.variables}: {difficulty.text}"


def _accumulated(row: Row) -> str:
    steps = f"{row.steps} steps" if row.steps else "its steps"
    drift = f"; h drifts by {row.h_drift:.1g} of the kinetic energy" if row.h_drift else ""
    return f"the local errors of {steps} add up{drift}"


def _sentence(parts: list[str]) -> str:
    text = "; ".join(part.rstrip(".") for part in parts if part)
    return text[:1].upper() + text[1:] + "." if text else ""
