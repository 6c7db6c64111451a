"""How a dataset is made is read off its command and off the index by one parser, which knows the older forms."""

from __future__ import annotations

import json

import pytest

from reference.dataset.making import Making, options_in
from reference.scenes.shipped import golden_root, index


@pytest.mark.parametrize(("options", "making"), [
    ("--engine limbs --audit --confirm whole", Making()),
    ("--engine heyoka --no-audit --confirm sampled", Making("heyoka", audit=False, confirm="sampled")),
    ("--engine limbs --audit --confirm whole --function --no-tables", Making(function=True, tables=False)),
    # what was made before there was --confirm
    ("--engine limbs --audit", Making()),
    ("--engine limbs --audit --function", Making(function=True)),
    ("--engine limbs --audit --no-confirm", Making(confirm="none")),
    # without a proof there is nothing to audit
    ("--engine heyoka", Making("heyoka", audit=False)),
])  # fmt: skip
def test_every_form_that_a_command_has_had_is_read(options, making):
    command = f"foucault generate paris --level enclosed {options} --section highest"
    assert options_in(command) == options
    assert Making.of(command) == Making.of(options) == making


def test_a_command_that_does_not_say_how_it_was_made_is_refused():
    command = "foucault generate paris --engine abacus"
    assert options_in(command) is None
    with pytest.raises(ValueError, match="abacus"):
        Making.of(command)


def test_index_and_manifest_of_what_ships_say_the_same():
    for name, entry in index().items():
        manifest = json.loads((golden_root() / name / "manifest.json").read_text())
        assert options_in(manifest["command"]) == entry["options"]
        assert Making.of(entry["options"]).tables == ("grid.csv" in manifest["files"])
        assert Making.of(entry["options"]).function == ("function.json" in manifest["files"])
