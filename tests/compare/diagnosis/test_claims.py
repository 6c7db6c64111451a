"""The tests of a claim, each by a file that fails it: what is certain, what is one of several, what is not said."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mistakes import told

from compare.diagnosis.claims import Alternative, one_of
from compare.diagnosis.hypotheses import Claim, has_few_digits
from compare.diagnosis.thresholds import FACTOR_DIGITS
from reference import Scene, load_scene, trajectory

TIMES = np.linspace(0, 600, 301)
ALLOWED_M = 5e-7


def paris(*settings: str) -> Scene:
    return load_scene(
        "paris", ["run.t_end=700", "run.transits=false", "inputs=binary64", *settings]
    )


def explained(positions: np.ndarray, times: np.ndarray = TIMES, scene: Scene | None = None) -> Any:
    """Return what is told of x and y in m, shape (rows, 2)."""
    columns = {"x": positions[:, 0].copy(), "y": positions[:, 1].copy()}
    return told(scene or paris(), times, columns, ALLOWED_M)


def rows(*settings: str, times: np.ndarray = TIMES) -> np.ndarray:
    """Return x and y of a program with other inputs in m."""
    return trajectory(paris(*settings), times)[:, :2]


def stages(found: Any) -> dict[str, str]:
    return {cause.id: cause.stage for cause in found.explanation.causes}


@pytest.mark.parametrize(
    ("value", "doubt", "few"),
    [
        (9.81, 1e-6, True),
        (9.80665, 1e-9, True),
        (9.804688964, 1e-9, False),  # ten digits
        (9.80468896, 1e-13, False),  # nine digits, and no accident
        (9.8046889, 1e-7, False),  # an eighth digit, by chance at odds of one in five
        (9.81, 1e-3, False),  # any number is as near to a decimal of three digits
        (1e-9, 1e-8, True),  # zero
    ],
)
def test_few_digits(value: float, doubt: float, few: bool) -> None:
    assert has_few_digits(value, doubt) is few


def test_a_factor_that_people_type_has_fewer_digits() -> None:
    assert has_few_digits(1.5, 1e-9, FACTOR_DIGITS)
    assert not has_few_digits(1.00012, 1e-9, FACTOR_DIGITS)


def test_what_rounding_leaves_is_explained() -> None:
    """A mistake that is seventeen times as large as the rounding of x and y, five decimals each."""
    found = explained(rows("site.rotation_rate=7.29e-5").round(5))
    assert stages(found) == {"rounded_rate": "input"}


def test_rounding_is_no_error() -> None:
    """Rows with six decimals, and a mistake that moves them by less than their rounding."""
    found = explained(rows("site.latitude=48.84612").round(6))
    assert found.agrees or stages(found) == {}


def test_few_digits_are_certain_and_many_are_one_of_several() -> None:
    assert stages(explained(rows("site.gravity=9.81"))) == {"gravity_9.81": "input"}
    assert stages(explained(rows("site.gravity=9.8071"))) == {"site.gravity": "input"}
    assert stages(explained(rows("site.gravity=9.807123"))) == {"site.gravity": "input"}
    (either,) = explained(rows("site.gravity=9.80712345678")).explanation.causes
    assert either.stage == "either" and {"site.gravity", "integrator_loose"} <= {
        *either.id.split("|")
    }
    assert either.text.startswith("either takes site.gravity to be 9.807123")


def test_rivals_are_told_beside_each_other() -> None:
    """A plane of small swings, not of the sphere: Ω of the other sign, or of the other hemisphere."""
    scene = paris("site.gravity_is=effective")
    beta = 7.292115e-5 * math.sin(math.radians(48.846111))
    swing = math.sqrt(9.80665 / 67 + beta * beta)
    start = 0.3 + 0.4j
    turned = np.cos(swing * TIMES) - 1j * beta / swing * np.sin(swing * TIMES)
    plane = start * np.exp(1j * beta * TIMES) * turned
    found = explained(np.column_stack([plane.real, plane.imag]), scene=scene)
    (either,) = [cause for cause in found.explanation.causes if cause.stage == "either"]
    assert {"coriolis_sign", "hemisphere"} <= {*either.id.split("|")}
    assert len(either.id.split("|")) <= 3


def test_what_does_not_predict_is_not_certain() -> None:
    """A g for the first rows and another one, seven digits the same, for the last."""
    first, last = rows("site.gravity=9.8071"), rows("site.gravity=9.80711")
    mixed = np.where((TIMES < 400)[:, None], first, last)
    assert explained(mixed).words == set()


def test_of_few_rows_nothing_fitted_is_certain() -> None:
    times = np.array([0.0, 9.0, 18.0])  # longer than a swing
    found = explained(rows("site.gravity=9.8123", times=times), times)
    assert "site.gravity" not in found.words


@pytest.mark.parametrize("setting", ["site.gravity=9.81", "release.x=0.6"])
def test_a_swing_too_fast_for_other_models_to_be_run_is_not_certain(setting: str) -> None:
    """Times in minutes, rows half a swing apart: they fit a swing 60 times as fast, or nearly, in a linear model."""
    times = np.arange(0, 1700, 8.5)
    long = "run.t_end=2000"
    found = explained(rows(long, setting, times=times), times / 60, paris(long))
    assert found.explanation.causes
    assert found.words == set()


def test_what_is_hardly_needed_is_not_certain() -> None:
    """A latitude whose effect is a few times that of a smooth error of another origin."""
    wave = 2e-6 * np.sin(0.05 * TIMES) * (TIMES / 600) ** 2
    found = explained(rows("site.latitude=48.85") + np.column_stack([wave, -wave]))
    assert "site.latitude" not in found.words


def test_a_number_that_may_be_the_scene_s_own_is_not_certain() -> None:
    """A latitude of many digits that moves the bob by little more than the tolerance, and on average by less."""
    found = explained(rows("site.latitude=48.80024681357"), scene=paris("site.latitude=48.8"))
    assert not found.agrees
    assert "site.latitude" not in found.words


def test_a_model_that_moves_the_bob_by_less_than_the_tolerance_is_not_told() -> None:
    """A linear model of a swing of 0.1 mrad: the solar day is wrong, and the model makes no difference."""
    scene = paris("site.gravity_is=effective", "release.x=0.006", "release.y=0.008")
    beta = 2 * math.pi / 86400 * math.sin(math.radians(48.846111))
    omega = math.sqrt(9.80665 / 67 + beta**2)
    swing = np.cos(omega * TIMES) + 1j * beta / omega * np.sin(omega * TIMES)
    plane = (0.006 + 0.008j) * swing * np.exp(-1j * beta * TIMES)
    columns = {"x": plane.real.copy(), "y": plane.imag.copy()}
    found = told(scene, TIMES, columns, 1e-8)
    assert stages(found) == {"no_centrifugal": "gravity", "solar_day": "input"}


def irregular(size_m: float) -> np.ndarray:
    """Return errors of x and y in m that no motion makes, shape (rows, 2)."""
    row = np.arange(len(TIMES))
    errors = size_m * np.column_stack([np.sin(1.7 * row * row), np.cos(2.3 * row * row)])
    errors[0] = 0.0
    return np.asarray(errors)


@pytest.mark.parametrize(
    ("size_m", "gravity"), [(1e-7, "9.8066507123456"), (3e-7, "9.8066511123456")]
)
def test_a_step_error_is_not_certain_where_one_number_does_as_well(
    size_m: float, gravity: str
) -> None:
    """A g of many digits beside an error within the tolerance."""
    found = explained(rows(f"site.gravity={gravity}") + irregular(size_m))
    (either,) = found.explanation.causes
    assert either.stage == "either"
    assert {"site.gravity", "integrator_loose"} <= {*either.id.split("|")}


def test_an_either_without_which_little_more_is_left_is_not_certain() -> None:
    """A g of many digits whose effect is seven times that of an error within the tolerance."""
    found = explained(rows("site.gravity=9.8066507123456") + irregular(3e-7))
    assert [cause.stage for cause in found.explanation.causes] == ["as_if"]


def test_beside_an_arbitrary_number_no_either_is_certain() -> None:
    """Velocity Verlet with both accelerations of the old velocity: a push at the release makes up for most of it."""
    step, square, coriolis = 0.27 / 21, 9.81 / 20, 0.01 * math.sqrt(3)
    place, velocity = 0.2 + 0j, 0j
    printed = []
    for count in range(220 * 21):
        if count % 21 == 0:
            printed.append((place.real, place.imag))
        old = -square * place - 1j * coriolis * velocity
        place += step * velocity + step**2 / 2 * old
        new = -square * place - 1j * coriolis * velocity
        velocity += step / 2 * (old + new)
    fields = [
        "pendulum.length=20",
        "site.latitude=60",
        "site.rotation_rate=0.01",
        "site.gravity=9.81",
    ]
    scene = paris(*fields, "site.gravity_is=effective", "release.x=0.2", "release.y=0")
    found = explained(np.array(printed), 0.27 * np.arange(220), scene)
    assert "as_if.release.vx" in stages(found)
    assert not any("site.latitude" in word for word in stages(found))


def test_beside_an_arbitrary_number_a_factor_is_not_certain() -> None:
    """Semi-implicit Euler whose velocity loses a part of 10,000 each step, and so the push of the Coriolis force."""
    step, square, coriolis = 0.86 / 73, 9.8 / 67, 0.02 * math.sin(math.pi / 4)
    place, velocity = 0.335 + 0.268j, 0j
    printed = []
    for count in range(524 * 73):
        if count % 73 == 0:
            printed.append((place.real, place.imag))
        velocity += step * (-square * place - 1j * coriolis * velocity)
        place += step * velocity
        velocity *= 0.9999
    fields = ["site.latitude=45", "site.rotation_rate=0.01", "site.gravity=9.8", "release.x=0.335"]
    scene = paris(*fields, "site.gravity_is=effective", "release.y=0.268")
    found = explained(np.array(printed), 0.86 * np.arange(524), scene)
    assert {"linear_g", "integrator_semi_implicit_euler"} <= found.words
    assert "site.rotation_rate" not in found.words


def test_a_map_of_a_column_that_is_hardly_needed_is_not_certain() -> None:
    """A y that is too large by 4e-6 of itself, beside an error within the tolerance."""
    right = rows()
    found = explained(right * [1.0, 1 + 4e-6] + irregular(4e-7))
    assert stages(found) == {"as_if.column_scaled": "as_if"}


def test_axes_that_the_first_row_alone_shows_are_not_certain() -> None:
    """x and y under each other's names, and an unknown error as large as the difference that this makes."""
    wave = 0.15 * np.sin(0.05 * TIMES)
    found = explained(rows()[:, ::-1] + np.column_stack([wave, -wave]))
    assert found.words == set()


class ParabolaOfAWave(Claim):
    """The claim that a parabola made three quarters of a wave: it meets them all, and not the last from the first."""

    free_numbers = 3

    def foreseen(self, count: int) -> np.ndarray:
        times = self.case.rows.times
        wave = np.sin(1.5 * math.pi * times)
        fitted = np.polynomial.Polynomial.fit(times[:count], wave[:count], 2)
        return np.asarray(wave - fitted(times))[:, None]


def test_numbers_that_do_not_predict_are_not_sound() -> None:
    times = np.linspace(0, 1, 90)
    case: Any = SimpleNamespace(rows=SimpleNamespace(times=times), resolution=1e-9, frequency=7.0)
    claim = ParabolaOfAWave(case, np.zeros((90, 1)))
    claim = ParabolaOfAWave(case, claim.foreseen(90))
    assert claim.enough_rows() and not claim.predicts() and not claim.is_sound


def test_normal_gravity_is_recognised() -> None:
    found = explained(rows("site.gravity=9.80967161366882"))
    assert stages(found) == {"gravity_normal": "input"}


@pytest.mark.parametrize(
    ("words", "end"),
    [
        (("site.latitude", "site.rotation_rate"), ", or both"),
        (("site.gravity", "pendulum.length", "integrator_loose"), ", or several of these"),
        (("hemisphere", "coriolis_sign"), "or has a wrong coriolis_sign"),
    ],
)
def test_of_numbers_that_act_together_each_may_be_wrong_or_both(
    words: tuple[str, ...], end: str
) -> None:
    alternatives = [Alternative(word, f"has a wrong {word}") for word in words]
    assert one_of(alternatives, 1.0).text.endswith(end)


def test_of_a_turn_alone_no_latitude_is_claimed() -> None:
    """A day of 86400 s and a latitude of many digits: Ω sin φ is known, and neither of both."""
    scene = paris("site.gravity_is=effective")
    fields = ["site.gravity_is=effective", "site.rotation_rate=7.27220521664304e-5"]
    found = explained(rows(*fields, "site.latitude=48.4861123456"), scene=scene)
    assert "site.latitude" not in found.words


def test_a_change_explains_what_lies_between_the_versions() -> None:
    from compare.diagnosis import Version, explain_change

    def version(size_m: float, left_m: float) -> Version:
        cause = {
            "id": "solar_day",
            "text": "your program turns the Earth once in a day",
            "size_m": size_m,
        }
        causes = [cause] if size_m else []
        document = {
            "conventions": [],
            "causes": causes,
            "slip": None,
            "corrected": {"max_error_m": left_m},
        }
        return Version(document, size_m + left_m)

    old, new = version(0.0, 1e-6), version(1e-3, 2e-4)
    assert explain_change(old, version(1e-3, 1e-5), 1e-3, math.inf)[0] != ()
    assert explain_change(old, new, 1e-3, math.inf) == ((), None)


def test_a_step_that_errs_about_as_much_is_the_same() -> None:
    from compare.diagnosis import Version, explain_change

    def version(size_m: float) -> Version:
        text = "your program has a step error"
        cause = {"id": "integrator_loose", "text": text, "size_m": size_m, "value": None}
        document = {
            "conventions": [],
            "causes": [cause],
            "slip": None,
            "corrected": {"max_error_m": 0.0},
        }
        return Version(document, size_m)

    assert explain_change(version(1e-3), version(1.8e-3), 1e-3, math.inf)[0] == ()
    (change,) = explain_change(version(1e-3), version(2.2e-3), 1e-3, math.inf)[0]
    assert change.startswith("the step")


def test_a_change_between_named_steps_is_not_compared_by_size() -> None:
    from compare.diagnosis import Version, explain_change

    def version(method: str, value: float | None) -> Version:
        text = f"your program integrates with {method} at a step of 0.05 s"
        cause = {"id": f"integrator_{method}", "text": text, "size_m": 1e-3, "value": value}
        document = {
            "conventions": [],
            "causes": [cause],
            "slip": None,
            "corrected": {"max_error_m": 0.0},
        }
        return Version(document, 1e-3)

    for value in (0.05, None):
        old, new = version("leapfrog", value), version("rk2", value)
        (change,) = explain_change(old, new, 1e-3, math.inf)[0]
        assert change == "the step (it now integrates with rk2 at a step of 0.05 s)"
        assert explain_change(old, old, 1e-3, math.inf)[0] == ()


def test_a_change_that_the_old_file_may_not_tell_is_left_out() -> None:
    """A file that does not tell whether the change along the swing is there has the shorter sentence on g."""
    from compare.diagnosis import Version, explain_change

    effective = {"id": "effective_gravity", "text": "your program takes g as effective"}
    without_change = {"id": "no_centrifugal", "text": "your program takes g as effective, and more"}
    other_g = {"id": "gravity_9.8", "text": "your program computes with g = 9.8 m/s²"}

    def version(*causes: dict[str, str]) -> Version:
        sized = [cause | {"size_m": 1e-3} for cause in causes]
        document = {
            "conventions": [],
            "causes": sized,
            "slip": None,
            "corrected": {"max_error_m": 0.0},
        }
        return Version(document, 1e-3)

    changes = explain_change(version(effective), version(without_change), 1e-3, math.inf)
    assert changes == (("it now more",), 0.0)
    changes = explain_change(version(effective), version(without_change, other_g), 1e-3, math.inf)
    assert changes == (("it now computes with g = 9.8 m/s²",), None)


def test_a_change_is_no_known_mistake_if_nothing_is_known() -> None:
    from compare.diagnosis import Version, unexplained

    def version(cause_id: str) -> Version:
        cause = {"id": cause_id, "text": f"your program has {cause_id}", "size_m": 1e-3}
        causes = [cause] if cause_id else []
        return Version({"conventions": [], "causes": causes, "slip": None, "corrected": None}, 1e-3)

    assert unexplained(version(""), version("")) == "is explained by nothing that was tried"
    assert unexplained(version("a"), version("a")) == "is explained by nothing that was tried"
    for doubtful in ("as_if.a", "a|b"):
        assert "not certain" in unexplained(version(doubtful), version(""))
        assert "not certain" in unexplained(version(""), version(doubtful))
    assert "not certain" in unexplained(version("a"), version(""))
