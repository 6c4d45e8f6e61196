"""What people would do instead: that it does what it says, on data where it must work."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.benchmark.competitors import COMPETITORS
from pounding.diagnosis.benchmark.regression import best_model, thresholded, thresholded_by_pysindy
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.writing import write_hidden
from pounding.extras import MissingExtraError


@pytest.fixture(scope="module")
def regression() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(4)
    columns = rng.standard_normal((2000, 6))
    return columns, columns @ [1.0, 0.5, 0.0, 0.8, 0.0, 0.0] + 0.1 * rng.standard_normal(2000)


def test_thresholding_finds_the_support(regression: tuple[np.ndarray, np.ndarray]) -> None:
    columns, target = regression
    factors = thresholded(columns, target, 0.1, 2)
    assert factors == pytest.approx([1.0, 0.5, 0.0, 0.8, 0.0, 0.0], abs=0.02)
    assert np.flatnonzero(factors).tolist() == [0, 1, 3]
    # What is always in stays in, however small.
    assert np.flatnonzero(thresholded(columns, target, np.inf, 2)).tolist() == [0, 1]


def test_information_criterion_takes_the_term_and_no_other(regression: tuple[np.ndarray, np.ndarray]) -> None:
    columns, target = regression
    gain, factors = best_model(columns, target, 2)
    assert gain > 1000
    assert np.flatnonzero(factors).tolist() == [0, 1, 3]
    gain, _ = best_model(columns[:, [0, 1, 3, 4, 5]], target, 3)
    assert gain == 0.0


def test_pysindy_agrees_where_it_is_installed(regression: tuple[np.ndarray, np.ndarray]) -> None:
    columns, target = regression
    if importlib.util.find_spec("pysindy") is None:
        with pytest.raises(MissingExtraError, match=r"pounding\[sparse\]"):
            thresholded_by_pysindy(columns, target, 0.1, 2)
    else:
        ours = thresholded(columns, target, 0.1, 2)
        assert thresholded_by_pysindy(columns, target, 0.1, 2) == pytest.approx(ours, abs=1e-9)


@pytest.fixture(scope="module")
def plain_cubic(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("case")
    hidden = hide(
        ["cubic_stiffness:3"], ["5A"], seed=22, visibility=12.0, source="artificial", duration_s=5.0
    )
    write_hidden(hidden, folder)
    return folder


def test_sparse_regression_sees_a_plain_cubic_spring(plain_cubic: Path) -> None:
    report = COMPETITORS["sparse"](plain_cubic)
    (claim,) = report.effects
    assert (claim.effect, claim.frame, claim.storey) == ("cubic_stiffness", "5A", 3)


@pytest.mark.slow
@pytest.mark.guard
def test_refitting_sees_a_plain_cubic_spring(plain_cubic: Path) -> None:
    report = COMPETITORS["refit"](plain_cubic)
    (claim,) = report.effects
    assert (claim.effect, claim.frame, claim.storey) == ("cubic_stiffness", "5A", 3)
    assert len(report.candidates) > 50
