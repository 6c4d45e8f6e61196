"""What a report says of the calibration and of what remains."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from msgspec import structs

from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.search import search
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.report.calibration import calibration, remainder
from pounding.diagnosis.report.report import CalibratedParameter
from pounding.diagnosis.report.report_text import beside_the_verdict, storeys_that_moved
from tests.diagnosis.models import measured
from tests.diagnosis.pair_models import CONTACT, found_of
from tests.diagnosis.report.test_report import of_runs

SOFTER = -0.06


def of(values: dict[tuple[str, int], float] | None = None, discrepancy: float = 0.0) -> Findings:
    plain = measured(samples=50, runs=1)
    made = discrepancy * np.where(
        plain.discrepant, np.random.default_rng(3).standard_normal(len(plain.std)), 0.0
    )
    for place, value in (values or {}).items():
        made[[(one.kind, one.place) for one in plain.parameters].index(place)] = value
    model = measured(values=made, noise=0.005)
    effects = [one for one in candidates(model) if one.name == "cubic_stiffness"]
    return search(model, effects, [0], [1], lambda what, share: None)


@cache
def softer() -> Findings:
    return of({("storey_stiffness", 1): SOFTER})


def test_a_storey_that_the_calibration_took_is_listed_with_its_size() -> None:
    found = softer()
    rows = calibration(found, found.null)
    (storey,) = [one for one in rows if one.parameter == "storey_stiffness"]
    assert (storey.frame, storey.storey) == ("bench", 2)
    assert storey.std is not None
    assert storey.std < 0.03
    assert storey.calibrated == pytest.approx(1 + SOFTER, abs=3 * storey.std)
    said = storeys_that_moved(structs.replace(of_runs(), calibration=rows))
    assert said.startswith("storey 2 of bench moved by -")
    assert "prior standard deviations" in said


def test_frequencies_are_those_of_the_frame_before_and_after() -> None:
    found = softer()
    rows = [one for one in calibration(found, found.null) if one.parameter == "frequency_hz"]
    assert [one.mode for one in rows] == [1, 2, 3]
    model: Model = found.model
    before = model.plain_modes(model.assemble(np.zeros(len(model.std)))).omega / (2 * np.pi)
    np.testing.assert_allclose([one.baseline for one in rows], before)
    assert all(one.calibrated < one.baseline for one in rows)
    assert rows[0].where() == "mode 1 of bench"


def test_damping_that_grows_with_the_frequency_is_one_number_of_the_frame() -> None:
    found = of({("damping_power", 0): 0.8})
    rows = {one.parameter: one for one in calibration(found, found.null)}
    power = rows["damping_power"]
    assert power.frame == "bench"
    assert power.baseline == 0.0
    assert power.std is not None
    assert power.calibrated == pytest.approx(0.8, abs=2.5 * power.std)
    assert (power.moved() or 0.0) > 1.0
    assert "mode_damping" not in rows


def test_a_contact_that_moved_within_its_priors_is_listed() -> None:
    """The gap is wider than believed by twice its prior's standard deviation, and nothing else is."""
    found = softer()
    wider_m = 6e-5
    _, contact, conclusion = found_of(replace(CONTACT, gap_m=CONTACT.gap_m + wider_m))
    assert not conclusion.effects
    rows = calibration(found, found.null, contact.null)
    (gap,) = [one for one in rows if one.contact]
    assert (gap.parameter, gap.where()) == ("contact_gap", "contact 1")
    assert gap.baseline == CONTACT.gap_m
    assert gap.calibrated == pytest.approx(CONTACT.gap_m + wider_m, abs=3 * (gap.std or 0.0))
    assert 1.0 < (gap.moved() or 0.0) < 2.0
    assert not [one for one in calibration(found, found.null) if one.contact]


@pytest.mark.parametrize(("believed", "calibrated", "prior", "row"), [
    ({}, {}, 0.01, None),
    ({}, {"stiffness": 1.05}, 0.01, ("contact_stiffness", 1.05)),
    ({"restitution": 0.7}, {"restitution": 0.72}, 0.01, ("contact_restitution", 0.72)),
    ({"damping": 1.0}, {"damping": 0.9}, 0.05, ("contact_damping", 0.9)),
    ({"damping": 1.0}, {"damping": 0.96}, 0.05, None),
])  # fmt: skip
def test_a_contacts_stiffness_and_loss_are_listed_as_its_law_has_them(
    believed: dict[str, float], calibrated: dict[str, float], prior: float, row: tuple[str, float] | None
) -> None:
    """Of a law with a dashpot the damping, of another damped one the restitution, of none without loss either."""
    found, (_, contact, _) = softer(), found_of(CONTACT)
    fitted = contact.null
    assert fitted is not None
    plain = replace(fitted.hypothesis.law, stiffness=1.0, damping=np.nan, restitution=np.nan)
    was = replace(plain, **believed)
    known = replace(fitted.hypothesis, law=was, stiffness=0.03, loss=prior if believed else 0.0)
    moved = replace(fitted, hypothesis=known, law=replace(was, **calibrated))
    rows = [one for one in calibration(found, found.null, moved) if one.contact]
    assert [(one.parameter, one.calibrated) for one in rows] == ([] if row is None else [row])


def test_logarithms_are_said_in_prior_standard_deviations_of_theirs() -> None:
    row = CalibratedParameter(
        parameter="mode_damping",
        frame="bench",
        mode=2,
        baseline=1.0,
        calibrated=float(np.exp(0.4)),
        std=0.1,
        prior_std=0.2,
    )
    assert row.moved() == pytest.approx(2.0)
    assert structs.replace(row, prior_std=None).moved() is None


def test_a_frame_that_is_not_quite_the_model_is_said_to_differ_by_some_of_the_motion() -> None:
    sizes = []
    for scale in (0.0, 0.01):
        found = of(discrepancy=scale)
        said = remainder(found, found.null, Sight.of(found, found.null.fit.filtered))
        assert said.linear
        assert "of the motion in ways that no single effect explains" in said.statement
        assert ("by less than 0.01 %" in said.statement) == ((said.size or 0.0) < 1e-4)
        sizes.append(said.size or 0.0)
    assert sizes[1] > 5 * sizes[0]


@pytest.mark.parametrize("power", [1, 2])
def test_what_a_linear_frame_cannot_be_is_no_model_error(power: int) -> None:
    """A motion with its own square added has tones that no stiffness, mass or damping makes; a louder one has not."""
    found = softer()
    sight = Sight.of(found, found.null.fit.filtered)
    loud = sight.output * (sight.output / sight.output.std(axis=0)) ** (power - 1)
    run = found.model.observed.runs[sight.run]
    changed = replace(run, measured=run.measured + 0.2 * loud)
    runs = tuple(changed if one is run else one for one in found.model.observed.runs)
    sight = replace(sight, model=found.model.seeing(replace(found.model.observed, runs=runs)))
    assert (sight.linear_share() > 0.5) == (power == 1)


def frequencies(ratios: list[float]) -> tuple[CalibratedParameter, ...]:
    return tuple(
        CalibratedParameter(
            parameter="frequency_hz", frame="5B", mode=mode, baseline=6.0 * mode, calibrated=6.0 * mode * ratio,
            std=None, prior_std=None,
        )
        for mode, ratio in enumerate(ratios, 1)
    )  # fmt: skip


def test_frequencies_that_are_all_off_alike_may_be_a_clock() -> None:
    def said(ratios: list[float]) -> list[str]:
        return beside_the_verdict(structs.replace(of_runs(), calibration=frequencies(ratios)))

    assert said([0.990, 0.9905, 0.9895]) == [
        "All frequencies of 5B are 1.0 % lower than in the baseline model; if the logger's clock may be off, seconds that "
        "are 1.0 % too long would look the same."
    ]
    assert "1.2 % higher" in said([1.012, 1.012])[0]
    assert not said([0.990, 0.999, 0.985])
    assert not said([0.998, 0.998])
    assert not said([0.98])
