"""What people would do instead, on the same cases: refit each candidate, or regress each storey's force."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from pounding.diagnosis.benchmark.refitting import refit_each
from pounding.diagnosis.benchmark.regression import sparse_regression, thresholded_by_pysindy
from pounding.diagnosis.report.report import Report

COMPETITORS: dict[str, Callable[[Path], Report]] = {
    "refit": refit_each,
    "sparse": sparse_regression,
    "sparse-pysindy": partial(sparse_regression, optimiser=thresholded_by_pysindy),
}
