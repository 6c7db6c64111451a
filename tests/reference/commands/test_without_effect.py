"""Options of generate and show that would have no effect beside others are refused, each by its word and the case."""

from __future__ import annotations

import pytest

OF_A_PROOF = (
    "--audit",
    "--no-audit",
    "--confirm whole",
    "--no-confirm",
    "--function",
    "--no-function",
    "--no-tables",
)
OTHERS = (
    "--no-transits",
    "--set site.g=9",
    "--section highest",
    "--uncertain length=±1",
    "--engine limbs",
)
# were an option not refused, then these words would be, and nothing would be solved
ALL = "generate --workers 0 --all"
ONE = "generate paris --engine abacus"
CASES = [
    *((f"{ALL} {option}", "with --all") for option in (*OF_A_PROOF, *OTHERS)),
    (f"{ALL} paris", "with --all"),
    (f"{ONE} --workers 2", "without --all"),
    (f"{ONE} --cluster local:2", "without --all"),
    *(
        (f"{ONE} --uncertain length=±0.001 {option}", "while inputs are uncertain")
        for option in (*OF_A_PROOF, "--digits 20")
    ),
    *((f"{ONE} --level confirmed {option}", "without --level enclosed") for option in OF_A_PROOF),
    (f"{ONE} --no-confirm --confirm whole", "with --no-confirm"),
    ("generate at_rest --t-end 1 --no-function --no-tables", "without --function"),
    *(
        (f"show --template {option}", "together with --template")
        for option in ("--equations", "--sensitivity", "--proved", "--json", "--uncertain g=±1")
    ),
    ("show --template --set site.g=9", "without SCENE"),
]


@pytest.mark.parametrize(("line", "case"), CASES)
def test_an_option_without_effect_is_refused_by_its_word_and_the_case(
    line, case, foucault, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    status, out, err = foucault(*line.split())
    options = [word for word in line.split() if word.startswith("--")]
    word = "SCENE" if line.endswith("paris") else options[-1]
    assert (status, out) == (2, "")
    assert err.startswith(f"foucault: {word}: has no effect {case}")
    assert not list(tmp_path.iterdir())
