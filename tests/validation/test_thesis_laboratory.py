"""The two studies of this part run as a user runs them, and their numbers are what the docs claim."""

import json

import pytest

from pounding.experiments.studies import engine_accuracy, laboratory


@pytest.fixture(scope="module")
def engine():
    return engine_accuracy.main(names=["5A"], json=True)


def rows(result, integrator):
    return [row for row in result["integrators"] if row["integrator"] == integrator]


@pytest.mark.slow
def test_the_engine_meets_a_thousandth_with_what_the_rig_uses(engine):
    errors = [row["error"] for row in rows(engine, "DOPRI5, adaptive") + rows(engine, "RK44")]
    # 1e-3 is asked; 1e-5 is measured, and a hundredth of what is asked is what the docs state.
    assert max(errors) < 3e-5


@pytest.mark.slow
def test_second_order_integrators_gain_a_factor_of_four_when_the_step_is_halved(engine):
    for name in ("GeneralizedAlpha", "TrapezoidalIndex2"):
        coarse, fine = rows(engine, name)[-2:]
        assert coarse["longest_step_s"] == 2 * fine["longest_step_s"]
        # The steps meet the record's samples, so their ratio is 1.95 rather than 2.
        assert 3.0 < coarse["error"] / fine["error"] < 5.0


@pytest.mark.slow
def test_the_error_falls_with_the_tables_mass(engine):
    errors = {row["table_mass_kg"]: row["error"] for row in engine["table_masses"]}
    assert errors[1e6] / errors[1e7] == pytest.approx(10.0, rel=0.2)
    assert errors[1e9] < 1e-5


@pytest.mark.slow
def test_the_laboratorys_tests_give_back_what_was_put_in(tmp_path, capsys):
    result = laboratory.main(names=["5B"], out=tmp_path, json=True)
    assert json.loads(capsys.readouterr().out)["tests"][0]["frame"] == "5B"
    (test,) = result["tests"]
    assert test["push_n_per_mm"] == pytest.approx(test["model_roof_stiffness_n_per_mm"], rel=1e-9)
    assert test["free_vibration_hz"] == pytest.approx(test["model_hz"][0], rel=1e-4)
    assert test["free_vibration_damping_ratio"] == pytest.approx(0.00467, rel=2e-3)
    assert test["sweep_hz"] == pytest.approx(test["model_hz"], rel=1e-4)
    # Flanks of the neighbouring modes: 0.1 % of the third mode's damping.
    assert test["sweep_damping_ratio"] == pytest.approx([0.00467] * 3, rel=3e-3)
    errors = {
        (row["time_constants"], row["window"]): row["damping_error"] for row in result["record_lengths"]
    }
    assert errors[2.0, "boxcar"] > 0.5
    assert abs(errors[7.0, "boxcar"]) < 2e-3
    assert all(row["loudest_instant_error"] > 0.0 for row in result["sweep_rates"])
    assert all(abs(row["ratio_of_spectra_error"]) < 1e-4 for row in result["sweep_rates"])
    assert (tmp_path / "laboratory.png").is_file()
