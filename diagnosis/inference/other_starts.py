"""Other starts of what leads, and of what is alike: optima that a descent does not reach by itself."""

from __future__ import annotations

from collections.abc import Callable, Container, Hashable, Iterator, Sequence
from functools import partial

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.every_storey import AllCoulombFriction, EveryStorey
from pounding.diagnosis.effects.rivals import FadingFriction
from pounding.diagnosis.effects.storey import CoulombFriction, DampingChange, StoreyEffect
from pounding.diagnosis.effects.whole_frame import same_motion
from pounding.diagnosis.inference.clocks import clocks
from pounding.diagnosis.inference.discrepancy import SCALES
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, Judged, leaders, race
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.refining import refined, widths
from pounding.diagnosis.inference.starting import uncalibrated
from pounding.diagnosis.settings import SETTINGS

Start = Callable[[], Fit | None]
"""A refinement that is still to be done; None where it led to something else than was asked for."""


def other_starts(found: Findings, begun: Container[Hashable] = ()) -> list[Start]:
    """Return other starts of the likeliest effects and of what is alike, each independent of the others.

    What is outside the catalogue may lead because what leads of the catalogue is in a local optimum.

    Args:
        found: The findings.
        begun: Keys of fits from which all this has been begun, and effects that were refined from the baseline frame.
    """
    leading = leaders(found)
    if not leading:
        return []
    kinds = (_everywhere, _ticked, _weighed, _faded, _creeping)
    least = leading[0].ln_bayes - SETTINGS.decision.alike
    others = [one for one in found.judged if one.effects and one.ln_bayes > least]
    near = {id(one): one for one in (*others, *leading)}.values()
    return [
        *(
            partial(from_baseline, found, one.fit.effects, one.fit.values)
            for one in near
            if one.fit.effects not in begun and one.fit.key not in begun
        ),
        *(() if leading[0].fit.key in begun else _promised(found, leading[0])),
        *(
            start
            for one in leading
            if one.fit.key not in begun
            for kind in kinds
            for start in kind(found, one)
        ),
    ]


def _promised(found: Findings, leading: Judged) -> Iterator[Start]:
    """Yield the effects of frames whose score promised more than any fit has kept, from the baseline frame, as scored.

    A score weighs all scales of the discrepancy; a refinement from the null model begins with that model's own scale, and
    may stay there although another one is likelier. What is wrong with sensors moves no frame's parameters, and has no such
    maxima.
    """
    hopeful = [
        one for one in found.scores.ranked if one.ln_bayes > leading.ln_bayes and one.effect.frame is not None
    ]
    for one in hopeful[: SETTINGS.search.thorough]:
        yield partial(from_baseline, found, (one.effect,), (one.effect.values(one.amplitude, one.shape),))


def from_baseline(found: Findings, effects: Sequence[Effect], values: Sequence[np.ndarray]) -> Fit:
    """Refine effects once more from the baseline frame, as if its model had hardly an error.

    A null model that imitates an effect has its parameters at the ends of their box and a wide discrepancy, and a descent
    from there may end in a local optimum with a part of the effect.

    Args:
        found: The findings.
        effects: The effects.
        values: SI parameters of each to start from, each of shape (parameters,).
    """
    start = found.null.fit.filtered.with_discrepancy(float(SCALES[0]))
    still = np.zeros(len(found.model.std))
    # What a few steps leave would look like a wide discrepancy, beside which the effect is needed no longer.
    steps = SETTINGS.refinement.steps
    return refine(found.model, start, effects, values, iterations=steps, nuisance=still, race=race(found))


def softer(found: Findings, fit: Fit) -> Fit:
    """Refine a base that turns from one that is much softer: far from a fixed one its stiffness has other best values.

    Args:
        found: The findings.
        fit: The fit of the base.
    """
    values = SETTINGS.search.softer * fit.values[0]
    return refine(found.model, found.null.fit.filtered, fit.effects, (values,))


def _everywhere(found: Findings, leading: Judged) -> Iterator[Start]:
    """Yield the law that leads in one storey in all storeys of its frame, where that has not been refined to the end.

    To first order, about a null model that has taken a part of it, a law in all storeys may look like nothing while some of
    its storeys look like that law.
    """
    known = {one.effects for one in found.judged}
    for one in found.scores.ranked:
        whole = one.effect
        if not isinstance(whole, EveryStorey) or (whole,) in known:
            continue
        if [(type(effect), effect.frame) for effect in leading.effects] == [(whole.alone, whole.frame)]:
            yield partial(refined, found, found.null.fit.filtered, one)


def _ticked(found: Findings, leading: Judged) -> Iterator[Start]:
    """Yield clocks of another rate where an effect of table or sensors leads.

    They start from the baseline model, as what is rescued: a null model that follows a table out of step bears no other.
    """
    if any(effect.where not in ("", "channel", "logger") for effect in leading.effects):
        return
    start = uncalibrated(found.model, found.fitted)
    for clock, values in clocks(found.model, start, leading.effects)[: SETTINGS.search.rescues]:
        filtered = run_filter(found.model, start.values, start.noise, found.fitted, [(clock, values)])
        width = widths(found.model, clock, found.sizes, ())
        yield partial(refine, found.model, filtered, (clock,), (values,), (width,))


def _weighed(found: Findings, leading: Judged) -> Iterator[Start]:
    """Yield the mass of a whole frame from where its stiffness led, or the other way round.

    A table tells only their ratio; contact forces would tell them apart.
    """
    other = same_motion(leading.effects[0]) if len(leading.effects) == 1 else None
    if other is None or found.model.observed.contact_floors:
        return
    fit = leading.fit
    values = 1.0 / (1.0 + fit.values[0]) - 1.0
    yield partial(refine, found.model, fit.filtered, (other,), (values,), nuisance=fit.filtered.values)


def _faded(found: Findings, leading: Judged) -> Iterator[Start]:
    """Yield friction that has faded by half or more at the usual rate, from where plain friction led.

    That of dry parts fades a little beside what breaks them loose: only what fades as a whole is no Coulomb friction.
    """
    if len(leading.effects) != 1 or not isinstance(leading.effects[0], CoulombFriction):
        return
    plain, fit = leading.effects[0], leading.fit
    rival = FadingFriction(index=plain.index, frame=plain.frame, storey=plain.storey)
    usual = float(found.sizes.drift_rate[plain.index])

    def fading(share: float) -> Fit | None:
        force, stiffness, _, damping_ratio = fit.values[0]
        values = np.array([force * (1.0 + 1.0 / share), stiffness, share * usual, damping_ratio])
        # That is far from any optimum: with the little noise that plain friction leaves it would not come back.
        loud, there = found.null.fit.filtered, fit.filtered.values
        faded = refine(found.model, loud, (rival,), (values,), nuisance=there, race=race(found))
        return faded if faded.values[0][2] < usual else None

    yield from (partial(fading, share) for share in SETTINGS.search.faded)


def _creeping(found: Findings, leading: Judged) -> Iterator[Start]:
    """Yield friction that creeps instead of sticking, from where friction that sticks, or a damper, led.

    What slips a little all the time, as friction that goes with the hyperbolic tangent of the rate, is far from both: a
    damper takes hardly any power of the rate there, and a joint that sticks is too stiff at each turn.
    """
    if len(leading.effects) != 1:
        return
    led, values, model = leading.effects[0], leading.fit.values[0], found.model
    whole = led if isinstance(led, AllCoulombFriction) else None
    one = led if whole is None else whole.leading(found.sizes)
    if type(one) not in (CoulombFriction, DampingChange) or not isinstance(one, StoreyEffect):
        return
    joint = CoulombFriction(index=one.index, frame=one.frame, storey=one.storey)
    weight = 1.0 if whole is None else whole.weight(model, joint)
    usual = float(found.sizes.drift_rate[one.index])
    force = weight * values[0] * (usual if isinstance(one, DampingChange) else 1.0)
    if force <= 0.0:
        return
    start = joint.creeping(model, force, SETTINGS.search.creeps * usual) / (weight, 1.0, 1.0, 1.0)
    effect = joint if whole is None else whole
    start = start if whole is None else np.append(start, values[-1])

    def crept() -> Fit | None:
        fit = from_baseline(found, (effect,), (start,))
        there = np.array([weight * fit.values[0][0], *fit.values[0][1:4]])
        return fit if _slides(found, joint, there) else None

    yield crept


def _slides(found: Findings, joint: CoulombFriction, values: np.ndarray) -> bool:
    """Return whether friction slides in usual shaking; what does not is the damper, or the spring, of a joint that holds."""
    force, stiffness, damping, *_ = joint.numbers(found.model, values)
    share = SETTINGS.search.slides
    drift, rate = (share * float(one[joint.index]) for one in (found.sizes.drift, found.sizes.drift_rate))
    return bool(force < stiffness * drift or force < damping * rate)
