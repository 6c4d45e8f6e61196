"""The catalogue as a whole: its names, places and parameters, and what the documentation has of it."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.effects.candidates import candidates, kinds
from pounding.diagnosis.effects.catalogue import CATALOGUE, GROUPS, Effect
from pounding.diagnosis.effects.catalogue_page import shown, tables
from pounding.diagnosis.hidden.contact_effects import CONTACT
from pounding.diagnosis.hidden.effects import ASKED_FOR
from pounding.diagnosis.hidden.effects import CATALOGUE as HIDDEN
from pounding.diagnosis.hidden.opensees.effects import STATED_AT
from pounding.diagnosis.inference.evidence import scales
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.rig.storey_forces import DRAG_RATE
from tests.diagnosis.models import measured

PAGE = Path(__file__).parents[3] / "docs" / "diagnosis" / "catalogue.md"
BELIEVED = measured()
BASELINE = run_filter(BELIEVED, np.zeros(len(BELIEVED.std)), starting_noise(BELIEVED, (0,), 0.01), (0,))
SIZES = scales(BELIEVED, BASELINE)


def one_of_each() -> list[Effect]:
    found: dict[type, Effect] = {}
    for effect in candidates(BELIEVED):
        if effect.name != "joint_flexibility":  # A stick has no joints; see the test of a plate frame.
            found.setdefault(type(effect), effect)
    return list(found.values())


BEYOND_CALIBRATION = {"all_stiffness_change", "all_damping_change", "all_added_mass"}
"""What is always tried, and hidden only where it is asked for: most of it is what a calibration is for."""


def test_the_catalogue_has_every_effect_of_a_single_frame() -> None:
    candidates(BELIEVED)
    assert set(CATALOGUE.names()) == (set(HIDDEN) | BEYOND_CALIBRATION) - set(CONTACT)


def test_what_is_not_tried_by_default_is_no_candidate() -> None:
    tried = {type(effect) for effect in candidates(BELIEVED)}
    assert tried == {kind for kind in kinds() if kind.default}
    assert {kind.name for kind in CATALOGUE.optional()} == (
        set(ASKED_FOR) - BEYOND_CALIBRATION | {"dahl_friction"}
    )


def test_the_order_of_candidates_is_that_of_places_and_not_that_of_imports() -> None:
    groups = list(GROUPS.values())
    numbers = [next(i for i, group in enumerate(groups) if kind.where in group) for kind in kinds()]
    assert numbers == sorted(numbers)
    modules = sorted({kind.__module__ for kind in CATALOGUE.kinds}, reverse=True)
    imported_backwards = [kind for name in modules for kind in CATALOGUE.kinds if kind.__module__ == name]
    assert imported_backwards != CATALOGUE.kinds
    assert tuple(type(CATALOGUE)(imported_backwards).ordered()) == kinds()


def test_the_documentation_has_what_the_effects_say() -> None:
    page = PAGE.read_text(encoding="utf-8")
    for heading, table in tables(kinds()).items():
        section = page.split(f"## {heading}\n")[1].split("\n## ")[0]
        assert table in section, "run `python docs/diagnosis/sketches.py`"


def test_the_script_that_draws_the_page_runs_and_has_a_panel_for_every_effect() -> None:
    script = runpy.run_path(str(PAGE.parent / "sketches.py"))
    assert script["PAGE"] == PAGE
    drawn = {name for name, _ in script["panels"]()}
    assert {kind.name for kind in shown(kinds())} < drawn


def test_every_effect_that_may_be_named_is_described() -> None:
    described = {kind.name for kind in shown(kinds())}
    assert described == {kind.name for kind in kinds() if not kind.rival}


@pytest.mark.parametrize("kind", shown(kinds()), ids=lambda kind: kind.name)
def test_every_reported_parameter_is_a_symbol_of_the_equation(kind: type[Effect]) -> None:
    assert kind.described is not None
    for quantity in kind.quantities:
        if quantity.reported:
            assert quantity.symbol, quantity.name
            assert quantity.symbol in kind.described.equation, quantity.name


@pytest.mark.parametrize("kind", shown(kinds()), ids=lambda kind: kind.name)
def test_a_sketch_shows_a_difference(kind: type[Effect]) -> None:
    assert kind.described is not None
    x, baseline, true = kind.described.sketch.curves()
    assert x.shape == baseline.shape == true.shape
    assert np.isfinite(np.stack([x, baseline, true])).all()
    assert np.abs(true - baseline).max() > 0.1 * np.abs(true).max()


def test_every_storey_floor_and_channel_is_a_place() -> None:
    found = candidates(BELIEVED)
    storeys = {effect.storey for effect in found if effect.name == "coulomb_friction"}
    floors = {effect.floor for effect in found if effect.name == "added_mass"}
    channels = {effect.channel for effect in found if effect.name == "sensor_gain"}
    assert storeys == floors == {1, 2, 3}
    assert channels == set(BELIEVED.observed.names)


def test_every_parameter_has_a_unit_and_positive_ones_are_refined_as_such() -> None:
    for effect in one_of_each():
        assert len(effect.logarithmic()) == len(effect.quantities)
        assert all(quantity.name and quantity.unit for quantity in effect.quantities)
        values = effect.values((effect.sign or 1) * effect.size(BELIEVED, SIZES, effect.grid(SIZES)[0]),
                               effect.grid(SIZES)[0])  # fmt: skip
        assert len(values) == len(effect.quantities)
        assert (values[list(effect.logarithmic())] > 0).all()


def test_a_law_errs_on_a_frame_and_not_in_a_reading() -> None:
    """What the table and sensors read wrongly is what its size says; a table that pitches bends the frame by a law."""
    readings = {
        kind.name
        for kind in kinds()
        if kind.where in ("channel", "logger") or (kind.where == "" and kind.name != "table_tilt")
    }
    for effect in one_of_each():
        values = effect.values(effect.size(BELIEVED, SIZES, shape := effect.grid(SIZES)[0]), shape)
        error = effect.law_error(BELIEVED, values, SIZES)
        assert (error == 0.0) == (effect.name in readings)
        assert error == 0.0 or error >= SETTINGS.refinement.law_error


def test_a_hidden_drag_is_stated_where_the_catalogue_states_it() -> None:
    assert STATED_AT == DRAG_RATE
    (drag,) = (effect for effect in one_of_each() if effect.name == "air_drag")
    assert drag.described is not None
    assert f"that at {STATED_AT:g} m/s" in drag.described.equation
