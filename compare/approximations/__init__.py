"""Registry of the analytic and truncated models of the source papers, by id; one idea in each file.

>>> from compare.approximations import approximation
>>> from reference import load_scene
>>> approximation("linear_g").trajectory(load_scene("paris"), [0.0, 16.4]).shape
(2, 6)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module

from reference import InputError

from .approximation import Approximation, Motion, Order, Printed, Quantity

__all__ = [
    "APPROXIMATIONS",
    "Approximation",
    "Motion",
    "Order",
    "Printed",
    "Quantity",
    "approximation",
    "motions",
    "quantities",
]

_MODULES = {
    "mathar_items": (
        "mathar_item_1",
        "mathar_item_1_variant",
        "mathar_item_2",
        "mathar_item_3",
        "mathar_item_4",
        "mathar_item_5",
        "mathar_items_1_2",
        "mathar_items_1_to_5",
    ),
    "mathar_linear": ("linear_g", "linear_apparent", "linear_recentred", "linear_anharmonic"),
    "linear_3d": ("linear_3d",),
    "gastebois_general": ("gastebois_general",),
    "gastebois_small": ("gastebois_6_1", "gastebois_6_2", "gastebois_6_3"),
    "three_methods": ("method_1", "method_2", "method_3"),
    "planar": ("planar",),
    "conical": ("conical",),
    "rest_angle": ("rest_equation", "rest_series_1", "rest_series_2", "rest_series_3", "rest_triangle"),
    "apparent_gravity": ("apparent_gravity",),
    "frequency": (
        "frequency_harmonic",
        "frequency_planar",
        "frequency_turntable",
        "frequency_apparent",
        "frequency_anharmonic",
    ),
    "precession": ("precession_sine", "precession_tilted", "precession_spherical"),
}
_MODULE_OF = {word: module for module, words in _MODULES.items() for word in words}
_QUANTITIES = ("rest_angle", "apparent_gravity", "frequency", "precession")


class _Approximations(Mapping[str, Approximation]):
    """Approximations by id; a module is imported when one of its ids is first looked up."""

    def __getitem__(self, word: str) -> Approximation:
        module = import_module(f".{_MODULE_OF[word]}", __name__)
        by_id: dict[str, Approximation] = {declared.id: declared for declared in module.APPROXIMATIONS}
        return by_id[word]

    def __iter__(self) -> Iterator[str]:
        return iter(_MODULE_OF)

    def __len__(self) -> int:
        return len(_MODULE_OF)


APPROXIMATIONS: Mapping[str, Approximation] = _Approximations()


def approximation(word: str) -> Approximation:
    """Return the approximation with this id.

    Raises:
        InputError: there is no such id.
    """
    if word not in _MODULE_OF:
        raise InputError("approximation", word, "an approximation's id", f"Known ids: {', '.join(_MODULE_OF)}.")
    return APPROXIMATIONS[word]


def motions() -> tuple[str, ...]:
    """Return the ids of the approximations that give a trajectory."""
    return tuple(word for word, module in _MODULE_OF.items() if module not in _QUANTITIES)


def quantities() -> tuple[str, ...]:
    """Return the ids of the approximations that give one number."""
    return tuple(word for word, module in _MODULE_OF.items() if module in _QUANTITIES)
