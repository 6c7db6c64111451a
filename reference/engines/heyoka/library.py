"""heyoka itself. Where it is not installed (pip has it for Linux only), importing this says how to install it.

All other modules that compute with heyoka import it from here.
"""

from __future__ import annotations

from ...system.imports import needed

try:
    import heyoka as hy
except ModuleNotFoundError:
    needed("heyoka", "", "heyoka", "solving a scene")
    raise

__all__ = ["hy"]
