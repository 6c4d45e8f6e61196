"""Where the tests find ground motions and measured cases that are not part of the project."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def _folder(variable: str, what: str) -> Path:
    named = os.environ.get(variable)
    if not named or not Path(named).is_dir():
        # Where everything must hold, a test that quietly does not run is a failure.
        refuse = pytest.fail if os.environ.get("CI") else pytest.skip
        refuse(f"{what}: set {variable} to a folder that holds them")
    return Path(named)


@pytest.fixture(scope="session")
def test_records() -> Path:
    """Folder with the four motions of the tests: elcentro, hachinohe, northridge, kobe."""
    return _folder("POUNDING_RECORDS", "the four motions of the tests may not be redistributed")


@pytest.fixture(scope="session")
def open_cases() -> Path:
    """Folder with measured cases made by another simulator."""
    return _folder("POUNDING_CASES", "the open cases are not part of the project")
