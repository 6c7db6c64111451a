"""The switches of foucPend: their defaults, the checks on them, and the scene that they describe."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction

from pydantic import ValidationError

from reference import InputError, Scene, parse_scene
from reference.errors import NoEffectError
from reference.scenes.fields import RunTable
from reference.system.documents import texts_of

METHOD_OF = {"4": "rk4", "5": "rkng56", "6": "rkng67"}
MAX_STEPS = 1_000_000_000


@dataclass(frozen=True)
class Switch:
    """A switch of the program.

    Attributes:
        unit: of its value, as the help shows it.
        help: its meaning.
        default: its value where it is left out.
        field: the field of a scene that it sets, which checks the value; "" if none.
    """

    unit: str
    help: str
    default: str
    field: str = ""


SWITCHES = {letter: Switch(**switch) for letter, switch in texts_of(__file__).items()}
DEFAULTS = {letter: switch.default for letter, switch in SWITCHES.items()}
_LETTERS = {switch.field: letter for letter, switch in SWITCHES.items() if switch.field}


@dataclass(frozen=True)
class Options:
    """The settings of a run.

    Attributes:
        scene: pendulum, site and release; its numbers are the doubles nearest to the typed ones.
        step: step size in s.
        steps: whole steps up to T.
        skip: steps from one snapshot to the next.
        order: value of -R, which says the integrator.
        bits: value of -a; the lowest two bits tell which terms are left out, others mean nothing.
        exact: take the lines from the reference instead.
        printed: the switches that set the problem and the output, as they may be typed again.
    """

    scene: Scene
    step: Fraction
    steps: int
    skip: int
    order: str
    bits: int
    exact: bool
    printed: str

    @classmethod
    def parse(cls, given: Mapping[str, str], exact: bool = False) -> Options:
        """Check the switches; those left out have the program's defaults.

        Args:
            given: values by letter, as typed.
            exact: whether --exact is set.

        Raises:
            InputError: naming the switch.
        """
        unknown = [switch for switch in given if switch not in DEFAULTS]
        if unknown:
            raise InputError(f"-{unknown[0]}", given[unknown[0]], "one of -" + " -".join(DEFAULTS))
        values = DEFAULTS | dict(given)
        for switch, why in (
            ("R", "uses no Runge-Kutta scheme"),
            ("a", "includes all terms"),
        ):
            if exact and values[switch] != DEFAULTS[switch]:
                case = f"together with --exact, because the reference {why}"
                raise NoEffectError(f"-{switch}", values[switch], case)
        skip, bits = _whole("s", values["s"], 1), _whole("a", values["a"], 0)
        if values["R"] not in METHOD_OF:
            raise InputError(
                "-R", values["R"], "4, 5 or 6", "4: Runge-Kutta; 5: RKN-G 5(6); 6: RKN-G 6(7)."
            )
        scene = _scene(values)
        inputs = scene.exact
        # a little slack: the double 0.1 is above 1/10, and must still fit three times into 0.3
        steps = int(inputs.t_end / inputs.grid_step * (1 + Fraction(1, 10**12)))
        if not 1 <= steps <= MAX_STEPS:
            raise InputError(
                "-t",
                values["t"],
                f"1 to {MAX_STEPS} steps up to T = {values['T']} s",
                "Change -t or -T.",
            )
        shown = values | {"s": skip}
        printed = " ".join(
            f"-{letter} {value}" for letter, value in shown.items() if letter not in ("R", "a")
        )
        return cls(scene, inputs.grid_step, steps, skip, values["R"], bits, exact, printed)


def _whole(switch: str, text: str, low: int) -> int:
    with suppress(ValueError):
        if (value := int(text)) >= low:
            return value
    raise InputError(f"-{switch}", text, f"a whole number, {low} or more")


def _scene(values: Mapping[str, str]) -> Scene:
    document: dict[str, dict[str, str]] = {"release": {"vy": "0"}}
    for field, letter in _LETTERS.items():
        section, _, key = field.partition(".")
        document.setdefault(section, {})[key] = values[letter]
    run = document.pop("run")
    for key in run:
        try:
            RunTable(**{key: run[key]})
        except ValidationError:
            raise InputError(
                f"-{_LETTERS[f'run.{key}']}", run[key], "a number above 0, in s"
            ) from None
    try:
        scene = parse_scene({"id": "pend", "inputs": "binary64", **document})
    except InputError as error:
        raise _renamed(error, values) from None
    # set after parsing: the limit on a scene's rows does not concern a program that prints them one
    # by one
    return scene.model_copy(update={"run": RunTable(**run)})


def _renamed(error: InputError, values: Mapping[str, str]) -> InputError:
    """Return the same error with the switch in place of the scene's field."""
    if error.field in _LETTERS:
        switch = _LETTERS[error.field]
        return InputError(f"-{switch}", values[switch], error.expected, error.advice)
    if error.field == "release":
        x, y = values["x"], values["y"]
        return InputError(
            "-x, -y", f"{x}, {y}", f"a point below the suspension: x² + y² < l² = {values['l']}²"
        )
    return error
