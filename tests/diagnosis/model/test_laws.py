"""Laws: one function for the compiled loop, for series, and for Python; a memory that only real motion changes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pounding.calling import MEMORY, called
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.storey import StoreyEffect
from pounding.experiments.rig.laws import Law, filled
from pounding.experiments.rig.storey_forces import PRESSED_M, damper, friction, stop, yielding

LAWS = {
    one.law.function.__name__: one.law
    for one in kinds()
    if issubclass(one, StoreyEffect) and hasattr(one, "law")
}
PARAMETERS = {
    "friction": (20.0, 9e5, 300.0, 0.1),
    "yielding": (30.0, 3e4, 8.0, 0.6),
    "growing_spring": (5e4, 4.0),
    "stop": (-1e-3, 6e4, 3.0, 0.2, 0.7),
    "cubic_spring": (4e8,),
    "damper": (40.0, 0.4, 0.02),
    "bristles": (20.0, 2e-4),
}
metres = st.floats(-0.01, 0.01)


def test_every_law_of_the_catalogue_is_tried_here() -> None:
    assert set(LAWS) == set(PARAMETERS)


@pytest.mark.parametrize("name", LAWS)
@given(before=metres, d=metres, v=st.floats(-1.0, 1.0), t=st.floats(0.0, 4.0))
@settings(max_examples=50, deadline=None)
def test_the_compiled_function_is_the_python_one(
    name: str, before: float, d: float, v: float, t: float
) -> None:
    law, p = LAWS[name], filled(PARAMETERS[name], 4.0)
    state, new = np.zeros(MEMORY), np.zeros(MEMORY)
    called(law.address, p, state, before, v, t, state_after := np.zeros(MEMORY))
    kept = state_after.copy()
    force = called(law.address, p, state_after, d, v, t, new)
    in_python = [0.0] * MEMORY
    assert force == pytest.approx(law.function(list(p), list(kept), d, v, t, in_python), rel=1e-12, abs=1e-12)
    assert list(new) == pytest.approx(in_python, rel=1e-12, abs=1e-12)
    # What was remembered stays as it was: a step may be tried and taken back.
    assert (state_after == kept).all()
    assert (p == filled(PARAMETERS[name], 4.0)).all()
    assert law.remembers or not new.any()


@pytest.mark.parametrize("name", LAWS)
def test_a_motion_that_stays_changes_no_memory(name: str) -> None:
    law, p = LAWS[name], filled(PARAMETERS[name], 4.0)
    first, again = np.zeros(MEMORY), np.zeros(MEMORY)
    called(law.address, p, np.zeros(MEMORY), 1e-3, 0.1, 1.0, first)
    called(law.address, p, first, 1e-3, 0.1, 1.0, again)
    assert (again == first).all()


def test_friction_sticks_then_slides_at_its_force() -> None:
    drift = np.linspace(0.0, 1e-3, 201)
    force = friction.along((10.0, 1e5, 0.0, np.inf), drift, np.zeros(201), drift)
    assert force == pytest.approx(np.minimum(1e5 * drift, 10.0))


def test_friction_that_fades_has_lost_half_of_itself_at_its_rate() -> None:
    drift, rate = np.linspace(0.0, 1e-3, 11), np.full(11, 0.2)
    plain = friction.along((10.0, 1e5, 0.0, np.inf), drift, rate, drift)
    faded = friction.along((10.0, 1e5, 0.0, 0.2), drift, rate, drift)
    assert faded == pytest.approx(plain / 2)


@pytest.mark.parametrize("beyond", [-0.5, 0.0, 0.7])
def test_a_damper_of_any_power_has_no_force_at_rest_and_its_own_at_the_usual_rate(beyond: float) -> None:
    rate = np.array([-0.02, -1e-12, 0.0, 1e-12, 0.02])
    force = damper.along((40.0, beyond, 0.02), np.zeros(5), rate, np.arange(5.0))
    assert np.isfinite(force).all()
    assert force[2] == 0.0
    assert force[[0, 4]] == pytest.approx([-0.8, 0.8])


def test_a_stop_beside_a_dashpot_pushes_at_once_and_never_pulls() -> None:
    """k d + c v while it is pressed (Kelvin and Voigt), c being k times loss times `PRESSED_M`; other losses begin at 0."""
    depth, numbers = np.array([1e-9, 5e-4, 5e-4, 5e-4]), (1e-3, 2e4, 4.0, 0.0)
    rate = np.array([0.1, 0.1, -0.1, -10.0])
    force = stop.along((*numbers, 1.0), 1e-3 + depth, rate, np.arange(4.0))
    assert force == pytest.approx(np.maximum(2e4 * depth + 2e4 * 4.0 * PRESSED_M * rate, 0.0), abs=1e-6)
    assert stop.along((*numbers, 0.0), 1e-3 + depth, rate, np.arange(4.0))[0] == pytest.approx(0.0, abs=1e-4)


def test_what_yields_unloads_elastically_or_rounds_from_where_it_turns() -> None:
    """Masing's rule: the way back is the first way at twice its size, here from near the yield force to its opposite."""
    drift = np.concatenate([np.linspace(0.0, 4e-3, 4001), np.linspace(4e-3, -4e-3, 8001)[1:]])
    for unloading, doubled in ((0.0, False), (1.0, True)):
        force = yielding.along((30.0, 3e4, 2.0, unloading), drift, np.zeros_like(drift), drift) + 3e4 * drift
        first, back = force[:4001], (force[4000] - force[4000:]) / 2.0
        assert force[4000] == pytest.approx(30.0, rel=0.01)
        assert np.allclose(back[::2], first, atol=0.3) == doubled
        assert force[4000] - force[4010] == pytest.approx(3e4 * 1e-5, rel=0.03)


def test_a_part_that_yields_lacks_nothing_of_small_drifts_and_loses_energy_in_large_ones() -> None:
    phase = np.linspace(0, 4 * np.pi, 4001)
    for largest, loses in ((2e-4, False), (3e-3, True)):
        drift = largest * np.sin(phase)
        force = yielding.along((30.0, 3e4, 8.0), drift, np.cos(phase), phase)
        lost = np.trapezoid(force[2000:], drift[2000:])
        # Ideally plastic it takes 4 F (X - F / k) a cycle, with a rounded knee a little less.
        ideal = 4 * 30.0 * (largest - 1e-3) if loses else 0.0
        assert lost == pytest.approx(ideal, rel=0.1, abs=1e-6)
        assert (np.abs(force).max() > 1.0) == loses


def test_a_stop_is_its_own_mirror() -> None:
    drift = np.linspace(-3e-3, 3e-3, 61)
    right = stop.along((1e-3, 2e4), drift, drift, drift)
    left = stop.along((-1e-3, 2e4), -drift, drift, drift)
    assert right == pytest.approx(-left)
    assert not right[drift <= 1e-3].any()
    assert right[-1] == pytest.approx(40.0)


@pytest.mark.parametrize("dashpot", [0.0, 1.0])
@pytest.mark.parametrize("rate", [0.2, -0.2])
def test_the_force_of_a_stop_over_a_step_is_the_mean_of_that_at_its_moments(
    dashpot: float, rate: float
) -> None:
    numbers, step = (1e-3, 2e4, 4.0, 0.0, dashpot), 1e-3
    moments = np.linspace(-step / 2, step / 2, 2001)
    for middle in (0.85e-3, 0.95e-3, 1.0e-3, 1.05e-3, 1.2e-3):
        drift = middle + rate * moments
        wanted = stop.along(numbers, drift, np.full(2001, rate), moments).mean()
        whole, still = filled(numbers, 1.0, step), np.zeros(MEMORY)
        assert stop.function(whole, still, middle, rate, 0.0, still) == pytest.approx(
            wanted, rel=2e-3, abs=2e-3
        )


def test_what_a_law_takes_for_the_end_of_a_run_is_filled_in() -> None:
    assert list(filled((2.0, float("nan")), 7.0)) == [2.0, 7.0, 0.0, 0.0, 0.0, 0.0]
    assert list(filled((2.0,), 7.0, 1e-3)) == [2.0, 0.0, 0.0, 0.0, 0.0, 1e-3]


def test_a_law_is_compiled_when_it_is_first_needed() -> None:
    def broken(p, state, d, v, t, new):  # type: ignore[no-untyped-def]
        return helper_that_is_not_there(d)  # type: ignore[name-defined]  # noqa: F821

    law = Law(broken, cache=False)
    with pytest.raises(Exception, match="helper_that_is_not_there"):
        law.compile()
