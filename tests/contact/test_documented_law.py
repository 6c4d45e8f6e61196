"""The law of the documentation whose restitution depends on the velocity, run as it is written there."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pounding import frames
from pounding.contact import Law, collide
from pounding.contact.laws import LAWS
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.rig import Rig

PAGE = Path(__file__).parents[2] / "docs" / "theory" / "contact.md"


@pytest.fixture
def steel_balls() -> Iterator[type[Law]]:
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    (text,) = [block for block in blocks if "class SteelBalls" in block]
    names: dict[str, Any] = {"__name__": __name__}
    exec(compile(text, str(PAGE), "exec", dont_inherit=True), names)
    yield names["SteelBalls"]
    del LAWS["steel_balls"]


@pytest.mark.parametrize(("speed", "low", "high"), [(0.2, 0.64, 0.74), (2.0, 0.48, 0.51)])
def test_it_has_the_restitution_of_the_balls(
    steel_balls: type[Law], speed: float, low: float, high: float
) -> None:
    assert low < collide(steel_balls(1.2e10), 6.2, 6.2, speed).restitution < high


def test_both_solvers_run_it(steel_balls: type[Law]) -> None:
    pair = [
        frames.build(
            frames.StickFrame(
                name=f"{hertz:g} Hz",
                storeys=1,
                storey_height_m=0.1,
                floor_mass_kg=[6.2],
                frequency_hz=[hertz],
                damping_ratio=0.01,
            )
        )
        for hertz in (3.0, 6.0)
    ]
    table = 3.0 * np.sin(2.0 * np.pi * 3.0 * np.arange(0.0, 1.0, 0.004))
    contact = Contact(steel_balls(1.2e10), 0.004, 1)
    one, other = (
        Rig(pair, [contact]).run(table, 0.004, solver=solver).contacts[0]
        for solver in ("exudyn", "exact")  # type: ignore[arg-type]
    )
    assert len(one.pulses) == len(other.pulses) > 1
    forces = [history.pulse(*history.pulses[0])[3].max() for history in (one, other)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-3)
    ratio = [-history.pulse(*history.pulses[0])[2][-1] / history.touches[1][0] for history in (one, other)]
    expected = 0.547 * one.touches[1][0] ** -0.144
    assert ratio == pytest.approx([expected, expected], abs=0.02)
