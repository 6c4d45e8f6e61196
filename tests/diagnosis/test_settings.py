"""The thresholds stand in one place, each says what it is and where it comes from, and the documentation shows them."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import FrozenInstanceError, dataclass, fields, is_dataclass, replace
from pathlib import Path

import pytest

from pounding.diagnosis import settings
from pounding.diagnosis.inference import model_checks
from pounding.diagnosis.settings import SETTINGS, Settings, rows, tables

DIAGNOSIS = Path(__file__).parents[2] / "diagnosis"
PAGE = DIAGNOSIS.parent / "docs/diagnosis/settings.md"
ROOMS = ("inference", "decision", "contact_force", "design")
MODULES = [
    *(path for room in ROOMS for path in sorted((DIAGNOSIS / room).glob("*.py"))),
    DIAGNOSIS / "model/sensors.py",
    DIAGNOSIS / "model/first_frequencies.py",
]

NO_THRESHOLDS = {
    "steps and limits of a numerical method": {
        "first_frequencies.SEGMENT_CYCLES",
        "first_frequencies.SPIKE",
        "sensors.FIRST_SAMPLES",
        "coordinates.REACH",
        "filtering.LARGEST_SLOPE",
        "evidence.AT_THE_END",
        "likeliest_noise.REACH",
        "likeliest_noise.SHARES",
        "modal_evidence.STEPS",
        "coordinates.NUDGE",
        "modal_model.COMPLIANCES",
        "numbers.STEP",
        "numbers.PROBE",
        "posterior.DAMPED",
        "posterior.SHORTENED",
        "posterior.PIECE",
        "posterior.CORRECTIONS",
        "posterior.PIVOTS",
        "constancy.PERIODS",
        "filtering.AT_ONCE",
        "contacts.REACH",
        "contacts.REGAINED",
        "striking.STEP_S",
        "striking.SLOWEST",
        "pairs.MEMORY_S",
        "sight.PROBE",
        "detectability.HALVINGS",
        "detectability.ROUNDS",
        "detectability.LARGEST_STRIDE",
    },
    "priors, which belong to what they are about": {
        "coordinates.LARGEST_LOGARITHM",
        "coordinates.LOG_WIDTH",
        "discrepancy.SCALES",
        "coordinates.WIDEST",
        "contacts.GAIN",
        "contacts.DELAY_S",
        "contacts.BEND",
        "contacts.UNEVEN",
        "contacts.CURVE",
        "hypotheses.GAP_M",
        "hypotheses.GAP_SHARE",
        "hypotheses.STIFFNESS",
        "hypotheses.DAMPING",
        "hypotheses.RESTITUTION",
        "hypotheses.WIDE_GAP",
        "hypotheses.WIDE_STIFFNESS",
        "hypotheses.WIDE_DAMPING",
        "hypotheses.WIDE_RESTITUTION",
        "hypotheses.USUAL_RESTITUTION",
        "hypotheses.USUAL_SPREAD",
        "hypotheses.RESTITUTION_ENDS",
        "hypotheses.UNLISTED_STIFFNESS",
        "hypotheses.UNLISTED_RESTITUTION",
        "hypotheses.UNLISTED_GAP_M",
        "hypotheses.UNLISTED_SPREAD",
        "pairs.LARGEST_N",
    },
    "the residual force, which is shown and decides nothing": {
        "residual_force.FIRST_LEVEL",
        "residual_force.ROUNDS",
        "residual_force.LEAST_LEVEL",
    },
    "definitions and layouts": {
        "misfit.SLOW",
        "constancy.CHANCE",
        "contenders.STRONG",
        "contenders.DECISIVE",
        "numbers.NONE",
        "confidence.SIGNS",
        "contacts.FILTER",
        "contacts.COMMON",
        "second_contact.ONE_SIDED",
        "contact_advice.TESTS",
        "contact_advice.FINER",
    },
    "what no result depends on but by chance": {"pair_calibration.SEED", "rig_calibration.WORKERS"},
}


def constants(path: Path) -> Iterator[str]:
    """Yield the upper-case names that a module binds to something with a number in it."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        numbers = (one.value for one in ast.walk(node.value) if isinstance(one, ast.Constant))
        if not any(isinstance(one, int | float) and not isinstance(one, bool) for one in numbers):
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        for one in (name for target in targets for name in ast.walk(target)):
            if isinstance(one, ast.Name) and one.id.isupper():
                yield f"{path.stem}.{one.id}"


def test_no_threshold_stands_elsewhere() -> None:
    found = {name for path in MODULES for name in constants(path)}
    listed = [name for names in NO_THRESHOLDS.values() for name in names]
    assert sorted(listed) == sorted(found)


def test_a_constant_in_a_module_would_be_seen(tmp_path: Path) -> None:
    module = tmp_path / "search.py"
    module.write_text('ONE, OTHER = 1.0, (2, "two")\n_THIRD: float = 3.0\nNAME = "4"\nsmall = 5\n')
    assert list(constants(module)) == ["search.ONE", "search.OTHER", "search._THIRD"]


def test_every_threshold_has_unit_meaning_and_origin() -> None:
    found = list(rows())
    assert len(found) == sum(len(fields(getattr(SETTINGS, group.name))) for group in fields(SETTINGS))
    for one in found:
        assert one.unit.strip(), one
        assert len(one.meaning.split()) > 3, one
        assert one.meaning.endswith("."), one
        assert one.origin.strip(), one


def test_a_threshold_without_a_line_of_its_own_is_refused() -> None:
    @dataclass(frozen=True)
    class Silent:
        threshold: float = 1.0

    with pytest.raises(ValueError, match=r"report\.threshold"):
        list(rows(replace(SETTINGS, report=Silent())))  # type: ignore[arg-type]


def test_settings_cannot_be_changed() -> None:
    groups = [getattr(SETTINGS, group.name) for group in fields(SETTINGS)]
    assert all(is_dataclass(group) for group in groups)
    for one in (SETTINGS, *groups):
        with pytest.raises(FrozenInstanceError):
            setattr(one, fields(one)[0].name, None)
    assert hash(SETTINGS) == hash(Settings())


def test_a_study_may_replace_them(monkeypatch: pytest.MonkeyPatch) -> None:
    assert model_checks._hum(50.2)
    checks = replace(SETTINGS.checks, hum_hz=0.1)
    monkeypatch.setattr(model_checks, "SETTINGS", replace(SETTINGS, checks=checks))
    assert not model_checks._hum(50.2)


def test_the_documentation_shows_what_the_program_decides_by() -> None:
    assert PAGE.read_text(encoding="utf-8").endswith("\n\n" + tables()), (
        "put what `python -m pounding.diagnosis.settings` prints at the end of docs/diagnosis/settings.md"
    )


def test_the_module_prints_the_tables() -> None:
    command = [sys.executable, "-m", "pounding.diagnosis.settings"]
    printed = subprocess.run(command, capture_output=True, check=True, cwd=DIAGNOSIS.parent)
    assert printed.stdout.decode() == tables()
    assert printed.stderr == b""


def test_values_are_shown_as_they_are() -> None:
    shown = {(one.group, one.name): one.value for one in rows()}
    assert shown["decision", "second_evidence"] == "60"
    assert shown["confidence", "limits"] == "0.01, 0.99"
    assert Path(str(settings.__file__)).samefile(DIAGNOSIS / "settings.py")
