"""The registry of approximations: lazy, complete, and with a reason for every scene it refuses."""

from __future__ import annotations

import numpy as np
import pytest

from compare.approximations import APPROXIMATIONS, mathar, motions, quantities
from compare.approximations.approximation import Approximation, Motion, Quantity
from compare.papers.foucpend import ITEMS
from reference import InputError, IntegrationError, UnreachableError, load_scene

PARIS = load_scene("paris")


def test_motions_stand_before_numbers_and_follow_from_the_declarations_types():
    assert list(APPROXIMATIONS) == [*motions(), *quantities()]
    assert "conical" in motions() and "apparent_gravity" in quantities()


def test_every_declaration_is_filled_in():
    for word, declared in APPROXIMATIONS.items():
        assert isinstance(declared, Approximation)
        assert declared.id == word
        assert all((declared.title, declared.where, declared.drops)), word
    assert all(isinstance(APPROXIMATIONS[word], Motion) for word in motions())
    assert all(isinstance(APPROXIMATIONS[word], Quantity) for word in quantities())


def test_an_unknown_word_is_answered_with_those_most_like_it():
    with pytest.raises(InputError, match=r"Did you mean linear_g or linear_3d\?"):
        APPROXIMATIONS["linear"]


def test_the_bits_of_the_papers_program_name_motions():
    truncations = [motion for motion in mathar.APPROXIMATIONS if "item" in motion.id]
    word_of = {motion.path.keywords["items"]: motion.id for motion in truncations}
    names = [word_of[items] for items in ITEMS if items]
    assert names == ["mathar_item_2", "mathar_item_1", "mathar_items_1_2"]


@pytest.mark.long  # three million steps
def test_a_motion_that_comes_to_the_horizontal_comes_to_an_end():
    # without a limit it takes smaller and smaller steps for ever
    scene = load_scene("weightless").with_values(["site.latitude=60"])
    with pytest.raises(IntegrationError, match="only until the bob comes to the horizontal"):
        APPROXIMATIONS["mathar_item_3"].trajectory(scene, [0.0, 60.0])


@pytest.mark.parametrize(
    ("word", "change", "reason"),
    [
        ("linear_g", "pendulum.drag=0.1", "drag"),
        ("linear_g", "site.gravity=0", "gravity"),
        ("linear_anharmonic", "release.vx=1", "at rest"),
        ("gastebois_6_3", "release.vy=1", "at rest"),
        ("planar", "release.vx=1", "velocity"),
        ("conical", "release.vx=1", "circle"),
        ("precession_sine", "site.latitude=0", "turn"),
        ("rest_series_1", "site.latitude=-90", "pole"),
        ("frequency_harmonic", "site.gravity=0", "gravity"),
    ],
)
def test_a_scene_outside_the_domain_is_refused_with_the_reason(word, change, reason):
    declared, scene = APPROXIMATIONS[word], PARIS.with_values([change])
    with pytest.raises(InputError, match=reason) as refused:
        declared.trajectory(scene, [0.0, 1.0]) if isinstance(declared, Motion) else declared.value(
            scene
        )
    assert word in str(refused.value)


@pytest.mark.parametrize(
    "word", ["linear_g", "mathar_item_1", "linear_3d", "gastebois_6_1", "conical"]
)
def test_above_the_suspension_the_plane_forms_say_so(word):
    with pytest.raises(InputError, match="below the suspension"):
        APPROXIMATIONS[word].trajectory(load_scene("two_radians"), [0.0])


@pytest.mark.parametrize("times", [[], [-1.0, 0.0], [0.0, 0.0], [[0.0]], [0.0, float("nan")]])
def test_times_must_increase_from_zero_or_later(times):
    with pytest.raises(InputError, match="increasing"):
        APPROXIMATIONS["linear_g"].trajectory(PARIS, times)


def test_a_motion_that_leaves_the_sphere_gives_no_numbers():
    thrown = PARIS.with_values(["release.vx=40"])
    with pytest.raises(UnreachableError, match="sphere"):
        APPROXIMATIONS["linear_g"].trajectory(thrown, np.linspace(0.0, 20.0, 50))
    with pytest.raises(UnreachableError, match="horizontal"):
        APPROXIMATIONS["mathar_item_1"].trajectory(thrown, np.linspace(0.0, 20.0, 50))


def test_gravity_that_the_centrifugal_force_cancels_leaves_no_triangle_of_forces():
    with pytest.raises(InputError, match=r"rest_triangle.*cancel"):
        APPROXIMATIONS["rest_triangle"].value(load_scene("weightless"))


def test_gravity_that_the_centrifugal_force_cancels_leaves_no_swing():
    with pytest.raises(UnreachableError, match="cancel"):
        APPROXIMATIONS["linear_apparent"].trajectory(load_scene("weightless"), [0.0, 1.0])
