"""Thousands of damaged and strange scenes, assignments, candidates, transits and commands: each is read or refused."""

from __future__ import annotations

import contextlib
from collections import Counter

import pytest
from strange_inputs import (
    Chance,
    a_candidate,
    a_command,
    a_command_line,
    a_list_of_transits,
    a_scene,
    an_assignment,
)

from compare.candidates.external import arguments, placeholders, run_program
from compare.candidates.read import read, read_transits
from reference.commands.show import command as show
from reference.errors import FoucaultError, UnreachableError
from reference.scenes.scene import load_scene

# what makes an input, what takes it from a file or as it is, and how many in a short run, in a long one
KINDS = {
    "scene": (a_scene, lambda path: examine(str(path)), 40, 3000),
    "--set": (an_assignment, lambda word: examine("paris", word), 40, 2000),
    "candidate": (a_candidate, read, 50, 3000),
    "transits": (a_list_of_transits, read_transits, 25, 1000),
    "--run": (a_command, lambda word: run_program(arguments(word, load_scene("paris"))), 20, 1000),
}


def examine(word, *assignments):
    """Do with a scene what the commands do before they solve it."""
    scene = load_scene(word, assignments)
    with contextlib.suppress(FoucaultError):  # no double is as large
        scene.with_values(["inputs=binary64"])
    placeholders(scene)
    show(scene_word=word, set_=list(assignments))


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", KINDS)
def test_every_input_is_read_or_refused(kind, size, tally, tmp_path):
    make, use, *counts = KINDS[kind]
    file, outcomes = tmp_path / "input", Counter()
    for i in range(size(*counts)):
        made = make(Chance(f"1 {kind} {i}"))
        if isinstance(made, bytes):
            file.write_bytes(made)
        try:
            use(file if isinstance(made, bytes) else made)
            outcomes["read"] += 1
        except FoucaultError:
            outcomes["refused"] += 1
        except Exception as error:
            raise AssertionError(f"{kind} {i}: {ascii(made)[:2000]}") from error
    tally(f"fuzzed inputs, {kind}: {dict(outcomes)}")
    assert outcomes["read"] or kind == "--run", "all were refused"


@pytest.mark.filterwarnings("ignore")
def test_no_command_line_ends_in_a_traceback_or_moves_the_cursor(
    size, foucault, monkeypatch, tmp_path
):
    def stop(*_, **__):
        raise UnreachableError("Nothing is solved here.")

    # where each is called: a scene that is solved could be written over one that ships
    for place in (
        "compare.score.judge.golden_of",
        "compare.studies.study.golden_of",
        "reference.commands.generate_all.solve",
        "reference.commands.proved.prove_ranges",
        "reference.commands.proved.solve",
        "reference.dataset.ranges.prove_ranges",
        "reference.dataset.verify.solve",
        "reference.solver.uncertain.prove_ranges",
        # last: the others would keep what stands here when they are imported
        "reference.solver.solve.solve",
    ):
        monkeypatch.setattr(place, stop)
    for i in range(size(40, 1000)):
        words = a_command_line(Chance(f"1 command line {i}"), tmp_path / "input")
        status, out, err = foucault(*words)
        assert status in (0, 1, 2, 3) and "\x1b" not in out + err and "Traceback" not in err, (
            i,
            words,
            err[-1000:],
        )
