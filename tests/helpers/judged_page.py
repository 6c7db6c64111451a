"""docs/judged.md, a register of judged programs, written anew: python tests/helpers/judged_page.py."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

import wild_programs as programs
from places import ROOT

from compare.diagnosis.case import AS_IF
from compare.diagnosis.fitted import MODELS
from compare.score.judge import judge
from compare.score.verdict import Score
from reference import load_scene

PAGE = ROOT / "docs/judged.md"
LANGUAGES = {
    "C": ("w15",),
    "C++": ("w01", "w11", "w21", "w26"),
    "Java": ("w12", "w13"),
    "JavaScript": ("w07", "w27"),
    "MATLAB": ("w10", "w23", "w24", "w25", "w28"),
    "Python": (
        "w02",
        "w03",
        "w04",
        "w05",
        "w06",
        "w08",
        "w09",
        "w14",
        "w16",
        "w17",
        "w18",
        "w19",
        "w20",
        "w22",
        "w29",
        "w30",
    ),
}
LINEAR = {
    word: title
    for (word, _), title in zip(
        MODELS.values(), ("small swings", "linear in the angle"), strict=True
    )
}
MOST_DIGITS = 9  # beyond, rounding decides
HEAD = """# Register of judged programs

Thirty programs that anybody can find on the web were run at their own numbers, and judged as `foucault score` judges.
Here is what they solve, how many digits of the position are right, and which mistakes were named. The programs' names
are left out: what counts is which mistakes are made.

{counts}

- **model**: *sphere* is the full pendulum, *small swings* the linear one, in which a wide swing is no slower.
- **digits**: of the position, −log₁₀ of the largest error over the amplitude; 0 is no digit at all.
- **named**: the words of [the oracle](oracle.md#all-causes). "As if" stands before an input
  that the motion is like, with a number that is not round. Not in its table: `half_a_step`, of a leapfrog
  from two equal rows, and `y_is_vertical` and `falls`, which are told in a sentence.
- **then**: digits that are right once all of these are corrected, up to {most}. Where it is hardly
  more than before, something is not named.
- **not named**: what reading the program shows besides.

To judge a program of your own, begin with the [tutorial](tutorial.md). `python tests/helpers/judged_page.py`
writes this page from the trajectories in `tests/compare/diagnosis/`; a test holds it.

| | language | cord, span | model | digits | named | then | not named |
|---|---|---|---|---|---|---|---|
"""


def row(name: str) -> str:
    """Return the row of a program."""
    scene = load_scene("paris", programs.SETTINGS[name])
    score = judge(programs.FOLDER / f"{name}.csv", scene)
    found, said = score.explanation, programs.said(score.explanation)
    (language,) = (one for one, names in LANGUAGES.items() if name in names)
    words = {programs.G_EFFECTIVE: "effective_gravity"}
    likes = [
        f"as if `{one.id.removeprefix('as_if.')}`" for one in found.causes if one.stage == AS_IF
    ]
    named = ", ".join([*(f"`{words.get(word, word)}`" for word in sorted(said)), *likes]) or "–"
    unnamed = programs.TRUE[name] - said
    untold = ", ".join(f"`{words.get(word, word)}`" for word in sorted(unnamed)) or "–"
    model = next((title for word, title in LINEAR.items() if word in programs.TRUE[name]), "sphere")
    left = digits(found.corrected_m, score) if said or likes else digits(score.errors.max_m, score)
    then = f"{min(math.floor(left), MOST_DIGITS)}"
    place = f"{float(scene.pendulum.length):.6g} m, {float(scene.run.t_end):.5g} s"
    right = f"{digits(score.errors.max_m, score):.1f}"
    return f"| {' | '.join((name, language, place, model, right, named, then, untold))} |"


def digits(error_m: float, score: Score) -> float:
    """Return the digits of a position that an error leaves."""
    return max(0.0, -math.log10(error_m / score.errors.amplitude_m)) if error_m > 0 else MOST_DIGITS


def head() -> str:
    """Return what stands above the rows."""
    common = Counter(word for words in programs.TRUE.values() for word in words)
    linear = sum(common[word] for word in LINEAR)
    integrators = sum(
        any("integrator" in word for word in words) for words in programs.TRUE.values()
    )
    counts = (
        f"Of {len(programs.TRUE)} programs {linear} solve a linear model, {common[programs.G_EFFECTIVE]} take *g* for "
        f"the measured one,\n{integrators} have an integrator whose error shows, {common['inertial_rest']} release the "
        f"bob at rest against the stars,\nand {common['frame_x_south']} let *x* point south."
    )
    return HEAD.format(counts=counts, most=MOST_DIGITS)


def lines() -> Iterator[str]:
    """Yield the page: its head, and a row for each program."""
    yield head().rstrip("\n")
    for name in programs.SETTINGS:
        yield row(name)


if __name__ == "__main__":
    PAGE.write_text("\n".join(lines()) + "\n", encoding="utf-8")
