"""`--calibrate` for two frames that touch: the whole pair, contact and force cell included, by the exact solver.

As on a single frame null and rivals take turns at being the truth, the contact's rivals beside those of the frames. A
simulated case is diagnosed from its channels alone, as the measured one was: forces known or found, frames, impacts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.contact.damping import reduced_mass
from pounding.contact.errors import ContactError
from pounding.contact.parameters import make_law
from pounding.diagnosis.case.case import Case, Run
from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.contact_force.hypotheses import RESTITUTION_ENDS, at, baseline_law, null
from pounding.diagnosis.contact_force.impacts import Law
from pounding.diagnosis.contact_force.pair import ContactFindings
from pounding.diagnosis.contact_force.pairs import with_contacts
from pounding.diagnosis.decision.claims import Place, place_of
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.decision import NAMED
from pounding.diagnosis.decision.nulls import drawn
from pounding.diagnosis.decision.rig_calibration import (
    Outcome,
    noise_shares,
    scattered,
    turn,
)
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.observations import RunData, root_mean_square
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.model.twin import Between, simulate_pair
from pounding.diagnosis.settings import SETTINGS

SEED = 20261122
Diagnose = Callable[[Case], Conclusion]


@dataclass(frozen=True)
class Truth:
    """What a simulated case hides: in words, its place, and what makes it; nothing by default."""

    label: str = "nothing missing"
    place: Place | None = None
    frames: Judged | None = None
    contact: Fitted | None = None


def truths(found: Findings, contact_findings: ContactFindings) -> list[Truth]:
    """Return nothing missing and the best single candidates of the frames and of the contact."""
    single = [one for one in found.claimable() if len(one.effects) == 1 and not one.effects[0].rival]
    most = SETTINGS.calibration.pair_rivals
    rivals = [Truth(one.label(), place_of(one.effects[0]), frames=one) for one in single[:most]]
    seen: set[str] = set()
    for _, fit in contact_findings.ranked:
        effect = fit.hypothesis.effect
        if effect not in seen and len(seen) < most:
            seen.add(effect)
            where = Place(effect=effect, contact=1)
            rivals.append(Truth(effect.replace("_", " "), where, contact=fit))
    return [Truth(), *rivals]


def simulate_and_judge(
    case: Case, found: Findings, contact_findings: ContactFindings, diagnose: Diagnose, number: int
) -> Outcome:
    """Return the outcome of the case of a number, the same whenever it is asked for.

    Args:
        case: The measured case.
        found: What the search found of its frames.
        contact_findings: What its impacts say.
        diagnose: Returns what is concluded of a case.
        number: Number of the simulated case.
    """
    tried = truths(found, contact_findings)
    truth = tried[turn(number, len(tried) - 1)]
    conclusion = diagnose(simulated(case, found, truth, np.random.default_rng([number, SEED])))
    # Of claims on both, that on the frames.
    return Outcome(number, truth.label, right(conclusion, truth), conclusion.basis.behind()[0])


def right(conclusion: Conclusion, truth: Truth) -> bool:
    """Return whether a conclusion names what is hidden, or a class that holds it, and nothing else."""
    if truth.place is None:
        return conclusion.verdict == "nothing_missing"
    if conclusion.verdict not in NAMED or len(conclusion.effects) != 1:
        return False
    return truth.place in conclusion.effects[0].members


def simulated(case: Case, found: Findings, truth: Truth, rng: np.random.Generator) -> Case:
    """Return the case with simulated data of the pair, an effect being hidden in them.

    Args:
        case: The case.
        found: What the search found.
        truth: What is hidden.
        rng: Random numbers for nuisance parameters, sizes and noise.

    Raises:
        CaseError: The contact's law and damping make no law that the solver knows.
    """
    assert found.pair is not None
    bare = with_contacts(found.pair.full)
    values = drawn(bare, rng, (truth.frames or found.null).fit.filtered.discrepancy)
    acting = scattered(truth.frames, rng) if truth.frames is not None else []
    between = _between(case, found.pair, truth, rng)
    runs = [
        _run(case, found, bare, (values, acting), number, between, rng) for number in range(len(case.runs))
    ]
    return replace(case, runs=tuple(runs), warnings=())


def _between(case: Case, pair: Pair, truth: Truth, rng: np.random.Generator) -> Between:
    """Return the contact as it was set up, its numbers off by as much as they may be."""
    left, right = pair.full.observed.contact_floors[pair.column]
    mass = np.concatenate([frame.floor_mass for frame in pair.full.structure.frames])
    masses = float(mass[left]), float(mass[right])
    stated = baseline_law(case.contacts[0], reduced_mass(*masses))
    law = stated if truth.contact is None else _of_size(stated, truth.contact, rng)
    built = at(null(law), rng.standard_normal(3))
    try:
        acts = make_law(
            built.name,
            stiffness=built.stiffness,
            damping=_given(built.damping),
            restitution=_given(built.restitution),
            masses=masses,
        )
    except ContactError as error:
        raise CaseError(
            f"{case.folder / 'case.toml'}: --calibrate cannot simulate contact 1: {error}"
        ) from error
    return Between(left, right, acts, max(built.gap_m, 0.0))


def _given(value: float) -> float | None:
    return None if np.isnan(value) else value


def _of_size(stated: Law, fitted: Fitted, rng: np.random.Generator) -> Law:
    """Return a contact whose departure from the stated one is about the fitted one's; another law is as fitted."""
    law, effect = fitted.law, fitted.hypothesis.effect
    share = float(np.exp(SETTINGS.calibration.size_scatter * rng.standard_normal()))
    if effect == "gap_offset":
        return replace(stated, gap_m=stated.gap_m + share * (law.gap_m - stated.gap_m))
    if effect == "contact_stiffness":
        return replace(stated, stiffness=stated.stiffness * (law.stiffness / stated.stiffness) ** share)
    if effect == "contact_damping":
        if np.isnan(stated.damping):
            changed = stated.restitution + share * (law.restitution - stated.restitution)
            return replace(stated, restitution=float(np.clip(changed, *RESTITUTION_ENDS)))
        return replace(stated, damping=stated.damping * (law.damping / stated.damping) ** share)
    return replace(law, gap_m=stated.gap_m)


def _run(
    case: Case,
    found: Findings,
    bare: Model,
    model: tuple[np.ndarray, Sequence[tuple[Acting, np.ndarray]]],
    number: int,
    between: Between,
    rng: np.random.Generator,
) -> Run:
    """Return a run as it is recorded: the solver's motion, noise as estimated, dropouts where they were.

    It ends where the measured one ended for the diagnosis, which leaves out an end at which nothing is recorded.
    """
    run, whole = bare.observed.runs[number], case.runs[number]
    measured = replace(whole, time_s=whole.time_s[: len(run.table)], values=whole.values[: len(run.table)])
    clean, force = simulate_pair(bare, *model, number, between)
    channel, table = noise_shares(found)
    # White noise loses so much of its power where a run is slowed.
    more = float(np.sqrt(found.model.observed.slower))
    values = measured.values.copy()
    for column, one in enumerate(case.channels):
        missing = ~np.isfinite(measured.values[:, column])
        scatter = rng.standard_normal(len(values))
        if one.name in bare.observed.names:
            c = bare.observed.names.index(one.name)
            size = more * channel[c] * float(root_mean_square(clean[:, c]))
            values[:, column] = clean[:, c] + size * scatter
        elif one.quantity == "contact_force":
            values[:, column] = _recorded(found, measured.values[:, column], force, number, scatter)
        elif one.is_table:
            size = more * table * float(root_mean_square(run.table))
            values[:, column] = _table(run, measured.values[:, column]) + size * scatter
        values[missing, column] = np.nan
    return replace(measured, values=values)


def _table(run: RunData, series: np.ndarray) -> np.ndarray:
    index, good = np.arange(len(series)), np.isfinite(series)
    return np.asarray(np.interp(index, index[good], series[good])) if good.any() else run.table


def _recorded(
    found: Findings, measured: np.ndarray, force: np.ndarray, number: int, scatter: np.ndarray
) -> np.ndarray:
    """Return what the force channel shows; one that clips does so again."""
    assert found.pair is not None
    if found.pair.cell is not None:
        return np.asarray(force + found.pair.noise[number] * scatter)
    return np.asarray(np.minimum(force, np.nanmax(measured, initial=0.0)))
