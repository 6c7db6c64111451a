"""The input numbers of Gastebois's paper, in m, m/s² and degrees; the day and the rotation rate."""

from __future__ import annotations

from ..digits import mpf, pi

G = "Gastebois"
SIDEREAL_DAY = 2 * pi / mpf("7.292115e-5") / 3600  # h, by the rotation rate of WGS84
EARTH_RADIUS = mpf("6370e3")  # m, as in the paper
GRAVITY = mpf("9.8")  # m/s², as in the paper's 4.1
PANTHEON_LATITUDE = mpf("48.87")
PANTHEON_RELEASE = mpf("6.5")
PANTHEON_LENGTH = mpf("67")
MEAN_RADIUS = mpf("6371008.7714")  # m, NIMA TR8350.2: mean radius of semi-axes
RATE = 2 * pi / (SIDEREAL_DAY * 3600)  # rad/s
