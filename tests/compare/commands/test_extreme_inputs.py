"""Numbers in range that no double survives: every command says so, and none ends in a traceback."""

from __future__ import annotations

import pytest

BEYOND = "beyond the range of binary64"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["study", "paris", "--methods", "heyoka_double", "--set", "site.rotation_rate=1e200"],
            BEYOND,
        ),
        (["study", "paris", "--approximations", "--set", "site.rotation_rate=1e308"], BEYOND),
        (["show", "paris", "--sensitivity", "--set", "site.gravity=1e390"], BEYOND),
        (["generate", "paris", "--t-end", "60", "--set", "pendulum.length=1e390"], BEYOND),
        (
            [
                "score",
                "paris",
                "--approximation",
                "gastebois_6_1",
                "--set",
                "pendulum.length=1e200",
            ],
            "no finite",
        ),
        (["pend", "-T", "10", "-O", "1e308"], BEYOND),
    ],
)
def test_what_no_double_survives_cannot_be_reached(foucault, words, said):
    status, _, err = foucault(*words)
    assert status == 3
    assert said in err


def test_a_time_that_is_zero_as_a_double_is_refused(foucault):
    status, _, err = foucault("generate", "paris", "--t-end", "1e-390")
    assert (status, err.partition(", expected")[0]) == (2, "foucault: run.t_end: got '1e-390'")
