"""The engines, integrators of the model, each in a folder; one run of a scene, or two at a time.

- `batch_interface`: many scenes in double, what goes in and what comes out.
- `plan`: the input of an engine, `Plan`, its output, `Run`, and what it declares, `Engine`.
- `registry`: the engines by name, which of them a run takes, and the run itself, here or in the
  background.
- `trajectory`: single unconfirmed runs as binary64, of any system and with changed constants.
- `heyoka/`: everything that uses heyoka, in any number type.
- `limbs/`: an integrator in machine code for many digits; needs numba.
"""

from __future__ import annotations

from importlib.util import find_spec
from pkgutil import iter_modules

AUTO = "auto"  # the fastest engine that is installed


def _folders_with(file: str) -> tuple[str, ...]:
    """Return the folders here that have a module of this name."""
    folders = (module.name for module in iter_modules(__path__) if module.ispkg)
    return tuple(
        sorted(name for name in folders if find_spec(f"{__name__}.{name}.{file}") is not None)
    )


def engine_names() -> tuple[str, ...]:
    """Return the names of the engines: folders whose `engine.py` declares one as `ENGINE`."""
    return _folders_with("engine")


def batch_names() -> tuple[str, ...]:
    """Return the names of the engines for many rows: folders whose `batch.py` declares `BATCH`."""
    return _folders_with("batch")
