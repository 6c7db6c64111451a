"""A proof with heyoka's confirmation beside it, of the whole, of a sample, or none: what is said of it, and refused."""

from __future__ import annotations

import shutil
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from forgery import forge
from lines import unwrapped

import reference
from reference.dataset.files import read_files
from reference.dataset.verify import problems_of, recompute
from reference.dataset.write import write
from reference.engines import AUTO
from reference.engines.registry import run
from reference.errors import InputError, IntegrationError, UnreachableError
from reference.scenes.fields import CONFIRMATIONS
from reference.solver.choice import confirming_plan, first_prec
from reference.solver.enclosed import confirmed
from reference.solver.pilot import run_pilot
from reference.solver.proving import ProofTask

SHORT = {"t_end": "60", "digits": 18, "level": "enclosed"}
PARIS = reference.load_scene("paris")
WORDS = {
    "whole": "heyoka's run in another formulation agrees to every printed digit.",
    "sampled": "heyoka agrees to 1 of 1 rows, each reached from the row before.",
    "none": "No other run confirms it.",
}


@pytest.fixture(scope="module")
def solved():
    """One solution for each choice, by its word."""
    return {word: reference.solve(PARIS, **SHORT, confirm=word) for word in CONFIRMATIONS}


@pytest.fixture(scope="module")
def made(solved, tmp_path_factory):
    """Their datasets."""
    folder = tmp_path_factory.mktemp("made")
    return {word: write(solution, folder / word) for word, solution in solved.items()}


@pytest.mark.parametrize("word", CONFIRMATIONS)
def test_each_choice_is_named_by_manifest_and_page_and_made_again_byte_for_byte(
    made, word, foucault
):
    manifest = read_files(made[word]).manifest
    assert manifest.enclosure is not None and f"--no-audit --confirm {word}" in manifest.command
    others = [
        check for check in manifest.cross_checks if check.formulation != manifest.run.formulation
    ]
    assert [check.formulation for check in others] == ["space"] * (word != "none")
    for check in others:
        assert Fraction(check.position_m) < Fraction(manifest.bounds.position_m)
        # the event run beside a sample is not recorded
        assert (check.transit_s is not None) == (word == "whole")
    assert f"It is not audited. {WORDS[word]}\n" in (made[word] / "certified.txt").read_text(
        "utf-8"
    )
    told = unwrapped(foucault("verify", made[word])[1])
    assert told.endswith("checked only by --recompute: the proof, the cross-checks")
    assert recompute(made[word]) == ([], [])


def test_a_whole_confirmation_compares_transits_and_the_others_have_a_run_in_hardware_beside_them(
    solved, made
):
    check, bounds = (
        read_files(made["whole"]).manifest.cross_checks[-1],
        read_files(made["whole"]).manifest.bounds,
    )
    assert Fraction(check.transit_s) < Fraction(bounds.transit_s)
    guards = {word: solution.guard for word, solution in solved.items()}
    assert guards["whole"] is None
    assert {guards["sampled"].number, guards["none"].number} <= {"double", "long_double"}


def test_all_three_have_the_same_digits(made):
    for name in ("grid.csv", "transits.csv"):
        assert len({(folder / name).read_bytes() for folder in made.values()}) == 1


@pytest.mark.parametrize(
    ("word", "claimed"),
    [
        (word, claimed)
        for word in CONFIRMATIONS
        for claimed in ("whole", "sampled")
        if word != claimed
    ],
)
def test_a_manifest_that_claims_another_confirmation_has_to_show_it(made, tmp_path, word, claimed):
    forged = Path(shutil.copytree(made[word], tmp_path / "forged"))
    forge(
        forged,
        manifest=lambda m: m.update(
            command=m["command"].replace(f"--confirm {word}", f"--confirm {claimed}")
        ),
    )
    (problem,) = problems_of(forged)
    assert problem.endswith(f"do not show the confirmation that the command names: {claimed}")


def test_what_was_made_before_the_option_says_nothing_of_a_whole_confirmation(made, tmp_path):
    for word, older in (("whole", ""), ("none", " --no-confirm"), ("sampled", "")):
        old = Path(shutil.copytree(made[word], tmp_path / word))
        forge(
            old,
            manifest=lambda m, new=f" --no-audit --confirm {word}", older=older: m.update(
                command=m["command"].replace(new, older)
            ),
        )
        assert bool(problems_of(old)) == (word == "sampled")


@pytest.mark.parametrize("word", ["xdot", "gate 30"])
def test_a_proof_of_other_zeros_is_not_confirmed(word):
    proof = reference.solve(PARIS, **SHORT, sections=["gate 30"])
    scene, times = proof.scene, proof.times
    problem = ProofTask(scene, AUTO, run_pilot(scene.exact, times))
    witness = run(
        confirming_plan(scene, times, problem.pilot, first_prec(scene, problem.pilot, AUTO))
    )
    assert confirmed(problem, proof, "whole", witness).proof.confirmed == "whole"
    zeros = proof.zeros[word]
    forged = replace(
        proof, zeros=proof.zeros | {word: zeros._replace(directions=zeros.directions[:-1])}
    )
    with pytest.raises(IntegrationError, match="does not confirm"):
        confirmed(problem, forged, "whole", witness)


@pytest.mark.parametrize(("word", "t_end"), [("whole", "40000"), ("sampled", "400000")])
def test_a_confirmation_out_of_reach_is_refused_before_the_proof(word, t_end):
    """A tenth of ten times as many steps is out of reach as well; a test would not end with such a proof."""
    with pytest.raises(UnreachableError, match="--confirm none"):
        reference.solve(PARIS, t_end=t_end, digits=590, level="enclosed", confirm=word)


def test_without_a_proof_there_is_nothing_to_confirm(foucault, tmp_path):
    with pytest.raises(InputError, match="confirm: got"):
        reference.solve(PARIS, level="confirmed", confirm="sampled")
    for words in (("--confirm", "none"), ("--no-confirm",), ("--audit",), ("--no-audit",)):
        status, _, said = foucault(
            "generate", "paris", "--level", "confirmed", *words, "--out", tmp_path / "paris"
        )
        assert status == 2 and "without --level enclosed" in said and words[0] in said


def test_a_word_that_is_none_of_the_three_is_refused(foucault, tmp_path):
    with pytest.raises(InputError, match="confirm: got 'True', expected whole, sampled or none"):
        reference.solve(PARIS, **SHORT, confirm=True)
    words = ("generate", "paris", "--t-end", "60", "--out", tmp_path / "paris")
    status, _, said = foucault(*words, "--confirm", "sample")
    assert status == 2 and "Did you mean sampled?" in said
    status, _, said = foucault(*words, "--confirm", "whole", "--no-confirm")
    assert status == 2 and "with --no-confirm" in said


@pytest.mark.parametrize(
    ("words", "level", "named"),
    [
        ((), "enclosed; a sample confirmed by a second run", "--audit --confirm sampled"),
        (("--no-audit", "--no-confirm"), "enclosed", "--no-audit --confirm none"),
    ],
)
def test_a_user_gets_an_audit_and_a_sampled_confirmation_unasked(
    foucault, tmp_path, words, level, named
):
    status, out, _ = foucault(
        "generate", "paris", "--t-end", "60", "--digits", "18", *words, "--out", tmp_path / "paris"
    )
    assert status == 0 and f"{level}\n" in out
    assert read_files(tmp_path / "paris").manifest.command.endswith(f" {named} --function")
