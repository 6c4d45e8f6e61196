"""Thesis, Table 4.1 (p. 71): 64 measured peak displacements of frames that shake alone.

The model is the baseline model: fixed, and committed, before the first comparison. What is asserted are the
errors that this first comparison found, with little room, so that a change of the model that makes them worse
fails. They are large, and docs/validation/table-4-1.md says so: no bound here claims that the model is good.
"""

import numpy as np
import pytest

from pounding.experiments.records import RECORDS
from pounding.experiments.rig.rig import Rig
from pounding.experiments.studies import table_4_1
from pounding.experiments.studies.table_4_1 import BLIND, Variant

ROOM = 0.005
"""Half a percentage point: a frequency that moves by 0.1 % moves the mean errors by 0.1 to 0.3 points."""


@pytest.fixture(scope="module")
def blind(test_records):
    return table_4_1.predict(BLIND, test_records)


def test_the_blind_model_is_what_was_committed_before_the_first_comparison():
    assert Variant("free_vibration", True, "3.7", 1, None) == BLIND
    assert table_4_1.variants()[0] == BLIND
    assert len(table_4_1.variants()) == len(set(table_4_1.variants())) == 24


def test_sap2000_as_printed_is_9_5_percent_off():
    # recomputed from the printed numbers alone
    assert table_4_1.score(table_4_1.measured("numerical")).mean == pytest.approx(0.095, abs=5e-4)


def test_contested_peaks_follow_from_the_rules():
    trusted = table_4_1.trusted()
    doubtful = [
        (place, record)
        for place in trusted.place.values
        for record in trusted.record.values
        if not trusted.sel(place=place, record=record)
    ]
    assert doubtful == [(f"15B floor {floor}", "hachinohe") for floor in (15, 10, 5)]


def test_mean_error_of_all_64_peaks(blind):
    found = table_4_1.score(blind)
    assert found.count == 64
    assert found.mean < 0.239 + ROOM
    assert found.worst < 0.790 + 2 * ROOM  # a single peak, 5B under El Centro near resonance


def test_mean_error_without_the_contested_peaks(blind):
    found = table_4_1.score(blind, table_4_1.trusted())
    assert found.count == 58
    assert found.mean < 0.219 + ROOM
    # the model moves more than the frames did: free-vibration damping lets resonance build up
    assert 0.10 < found.bias < 0.152 + ROOM


@pytest.mark.parametrize(
    ("state", "mean", "uncontested"),
    [
        pytest.param("free-vibration", 0.239, 0.219, id="free vibration, blind"),
        pytest.param("strong-motion", 0.115, 0.120, id="strong motion, damping fitted to this table"),
    ],
)
def test_mean_error_in_each_state(state, mean, uncontested, test_records):
    found = table_4_1.predict_in(state, test_records)
    assert table_4_1.score(found).mean == pytest.approx(mean, abs=ROOM)
    assert table_4_1.score(found, table_4_1.trusted()).mean == pytest.approx(uncontested, abs=ROOM)


@pytest.mark.parametrize(
    ("place", "mean"),
    [
        ("15A floor 15", 0.166),
        ("15B floor 15", 0.271),
        ("15B floor 10", 0.157),
        ("15B floor 5", 0.149),
        ("10 floor 10", 0.332),
        ("10 floor 5", 0.135),
        ("5A floor 5", 0.058),
        ("5B floor 5", 0.464),
    ],
)
def test_mean_error_at_each_place(place, mean, blind):
    error = abs(table_4_1.errors(blind)).where(table_4_1.trusted()).sel(place=place)
    # eight or six peaks: room for two of them to move by 4 %
    assert float(error.mean()) < mean + 2 * ROOM


def test_the_frequency_decides_15b_under_hachinohe(blind, test_records):
    # Thesis, Table 4.3 (p. 88), was computed from 17.2 mm at the roof, Table 4.1 prints 33.8 mm. The model
    # takes no side: it is near the former with the frequency of free vibration, near the latter with the
    # sweep's.
    swept = table_4_1.predict(Variant("sweep"), test_records)
    free, sweep = (
        float(found.sel(place="15B floor 15", record="hachinohe").max()) for found in (blind, swept)
    )
    assert free / 17.2 == pytest.approx(1.0, abs=0.20)
    assert sweep / 33.8 == pytest.approx(1.0, abs=0.10)


def test_the_engine_finds_the_peaks_of_the_exact_response(test_records):
    reduced = table_4_1.build("5B", BLIND)
    motion = table_4_1.table_motion("kobe", BLIND, test_records).trimmed(lower=0.0, upper=0.7)
    exact = table_4_1.floor_peaks(reduced, motion, [5, 3])
    run = Rig([reduced]).run(motion).frames[0]
    engine = {entry["floor"]: (entry["max_mm"], entry["min_mm"]) for entry in run.peaks()}
    # tolerances of the integrator of 1e-6 over 40 periods, and peaks between two of its steps of up to 0.5 ms
    np.testing.assert_allclose([engine[5], engine[3]], exact, rtol=2e-3)


def test_peaks_scale_with_the_records(test_records):
    other = table_4_1.predict(Variant(peaks="7.1"), test_records)
    ratio = (other / table_4_1.predict(BLIND, test_records)).mean(("place", "side"))
    expected = [0.349 / 0.34844, 0.24 / 0.22944, 0.849 / 0.84306, 0.675 / 0.83394]
    np.testing.assert_allclose(ratio.sel(record=list(RECORDS)), expected, rtol=1e-4)


def test_noise_that_both_sides_of_a_floor_share_is_left_out():
    truth = table_4_1.measured()
    rng = np.random.default_rng(1)
    shared = 1.0 + 0.3 * rng.random((truth.sizes["place"], truth.sizes["record"], 1))
    assert table_4_1.noise_of_sides(truth * shared, truth, table_4_1.trusted()) == pytest.approx(
        0.0, abs=1e-12
    )
    # 29 ratios tell the mean size of a normal error, 0.8 sd, within 14 % (one standard error).
    noisy = truth * np.exp(0.1 * rng.standard_normal(truth.shape))
    found = table_4_1.noise_of_sides(noisy, truth, table_4_1.trusted())
    assert found == pytest.approx(0.1 * np.sqrt(2.0 / np.pi), rel=0.3)


def test_the_noise_of_the_measured_peaks_is_at_most_7_to_9_percent(blind, test_records):
    strong = table_4_1.predict_in("strong-motion", test_records)
    models = (table_4_1.measured("numerical"), strong, blind)
    found = [table_4_1.noise_of_sides(one, table_4_1.measured(), table_4_1.trusted()) for one in models]
    assert found == pytest.approx([0.072, 0.080, 0.088], abs=ROOM)


def test_polarity_swaps_the_sides(blind, test_records):
    turned = table_4_1.predict(Variant(polarity=-1), test_records)
    np.testing.assert_allclose(turned.sel(side="max"), blind.sel(side="min"), rtol=1e-12)
