"""Text for people: facts, paragraphs and tables that fit a terminal."""

from __future__ import annotations

import pytest

from reference.commands.layout import TextColumn, facts, paragraph, table


@pytest.fixture(autouse=True)
def narrow(monkeypatch):
    monkeypatch.setenv("COLUMNS", "50")


def test_a_fact_is_wrapped_beside_its_label_and_the_same_label_is_left_out():
    words = "one two three four five six seven eight nine ten"
    first, second, third, fourth = facts([("cord", words), ("cord", "67 m"), ("site", "48°")])
    text = len(first) - len(first.lstrip().removeprefix("cord").lstrip())
    assert first.startswith("  cord ") and second[:text].isspace()
    assert f"{first[text:]} {second[text:]}" == words
    assert third[:text].isspace() and third[text:] == "67 m"
    assert fourth.split() == ["site", "48°"]


def test_a_word_that_is_wider_than_a_line_stays_whole():
    path = "/a/path" * 20
    assert path in paragraph(f"{path}: written")[0]


def test_columns_that_do_not_fit_go_on_below_with_the_keys_again():
    columns = [TextColumn(["key"], ["a", "bb"], is_number=False)]
    columns += [TextColumn([f"column{i}", "m"], ["1.5", "22.25"]) for i in range(8)]
    lines = table(columns)
    assert max(map(len, lines)) <= 50
    blocks = "\n".join(lines).split("\n\n")
    assert len(blocks) == 2
    for block in blocks:
        names, units, first, second = block.splitlines()
        assert names.split()[0] == "key" and set(units.split()) == {"m"}
        assert (first.split()[0], second.split()[0]) == ("a", "bb")
    # every column is there once, aligned right
    assert sum(block.count("22.25") for block in blocks) == 8


@pytest.mark.parametrize("columns", ["50", "80", "300"])
def test_what_generate_and_verify_print_fits(foucault, monkeypatch, tmp_path, columns):
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.chdir(tmp_path)
    calls = [
        ("generate", "paris", "--t-end", "60", "--level", "enclosed", "--out", "exact"),
        ("generate", "museum_gate", "--t-end", "30", "--out", "ranges"),
        ("verify", "exact"),
        ("verify", "ranges"),
    ]
    for words in calls:
        status, out, _ = foucault(*words)
        assert status == 0
        most = min(80, int(columns))
        assert [line for line in out.splitlines() if len(line) > most] == []


def test_generate_calls_positions_useless_that_are_wider_than_the_cord(foucault, tmp_path):
    scene = tmp_path / "wide.toml"
    scene.write_text(
        '[pendulum]\nlength = "1"\n[site]\ngravity_is = "effective"\n'
        '[release]\nangle = "40"\nazimuth = "0"\n[run]\nt_end = "1.2"\ngrid_step = "0.6"\n'
        '[uncertain]\n"release.angle" = "4"\n"pendulum.length" = "0.01"\n'
    )
    for t_end, is_useless in (("1.2", True), ("0.1", False)):
        words = ("--t-end", t_end, "--set", "run.grid_step=0.1", "--out", tmp_path / t_end)
        status, out, err = foucault("generate", scene, *words)
        assert status == 0, err
        assert ("useless" in out) == is_useless
