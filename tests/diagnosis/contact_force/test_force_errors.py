"""Contact forces put right by the motion: errors of a cell's samples found, and a right force left as it is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from pounding.diagnosis import workflow as diagnose
from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.contact_force.force_errors import put_right, put_right_with
from pounding.diagnosis.contact_force.pair import prepare
from pounding.diagnosis.decision.decision import Decision, Verdict
from pounding.diagnosis.decision.measures import remaining
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.writing import write_hidden
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.misfit import channel_misfits, simulate
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.workflow import find
from tests.diagnosis.pair_models import CONTACT, FLOORS, colliding, model_of

TRAINING = (0,)


@dataclass(frozen=True)
class Observed:
    """Observations of nothing."""

    runs: tuple[Any, ...] = ()


def slow(case: Case) -> Model:
    return prepare(case, model_of(case)).slow


def with_errors(model: Model, share: float) -> Model:
    """Return the model with forces whose samples are each off by a share of their size."""
    rng = np.random.default_rng(3)
    runs = []
    for run in model.observed.runs:
        contact = run.contact * (1 + share * rng.standard_normal(run.contact.shape))
        assert run.fine_contact is not None
        at, fine = np.arange(len(contact)) * run.step_s, np.arange(len(run.fine_contact)) * run.fine_step_s
        added = np.interp(fine, at, (contact - run.contact)[:, 0])
        runs.append(replace(run, contact=contact, fine_contact=run.fine_contact + added[:, None]))
    return Model(model.structure, replace(model.observed, runs=tuple(runs)), model.prior)


def test_errors_of_a_force_are_told_by_the_motion_in_fitted_and_held_out_runs() -> None:
    right = slow(colliding(CONTACT))
    wrong = with_errors(right, 0.05)
    found, frames = put_right(wrong, TRAINING)

    assert frames is not None
    assert frames.runs == TRAINING

    def fitted(model: Model) -> Fit:
        return refine(model, calibrated(model, TRAINING), (), (), ())

    def held_out(model: Model) -> np.ndarray:
        outputs = simulate(model, np.zeros(len(model.std)), (), (1,))
        return channel_misfits(model, outputs, (1,))

    # As likely as with the right forces, which errors had made far less likely, and the struck floors' noise is one per
    # cent again, as it was made.
    likely = [fitted(one).log_posterior for one in (wrong, right, found)]
    assert likely[1] > likely[0] + 1000.0
    assert likely[2] > likely[1]
    struck = [channel.endswith("a3") for channel in right.observed.names]
    noise = fitted(found).filtered.noise[0].channel / found.observed.rms(found.observed.runs[0])
    # Forces that are told by these very channels take a part of their noise.
    assert (noise[struck] < 0.0115).all()
    assert (noise[struck] > 0.008).all()
    # The other run's motion follows from its forces again, to the noise of one per cent: the frames are right, and nothing
    # was fitted to it. Samples of a cell leave more, however right they are: between them a touch is no line.
    off = [float(np.median(held_out(one)[~np.array(struck)])) for one in (wrong, right, found)]
    assert off[0] > 1.2 * off[1]
    assert off[0] > 5.0 * off[2]
    assert off[2] < 1.2 * 0.01


def test_forces_are_put_right_once_more_by_frames_with_what_was_missing() -> None:
    case = colliding(CONTACT)
    lighter = model_of(case)
    lighter.structure.frames[0].mass[-1, -1] -= 1.5
    raw = prepare(case, lighter).slow
    without, start = put_right(raw, TRAINING)
    assert start is not None
    mass = next(one for one in candidates(without) if one.name == "added_mass" and one.floor == FLOORS)
    fit = refine(without, start, (mass,), (np.array([1.5]),), (np.array([1.5]),))
    measured = replace(without.observed, runs=raw.observed.runs)
    settled, again = put_right_with(Model(without.structure, measured, without.prior), without, fit)

    def left(model: Model, filtered: Filtered) -> float:
        outputs = simulate(model, filtered.values, filtered.effects, (1,))
        return float(np.median(channel_misfits(model, outputs, (1,))))

    # Forces that frames without the mass had put right kept a part of it, in the run that was not fitted, too.
    assert left(settled, again.filtered) < 0.7 * left(without, fit.filtered)
    before, after = (abs(float(one.values[0][0]) - 1.5) for one in (fit, again))
    assert after < before


@pytest.mark.parametrize("before", ["effect_named", "unknown_effect"])
@pytest.mark.parametrize("borne_out", [True, False])
def test_an_effect_is_judged_by_forces_that_frames_with_it_put_right(
    before: Verdict, borne_out: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of frames without it may be all that left much unexplained, or all that spoke for it."""
    effect = SimpleNamespace(rival=False)
    fit = SimpleNamespace(effects=(effect,), filtered="fitted")
    chosen = Judged(cast(Any, fit), 900.0, (0.1, 0.1), np.ones((2, 1)))
    better = replace(chosen, misfit=(0.05, 0.05))
    nothing: Any = None
    model: Any = SimpleNamespace(observed=Observed(), seeing=lambda observed: "as measured")
    null = replace(chosen, ln_bayes=0.0)
    decided = Decision("effect_named", better) if borne_out else Decision("nothing_missing", null)
    monkeypatch.setattr(diagnose, "put_right_with", lambda *given: ("model", fit))
    monkeypatch.setattr(diagnose, "judged_on", lambda *given: better)
    monkeypatch.setattr(diagnose, "decide", lambda found: decided)
    found = Findings(model, nothing, nothing, nothing, (0,), (1,), [chosen])
    found.pair = cast(Any, SimpleNamespace(slow=model))
    first = Decision(before, chosen)
    settled, decision = diagnose._settled(found, first, ())
    # What is unknown all the same is as it was found.
    again = borne_out or before == "effect_named"
    assert settled.judged == [better if again else chosen]
    assert decision is (decided if again else first)
    assert (settled.settled is None) is not borne_out
    # What was found before is not changed.
    assert found.judged == [chosen]


@pytest.mark.slow
@pytest.mark.guard
def test_a_calibration_is_not_held_back_by_what_wrong_forces_needed(tmp_path: Path) -> None:
    """Frames that were calibrated on forces a few per cent off left 2.7 times the noise, and the gain was no effect."""
    write_hidden(hide(("sensor_gain",), ("10", "5B"), seed=1302814148), tmp_path / "case")
    found, decision = find(read_case(tmp_path / "case"), lambda what, share: None)
    assert remaining(found, found.null) < 1.1
    assert [effect.label() for effect in decision.judged.effects] == ["sensor gain, channel 10_d10"]


def test_only_forces_that_a_cell_measured_are_certain_afterwards() -> None:
    right = slow(colliding(CONTACT))
    assert {event.run for event in right.observed.contact_events} == {0, 1}
    assert {event.run for event in put_right(right, TRAINING)[0].observed.contact_events} == {0}
    assert {event.run for event in put_right(right, TRAINING, measured=False)[0].observed.contact_events} == {
        0,
        1,
    }


def test_a_force_that_is_right_hardly_changes() -> None:
    right = slow(colliding(CONTACT))
    found, _ = put_right(right, TRAINING)
    for one, run in zip(found.observed.runs, right.observed.runs, strict=True):
        assert np.linalg.norm(one.contact - run.contact) < 0.02 * np.linalg.norm(run.contact)
        silent = np.abs(run.contact) < 1e-4 * np.abs(run.contact).max()
        np.testing.assert_allclose(one.contact[silent], run.contact[silent], atol=1.0)


def test_a_run_without_a_touch_stays_without() -> None:
    right = slow(colliding(CONTACT))
    touching, quiet = right.observed.runs
    quiet = replace(
        quiet, contact=np.zeros(quiet.contact.shape), fine_contact=np.zeros_like(quiet.fine_contact)
    )
    model = Model(right.structure, replace(right.observed, runs=(touching, quiet)), right.prior)
    found, _ = put_right(model, TRAINING)
    assert np.any(found.observed.runs[0].contact != touching.contact)
    assert not np.any(found.observed.runs[1].contact)
    assert not np.any(found.observed.runs[1].fine_contact)


def test_without_contact_there_is_nothing_to_put_right() -> None:
    never = slow(colliding(replace(CONTACT, gap_m=0.2)))
    assert put_right(never, TRAINING) == (never, None)
