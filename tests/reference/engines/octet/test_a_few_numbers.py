"""Five numbers of an hour of the Paris pendulum, hung up at five latitudes at once."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

pytest.importorskip("numba")

from random_rows import rows_of

from reference.engines.batch_interface import OK, RunOptions
from reference.engines.octet.batch import BATCH

LATITUDES = ("-48.846111", "0", "30", "48.846111", "90")


def test_an_hour_at_five_latitudes(paris):
    inputs = [replace(paris.exact, latitude=Fraction(at), t_end=Fraction(3600)) for at in LATITUDES]
    hour = BATCH.solve(rows_of(inputs), RunOptions(times=True))
    degrees_per_hour = np.degrees(hour.turn / (hour.apsis_last - hour.apsis_first)) * 3600

    assert (hour.fate == OK).all()
    # the Earth turns by 15.041 degrees an hour; times the sine of the latitude: 0.753, 0, 1/2, 1
    assert degrees_per_hour == pytest.approx([11.33, 0, -7.52, -11.33, -15.04], abs=0.03)
    # at the equator and at the pole the plumb line is the vertical: asin(0.5/67)
    assert np.degrees(hour.largest_angle)[[1, 4]] == pytest.approx(0.42758, abs=1e-5)
    # half a period, π sqrt(67/g): g is larger at the pole, where nothing is flung away
    assert hour.t_first == pytest.approx([8.218, 8.226, 8.222, 8.218, 8.212], abs=5e-4)
    # 3600/8.218 = 438.1; 3600/8.226 = 437.6
    assert hour.transits.tolist() == [438, 437, 437, 438, 438]
    # a highest point for each
    assert hour.apsides.tolist() == [438, 437, 437, 438, 438]
