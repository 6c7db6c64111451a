"""A Python in which some packages are not installed, as `find_spec` and `import` see it.

PYTHONPATH=tests/helpers/hidden HIDDEN=heyoka,flint python …
"""

import os
from importlib.machinery import ModuleSpec, PathFinder

HIDDEN = set(os.environ.get("HIDDEN", "").split(","))
find = PathFinder.find_spec


def find_spec(name: str, path: object = None, target: object = None) -> ModuleSpec | None:
    """Find a module as Python does, unless its package is hidden."""
    if name.partition(".")[0] in HIDDEN:
        return None
    return find(name, path, target)  # type: ignore[arg-type]


PathFinder.find_spec = find_spec  # type: ignore[assignment, method-assign]
