"""A few numbers as they are printed, rounded and counted in digits and bits."""

from fractions import Fraction

from reference.numbers.precision import (
    bits_of,
    decimals_for,
    double_below,
    fixed_decimal,
    magnitude,
    rounded_up,
)
from reference.numbers.table import Table


def test_lengths_and_errors_of_the_paris_pendulum():
    # two thirds of a millimetre
    assert fixed_decimal(Fraction(2, 3000), 6) == "0.000667"
    # 67 m is 6.7 times 10^1: 40 digits are 2 before the point and 38 after it
    assert magnitude(Fraction(67)) == 1
    assert decimals_for(Fraction(67), 40) == 38
    # 2^10 = 1024 is the first power of two from 1000 on; 2^40 is just above 10^12
    assert (bits_of(3), bits_of(12)) == (10, 40)
    # a bound is never rounded down
    assert rounded_up(Fraction("1.21e-41")) == "1.3e-41"
    # 0.3 m as a double is 0.299999999999999988898, 0.1 is above itself: the one below ends in 99
    assert double_below(Fraction("0.3")) == 0.3
    assert double_below(Fraction("0.1")) == 0.09999999999999999
    # integers over 2^8: 128 is a half
    assert Table(("x",), 8, [(128,), (-64,)]).printed({"x": 2}) == [("0.50",), ("-0.25",)]
