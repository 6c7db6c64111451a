"""The truth that printed lines are compared with, compared with other closed forms and textbook equations."""

from __future__ import annotations

from compare.papers.digits import MP, mpf, norm, pi, shown, sqrt, vector
from compare.papers.first_principles import (
    by_angles,
    by_plane,
    euler_lagrange,
    horizontal_acceleration,
    in_rate,
    motion,
    plane_state,
    rest,
    rotated,
    suspension,
)
from compare.papers.gastebois.rotation import plane_period, swing_period
from compare.papers.points import paris, points

TINY = MP.mpf("1e-50")


def test_the_suspension_stands_on_the_ellipsoid_and_its_normal() -> None:
    for p in points():
        x, y, z = suspension(p.but(altitude=MP.zero), MP.one)
        polar = p.radius * (1 - p.flattening)
        assert abs((x * x + y * y) / p.radius**2 + z * z / polar**2 - 1) < TINY
        # of the gradient of that quadric
        slope = MP.atan2(z / polar**2, sqrt(x * x + y * y) / p.radius**2)
        assert abs(slope - p.phi) < TINY


def test_a_turn_keeps_lengths_and_is_undone_by_the_turn_back() -> None:
    p = points()[0]
    axis = vector(mpf("0.6"), mpf("0"), mpf("0.8"))
    turned = rotated(p.position, axis, p.t)
    assert abs(norm(turned) - norm(p.position)) < TINY
    back = rotated(turned, axis, -p.t)
    assert max(abs(a - b) for a, b in zip(back, p.position, strict=True)) < TINY


def test_the_reference_s_accelerations_satisfy_euler_and_lagrange() -> None:
    for p in points():
        a = horizontal_acceleration(p)
        for i in (0, 1):
            assert abs(euler_lagrange(p, by_plane, *plane_state(p)[:2], a, i)) < TINY


def test_euler_and_lagrange_of_a_planar_pendulum_are_the_textbook_s() -> None:
    for p in points():
        still = MP.zero
        q, v, a = (
            vector(part, other)
            for part, other in ((p.cord, p.azimuth), (p.cord_rate, still), (p.cord_second, still))
        )
        left = euler_lagrange(p.but(rate=still), by_angles, q, v, a, 0)
        textbook = p.length**2 * p.cord_second + p.gravity * p.length * MP.sin(p.cord)
        assert abs(left - textbook) < TINY


def test_a_quadratic_s_coefficients_come_out() -> None:
    assert [in_rate(lambda w: 3 - 5 * w + 7 * w * w, power) for power in (0, 1, 2)] == [3, -5, 7]


def test_the_plumb_line_of_paris_is_that_of_the_closed_forms_elsewhere() -> None:
    # tests/reference/solver/test_closed_forms.py solves Mathar (46) by itself: 11.5 cm south
    assert shown(rest(paris())[1], 12) == "-0.115205163345"


def test_the_closed_form_of_the_turning_swing_becomes_the_area_rule_at_small_amplitudes() -> None:
    # the apsides of an ellipse with half axes a and b turn by 3/8 a b / l² a radian of swing (Airy)
    length, gravity, rate = mpf(67), mpf("9.8"), mpf("7.292115e-5")
    w = sqrt(gravity / length)
    r0 = mpf("0.067")
    period, turn = swing_period(length, r0, gravity, rate)
    area = 2 * pi * mpf("0.375") * r0 * (r0 * rate / w) / length**2
    assert abs(turn / area - 1) < mpf("1e-5")
    assert abs(period * w / (2 * pi) - 1) < mpf("1e-6")
    assert abs(plane_period(length, r0, gravity, rate) * rate / (2 * pi) - 1) < mpf("1e-6")


def test_the_linear_motion_obeys_its_equation_and_bends_to_the_right_in_the_north() -> None:
    p = points()[0]
    x, y, _, vy = motion(p, (p.x, MP.zero, MP.zero, MP.zero), mpf("1e-3"))
    assert x < p.x
    assert y > 0 < vy  # let go in the east it falls to the west, and the north is on its right
    whole = motion(p, (p.x, p.y, p.vx, p.vy), p.t)
    halves = motion(p, motion(p, (p.x, p.y, p.vx, p.vy), p.t / 2), p.t / 2)
    assert max(abs(a - b) for a, b in zip(whole, halves, strict=True)) < TINY
