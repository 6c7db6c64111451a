"""A scene with the settings of a run that a caller asks for, checked before any work."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..model.sections import form_of
from ..model.start import Start
from ..numbers.precision import LONG_DOUBLE
from ..scenes.scene import AnyScene, Scene, as_scene


def requested_scene(scene: AnyScene, settings: Mapping[str, Any]) -> Scene:
    """Return a scene with those settings of its run that are not None.

    Raises:
        InputError: a setting is wrong, or the scene has no such section: no gate without a rest position.
    """
    given = {f"run.{name}": value for name, value in settings.items() if value is not None}
    scene = as_scene(scene).with_values(given)
    for word in scene.run.sections or ():
        form_of(word, Start.of(scene.exact, LONG_DOUBLE.prec))
    return scene
