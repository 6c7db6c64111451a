"""Heat map of scenes × methods: digits kept by each run, or a letter for how it failed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from reference import InputError
from reference.errors import shortened
from reference.status import Status

from .drawing import BAND, FAINT, INK, PAPER, sheet, svg_text

LETTERS = {
    Status.SILENTLY_WRONG: "W",
    Status.ILL_CONDITIONED: "I",
    Status.NOT_FINITE: "N",
    Status.GAVE_UP: "G",
    Status.CRASHED: "C",
    Status.OUT_OF_TIME: "T",
    Status.MISSED_TRANSITS: "M",
    Status.REFUSED: "R",
    Status.UNREACHABLE: "U",
    Status.NOT_INSTALLED: "–",
}
LOUD = Status.SILENTLY_WRONG  # the status that stands out by its colour
_LOUD_COLOUR, _QUIET_COLOUR = "#D55E00", "#F2C9A8"
_BLUES = ("#dbe9f4", "#b3d1e8", "#7fb3d9", "#4292c6", "#1f6aa8", "#0b4477")  # few to many digits, in grey as well
_DARK_FROM = 3  # index of the first blue with white text
_CELL = 0.27  # side of a cell in inches
_MARGINS = (2.3, 1.9)  # width and height for the names, in inches
_LONGEST_NAME = 30  # characters of a scene's name, which may be the path of a file
_CHARACTER = 0.27  # width of a character in cells
_LEAST_COLUMNS, _KEY_ROWS = 15, 5.5  # cells that the key needs


@dataclass(frozen=True)
class Field:
    """One field of the map.

    Attributes:
        row: scene.
        column: method, with its precision where that is needed to tell columns apart.
        status: OK or a key of `LETTERS`.
        digits: digits kept, if the status is OK.
    """

    row: str
    column: str
    status: Status
    digits: float | None = None

    @property
    def mark(self) -> str:
        """Text of the field: digits kept, rounded down, or the letter of its status."""
        if self.status in LETTERS:
            return LETTERS[self.status]
        return "?" if self.digits is None else f"{int(max(0.0, self.digits))}"


def heat_map(cells: Sequence[Field], steps: Sequence[float] = (3, 6, 9, 12, 15)) -> str:
    """Draw the map, rows and columns in order of appearance; a field that is not in `cells` stays empty.

    Args:
        cells: fields of the map, at least one.
        steps: the five numbers of digits at which the colour changes.

    Raises:
        InputError: there is nothing to draw, or a status is unknown.
    """
    if not cells:
        raise InputError("cells", "none", "at least one")
    unknown = next((cell for cell in cells if cell.status not in LETTERS and cell.status != Status.OK), None)
    if unknown is not None:
        raise InputError("status", unknown.status, f"ok or one of {', '.join(LETTERS)}")
    rows, columns = (
        list(dict.fromkeys(names)) for names in zip(*[(one.row, one.column) for one in cells], strict=True)
    )
    size = (_MARGINS[0] + _CELL * max(len(columns), _LEAST_COLUMNS), _MARGINS[1] + _CELL * (len(rows) + _KEY_ROWS))
    with sheet(size) as figure:
        axes = figure.subplots()
        wide = max(len(columns), _LEAST_COLUMNS)
        axes.set(xlim=(0, wide), ylim=(len(rows) + _KEY_ROWS, 0), aspect="equal")
        for cell in cells:
            _field(axes, columns.index(cell.column), rows.index(cell.row), cell.mark, *_colours(cell, steps))
        _key(axes, len(rows) + 0.7, wide, {cell.status for cell in cells}, steps)
        axes.set_xticks(
            [i + 0.5 for i in range(len(columns))], columns, rotation=55, rotation_mode="anchor", ha="left", fontsize=8
        )
        names = [shortened(row, _LONGEST_NAME) for row in rows]
        axes.set_yticks([i + 0.5 for i in range(len(rows))], names, fontsize=8)
        axes.tick_params(length=0, top=False, labeltop=True, labelbottom=False, bottom=False, pad=2)
        axes.spines[:].set_visible(False)
        wrong = sum(cell.status == LOUD for cell in cells)
        return svg_text(figure, "map", f"{len(rows)} scenes by {len(columns)} methods; silently wrong: {wrong}.", "map")


def _colours(cell: Field, steps: Sequence[float]) -> tuple[str, str]:
    """Return the colours of the field and of its text."""
    if cell.status == Status.OK:
        shade = sum((cell.digits or 0.0) >= step for step in steps)
        return _BLUES[shade], PAPER if shade >= _DARK_FROM else "#10202c"
    if cell.status == Status.NOT_INSTALLED:
        return BAND, FAINT
    return (_LOUD_COLOUR, "#000000") if cell.status == LOUD else (_QUIET_COLOUR, "#3a1c05")


def _field(axes: Any, x: float, y: float, mark: str, colour: str, ink: str) -> None:
    axes.fill([x, x + 0.94, x + 0.94, x], [y, y, y + 0.94, y + 0.94], color=colour, linewidth=0)
    weight = "bold" if mark == LETTERS[LOUD] else "normal"
    axes.text(x + 0.47, y + 0.5, mark, ha="center", va="center_baseline", fontsize=7.5, color=ink, weight=weight)


def _key(axes: Any, y: float, wide: float, present: set[Status], steps: Sequence[float]) -> None:
    """Draw the key below the map."""
    for i, digits in enumerate([0.0, *steps]):
        cell = Field("", "", Status.OK, digits)
        _field(axes, i, y, cell.mark, *_colours(cell, steps))
    axes.text(len(steps) + 1.3, y + 0.5, "digits kept, at least", fontsize=8, va="center_baseline", color=INK)
    x = 0.0
    for status in [one for one in LETTERS if one in present]:
        needs = 1.7 + _CHARACTER * len(status.words)
        if x == 0.0 or x + needs > wide:
            x, y = 0.0, y + 1.2
        _field(axes, x, y, LETTERS[status], *_colours(Field("", "", status), steps))
        axes.text(x + 1.2, y + 0.5, status.words, fontsize=8, va="center_baseline", color=INK)
        x += needs
