"""data/flags.toml explains every flag of the scenes, and no other."""

from __future__ import annotations

import tomllib

from reference.scenes.scene import load_scene
from reference.scenes.shipped import data_root, scene_ids

MEANINGS = tomllib.loads((data_root() / "flags.toml").read_text("utf-8"))


def test_every_flag_of_a_scene_is_explained_and_every_explanation_is_used():
    used = {flag for name in scene_ids() for flag in load_scene(name).flags}
    assert used == set(MEANINGS)


def test_an_explanation_is_a_sentence_that_fits_a_line():
    for flag, text in MEANINGS.items():
        assert text.endswith(".") and text[0] == text[0].upper() and len(text) <= 150, flag
    assert list(MEANINGS) == sorted(MEANINGS)
