"""The set-up that all pictures share: figures, colours, logarithmic axes, lines with their names, SVG for a page.

Every chart takes plain data and is an SVG element of a page. Text stays text, and the same data
give the same bytes. Markers, dashes and labels repeat what the colours say, so nothing is lost in
grey.
"""

from __future__ import annotations

import html
import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from reference import InputError
from reference.errors import Described, in_words
from reference.system.imports import needed

# Colours that follow a page's light or dark scheme, by these names: the greys of a figure, and its
# darkest colour
INKS = {
    "ink": "#1b1b1b", "faint": "#6b6b6b", "rule": "#dcdcdc", "band": "#e9e9e9", "paper": "#fefefe", "blue": "#0072b2",
}  # fmt: skip
INK, FAINT, RULE, BAND, PAPER, BLUE = INKS.values()
# the same on a dark page, as in page.css
_DARK_INKS = {
    "ink": "#e6e6e6", "faint": "#a4a4a4", "rule": "#3b3b3b", "band": "#272727", "paper": "#171717", "blue": "#3d9fdc",
}  # fmt: skip
# Okabe and Ito's palette for colour-blind readers; in grey the line styles tell lines apart
COLOURS = (BLUE, "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", INK)
# lines to compare others with
GUIDE: dict[str, Any] = {"color": FAINT, "linewidth": 0.8, "linestyle": (0, (1, 2))}
_DASHES: tuple[Any, ...] = (
    "-",
    (0, (5, 1.5)),
    (0, (1.2, 1.2)),
    (0, (7, 1.5, 1.2, 1.5)),
    (0, (3, 3)),
)
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h")

_SUFFIXES = (".svg", ".png", ".pdf")  # of picture files
_ROOM = 0.06  # free part of a logarithmic axis at each end
_STYLE = re.compile(r' style="([^"]*)"')
_PIXELS = 4 / 3  # CSS pixels in a typographic point
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PARAMETERS = {
    "svg.hashsalt": "foucault",  # the same picture gives the same bytes
    "svg.fonttype": "none",
    "font.size": 9,
    "font.family": ["DejaVu Sans", "sans-serif"],
    **dict.fromkeys(
        (
            "text.color",
            "axes.labelcolor",
            "axes.titlecolor",
            "xtick.labelcolor",
            "ytick.labelcolor",
        ),
        INK,
    ),
    **dict.fromkeys(("axes.edgecolor", "xtick.color", "ytick.color"), FAINT),
    **dict.fromkeys(("figure.facecolor", "axes.facecolor"), PAPER),
    **dict.fromkeys(("axes.spines.top", "axes.spines.right"), False),
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.axisbelow": True,
    "grid.color": RULE,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.3,
}
_NO_DATE = {"svg": {"Date": None, "Creator": None}, "pdf": {"CreationDate": None}}
_NARROW = 0.06  # a band below this part of the height of the axes has its text above it
_GAP = 5  # between a line's end and its name, in points
_NAME_GAP = 0.045  # from name to name, over the height of the axes


def check_matplotlib(field: str) -> None:
    """Check that pictures can be drawn.

    Args:
        field: option or function that needs the picture, for the error message.

    Raises:
        InputError: matplotlib is not installed, or cannot be imported.
    """
    needed("matplotlib", "plot", field, "plotting")
    try:
        import_module("matplotlib.figure")
    except ImportError as error:
        advice = "Install it again with pip install --force-reinstall 'foucault-reference[plot]'."
        raise InputError(
            field, Described(error), "a matplotlib that can be imported", advice
        ) from None


def check_target(path: Path, field: str = "--plot") -> None:
    """Check, before anything is computed, that the picture can be written.

    Args:
        path: of the picture.
        field: the option that names it, for the message.

    Raises:
        InputError: matplotlib is missing, the suffix is no picture's, or there is no such folder.
    """
    check_matplotlib(field)
    if path.suffix.lower() not in _SUFFIXES:
        raise InputError(field, str(path), f"a path that ends in {in_words(_SUFFIXES)}")
    if path.is_dir() or not path.absolute().parent.is_dir():
        raise InputError(field, str(path), "a path in an existing folder")


@contextmanager
def sheet(size: tuple[float, float]) -> Iterator[Any]:
    """Yield an empty figure of this size in inches; draw and save it inside the context.

    The figure belongs to no window and not to pyplot, so that a caller's own settings of matplotlib
    stay as they are.

    Raises:
        InputError: matplotlib is not installed.
    """
    check_matplotlib("--out")
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with rc_context(_PARAMETERS):
        figure = Figure(figsize=size, layout="constrained")
        FigureCanvasAgg(figure)
        yield figure


def line_style(colour: str, place: int) -> dict[str, Any]:
    """Return the style of the n-th line of a colour; full and hollow markers alternate."""
    return {
        "color": colour,
        "linestyle": _DASHES[place % len(_DASHES)],
        "marker": _MARKERS[place % len(_MARKERS)],
        "markersize": 4.5,
        "markerfacecolor": colour if place % 2 == 0 else "none",
    }


def picture(figure: Any, form: str = "svg") -> bytes:
    """Return the content of a picture file: svg, pdf or png.

    An svg file follows the reader's light or dark scheme.
    """
    content = _saved(figure, form)
    if form != "svg":
        return content
    return content.replace(b"</style>", f"\n{_dark_scheme()}</style>".encode(), 1)


def _dark_scheme() -> str:
    """Return the rules that replace the inks on a dark page.

    The colours stay in each element, so a program that does not know the rules draws the light
    picture.
    """
    rules = []
    for name, light in INKS.items():
        for use in ("fill", "stroke"):
            rule = f'[style*="{use}: {light}"] {{ {use}: {_DARK_INKS[name]} !important }}'
            rules.append(rule)
    return "@media (prefers-color-scheme: dark) {\n" + "\n".join(rules) + "\n}\n"


def _saved(figure: Any, form: str) -> bytes:
    """Return the figure as svg, pdf or png, without a date."""
    content = io.BytesIO()
    figure.savefig(content, format=form, dpi=150, metadata=_NO_DATE.get(form))
    return content.getvalue()


def svg_text(figure: Any, name: str, description: str, kind: str = "lines") -> str:
    """Return the figure as one SVG element that fits into a page.

    It has no styles, which a page's content security policy would have to allow one by one.

    Args:
        figure: figure from `sheet`.
        name: another one for each picture in the page: the ids in the SVG depend on it.
        description: text for readers who cannot see the picture.
        kind: CSS class; in class `lines` the page gives text a halo, so that it is legible over
            lines.
    """
    from matplotlib import rc_context

    for part in (figure, *figure.axes):
        part.patch.set_visible(False)  # the page's background shows
    with rc_context({"svg.hashsalt": name}):
        text = _saved(figure, "svg").decode()
    text = text[text.index(">", text.index("<svg")) + 1 :]
    text = re.sub(
        r"<metadata>.*?</metadata>\s*|<defs>\s*<style.*?</defs>\s*|<!--.*?-->\s*|(?<=\n) +",
        "",
        text,
        flags=re.DOTALL,
    )
    # ids that nothing refers to would appear in a page more than once
    targets = set(re.findall(r'#([^")]+)', text))

    def kept_id(match: re.Match[str]) -> str:
        return match[0] if match[1] in targets else ""

    text = re.sub(r' id="([^"]+)"', kept_id, text)
    width, height = 72 * figure.get_size_inches()
    text = _STYLE.sub(_as_attributes, text)
    opening = (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'viewBox="0 0 {width:g} {height:g}" width="{width * _PIXELS:.0f}" class="{kind}" '
        f'stroke-linejoin="round" role="img" aria-label="{html.escape(description)}">'
    )
    for word, colour in INKS.items():
        text = text.replace(colour, f"var(--{word}, {colour})")
    return opening + text.strip() + "\n"


def _as_attributes(style: re.Match[str]) -> str:
    """Return the declarations of a style as attributes: those of matplotlib have one of the same name each."""
    declarations = (part.partition(":") for part in style[1].split(";") if part.strip())
    return "".join(f' {name.strip()}="{value.strip()}"' for name, _, value in declarations)


def powers_of_ten(exponents: Sequence[int]) -> list[str]:
    """Return the labels of ticks, all in one style: 0.01, 1 and 100 if all are near 1, otherwise 10⁻², 10⁰ and 10²."""
    if all(-3 < exponent < 4 for exponent in exponents):
        return [f"{10.0**exponent:g}" for exponent in exponents]
    return ["10" + str(exponent).translate(_RAISED) for exponent in exponents]


def logarithmic(axes: Any, which: str, low: float, high: float, labels: int = 8) -> None:
    """Make an axis logarithmic between limits, with about `labels` labels at most."""
    getattr(axes, f"set_{which}scale")("log")
    getattr(axes, f"set_{which}lim")(low, high)
    first = math.ceil(math.log10(low) - 1e-9)
    last = math.floor(math.log10(high) + 1e-9)
    spacing = max(1, math.ceil((last - first + 1) / labels))
    exponents = [n for n in range(first, last + 1) if n % spacing == 0]
    ticks = [10.0**n for n in exponents]
    getattr(axes, f"set_{which}ticks")(ticks, powers_of_ten(exponents))
    axes.minorticks_off()
    axes.grid(True, axis=which)


def limits(values: Sequence[float], low: float = 0.6, high: float = 1.8) -> tuple[float, float]:
    """Return limits of a logarithmic axis around positive values.

    Args:
        values: what is drawn.
        low: factor below the smallest; a long axis has a smaller one.
        high: factor above the largest; a long axis has a larger one.
    """
    spread = (max(values) / min(values)) ** _ROOM
    return min(values) * min(low, 1 / spread), max(values) * max(high, spread)


@dataclass(frozen=True)
class ChartLine:
    """A line of a chart.

    Attributes:
        name: its name, in one or more lines of text.
        x: x of its points, in data coordinates.
        y: y of its points, in data coordinates.
        style: matplotlib's keywords, with the colour; see `line_style`.
        markers: opacity of its markers; 0 for a line without.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    style: Mapping[str, Any]
    markers: float = 0.0

    @property
    def without_markers(self) -> dict[str, Any]:
        """The style of the line alone."""
        return {**self.style, "marker": ""}

    @property
    def without_line(self) -> dict[str, Any]:
        """The style of the markers alone."""
        return {**self.style, "linestyle": "none"}


def draw(axes: Any, lines: Sequence[ChartLine]) -> None:
    """Draw lines with their markers."""
    for line in lines:
        axes.plot(line.x, line.y, **line.without_markers, zorder=3)
        if line.markers:
            axes.plot(line.x, line.y, **line.without_line, alpha=line.markers, zorder=4)


def legend(
    axes: Any, lines: Sequence[ChartLine], *, size: float = 8.0, inside: bool = False
) -> None:
    """Name lines in a legend right of the axes, or inside them where there is most room."""
    from matplotlib.lines import Line2D

    handles = []
    for line in lines:
        style = line.style if line.markers else line.without_markers
        handles.append(Line2D([], [], label=line.name, **style))
    where = {"loc": "best"} if inside else {"loc": "upper left", "bbox_to_anchor": (1, 1)}
    axes.legend(handles=handles, fontsize=size, labelspacing=0.35, handlelength=3, **where)


def name_ends(axes: Any, lines: Sequence[ChartLine], *, size: float = 8.0) -> None:
    """Write the name of each line beside its end: to the right, or to the left if x is negative."""
    for line in lines:
        end = (line.x[-1], line.y[-1])
        on_the_left = end[0] < 0
        axes.annotate(
            line.name,
            end,
            (-_GAP if on_the_left else _GAP, 0),
            textcoords="offset points",
            fontsize=size,
            color=line.style["color"],
            ha="right" if on_the_left else "left",
            va="center_baseline",
        )


def name_beside(axes: Any, lines: Sequence[ChartLine], *, size: float = 8.0) -> None:
    """Write the name of each line to the right of logarithmic axes, at the height of its end, without overlaps."""
    low, high = axes.get_ylim()
    upwards = sorted(lines, key=lambda line: line.y[-1])
    heights = [math.log(line.y[-1] / low) / math.log(high / low) for line in upwards]
    gap = min(_NAME_GAP, 1 / len(lines))
    for line, height in zip(upwards, _spread(heights, gap), strict=True):
        axes.text(
            1.012,
            height,
            line.name,
            transform=axes.transAxes,
            fontsize=size,
            color=line.style["color"],
            va="center_baseline",
        )


def _spread(heights: Sequence[float], gap: float) -> list[float]:
    """Return ascending heights at least `gap` apart and at most 1, near the given ones, which ascend."""
    spread = list(heights)
    for i in range(1, len(spread)):
        spread[i] = max(spread[i], spread[i - 1] + gap)
    highest = 1.0
    for i in reversed(range(len(spread))):
        spread[i] = min(spread[i], highest)
        highest = spread[i] - gap
    return spread


def band(axes: Any, bound_m: float) -> None:
    """Draw a band over errors below the reference's bound, which cannot be measured."""
    low, high = axes.get_ylim()
    if not low < bound_m < high:
        return
    axes.axhspan(low, bound_m, color=BAND, linewidth=0, zorder=0)
    text_fits_inside = math.log(bound_m / low) > _NARROW * math.log(high / low)
    height = low if text_fits_inside else bound_m
    text = f"bound of the reference, {bound_m:.1e} m"
    place = axes.get_yaxis_transform()
    axes.text(0.005, height, text, transform=place, va="bottom", color=FAINT, fontsize=8)
