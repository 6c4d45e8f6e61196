import numpy as np
import pytest

from pounding import frames
from pounding.frames.errors import FrameError
from pounding.frames.response.stress import largest_stress, stress_map


@pytest.fixture(scope="module")
def portal():
    """One storey with rigid joints under a floor so thick that it does not bend."""
    frame = frames.load("5A")
    plate = frames.Plate(length_m=0.4, width_m=0.4, thickness_m=0.1)
    portal = frames.changed(frame, name="portal", storeys=1, plate=plate)
    return frames.build(portal, joints="rigid", p_delta=False)


def pushed(reduced):
    force = np.zeros(len(reduced.mass))
    force[reduced.floor_x[-1]] = 1.0
    q = np.linalg.solve(reduced.stiffness, force)
    return q / q[reduced.floor_x[-1]]


def test_stress_at_the_end_of_a_guided_column_is_that_of_beam_theory(portal):
    # sigma = E t / 2 * 6 delta / h^2 = 120 MPa a millimetre. A strip 20 times as wide as thick is stiffer
    # than a beam by up to 1 / (1 - nu^2), most at its clamped ends, and von Mises' stress lies below the
    # largest normal stress there by up to sqrt(1 - nu + nu^2): 0.89 to 1.10 of the beam's.
    stress = stress_map(portal).von_mises(1e-3 * pushed(portal))
    expected = 3.0 * 200e9 * 0.002 * 1e-3 / 0.1**2
    assert 0.93 * expected < stress.max() < 1.10 * expected


def one_shape(reduced, times):
    return 1e-3 * np.outer(np.sin(7.0 * times) * times, pushed(reduced))


def all_modes(reduced, times):
    """Return a motion of all modes at once."""
    rate = np.arange(1, len(reduced.mass) + 1)
    return 1e-3 * np.sin(np.outer(7.0 * times, rate) + rate) / rate**2 @ reduced.shapes.T


@pytest.mark.parametrize("moves", [one_shape, all_modes])
def test_the_largest_stress_of_a_motion_is_found_with_its_place_and_instant(portal, moves):
    motion = moves(portal, np.linspace(0.0, 1.0, 101))
    found = largest_stress(portal, motion)
    everything = np.array([stress_map(portal).von_mises(q) for q in motion])
    assert found.stress_pa == pytest.approx(everything.max(), rel=1e-12)
    assert found.instant == everything.max(axis=1).argmax()
    assert everything[found.instant, found.element] == pytest.approx(everything.max(), rel=1e-12)
    assert "column at x = " in found.place
    assert found.place.endswith("of storey 1")


def test_a_stick_has_no_stress():
    stick = frames.StickFrame(
        name="s", storeys=1, storey_height_m=0.2, floor_mass_kg=[5.0], damping_ratio=0.01, frequency_hz=[2.0]
    )
    with pytest.raises(FrameError, match="stick"):
        stress_map(frames.build(stick))
