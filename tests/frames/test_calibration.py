import pytest

from pounding import frames
from pounding.frames.calibration import joint_stiffness, with_joint_stiffness
from pounding.frames.errors import FrameError

COARSE = frames.Density(0.05, 2, 4)


@pytest.mark.parametrize("name", ["5A", "5B", "10", "15A", "15B"])
@pytest.mark.parametrize("calibration", ["free_vibration", "sweep"])
def test_shipped_joints_give_the_first_frequency_they_were_fitted_to(name, calibration):
    frame = frames.load(name)
    known = frame.published
    first = known.free_vibration_hz if calibration == "free_vibration" else known.sweep_hz[0]
    reduced = frames.build(frame, calibration=calibration)
    assert reduced.frequencies_hz[0] == pytest.approx(first, rel=2e-5)


@pytest.mark.parametrize("name", ["8", "12"])
def test_frames_of_section_7_4_are_fitted_to_their_stated_frequency(name):
    frame = frames.load(name)
    assert frames.build(frame).frequencies_hz[0] == pytest.approx(frame.published.numerical_hz[0], rel=2e-5)


@pytest.mark.parametrize("start", [20.0, 5e4])
def test_fit_finds_the_joints_again_wherever_it_begins(start):
    frame = frames.load("5A")
    first = frames.build(frame, density=COARSE).frequencies_hz[0]
    found = joint_stiffness(with_joint_stiffness(frame, start), first, density=COARSE)
    assert found == pytest.approx(frame.joint_stiffness(), rel=1e-3)


def test_the_default_is_the_free_vibration():
    for name in ("5A", "5B", "10", "15A", "15B"):
        assert frames.load(name).joints.default == "free_vibration"


def test_stiff_joints_are_rigid_joints():
    frame = frames.load("5A")
    stiff = frames.build(with_joint_stiffness(frame, 1e9), density=COARSE)
    rigid = frames.build(frame, joints="rigid", density=COARSE)
    assert stiff.frequencies_hz[:5] == pytest.approx(rigid.frequencies_hz[:5], rel=1e-4)


@pytest.mark.parametrize(
    ("first", "sentence"), [(9.5, "above the 8.* Hz of rigid joints"), (0.3, "hinged|buckles")]
)
def test_a_frequency_out_of_reach_is_said(first, sentence):
    with pytest.raises(FrameError, match=sentence):
        joint_stiffness(frames.load("5A"), first, density=COARSE)
