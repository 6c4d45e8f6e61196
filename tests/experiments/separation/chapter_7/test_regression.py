"""Regressions against known answers, and the thesis' numbers that no regression can have given."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from pounding.experiments import published
from pounding.experiments.errors import ExperimentError
from pounding.experiments.separation.chapter_7 import regression
from pounding.experiments.separation.chapter_7.formulas import compare, with_spectra
from pounding.experiments.separation.chapter_7.parametric import EVENTS
from pounding.scale import THESIS


@pytest.fixture
def cases() -> pd.DataFrame:
    """Gaps that follow equation 7.7's form with noise of 1 mm, and an earthquake's own part."""
    rng = np.random.default_rng(11)
    count = 600
    made = pd.DataFrame(
        {
            "HT": rng.choice([1000.0, 1500.0], count),
            "HS": rng.choice([500.0, 1000.0], count),
            "E": rng.choice([0.35, 0.46, 0.52], count),
            "FT": rng.uniform(1.9, 3.5, count),
            "FS": rng.uniform(2.8, 7.0, count),
            "DT": rng.uniform(1.0, 5.0, count),
            "DS": rng.uniform(1.0, 5.0, count),
        }
    )
    made["ST"], made["SS"] = 0.0268 - 1.18e-5 * made["HT"], 0.0403 - 2.54e-5 * made["HS"]
    made["MT"], made["MS"] = rng.uniform(72.0, 160.0, count), rng.uniform(35.0, 112.0, count)
    made["event"] = made["E"].map({0.35: "a", 0.46: "b", 0.52: "c"})
    made["pair"] = made["HT"].astype(int).astype(str) + "-" + made["HS"].astype(int).astype(str)
    made["gap_mm"] = (
        16.0
        - 0.002 * made["HT"]
        + 0.008 * made["HS"]
        + 3.0 * made["E"]
        - 2.2 * made["FT"]
        - 0.24 * made["FS"]
        - 0.65 * made["DT"]
        - 0.91 * made["DS"]
        + rng.normal(0.0, 1.0, count)
    )
    return made


def test_known_coefficients_come_back(cases) -> None:
    table = regression.fit(cases, regression.WITHOUT_STIFFNESS_AND_MASS).table
    truth = {"HT": -0.002, "HS": 0.008, "E": 3.0, "FT": -2.2, "FS": -0.24, "DT": -0.65, "DS": -0.91}
    for symbol, value in truth.items():
        assert abs(table.loc[symbol, "coefficient"] - value) < 4.0 * table.loc[symbol, "standard_error"], (
            symbol
        )
    assert table.loc["DS", "p"] < 1e-50


def test_fit_is_least_squares(cases) -> None:
    fitted = regression.fit(cases, regression.WITHOUT_STIFFNESS_AND_MASS)
    design = regression.regressors(cases, regression.WITHOUT_STIFFNESS_AND_MASS).to_numpy(float)
    beta, residual, *_ = np.linalg.lstsq(design, cases["gap_mm"].to_numpy(), rcond=None)
    np.testing.assert_allclose(fitted.table["coefficient"], beta, rtol=1e-6)
    variance = residual[0] / (len(cases) - design.shape[1]) * np.linalg.inv(design.T @ design)
    np.testing.assert_allclose(fitted.table["standard_error"], np.sqrt(np.diag(variance)), rtol=1e-6)


def test_exact_combinations_are_left_out_and_named(cases) -> None:
    """Stiffness on a straight line of height, as in the high class (printed: 0.0, 65535, #NUM!)."""
    fitted = regression.fit(cases, regression.ALL)
    assert set(regression.ALL) - set(fitted.kept) == {"ST", "SS"}
    assert np.isnan(fitted.table.loc["SS", "coefficient"])
    assert np.isinf(regression.variance_inflation(cases, ("HS", "SS"))["SS"])


def test_square_of_the_acceleration(cases) -> None:
    made = regression.regressors(cases, ("E", "E2"))
    np.testing.assert_allclose(made["E2"], cases["E"] ** 2)
    with pytest.raises(ExperimentError, match="no column 'FT'"):
        regression.regressors(cases.drop(columns="FT"), ("FT",))


def test_too_few_cases_are_refused(cases) -> None:
    with pytest.raises(ExperimentError, match="cannot carry"):
        regression.fit(cases.head(8), regression.ALL)


def test_variance_inflation_of_two_correlated_regressors() -> None:
    rng = np.random.default_rng(5)
    x = rng.normal(size=4000)
    made = pd.DataFrame({"HT": x, "HS": 0.8 * x + 0.6 * rng.normal(size=4000)})
    found = regression.variance_inflation(made, ("HT", "HS"))
    assert found["HT"] == pytest.approx(1.0 / (1.0 - 0.8**2), rel=0.05)


def test_prediction_interval_covers_what_it_says(cases) -> None:
    by_row = regression.cross_validate(cases, regression.WITHOUT_STIFFNESS_AND_MASS, "row")
    assert by_row["cases"].sum() == len(cases)
    assert regression.pooled(by_row)["coverage"] == pytest.approx(0.95, abs=0.03)


def test_an_earthquake_of_its_own_is_found_by_events_and_not_by_rows(cases) -> None:
    strange = cases.assign(gap_mm=cases["gap_mm"] + 20.0 * (cases["event"] == "b"))
    model = regression.WITHOUT_STIFFNESS_AND_MASS
    by_row = regression.pooled(regression.cross_validate(strange, model, "row"))
    by_event = regression.pooled(regression.cross_validate(strange, model, "event"))
    assert by_event["mae_mm"] > 1.5 * by_row["mae_mm"]
    assert by_event["coverage"] < 0.5 < by_row["coverage"]


def test_only_one_event_cannot_be_held_out(cases) -> None:
    with pytest.raises(ExperimentError, match="only one event"):
        regression.cross_validate(cases[cases["event"] == "a"], ("HT",), "event")


def test_errors_of_7_11_and_7_12() -> None:
    found = regression.errors(np.array([10.0, 20.0]), np.array([12.0, 19.0]))
    assert found["mse_mm2"] == pytest.approx(2.5)
    assert found["mae_mm"] == pytest.approx(1.5)
    assert found["unsafe"] == 0.5
    assert found["mae_mm"] ** 2 <= found["mse_mm2"]


def test_six_printed_errors_are_impossible() -> None:
    """Section 7.4: an MSE cannot be below the square of its MAE."""
    found = regression.impossible(published.table("section 7.4"))
    assert sorted(found.index) == [
        ("eq 7.10", "10-8"),
        ("eq 7.5", "10-8"),
        ("eq 7.5", "12-8"),
        ("eq 7.7", "12-8"),
        ("eq 7.8", "12-8"),
        ("eq 7.9", "10-8"),
    ]
    assert regression.impossible(published.table("section 7.5")).empty


def test_p_values_that_are_not_those_of_their_t() -> None:
    """Table 7.12 prints 1.7E-36 for t = 35.94, which is E-236: an exponent has lost a digit."""
    found = regression.p_values_that_do_not_follow(published.table("7.12"), 3081)
    assert list(found.index) == ["constant", "E", "MS"]
    assert found.loc["E", "log10_p_of_t"] == pytest.approx(-235.7, abs=0.1)
    assert regression.p_values_that_do_not_follow(published.table("7.8"), 3081).empty


def test_spectral_formulas_know_what_the_peak_does_not(test_records) -> None:
    """Where the gap is the double difference itself, the spectra find it and the peak does not."""
    from pounding.experiments.records import find

    names = ["elcentro", "hachinohe", "northridge", "kobe"]
    records = {name: find(name, test_records).scaled(THESIS.time_factor) for name in names}
    rng = np.random.default_rng(2)
    made = pd.DataFrame({"record": rng.choice(names, 160)})
    made["FT"], made["FS"] = rng.uniform(1.9, 3.5, 160), rng.uniform(2.8, 7.0, 160)
    made["DT"], made["DS"] = rng.choice([1.0, 3.0], 160), rng.choice([1.0, 5.0], 160)
    made["HT"], made["HS"] = 1500.0, rng.choice([500.0, 1000.0], 160)
    made["E"] = made["record"].map({name: record.pga_g for name, record in records.items()})
    made["event"], made["pair"] = made["record"].map(EVENTS), made["HS"].astype(str)
    made["level"], made["gap_mm"] = "any", 1.0
    prepared = with_spectra(made, records)
    prepared["gap_mm"] = np.sqrt(
        prepared["spectral_tall_mm"] ** 2
        + prepared["spectral_short_mm"] ** 2
        - 2.0 * prepared["correlation"] * prepared["spectral_tall_mm"] * prepared["spectral_short_mm"]
    )
    prepared["log_gap"] = np.log(prepared["gap_mm"])
    found = compare(prepared)
    assert found.loc["DDC of spectral displacements", "event"] == pytest.approx(0.0, abs=1e-9)
    assert found.loc["one linear equation", "event"] > 0.2
    with pytest.raises(ExperimentError, match="kobe"):
        with_spectra(made[made["record"] == "kobe"], {})
