"""The quick ways of predictor and signatures beside the slow ones that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.effects.storey import DampingChange
from pounding.diagnosis.inference.filtering import (
    Filtered,
    run_filter,
    run_signatures,
    signature_pieces_of_run,
)
from pounding.diagnosis.inference.motions import motions
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model import closed_loop
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import MODAL_DAMPING, vary
from pounding.diagnosis.model.terms import nuisance_terms
from tests.diagnosis.models import measured

NO_DAMPER = (DampingChange(index=0, frame="bench", storey=1), np.array([0.0, 0.0]))


def problem() -> tuple[Model, np.ndarray, Filtered]:
    model = measured(samples=500)
    values = 0.3 * model.std * np.random.default_rng(3).standard_normal(len(model.std))
    return model, values, run_filter(model, values, starting_noise(model, [0, 1]), [0, 1])


def test_a_linear_frame_goes_through_all_substeps_at_once() -> None:
    """With a law, even one that does nothing, each substep is taken by itself; what couples modes, once a sample."""
    model, values, filtered = problem()
    gains = filtered.gains
    coupling = np.array([one.kind == MODAL_DAMPING for one in model.parameters])
    for coupled, tolerance in ((np.where(coupling, 0.0, values), 1e-9), (values + 0.5 * coupling, 1e-3)):
        whole = model.predict(coupled, gains)
        each = model.predict(coupled, gains, [NO_DAMPER])
        for quick, slow in zip(whole.before, each.before, strict=True):
            assert np.abs(quick - slow).max() < tolerance * np.abs(slow).max()


def test_innovations_alone_are_those_of_the_whole_prediction() -> None:
    model, values, filtered = problem()
    gains = filtered.gains
    alone = model.predict(values, gains, [NO_DAMPER], whole=False)
    for quick, slow in zip(
        alone.innovations, model.predict(values, gains, [NO_DAMPER]).innovations, strict=True
    ):
        np.testing.assert_array_equal(quick, slow)
    assert [len(one) for one in alone.before] == [0, 0]


def test_an_assembly_is_that_of_its_parameters_one_after_the_other() -> None:
    model, values, _ = problem()
    slow = model.assemble(np.zeros_like(values))
    for parameter, value in zip(model.parameters, values, strict=True):
        vary(slow, model.structure, parameter.kind, parameter.place, float(value))
    quick = model.assemble(values)
    for key, one in vars(slow).items():
        if isinstance(one, np.ndarray | float):
            np.testing.assert_allclose(
                getattr(quick, key), one, rtol=1e-12, atol=1e-12 * np.max(np.abs(one), initial=0.0)
            )
    assert type(quick.table_gain) is float


def test_a_kept_assembly_is_not_changed_by_effects() -> None:
    model, values, _ = problem()
    changed = model.assemble(values, [NO_DAMPER])
    changed.stiffness[:] = 0.0
    assert len(model.assemble(values).laws) == 0
    assert np.all(np.diag(model.assemble(values).stiffness) > 0.0)


def test_signatures_by_own_motions_are_those_of_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    model, _, filtered = problem()
    closed = closed_loop.transition(filtered.filters[0])
    columns = [[*nuisance_terms(model, filtered.modes, motion), []] for motion in motions(model, filtered)]
    pieces = [rows for _, rows in signature_pieces_of_run(model, filtered, 0, columns[0], 64, None)]
    quick = [run_signatures(model, filtered, number, own) for number, own in enumerate(columns)]
    own_motions = closed_loop.own_motions(closed)
    assert own_motions is not None
    assert own_motions.precision is np.float32
    monkeypatch.setattr(closed_loop, "TOLERANCE", 1e-9)
    own_motions = closed_loop.own_motions(closed)
    assert own_motions is not None
    assert own_motions.precision is np.float64
    precise = [run_signatures(model, filtered, number, own) for number, own in enumerate(columns)]
    monkeypatch.setattr(closed_loop, "TOLERANCE", 0.0)
    assert closed_loop.own_motions(closed) is None
    for number, (one, better, own) in enumerate(zip(quick, precise, columns, strict=True)):
        other = run_signatures(model, filtered, number, own)
        np.testing.assert_allclose(one, other, atol=1e-6 * np.abs(other).max())
        np.testing.assert_allclose(better, other, atol=1e-7 * np.abs(other).max())
        assert not one[:, -1].any()
    np.testing.assert_array_equal(np.concatenate(pieces), quick[0])
