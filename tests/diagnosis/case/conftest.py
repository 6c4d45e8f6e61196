"""The folder of a small case, for the tests that read it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.diagnosis.case.bench_case import CASE, samples


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "run1.csv").write_text(samples(0.002))
    (tmp_path / "run2.csv").write_text(samples(1 / 1024, digits=4))
    return tmp_path
