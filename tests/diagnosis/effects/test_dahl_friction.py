"""Dahl's friction: its equation, and how it is asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.effects.candidate_file import read_candidates
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.effects.dahl_friction import DahlFriction
from pounding.diagnosis.effects.user import user_kinds
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.evidence import scales, score
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.starting import starting_noise
from pounding.experiments.rig.storey_forces import bristles
from tests.diagnosis.models import measured

FORCE, BUILD_UP = 12.0, 1e-4


def force_along(drift: np.ndarray) -> np.ndarray:
    time = np.linspace(0.0, 1.0, len(drift))
    return bristles.along((FORCE, BUILD_UP), drift, np.gradient(drift, time), time)


def test_it_solves_dahls_equation() -> None:
    """Against many small explicit steps of the equation itself."""
    time = np.linspace(0.0, 1.0, 20001)
    drift = 3e-4 * np.sin(2 * np.pi * 2 * time) * (1 - 0.5 * time)
    expected, force = np.zeros(len(drift)), 0.0
    for k in range(1, len(drift)):
        moved = drift[k] - drift[k - 1]
        force += (FORCE * np.sign(moved) - force) / BUILD_UP * abs(moved)
        expected[k] = force
    assert force_along(drift) == pytest.approx(expected, abs=2e-3 * FORCE)


def test_the_steps_that_a_drift_is_cut_into_do_not_matter() -> None:
    coarse = np.array([0.0, 2e-4, -1e-4, 3e-4])
    fine = np.interp(np.linspace(0, 3, 301), np.arange(4), coarse)
    assert force_along(fine)[::100] == pytest.approx(force_along(coarse), rel=1e-9)


def test_over_long_strokes_it_takes_the_energy_of_coulombs_friction() -> None:
    stroke = 200 * BUILD_UP
    drift = stroke * np.sin(2 * np.pi * np.linspace(0, 2, 8001))
    force = force_along(drift)
    last = slice(4000, None)
    lost = np.trapezoid(force[last], drift[last])
    assert lost == pytest.approx(4 * FORCE * stroke, rel=0.02)
    assert np.abs(force).max() <= FORCE


def test_a_file_asks_for_it_beside_a_function(tmp_path: Path) -> None:
    file = tmp_path / "ask_for.py"
    file.write_text(
        "from pounding.diagnosis.effects.dahl_friction import DahlFriction\n"
        "from pounding.diagnosis.effects.storey import Bumper\n"
        'def guy_rope(u, v, t, stiffness: "kN/m" = 3): return stiffness * max(u, 0.0)\n'
    )
    assert [kind.name for kind in user_kinds(read_candidates(file))] == ["dahl_friction", "guy_rope"]
    file.write_text('def dahl_friction(d, v, t, k: "N/m" = 3): return k * d\n')
    with pytest.raises(CaseError, match="rename the function"):
        user_kinds(read_candidates(file))


def test_where_it_is_asked_for_it_is_told_from_the_catalogue() -> None:
    """Of what is in storeys it explains its own data best, in its storey, with its parameters."""
    model = measured()
    nothing, noise = np.zeros(len(model.std)), starting_noise(model, (0, 1), 0.01)
    usual = scales(model, run_filter(model, nothing, noise, (0, 1)))
    force, build_up = 0.05 * usual.shear[1], 0.5 * usual.drift[1]
    model = measured([(DahlFriction(index=1), np.array([force, build_up]))], noise=0.01)
    filtered = run_filter(model, nothing, noise, (0, 1))
    effects: list[Effect] = [one for one in candidates(model) if one.where == "storey" and not one.rival]
    effects += places(DahlFriction, model)
    best = score(model, filtered, effects, scales(model, filtered)).ranked[0]
    assert (best.effect.name, best.effect.storey) == ("dahl_friction", 2)
    start = best.effect.values(best.amplitude, best.shape)
    fit = refine(model, filtered, (best.effect,), (start,), (np.abs(start),))
    assert fit.values[0] == pytest.approx([force, build_up], rel=0.02)
