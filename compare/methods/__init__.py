"""Integrators behind one interface (the paper's, this project's, libraries'), each declared in a file of its own.

>>> from compare.methods import METHODS, available
>>> METHODS["rk4"].title
'classical Runge-Kutta, order 4'

A method prepares a problem and returns a function that integrates it, so that the integration can be timed alone:

    problem = Problem.of(reference.load_scene("paris"), "plane")
    work = METHODS["rk4"].prepare(problem, 0.01)    # imports and compiles
    outcome = work()                                # integrates
    outcome.states                                  # x, y, z, vx, vy, vz at problem.times

A method's file is imported when the method is looked up, and its library when it prepares a problem.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module

from reference.errors import InputError

from ..rhs.problem import Problem
from .external import external
from .method import Exact, Method, Outcome, Work, available

__all__ = ["EXTERNAL", "METHODS", "Exact", "Method", "Outcome", "Problem", "Work", "available", "external"]

EXTERNAL = "external: "  # begins the id of a method that is a command

_MODULES = {
    "rk4": ("rk4",),
    "rkng56": ("rkng56",),
    "rkng67": ("rkng67",),
    "rkmk4": ("rkmk4",),
    "gauss_legendre": ("gauss_legendre",),
    "heyoka": ("heyoka_double", "heyoka_long_double", "heyoka_real128", "heyoka_real"),
    "limbs": ("limbs",),
    "scipy": ("scipy_rk45", "scipy_dop853", "scipy_radau", "scipy_bdf", "scipy_lsoda"),
    "numbalsoda": ("numbalsoda_dop853", "numbalsoda_lsoda"),
    "sundials": ("cvode_adams", "cvode_bdf"),
    "rebound": ("rebound_bs", "rebound_ias15"),
    "diffrax": ("diffrax_dopri8",),
    "mpmath": ("mpmath_odefun",),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


class _Methods(Mapping[str, Method]):
    """The mapping from id to method, in the order of the documentation; modules are imported on first use."""

    def __getitem__(self, name: str) -> Method:
        if name.startswith(EXTERNAL):
            from .external import external

            return external(name.removeprefix(EXTERNAL), name=name)
        if name not in _MODULE_OF:
            raise InputError("method", name, "a method's id", f"Known ids: {', '.join(_MODULE_OF)}.")
        module = import_module(f".{_MODULE_OF[name]}", __name__)
        declared: tuple[Method, ...] = getattr(module, "METHODS", None) or (module.METHOD,)
        return next(method for method in declared if method.id == name)

    def __contains__(self, name: object) -> bool:
        return name in _MODULE_OF

    def __iter__(self) -> Iterator[str]:
        return iter(_MODULE_OF)

    def __len__(self) -> int:
        return len(_MODULE_OF)


METHODS: Mapping[str, Method] = _Methods()
