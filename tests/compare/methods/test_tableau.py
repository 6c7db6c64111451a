"""A tableau proves its order when it is made: a misprint, any wrong digit and a higher claim are refused."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from compare.methods import rk4
from compare.methods.rkng import RKNG56, RKNG67
from compare.methods.tableau import Tableau, TableauError, conditions, fractions, triangle

# Misprints of public copies: (table, row, column, as printed), counted from 0. In place of the tableau's own entry each
# must make the order conditions fail. The first of 6(7) is the entry of column 2 printed in column 1, which leaves 0 in
# its own. The second violates Σ position_ij c_j^q = c_i^(q+2) / ((q+1) (q+2)) by 4.877e-24 times c_7^q, for q = 0 to 3;
# the factor c_7^q identifies the column, where the 24th to the 27th digit are wrong.
MISPRINTS = {
    RKNG56: (("position", 4, 0, "81/840"),),
    RKNG67: (
        ("position", 8, 1, "-0.6816741819616552879282309588555"),
        ("position", 9, 7, "1.6612294394931082916619461943874"),
    ),
}
NYSTROM = {"rkng56": RKNG56, "rkng67": RKNG67}


@pytest.mark.parametrize("name", NYSTROM)
def test_a_misprint_of_a_public_copy_is_refused(name):
    tableau = NYSTROM[name]
    for table, row, column, printed in MISPRINTS[tableau]:
        rows = [list(line) for line in getattr(tableau, table)]
        # an entry in the wrong column leaves its own empty
        if len(rows[row]) > column and rows[row][column] == 0:
            where = rows[row].index(Fraction(printed))
            rows[row][where] = Fraction(0)
        rows[row][column] = Fraction(printed)
        with pytest.raises(TableauError, match="misprint"):
            replace(tableau, **{table: tuple(map(tuple, rows))})


@pytest.mark.parametrize("name", NYSTROM)
def test_any_wrong_coefficient_is_refused_even_where_row_sums_hide_it(name):
    tableau, wrong = NYSTROM[name], Fraction("1e-20")
    for table in ("velocity", "position"):
        for i, line in enumerate(getattr(tableau, table)):
            if len(line) < 3 or (table, i, len(line)) == ("position", 0, 0):
                continue
            rows = [list(row) for row in getattr(tableau, table)]
            rows[i][0] += wrong
            rows[i][2] -= wrong
            with pytest.raises(TableauError):
                replace(tableau, **{table: tuple(map(tuple, rows))})
    for table in ("velocity_weights", "position_weights"):
        for i in range(len(tableau.c)):
            weights = list(getattr(tableau, table))
            weights[i] += wrong
            with pytest.raises(TableauError):
                replace(tableau, **{table: tuple(weights)})


@pytest.mark.parametrize("tableau", [rk4.TABLEAU, RKNG56, RKNG67])
def test_a_tableau_has_no_higher_order_than_it_claims(tableau):
    with pytest.raises(TableauError) as caught:
        replace(tableau, order=tableau.order + 1)
    assert caught.value.order == tableau.order + 1


def test_a_runge_kutta_tableau_is_checked_by_the_same_trees():
    replace(rk4.TABLEAU, b=fractions("1/6 1/3 1/3 1/6"))
    with pytest.raises(TableauError):
        replace(rk4.TABLEAU, b=fractions("1/6 1/6 1/2 1/6"))
    with pytest.raises(TableauError):
        Tableau(
            "3/8 rule with a sign lost",
            4,
            triangle("", "1/3", "1/3 1", "1 -1 1"),
            fractions("1/8 3/8 3/8 1/8"),
        )
    Tableau("3/8 rule", 4, triangle("", "1/3", "-1/3 1", "1 -1 1"), fractions("1/8 3/8 3/8 1/8"))


def test_there_are_as_many_rooted_trees_as_cayley_counted():
    one_stage = [(triangle(""), fractions("1"))]
    assert [len(residuals) for residuals in conditions(7, [], one_stage)] == [1, 1, 2, 4, 9, 20, 48]
