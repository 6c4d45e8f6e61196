"""The block of rubber: its stiffness, how it hardens, what a collision loses, and that it has no name of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.contact import ContactError, collide, names
from pounding.contact.recorded import recorded
from pounding.contact.rubber import FLAT, RubberBlock

BLOCK = RubberBlock(1e6, thickness_m=0.05, restitution=0.6)


def test_it_begins_with_its_stiffness() -> None:
    small = 1e-8
    assert BLOCK.force(small, 0.0, 1.0) / small == pytest.approx(1e6, rel=1e-5)


def test_it_follows_the_stress_of_rubber_and_goes_on_straight_when_flat() -> None:
    depth = 0.5 * BLOCK.thickness_m
    # Half its thickness left: E A (4 - 0.5) / 3 with E A = k t.
    assert BLOCK.force(depth, 0.0, 1.0) == pytest.approx(1e6 * 0.05 * 3.5 / 3.0)
    flat = FLAT * BLOCK.thickness_m
    beyond = np.array([flat * (1 - 1e-7), flat, flat * (1 + 1e-7), 1.2 * flat])
    forces = BLOCK.force(beyond, 0.0, 1.0)
    slopes = np.diff(forces) / np.diff(beyond)
    assert slopes == pytest.approx(np.full(3, 1e6 * (2 * 0.2**-3 + 1) / 3), rel=1e-4)


@pytest.mark.parametrize(("stated", "found"), [(0.5, 0.47), (0.65, 0.63)])
def test_a_collision_loses_about_what_the_restitution_says(stated: float, found: float) -> None:
    """The dashpot is of first order in the loss, and Ye's formula corrects for Hertz' spring only."""
    block = RubberBlock(1e6, thickness_m=0.05, restitution=stated)
    for approach in (0.1, 0.5, 1.0):
        assert collide(block, 1000.0, 1000.0, approach).restitution == pytest.approx(found, abs=0.005)
    page = Path(__file__).parents[2] / "docs" / "mitigation.md"
    assert f"{found} instead of {stated}" in page.read_text(encoding="utf-8")


def test_it_cannot_be_asked_for_by_name_without_its_thickness() -> None:
    assert "rubber_block" not in names()


def test_the_exact_solver_can_record_it() -> None:
    assert len(recorded(BLOCK).instructions) > 5


@pytest.mark.parametrize("wrong", [{"thickness_m": 0.0}, {"restitution": 1.5}, {"restitution": 0.0}])
def test_blocks_that_cannot_be(wrong: dict[str, float]) -> None:
    with pytest.raises(ContactError):
        RubberBlock(1e6, **wrong)
