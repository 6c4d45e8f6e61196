"""`[[storey_law]]` of a frame file: read, refused where it cannot be, and run alike by both solvers."""

from __future__ import annotations

import numpy as np
import pytest

from pounding import frames
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.exact import run_exact
from pounding.experiments.rig.frame_laws import STATED, frame_laws, parameters, statement
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.rig import Rig
from pounding.experiments.separation.gaps.gap import spread
from pounding.frames import FrameError
from pounding.frames.loading import parse
from pounding.frames.storey_laws import StatedLaw

STEP = 0.004
LAWS = {
    "friction": "storey = 2\nforce_n = 4\nsticking_stiffness_n_per_m = 5e4\nsticking_damping_n_s_per_m = 90",
    "dahl_friction": "storey = 1\nforce_n = 5\nbuild_up_mm = 0.3",
    "damper": "storey = 2\ndamping_n_s_per_m = 15\npower = 1.4\nat_m_per_s = 0.05",
    "quadratic_damper": "storey = 1\ndamping_n_s2_per_m2 = 90",
    "cubic": "storey = 1\nstiffness_n_per_m3 = 1e8",
    "hysteresis": "storey = 1\nyield_force_n = 6\nstiffness_n_per_m = 2.5e3\nsharpness = 4\nunloading = 0.2",
    "loosening": "storey = 2\nstiffness_change_n_per_m = -2e3\ndrift_shares = [-0.2, 1.0]",
    "bumper": "storey = 2\ngap_mm = -1.5\nstiffness_n_per_m = 1e4\nloss_s_per_m = 0.5\npower = 1.3\ndashpot = 0.8",
    "drag": "floor = 1\ncoefficient_n_s2_per_m2 = 40\npower = 1.8\nair_at_rest = 0.7",
}
LOOSENING = 'kind = "loosening"\nstorey = 2\nstiffness_change_n_per_m = -2e3\n'


def stick(*laws: str, more: str = "", name: str = "tower") -> frames.StickFrame:
    tables = "".join(f'[[storey_law]]\nkind = "{law}"\n{LAWS.get(law, "")}\n' for law in laws)
    frame = parse(
        f'kind = "stick"\nname = "{name}"\nstoreys = 2\nstorey_height_m = 0.1\nfloor_mass_kg = [6.0, 5.0]\n'
        f"storey_stiffness_n_per_m = [5e3, 4e3]\ndamping_ratio = 0.01\nscale = 1\n{tables}{more}",
        "tower.toml",
    )
    assert isinstance(frame, frames.StickFrame)
    return frame


def test_what_loosens_along_its_own_drift_is_the_storey_itself() -> None:
    both = (
        stick(more=f"[[storey_law]]\n{LOOSENING}drift_shares = {one}\n") for one in ("[0.0, 1.0]", "[0, 1]")
    )
    runs = [
        Rig([frames.build(one)]).run(motion(), solver="exact").frames[0].displacement_m[-1]
        for one in (*both, stick(more=f"[[storey_law]]\n{LOOSENING}"))
    ]
    np.testing.assert_array_equal(runs[0], runs[2])
    np.testing.assert_array_equal(runs[1], runs[2])


def motion(samples: int = 200) -> Record:
    time = STEP * np.arange(samples)
    return Record("sine", 3.0 * np.minimum(1.0, time / 0.3) * np.sin(2 * np.pi * 2.3 * time), STEP)


def test_every_kind_is_tried_here() -> None:
    assert set(LAWS) == {kind.__struct_config__.tag for kind in STATED}


@pytest.mark.parametrize("kind", LAWS)
def test_a_law_becomes_the_parameters_of_its_force_and_back(kind: str) -> None:
    (law,) = stick(kind).storey_law
    shares = getattr(law, "drift_shares", None)
    place = "floor" if kind == "drag" else "storey"
    in_room = getattr(law, "air_at_rest", 0.0)
    again = statement(STATED[type(law)].law, parameters(law), (place, getattr(law, place)), in_room, shares)
    assert type(again) is type(law)
    for key in law.__struct_fields__:
        expected: StatedLaw = getattr(law, key)
        assert getattr(again, key) == (None if expected is None else pytest.approx(expected, rel=1e-14))
    assert statement(STATED[type(law)].law, parameters(law), ("roof", 1), in_room) is None


@pytest.mark.parametrize("kind", LAWS)
def test_both_solvers_run_a_law_alike_and_close_the_energy(kind: str) -> None:
    reduced, record = frames.build(stick(kind)), motion()
    exudyn, exact = (Rig([reduced]).run(record, solver=solver) for solver in ("exudyn", "exact"))
    times = np.linspace(0.0, 0.999 * record.time_s[-1], 400)
    one, other = (run.frames[0].sampled(times)[0] for run in (exudyn, exact))
    linear = Rig([frames.build(stick())]).run(record, solver="exact").frames[0].sampled(times)[0]
    scale = np.abs(linear).max()
    assert np.abs(one - other).max() < 3e-4 * scale
    assert np.abs(other - linear).max() > 0.02 * scale
    assert exudyn.energy.error < 2e-5
    assert exact.energy.error < 1e-6
    assert np.abs(exact.energy.storey_j).max() > 0.0


def test_the_required_gap_of_a_frame_with_laws_is_that_of_its_run() -> None:
    left, right, record = (
        frames.build(stick("friction", "cubic")),
        frames.build(stick(name="other")),
        motion(),
    )
    gap = pair_gap(left, right, record)
    times = 1e-3 * np.arange(round(record.time_s[-1] / 1e-3) + 1)
    runs = [
        Rig([frame]).run(record).frames[0].sampled(times.clip(max=0.7959))[0][:, -1]
        for frame in (left, right)
    ]
    assert gap.closing_m == pytest.approx(float((runs[0] - runs[1]).max()), rel=2e-3)
    about = spread(left, right, record)
    assert about.low_mm <= 1e3 * gap.closing_m <= about.high_mm
    assert pair_gap(right, right, record).closing_m == 0.0


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ('kind = "friction"\nstorey = 3', "the key force_n is missing; add it"),
        ('kind = "cubic"\nstorey = 3\nstiffness_n_per_m3 = 1', "storey_law 1: storey is 3, must be 1 to 2"),
        ('kind = "drag"\nfloor = 0\ncoefficient_n_s2_per_m2 = 1', "storey_law 1: floor is 0, must be 1 to 2"),
        ('kind = "damper"\nstorey = 1\ndamping_n_s_per_m = nan', "storey_law 1: damping_n_s_per_m is nan"),
        ('kind = "dahl_friction"\nstorey = 1\nforce_n = -2\nbuild_up_mm = 1', "force_n is -2; it must be"),
        ('kind = "rust"\nstorey = 1', "storey_law 1: kind is 'rust', must be one of friction, dahl_friction"),
        ('law = "friction"\nstorey = 1', "storey_law 1: kind is missing, must be one of friction, dahl_"),
        (
            f"{LOOSENING}drift_shares = [1.0]",
            "storey_law 1: drift_shares must have 2 numbers, one for each storey, and has 1",
        ),
        (f"{LOOSENING}drift_shares = [1.0, nan]", "storey_law 1: drift_shares is nan"),
        (
            f"{LOOSENING}drift_shares = [0.0, 0]",
            "storey_law 1: drift_shares are all 0, so that nothing loosens",
        ),
        (f'{LOOSENING}drift_shares = "own"', "drift_shares of storey_law 1: expected a list .*found a text"),
        (
            'kind = "cubic"\nstorey = 1\nstiffness = 1',
            "storey_law 1: 'stiffness' is not a key .*stiffness_n_per_m3",
        ),
    ],
)
def test_a_law_that_cannot_be_is_refused_in_a_sentence(law: str, said: str) -> None:
    with pytest.raises(FrameError, match=f"tower.toml: .*{said}"):
        stick(more=f"[[storey_law]]\n{law}\n")


def test_a_law_that_a_frame_states_is_refused_beside_it() -> None:
    tower = frames.build(stick("friction"))
    with pytest.raises(ExperimentError, match=r"frame tower states itself would act twice; leave it out"):
        run_exact([tower], [], np.ones(10), STEP, storeys=frame_laws([tower]))
    plain = frames.build(stick())
    once = run_exact([plain], [], np.ones(10), STEP, storeys=frame_laws([tower]))
    itself = run_exact([tower], [], np.ones(10), STEP)
    np.testing.assert_array_equal(once.frames[0].displacement_m, itself.frames[0].displacement_m)
