import numpy as np
import pytest

from pounding.experiments.rig.shaking import largest_drift, shake, validity
from pounding.frames import FrameError
from pounding.frames.response.exact import linear_response, refine
from pounding.frames.response.stress import largest_stress


def test_peaks_are_those_of_the_exact_solution(shaken_plate):
    reduced, record = shaken_plate.reduced, shaken_plate.record
    # Refined, because a peak may lie between two samples of the record.
    displacement, _ = linear_response(reduced, refine(record.acceleration_m_s2, 8), record.step_s / 8)
    for peak in shaken_plate.result()["peaks"]:
        floor = displacement[:, reduced.floor_x[peak["floor"] - 1]]
        # 1e-3 is what the engine promises.
        assert peak["max_mm"] == pytest.approx(1e3 * floor.max(), rel=1e-3)
        assert peak["min_mm"] == pytest.approx(-1e3 * floor.min(), rel=1e-3)


def test_the_stress_is_that_of_the_exact_motion(shaken_plate):
    reduced, record = shaken_plate.reduced, shaken_plate.record
    displacement, _ = linear_response(reduced, refine(record.acceleration_m_s2, 8), record.step_s / 8)
    expected = largest_stress(reduced, displacement)
    assert shaken_plate.stress.stress_pa == pytest.approx(expected.stress_pa, rel=5e-3)
    # The columns at x = -200 and 200 mm are stressed alike.
    assert shaken_plate.stress.place.partition(", ")[2] == expected.place.partition(", ")[2]


def test_result_has_the_keys_that_are_promised(shaken_plate, shaken_stick):
    result = shaken_plate.result()
    keys = {"frame", "record", "pga_g", "damping_ratio", "peaks", "max_stress_mpa", "wall_s", "model_s"}
    assert keys <= set(result)
    assert set(result["peaks"][0]) == {
        "floor",
        "max_mm",
        "min_mm",
        "max_acceleration_g",
        "drift_mm",
        "drift_percent",
    }
    assert [peak["floor"] for peak in result["peaks"]] == [1, 2, 3, 4, 5]
    assert result["pga_g"] == pytest.approx(0.3)
    assert result["damping_ratio"] == 0.00664
    assert result["model_s"] == pytest.approx(399 * 0.0036)
    assert result["wall_s"] > 0.0
    assert shaken_stick.result()["max_stress_mpa"] is None


def test_a_linear_model_scales(plate, noise, shaken_plate):
    double = shake(plate, noise(peak_g=0.6)).result()
    single = shaken_plate.result()
    assert double["max_stress_mpa"] == pytest.approx(2 * single["max_stress_mpa"], rel=1e-3)
    assert double["peaks"][-1]["max_mm"] == pytest.approx(2 * single["peaks"][-1]["max_mm"], rel=1e-3)


def test_no_warning_at_a_small_amplitude_and_both_at_a_large_one(plate, noise, shaken_plate):
    assert shaken_plate.warnings == []
    warnings = shake(plate, noise(peak_g=8.0)).warnings
    assert len(warnings) == 2
    assert "above the yield stress of 280 MPa" in warnings[0]
    assert "of its height" in warnings[1]


def test_warnings_begin_at_their_limits(shaken_plate):
    moved = shaken_plate.motion.frames[0]
    drift, _, _ = largest_drift(moved)
    stress = shaken_plate.stress
    at_yield = stress._replace(stress_pa=280e6)
    assert len(validity(moved, at_yield)) == 1
    assert validity(moved, stress._replace(stress_pa=279e6)) == []
    assert drift < 0.05


@pytest.mark.parametrize(
    ("samples", "words"), [([0.0, np.nan, 1.0], "sample 1 is nan"), ([0.0], "two samples")]
)
def test_a_record_that_cannot_be_followed_is_told(stick, noise, samples, words):
    record = noise()
    object.__setattr__(record, "acceleration_m_s2", np.array(samples))
    with pytest.raises(FrameError, match=words):
        shake(stick, record)
