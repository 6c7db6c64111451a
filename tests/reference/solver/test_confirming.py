"""A proof with heyoka's confirmation beside it: a run in another formulation that agrees to every digit."""

from __future__ import annotations

import dataclasses
from fractions import Fraction

import pytest

import reference
from reference.dataset.golden import read_files
from reference.dataset.record import NO_CONFIRM
from reference.dataset.verify import problems_of, recompute
from reference.dataset.write import write
from reference.engines import background
from reference.engines.background import Background, send_run
from reference.errors import InputError, IntegrationError, UnreachableError
from reference.solver import enclosed, reach

SHORT = {"t_end": "60", "digits": 18, "level": "enclosed"}
PARIS = reference.load_scene("paris")


@pytest.fixture(scope="module")
def confirmed(tmp_path_factory):
    solution = reference.solve(PARIS, **SHORT, confirm=True)
    return write(solution, tmp_path_factory.mktemp("confirmed") / "paris")


def test_the_manifest_says_both_and_the_dataset_is_made_again_byte_for_byte(confirmed):
    manifest = read_files(confirmed).manifest
    confirming = manifest.cross_checks[-1]
    assert manifest.enclosure is not None and NO_CONFIRM not in manifest.command
    assert confirming.formulation == "space" != manifest.run.formulation
    assert Fraction(confirming.position_m) < Fraction(manifest.bounds.position_m)
    assert confirming.transit_s is not None and manifest.bounds.transit_s is not None
    assert Fraction(confirming.transit_s) < Fraction(manifest.bounds.transit_s)
    assert problems_of(confirmed) == []
    assert recompute(confirmed) == ([], [])


def test_a_proof_alone_says_so_and_has_the_same_digits(confirmed, tmp_path):
    alone = write(reference.solve(PARIS, **SHORT), tmp_path / "paris")
    assert NO_CONFIRM in read_files(alone).manifest.command.split()
    assert problems_of(alone) == []
    for name in ("grid.csv", "transits.csv"):
        assert (alone / name).read_bytes() == (confirmed / name).read_bytes()


def test_a_manifest_that_claims_a_confirmation_has_to_show_it(confirmed, tmp_path):
    files = read_files(confirmed)
    fewer = files.manifest.model_copy(update={"cross_checks": files.manifest.cross_checks[:-1]}).sealed()
    for name, text in files.texts.items():
        (tmp_path / name).write_text(text, "utf-8")
    (tmp_path / "manifest.json").write_text(fewer.text(), "utf-8")
    assert any("no cross-check confirms the proof" in problem for problem in problems_of(tmp_path))


def test_heyoka_that_finds_other_numbers_is_an_error(monkeypatch):
    honest = Background.result

    def wrong(self, report=None):
        return dataclasses.replace(honest(self), directions=[])

    monkeypatch.setattr(Background, "result", wrong)
    monkeypatch.setattr("reference.solver.enclosed.run", lambda plan: wrong(Background(None, send_run, plan)))
    with pytest.raises(IntegrationError, match="does not confirm"):
        reference.solve(PARIS, **SHORT, confirm=True)


def test_a_confirmation_out_of_reach_is_refused_before_the_proof(monkeypatch):
    monkeypatch.setattr(reach, "MAX_PREC", 64)
    monkeypatch.setattr("reference.solver.enclosed.proved", None)
    with pytest.raises(UnreachableError, match=NO_CONFIRM):
        reference.solve(PARIS, **SHORT, confirm=True)


def test_without_a_proof_there_is_nothing_to_confirm(foucault, tmp_path):
    with pytest.raises(InputError, match="confirm: got"):
        reference.solve(PARIS, level="confirmed", confirm=True)
    status, _, said = foucault("generate", "paris", "--level", "confirmed", NO_CONFIRM, "--out", tmp_path / "paris")
    assert status == 2 and "without --level enclosed" in said


def test_progress_is_that_of_the_slowest_of_proof_audit_and_confirmation(monkeypatch):
    seen: list[float] = []
    honest, before = enclosed.proved, []

    def noted(*arguments):
        solution = honest(*arguments)
        before.extend(seen)
        return solution

    monkeypatch.setattr(enclosed, "proved", noted)
    monkeypatch.setattr(background, "usable_cores", lambda: 2)
    monkeypatch.setattr("reference.solver.enclosed.WORTH_A_PROCESS", 0.0)
    end = 9000.0
    reference.solve(PARIS, t_end=str(end), digits=18, level="enclosed", audit=True, confirm=True, report=seen.append)
    assert before[-1] < end  # the proof has ended, its audit has not
    after = seen[len(before) :]
    assert after[0] < after[-1]
    assert after == sorted(after)
