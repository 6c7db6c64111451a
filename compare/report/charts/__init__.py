"""Charts of the reports as SVG text (matplotlib, extra `plot`): costs, precision, stability map, growth of errors.

Every function takes plain data and returns one SVG element for a page. Text stays text, and the same data give the same
bytes. The colours are Okabe and Ito's; markers, dashes and labels repeat their information, so nothing is lost in grey.
"""

from __future__ import annotations

from .error_growth import ErrorHistory, error_growth
from .heat_map import Field, heat_map
from .study import achieved_tolerance, by_family, formulations, overview, precision_ladder, right_hand_sides

__all__ = [
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
