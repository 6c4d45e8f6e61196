"""States of the frames, the lattice of models, and what a model that was fitted to peaks foretells."""

import numpy as np
import pytest

from pounding.experiments.records import RECORDS
from pounding.experiments.rig.states import first_frequency
from pounding.experiments.studies import foretold, peak_lattice
from pounding.experiments.studies.averaged_peaks import averaged, averaged_errors, weighted_median
from pounding.experiments.studies.frame_states import (
    TWO_STATES,
    Setting,
    displacements,
    in_state,
)
from pounding.experiments.studies.held_out import picked_inside, split_errors
from pounding.experiments.studies.missing_in_the_thesis import freedoms
from pounding.experiments.studies.peak_lattice import FRAMES, Freedom, PeakLattice
from pounding.experiments.studies.table_4_1 import BLIND, predict, score, table_motion, trusted
from pounding.frames.response.exact import linear_response

ALL = range(len(RECORDS))


@pytest.fixture(scope="module")
def lattice():
    """A lattice with few frequencies and damping ratios, which takes seconds instead of minutes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(peak_lattice, "FREQUENCIES", np.array([0.85, 0.95, 1.0, 1.05, 1.13]))
        patch.setattr(peak_lattice, "RATIOS", (None, 0.01, 0.02))
        yield PeakLattice()


def test_states_are_the_printed_first_frequencies():
    printed = [first_frequency("15B", state) for state in ("free vibration", "sweep", "unequal pair")]
    assert printed == [2.28, 2.113, 2.29]
    assert first_frequency("5B", "unequal pair") == 6.96
    assert first_frequency("10", "unequal pair") == 3.53


def test_a_frame_in_a_state_has_its_frequency_and_damping_and_moves_as_its_modes_do():
    setting, motion = Setting(damping=0.013, factor=0.98), table_motion("elcentro", BLIND)
    frame = in_state("5B", "sweep", setting)
    assert frame.frequencies_hz[0] == pytest.approx(0.98 * 6.43)
    assert frame.damping_ratio == pytest.approx(0.013)
    roof, _ = linear_response(frame, motion.acceleration_m_s2, motion.step_s, outputs=[int(frame.floor_x[4])])
    few = displacements("5B", [5], motion, 0.98 * 6.43, 0.013)
    assert np.abs(few).max() == pytest.approx(np.abs(roof).max(), rel=1e-3)


def test_the_lattice_without_any_freedom_is_the_baseline_model(lattice):
    blind = score(predict(BLIND), trusted()).mean
    assert lattice.fit(Freedom(), ALL).error == pytest.approx(blind, abs=0.002)


@pytest.mark.parametrize("states", ["fitted", tuple(TWO_STATES.items())])
def test_a_hidden_model_of_the_lattice_is_found(lattice, states, monkeypatch):
    truth = {name: 0.85 * lattice.peaks(name, TWO_STATES[name], 0.98)[..., 2] for name in FRAMES}
    monkeypatch.setattr(lattice, "measured", truth)
    lattice.__dict__.pop("errors", None)
    found = lattice.fit(Freedom(("damping", "factor", "gain"), states), ALL)
    lattice.__dict__.pop("errors", None)
    assert found.error < 1e-9
    assert (found.setting.damping, found.setting.factor) == (0.02, pytest.approx(0.98))
    assert found.setting.gain == pytest.approx(0.85)
    assert found.states == TWO_STATES


def test_what_is_held_out_takes_no_part_in_the_fit(lattice, monkeypatch):
    freedom = Freedom(("gain",))
    before = lattice.fit(freedom, [0, 1])
    changed = {name: peaks.copy() for name, peaks in lattice.measured.items()}
    for peaks in changed.values():
        peaks[:, 2:] *= 3.0
    monkeypatch.setattr(lattice, "measured", changed)
    lattice.__dict__.pop("errors", None)
    after = lattice.fit(freedom, [0, 1])
    errors = split_errors(lattice, freedom, 2, every=False)
    lattice.__dict__.pop("errors", None)
    assert after == before
    assert len(errors) == 6
    assert max(errors) > 0.5


def test_the_model_picked_inside_a_split_is_one_of_those_offered(lattice):
    offered = [Freedom(), Freedom(("gain",))]
    error, picked = picked_inside([(lattice, one) for one in offered])
    assert len(picked) == 6
    assert set(picked) <= set(offered)
    assert 0.05 < error < 0.3


def test_a_weighted_median_has_half_of_the_weight_on_each_side():
    values = np.array([[3.0, 1.0], [1.0, 2.0], [2.0, 9.0]])
    assert weighted_median(values, np.array([0.6, 0.3, 0.1])).tolist() == [3.0, 1.0]
    assert weighted_median(values, np.array([0.2, 0.3, 0.5])).tolist() == [2.0, 2.0]


def test_the_average_of_all_models_is_the_hidden_one_where_the_fitted_peaks_tell_it(lattice, monkeypatch):
    rng = np.random.default_rng(2)
    truth = {name: 0.85 * lattice.peaks(name, TWO_STATES[name], 0.98)[..., 2] for name in FRAMES}
    noisy = {name: peaks * (1 + 0.01 * rng.standard_normal(peaks.shape)) for name, peaks in truth.items()}
    monkeypatch.setattr(lattice, "measured", noisy)
    lattice.__dict__.pop("errors", None)
    errors = averaged_errors([lattice], 2)
    before = averaged([lattice], [0, 1])
    changed = {name: peaks.copy() for name, peaks in noisy.items()}
    for peaks in changed.values():
        peaks[:, 2:] *= 3.0
    monkeypatch.setattr(lattice, "measured", changed)
    lattice.__dict__.pop("errors", None)
    after = averaged([lattice], [0, 1])
    lattice.__dict__.pop("errors", None)
    assert len(errors) == 6
    assert max(errors) < 0.015
    assert all(np.array_equal(before[name], after[name]) for name in FRAMES)


def test_every_model_is_named_and_those_with_states_chosen_beforehand_say_so():
    models = freedoms()
    assert len(models) == 24
    assert models["baseline"] == Freedom()
    assert all(("beforehand" in name) == (not isinstance(one.states, str)) for name, one in models.items())


def test_a_pair_as_tall_stands_in_the_state_of_the_sweep():
    assert foretold.by_configuration("15A", "15B") == ("sweep", "sweep")
    assert foretold.by_configuration("15B", "5B") == ("unequal pair", "unequal pair")


@pytest.mark.slow
def test_the_baseline_model_foretells_the_gaps_and_impacts_that_the_chapters_have():
    motions = {name: table_motion(name, BLIND) for name in RECORDS}
    gaps = foretold.gaps(Setting(), lambda left, right: ("free vibration", "free vibration"), motions)
    assert foretold.mean_error(gaps, "equation_4_1_mm") == pytest.approx(0.237, abs=0.002)
    counts = foretold.counts(Setting(), lambda left, right: ("free vibration", "free vibration"))
    assert (counts["ours"].sum(), counts["counted"].sum()) == (53, 40)
    assert foretold.sum_of_differences(counts) == 45
