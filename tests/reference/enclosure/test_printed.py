"""What is printed from a proof is read back and held against its intervals: a wrong digit anywhere is found."""

from __future__ import annotations

from dataclasses import replace

import pytest

pytest.importorskip("flint")

import reference
from reference.dataset.render import render
from reference.enclosure.printed import check_grid, check_transits
from reference.errors import FoucaultError
from reference.numbers.columns import GRID


@pytest.fixture(scope="module")
def solution():
    return reference.solve(reference.load_scene("paris"), t_end="60", digits=18, level="enclosed")


@pytest.fixture(scope="module")
def printed(solution):
    texts, proved = render(solution), solution.proof.enclosed
    bounds = dict.fromkeys((*GRID, "ax"), "1")
    return {
        "grid.csv": lambda text: check_grid(text, proved.times, proved.states, bounds),
        "transits.csv": lambda text: check_transits(text, proved.transits, bounds),
    }, texts


@pytest.mark.parametrize("name", ["grid.csv", "transits.csv"])
def test_every_digit_that_is_changed_is_found(name, printed):
    checks, texts = printed
    checks[name](texts[name])
    header, *lines = texts[name].splitlines()
    found = 0
    for i in (0, len(lines) // 2, -1):
        cells = lines[i].split(",")
        for k in range(len(cells) - (name == "transits.csv")):  # the bound may be larger
            for place in (0, len(cells[k]) // 2, -1):
                old = cells[k][place]
                if old.isdigit():
                    new = cells[k][:place] + str((int(old) + 1) % 10) + cells[k][place:][1:]
                    spoilt = [*lines]
                    spoilt[i] = ",".join([*cells[:k], new, *cells[k + 1 :]])
                    with pytest.raises(ArithmeticError, match="misprint"):
                        checks[name]("\n".join([header, *spoilt]))
                    found += 1
    assert found > 40


def swapped(lines):
    return [lines[0], lines[2], lines[1], *lines[3:]]


@pytest.mark.parametrize(
    "spoil",
    [
        swapped,
        lambda lines: lines[:-1],
        lambda lines: [*lines, lines[-1]],
        lambda lines: [lines[0].replace("x,y", "y,x"), *lines[1:]],
        lambda lines: [line.replace(",+1,", ",-1,") for line in lines],
        lambda lines: [",".join([*line.split(",")[:-1], "1e-40"]) if k else line for k, line in enumerate(lines)],
        lambda lines: [line.replace(",-0.", ",-0_0.") for line in lines],
    ],
)
def test_rows_columns_directions_bounds_and_spellings_that_are_wrong_are_found(spoil, printed):
    checks, texts = printed
    with pytest.raises((ArithmeticError, ValueError)):
        checks["transits.csv"]("\n".join(spoil(texts["transits.csv"].splitlines())))


def test_a_column_whose_bound_is_too_small_is_found(solution, printed):
    proved = solution.proof.enclosed
    with pytest.raises(ArithmeticError, match="misprint"):
        check_grid(
            printed[1]["grid.csv"],
            proved.times,
            proved.states,
            dict.fromkeys(GRID, "1e-30"),
        )


def test_a_table_that_is_not_the_proof_is_not_printed(solution):
    values = [tuple(v + (1 << solution.grid.bits) // 10**15 for v in row) for row in solution.grid.values]
    with pytest.raises(ArithmeticError, match="misprint"):
        render(replace(solution, grid=replace(solution.grid, values=values)))


def test_a_proof_ships_only_when_it_was_audited(solution, tmp_path, monkeypatch):
    from reference.dataset import place, write

    monkeypatch.setattr(place, "golden_root", lambda: tmp_path)
    monkeypatch.setattr(write, "keep_seal", lambda *_: None)
    with pytest.raises(FoucaultError, match="audit"):
        reference.write(solution, tmp_path / "paris")
    assert not (tmp_path / "paris").exists()
    audited = replace(solution, proof=replace(solution.proof, audited=True))
    reference.write(audited, tmp_path / "paris")
    from reference.dataset import verify
    from reference.dataset.golden import read_files

    assert verify.problems_of(tmp_path / "paris") == []
    monkeypatch.setattr(verify, "golden_root", lambda: tmp_path)
    monkeypatch.setattr(verify, "seals", dict)
    assert list(verify.seal_problems(read_files(tmp_path / "paris"))) == []
    reference.write(solution, tmp_path / "elsewhere" / "paris")
    (tmp_path / "paris").rename(tmp_path / "older")
    (tmp_path / "elsewhere" / "paris").rename(tmp_path / "paris")
    assert any("audit" in problem for problem in verify.seal_problems(read_files(tmp_path / "paris")))
