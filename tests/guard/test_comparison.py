"""The guard tells apart what must stay from what may move."""

from __future__ import annotations

import json
from copy import deepcopy
from typing import Any

import pytest

from tests.guard.__main__ import EXPECTED
from tests.guard.cases import drawn_names
from tests.guard.comparison import differences, kept

REPORT: dict[str, Any] = {
    "verdict": "effect_named",
    "effects": [
        {
            "effect": "coulomb_friction",
            "frame": "5B",
            "storey": 2,
            "floor": None,
            "parameters": [{"name": "friction_force", "value": 48.0, "std": 0.2, "unit": "N"}],
        }
    ],
}


def changed(**parameter: Any) -> dict[str, Any]:
    report = deepcopy(REPORT)
    report["effects"][0]["parameters"][0] |= parameter
    return kept(report, 1.0)


def test_the_same_report_is_as_expected() -> None:
    assert differences(kept(REPORT, 1.0), kept(REPORT, 9.0)) == []
    assert differences(kept(REPORT, 1.0), changed(value=48.019)) == []


@pytest.mark.parametrize(
    ("found", "told"),
    [
        (changed(value=48.021), "friction_force"),
        (changed(value=float("nan")), "friction_force"),
        (changed(unit="kN"), "friction_force"),
        (changed(name="force"), "has the parameters force"),
        (kept(REPORT | {"verdict": "unknown_effect"}, 1.0), "verdict unknown_effect, was effect_named"),
        (kept(REPORT | {"effects": []}, 1.0), "coulomb_friction frame 5B storey 2 is no longer there"),
        (kept(REPORT | {"effects": [REPORT["effects"][0] | {"storey": 3}]}, 1.0), "storey 3 is new"),
    ],
)
def test_what_differs_is_said(found: dict[str, Any], told: str) -> None:
    assert told in "; ".join(differences(kept(REPORT, 1.0), found))


def test_every_case_of_the_set_has_its_standard() -> None:
    cases = json.loads(EXPECTED.read_text(encoding="utf-8"))["cases"]
    assert set(drawn_names()) < set(cases)
    assert all(case["verdict"] for name, case in cases.items() if name != "real-oscillator")
