"""Laws in storeys by the exact solver: every law of the catalogue against exudyn, energies, and convergence."""

from __future__ import annotations

import dataclasses
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from pounding.calling import MEMORY, NUMBERS
from pounding.contact import thesis_law
from pounding.diagnosis.effects.bases import LawEffect
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.twin import _Addition, _between_samples
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import ExactRig, Solution, run_exact
from pounding.experiments.rig.laws import Law, filled
from pounding.experiments.rig.many import Case, run_one
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.rig import Accuracy, Rig
from pounding.experiments.rig.storey_forces import damper, friction
from pounding.experiments.rig.storeys import KnownForce, StoreyLaw
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.response.exact import linear_response
from tests.experiments.rig.test_exact import shear

STEP, END = 0.004, 1.6
TIME = np.arange(0.0, END + STEP / 2, STEP)
TABLE = 3.0 * np.sin(2 * np.pi * 2.1 * TIME) + 2.0 * np.sin(2 * np.pi * 6.4 * TIME)
TABLE *= np.minimum(1.0, TIME / 0.4)
TIGHT = Accuracy(1e-10, 1e-12, 5e-5)

LEFT, RIGHT = shear(3, 2.3), shear(2, 6.1)
SPRING = -float(LEFT.stiffness[0, 1])
STUCK = 2 * 0.3 * np.sqrt(15 * SPRING * 6.0 / 2)
DRIFT, FLOOR = np.array([-1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
"""The drift of the second storey; the displacement of the third floor."""
CONTACT = Contact(thesis_law("linear_viscoelastic", masses=(6.0, 6.0)), 0.004, 2)


class Placed(NamedTuple):
    """Parameters of a law in SI, the row on which it acts, and whether on the rate in the room."""

    parameters: tuple[float, ...]
    row: np.ndarray = DRIFT
    in_room: bool = False


PLACED = {
    "damper": Placed((20.0, 0.0, 1.0)),
    "friction": Placed((6.0, 15 * SPRING, STUCK, np.inf)),
    "cubic_spring": Placed((0.3 * SPRING / 0.004**2,)),
    "yielding": Placed((8.0, 0.5 * SPRING, 30.0)),
    "growing_spring": Placed((-0.4 * SPRING, np.nan)),
    "stop": Placed((0.002, 3 * SPRING)),
    "bristles": Placed((6.0, 3e-4)),
    "drag": Placed((8.0,), FLOOR, True),
}
LAWS = {
    kind.law.function.__name__: kind.law
    for kind in kinds()
    if issubclass(kind, LawEffect) and hasattr(kind, "law")
}


def storey(law: Law, placed: Placed) -> StoreyLaw:
    return StoreyLaw(
        law.address,
        placed.row,
        filled(placed.parameters, END),
        in_room=placed.in_room,
        remembers=law.remembers,
    )


def row_of(pair: bool) -> tuple[list[ReducedFrame], list[Contact]]:
    return ([LEFT, RIGHT], [CONTACT]) if pair else ([LEFT], [])


def exact(law: Law, placed: Placed, pair: bool) -> Motion:
    return run_exact(*row_of(pair), TABLE, STEP, storeys=[storey(law, placed)])


def engine(law: Law, placed: Placed, pair: bool) -> Motion:
    finer = STEP / 16
    at = np.arange(0.0, END + finer / 2, finer)
    table = np.interp(at, TIME, TABLE)
    rate = np.concatenate([[0.0], np.cumsum(0.5 * finer * (table[1:] + table[:-1]))])
    one = PlacedLaw(law, placed.row, placed.parameters, placed.in_room)
    addition = _Addition([one], END, _between_samples(rate, finer), None, STEP)
    frames, contacts = row_of(pair)
    return Rig(frames, contacts, additions=[addition]).run(TABLE, STEP, accuracy=TIGHT)


def peaks(motion: Motion) -> np.ndarray:
    return np.array(
        [peak[key] for one in motion.frames for peak in one.peaks() for key in ("max_mm", "min_mm")]
    )


def test_every_law_of_the_catalogue_is_tried_here() -> None:
    assert set(LAWS) == set(PLACED)


@pytest.mark.parametrize("pair", [False, True], ids=["alone", "pair"])
@pytest.mark.parametrize("name", PLACED)
def test_it_agrees_with_the_engine_for_every_law(name: str, pair: bool) -> None:
    found, reference = exact(LAWS[name], PLACED[name], pair), engine(LAWS[name], PLACED[name], pair)
    assert peaks(found) == pytest.approx(peaks(reference), rel=1e-4 if pair else 1e-5)
    for mine, other in zip(found.contacts, reference.contacts, strict=True):
        assert len(mine.touches[0]) == len(other.touches[0]) > 3
    # The law is no trifle, and its work is part of a balance that closes.
    plain = peaks(run_exact(*row_of(pair), TABLE, STEP))
    assert np.abs(peaks(found) / plain - 1.0).max() > 0.02
    assert found.energy.error < (1e-3 if pair else 1e-6)
    assert np.abs(found.energy.storey_j).max() > 1e-3 * found.energy.input_j.max()


def test_a_damper_as_a_law_is_a_damper_of_the_frame() -> None:
    """The one law whose response is a closed formula: that of a linear frame with another damping matrix."""
    damped = dataclasses.replace(LEFT, damping=LEFT.damping + 20.0 * np.outer(DRIFT, DRIFT))
    wanted, _ = linear_response(damped, TABLE, STEP)
    motion = exact(damper, PLACED["damper"], pair=False)
    found = motion.frames[0].sampled(TIME)[0]
    assert np.abs(found - wanted).max() < 1e-6 * np.abs(wanted).max()


def test_drag_sees_the_tables_velocity_and_takes_another_one_if_given() -> None:
    """A linear drag in the room is a damper to ground and a load by the table's velocity."""
    law = storey(damper, Placed((30.0,), FLOOR, in_room=True))
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (TABLE[1:] + TABLE[:-1]))])
    own = run_exact([LEFT], [], TABLE, STEP, storeys=[law])
    given = run_exact([LEFT], [], TABLE, STEP, storeys=[law], table_rate=velocity)
    still = run_exact([LEFT], [], TABLE, STEP, storeys=[law], table_rate=0.0 * velocity)
    in_frame = run_exact([LEFT], [], TABLE, STEP, storeys=[storey(damper, Placed((30.0,), FLOOR))])
    assert peaks(given) == pytest.approx(peaks(own), rel=1e-12)
    # The curve between the samples is the acceleration's, so that a still table is one at the samples only.
    assert peaks(still) == pytest.approx(peaks(in_frame), rel=1e-3)
    assert np.abs(peaks(own) / peaks(in_frame) - 1.0).max() > 0.05


def test_known_forces_that_are_the_tables_do_what_the_table_does() -> None:
    """The inertia of each floor as a known force on a frame whose table is still, and beside another that is shaken."""
    inertia = -TABLE[:, None] * (LEFT.mass @ LEFT.influence)
    forces = [KnownForce(row, force) for row, force in zip(np.eye(3), inertia.T, strict=True)]
    still = dataclasses.replace(LEFT, influence=0.0 * LEFT.influence)
    for pair in (False, True):
        frames, contacts = row_of(pair)
        wanted = run_exact(frames, contacts, TABLE, STEP)
        pushed = run_exact([still, *frames[1:]], contacts, TABLE, STEP, storeys=forces)
        assert peaks(pushed) == pytest.approx(peaks(wanted), rel=1e-4 if pair else 1e-8)
        assert pushed.energy.error < 1e-3
        assert pushed.energy.storey_j.min() < -0.1 * wanted.energy.input_j.max()
    later = [dataclasses.replace(one, force_n=one.force_n[:200]) for one in forces]
    free = run_exact([still], [], TABLE, STEP, storeys=later)
    assert np.abs(free.storeys[0].force_n[free.time_s > 200 * STEP]).max() == 0.0


def solved(law: Law, placed: Placed, **options: float) -> tuple[ExactRig, Solution]:
    rig = ExactRig([LEFT], [], [storey(law, placed)])
    return rig, rig.solve(TABLE, STEP, **options)


def roof(law: Law, placed: Placed, level: int) -> float:
    rig, solution = solved(law, placed, contact_level=level)
    return float(rig.coordinates(solution, 0, [2])[0][-1, 0])


@pytest.mark.parametrize(("name", "least"), [("cubic_spring", 3.8), ("drag", 2.5), ("yielding", 1.5)])
def test_halved_steps_converge(name: str, least: float) -> None:
    """Order four where the law is smooth, less where it has a kink or its memory is of order two."""
    law, placed = LAWS[name], PLACED[name]
    if name == "yielding":
        placed = Placed((8.0, 0.5 * SPRING, 2.0))
    wanted = roof(law, placed, 9)
    errors = [abs(roof(law, placed, level) - wanted) for level in (1, 2, 3, 4)]
    assert np.log2(errors[0] / errors[-1]) / 3.0 > least


@pytest.mark.parametrize("name", ["friction", "stop", "yielding"])
def test_the_error_control_copes_with_kinks(name: str) -> None:
    law, placed = LAWS[name], PLACED[name]
    shortest = roof(law, placed, 10)
    errors = []
    for tolerance in (1e-4, 1e-7):
        rig, solution = solved(law, placed, tolerance=tolerance)
        errors.append(abs(float(rig.coordinates(solution, 0, [2])[0][-1, 0]) / shortest - 1.0))
        steps = np.diff(solution.time_s)
        assert steps.max() > 8.0 * steps.min()
    assert errors[0] < 1e-3
    assert errors[1] < 1e-5


def test_a_contact_within_reach_is_not_stepped_over() -> None:
    """A law allows long steps; one whose force may close a gap must not be longer than the finest in flight."""
    law, stiff = storey(damper, Placed((2.0,))), shear(2, 60.0)
    free = run_exact([LEFT, stiff], [], TABLE, STEP, storeys=[law], longest_s=1e-4)
    at = np.linspace(0.0, END, 400_001)
    apart = free.frames[0].sampled(at)[0][:, 1] - free.frames[1].sampled(at)[0][:, 1]
    contacts = [dataclasses.replace(CONTACT, gap_m=float(apart.max()) - 2e-7)]
    rig = ExactRig([LEFT, stiff], contacts, [law])
    for longest in (STEP, 1e-4):
        solution = rig.solve(TABLE, STEP, longest_s=longest)
        touches = rig.motion(solution, (0.0, 0.0)).contacts[0].touches[0]
        assert len(touches) == 1
        assert touches[0] == pytest.approx(at[apart.argmax()], abs=1e-3)
        assert np.diff(solution.time_s).max() == pytest.approx(longest, rel=1e-6)


def test_what_a_law_remembers_at_the_start_counts() -> None:
    """Friction that is stretched at the start pulls the floors together at once."""
    law = storey(friction, PLACED["friction"])
    stretched = np.zeros(MEMORY)
    stretched[0] = 6.0
    still = 0.0 * TABLE[:100]
    still[-1] = 1e-9
    quiet = run_exact([LEFT], [], still, STEP, storeys=[law])
    pulled = run_exact([LEFT], [], still, STEP, storeys=[dataclasses.replace(law, memory=stretched)])
    assert np.abs(quiet.frames[0].displacement_m).max() < 1e-9
    assert pulled.storeys[0].force_n[0] == 6.0
    at_once = pulled.frames[0].acceleration_m_s2[0]
    assert at_once == pytest.approx(-6.0 * np.linalg.solve(LEFT.mass, DRIFT), rel=1e-9)


def test_several_laws_and_many_runs() -> None:
    """Two laws in one frame are two connections; what is kept of a run shows the contacts' forces alone."""
    both = [storey(LAWS[name], PLACED[name]) for name in ("friction", "drag")]
    motion = run_exact([LEFT, RIGHT], [CONTACT], TABLE, STEP, storeys=both)
    assert [len(motion.contacts), len(motion.storeys)] == [1, 2]
    assert np.abs(motion.storeys[0].force_n).max() == pytest.approx(6.0, rel=1e-9)
    assert motion.energy.error < 1e-3
    plain = run_one(Case([LEFT, RIGHT], [CONTACT], TABLE, STEP))
    assert plain.peak_force_n.shape == (1,)


def test_a_law_that_a_frame_cannot_have_is_refused() -> None:
    law = storey(damper, PLACED["damper"])
    for changes, words in (
        ({"body": 1}, "frame 1, but there are 1"),
        ({"row": np.ones(4)}, "row of floors of .*give 3 numbers"),
        ({"parameters": np.ones(2)}, f"parameters.*give {NUMBERS}"),
        ({"memory": np.ones(1)}, f"memory.*give {MEMORY}"),
    ):
        with pytest.raises(ExperimentError, match=words):
            ExactRig([LEFT], [], [dataclasses.replace(law, **changes)])  # type: ignore[arg-type]


@lru_cache
def jumping() -> Law:
    """Friction that jumps with the rate: no step follows it."""

    def force(p, state, d, v, t, new):  # type: ignore[no-untyped-def]
        return p[0] if v > 0.0 else -p[0]

    return Law(force, cache=False)


def test_a_law_that_jumps_with_the_rate_is_said() -> None:
    with pytest.raises(ExperimentError, match="jump"):
        run_exact([LEFT], [], TABLE, STEP, storeys=[storey(jumping(), Placed((6.0,)))])


def test_a_step_through_a_turn_remembers_how_far_the_drift_went() -> None:
    """On long steps the force is that of the law along the drift between them, turns included."""
    rig, solution = solved(LAWS["bristles"], PLACED["bristles"], contact_level=0)
    history = rig.motion(solution, (0.0, 0.0)).storeys[0]
    finer = 200
    at = np.interp(
        np.arange(finer * (len(history.time_s) - 1) + 1) / finer,
        np.arange(len(history.time_s)),
        history.time_s,
    )
    drift = CubicHermiteSpline(history.time_s, history.drift_m, history.rate_m_s)(at)
    wanted = LAWS["bristles"].along(PLACED["bristles"].parameters, drift, 0.0 * at, at)[::finer]
    assert np.abs(history.force_n - wanted).max() < 2e-3 * np.abs(wanted).max()
