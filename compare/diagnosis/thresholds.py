"""The thresholds that decide what is said of a file, each with what it protects against and the test that moves it.

Everything else that is a number in this package says how much is tried, or at what a computation stops: with another
value of it an explanation may not be found, but none becomes certain.
"""

# Of the tolerance. Smaller residuals are rounding, and steps of a program's own or ours: no sentence depends on them.
# tests/compare/diagnosis/test_claims.py: test_few_digits_are_certain_and_many_are_one_of_several;
# tests/compare/diagnosis/test_same_words.py
FINEST = 1e-3

# Times the largest rounding of a row, √2 or √3 times that of its numbers: a program's own steps are rounded too.
# tests/compare/diagnosis/test_claims.py: test_what_rounding_leaves_is_explained
ROUNDED = 1.05

# Factor by which the residual grows at least without a part of an explanation that is certain, everything else
# fitted again. If the tolerance is not reached, the error has to shrink by the square of this before anything is named;
# the same square holds for each other cause beside a step error of unknown method. Of the difference between two
# versions, the changes have to explain all but a tenth.
# tests/compare/diagnosis/test_claims.py: test_a_map_of_a_column_that_is_hardly_needed_is_not_certain;
# test_an_either_without_which_little_more_is_left_is_not_certain; test_a_change_explains_what_lies_between_the_versions
NEEDED = 10.0

# Ratio of two residuals up to which one is about as good as the other. It compares two explanations; an explanation
# with and without a cause, which is not needed then; the last rows, predicted from the first, and fitted; and the
# residual of a column with the file's own error there.
# tests/compare/diagnosis/test_claims.py: test_a_map_of_a_column_that_is_hardly_needed_is_not_certain;
# tests/compare/diagnosis/test_false_causes.py: test_no_cause_is_stated_that_spoils_a_right_column
RIVAL = 3.0

# Of the rows, from the first one: numbers that are fitted to them have to predict the others.
# tests/compare/diagnosis/test_claims.py: test_numbers_that_do_not_predict_are_not_sound
FIRST_PART = 2 / 3

# Rows for each fitted number: of fewer rows nothing is certain.
# tests/compare/diagnosis/test_claims.py: test_of_few_rows_nothing_fitted_is_certain
ROWS_A_NUMBER = 4

# Alternatives of an "either … or …"; where there are more, the motion is like one of them.
# tests/compare/diagnosis/test_claims.py: test_rivals_are_told_beside_each_other
ALTERNATIVES = 3

# Chance that an arbitrary number is as near to a round one, within its own uncertainty.
# tests/compare/diagnosis/test_claims.py: test_few_digits
CHANCE = 0.01

# Digits of a number that people type, and of a factor.
# tests/compare/diagnosis/test_claims.py: test_few_digits; test_a_factor_that_people_type_has_fewer_digits
MOST_DIGITS = 7
FACTOR_DIGITS = 4

# Changes that a program may have, about: the number of accidents that may be mistaken for a cause. Divided by
# the chance above, it is the factor by which a drift has to grow without a cause that is no accident beside it.
# tests/compare/diagnosis/test_claims.py: test_few_digits_are_certain_and_many_are_one_of_several
CATALOGUE = 80

# Ratio of two errors of an integrator: versions between which it is less have the same step.
# tests/compare/diagnosis/test_claims.py: test_a_step_that_errs_about_as_much_is_the_same
OTHER_STEP = 2.0
