"""Pictures as SVG text (matplotlib, extra `plot`): for the page of a study, and for those of stability and long runs.

Every function takes plain data and gives one SVG element, ready to stand in a page: text kept as text, the same data
the same bytes. Colours are Okabe and Ito's; markers, dashes and labels repeat what colour says, so grey loses nothing.
"""

from __future__ import annotations

from .errors import achieved_tolerance, formulations, right_hand_sides
from .growth import ErrorHistory, error_growth
from .heat_map import CLASSES, Field, heat_map
from .overview import by_family, overview
from .precision import precision_ladder

__all__ = [
    "CLASSES",
    "ErrorHistory",
    "Field",
    "achieved_tolerance",
    "by_family",
    "error_growth",
    "formulations",
    "heat_map",
    "overview",
    "precision_ladder",
    "right_hand_sides",
]
