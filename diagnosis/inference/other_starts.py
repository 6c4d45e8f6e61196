"""Refinement of what leads from where something alike leads: other optima that a descent does not reach by itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.frame import TorsionalEccentricity
from pounding.diagnosis.effects.rivals import FadingFriction
from pounding.diagnosis.effects.storey import CoulombFriction
from pounding.diagnosis.effects.whole_frame import same_motion
from pounding.diagnosis.inference.clocks import clocks
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, best
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.refining import each, keep, widths
from pounding.diagnosis.inference.rescue import anew
from pounding.diagnosis.settings import SETTINGS


def from_baseline(found: Findings) -> None:
    """Refine what leads once more from the baseline frame.

    A null model that imitates an effect has its parameters at the ends of their box, and a descent from there may end in a
    local optimum with a part of the effect.

    Args:
        found: The findings, to which the fit is added.
    """
    fit = best(found).fit
    if fit.effects:
        still = np.zeros(len(found.model.std))
        keep(found, refine(found.model, found.null.fit.filtered, fit.effects, fit.values, nuisance=still))


def softer(found: Findings, fit: Fit) -> Fit:
    """Refine a base that turns from one that is much softer: far from a fixed one its stiffness has other best values.

    Args:
        found: The findings.
        fit: The fit of the base.
    """
    values = SETTINGS.search.softer * fit.values[0]
    return refine(found.model, found.null.fit.filtered, fit.effects, (values,))


def turned(found: Findings, effects: Sequence[Effect]) -> None:
    """Refine floors that turn from where a mass on a spring led: the frequency of turning is as sharp as that of a mass.

    Args:
        found: The findings, to which the fits are added.
        effects: The candidates.
    """
    leading = best(found)
    if [effect.name for effect in leading.effects] != ["appendage"]:
        return
    rival, fit = leading.effects[0], leading.fit
    for effect in effects:
        if isinstance(effect, TorsionalEccentricity) and effect.frame == rival.frame:
            values = effect.like_appendage(found.model, fit.filtered.values, rival.index, fit.values[0])
            turned = refine(found.model, fit.filtered, (effect,), (values,), nuisance=fit.filtered.values)
            keep(found, turned)


def ticked(found: Findings) -> None:
    """Refine clocks of another rate where an effect of table or sensors leads.

    They start from the baseline model, as what is rescued: a null model that follows a table out of step bears no other.

    Args:
        found: The findings, to which the fits are added.
    """
    leading = best(found).effects
    if not leading or any(effect.where not in ("", "channel", "logger") for effect in leading):
        return
    start = anew(found)

    def ticked(tried: tuple[Effect, np.ndarray]) -> Fit:
        clock, values = tried
        filtered = run_filter(found.model, start.values, start.noise, found.fitted, [(clock, values)])
        width = widths(found.model, clock, found.sizes, ())
        return refine(found.model, filtered, (clock,), (values,), (width,))

    for fit in each(found, ticked, clocks(found.model, start, leading)[: SETTINGS.search.rescues]):
        keep(found, fit)


def weighed(found: Findings) -> None:
    """Refine the mass of a whole frame from where its stiffness led, or the other way round: a table tells only their ratio.

    Contact forces would tell them apart.

    Args:
        found: The findings, to which the fit is added.
    """
    leading, model = best(found), found.model
    other = same_motion(leading.effects[0]) if len(leading.effects) == 1 else None
    if other is None or model.observed.contact_floors:
        return
    fit = leading.fit
    values = 1.0 / (1.0 + fit.values[0]) - 1.0
    keep(found, refine(model, fit.filtered, (other,), (values,), nuisance=fit.filtered.values))


def faded(found: Findings) -> None:
    """Refine friction that has faded by half or more at the usual rate, from where plain friction led.

    That of dry parts fades a little beside what breaks them loose: only what fades as a whole is no Coulomb friction.

    Args:
        found: The findings, to which the fits are added.
    """
    leading = best(found)
    if len(leading.effects) != 1 or not isinstance(leading.effects[0], CoulombFriction):
        return
    plain, fit = leading.effects[0], leading.fit
    rival = FadingFriction(index=plain.index, frame=plain.frame, storey=plain.storey)
    usual = float(found.sizes.drift_rate[plain.index])

    def fading(share: float) -> Fit:
        force, stiffness = fit.values[0][:2]
        values = np.array([force * (1.0 + 1.0 / share), stiffness, share * usual])
        return refine(found.model, fit.filtered, (rival,), (values,))

    for faded in each(found, fading, SETTINGS.search.faded):
        if faded.values[0][2] < usual:
            keep(found, faded)
