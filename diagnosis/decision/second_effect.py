"""Whether there is a second effect beside a first one, or only what the law of the first one gets wrong."""

from __future__ import annotations

import numpy as np

from pounding.diagnosis.decision.beside_latent_force import beside_latent_force
from pounding.diagnosis.decision.false_alarms import thresholds
from pounding.diagnosis.decision.hidden_by_calibration import moved
from pounding.diagnosis.decision.measures import over_noise, signal_to_noise, something_left, told_from_none
from pounding.diagnosis.decision.objections import another_frame
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.every_storey import EVERY
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.model_checks import log_prior_ratio
from pounding.diagnosis.settings import SETTINGS


def explains_more(found: Findings, single: Judged, double: Judged) -> bool:
    """Return whether a second effect explains a good part of what the first one leaves.

    Args:
        found: What the search found.
        single: The first effect alone.
        double: Both.
    """
    needs = SETTINGS.decision
    if not acts(found, single, double):
        return False
    if not _together(double):
        return True
    # In the same storey it is more likely that the first one's law is not quite the catalogue's.
    which = 1 if found.held_out else 0
    left = [np.nansum(np.maximum(over_noise(found, one)[which] ** 2 - 1, 0.0)) for one in (single, double)]
    return bool(left[1] < (1 - needs.same_storey) * left[0])


def acts(found: Findings, single: Judged, double: Judged) -> bool:
    """Return whether there is a second effect beside the first one, whatever it explains.

    What the first one's law gets wrong may pass for one, but is not made good down to the noise by another effect. It may
    as well hide one: whatever force acts instead of that law, the second effect has its evidence beside it.

    Args:
        found: What the search found.
        single: The first effect alone.
        double: Both.
    """
    gained, needed = double.ln_bayes - single.ln_bayes, _second_evidence(found, single, double)
    new = [effect for effect in double.effects if effect not in single.effects]
    small = signal_to_noise(found, double, single) < SETTINGS.decision.second_size
    if small or not told_from_none(found, double, new):
        return False
    if gained > needed and something_left(found, single) and not something_left(found, double):
        return True
    return gained > _least_evidence(found, single, double) and (
        beside_latent_force(found, single, double).gained > needed
    )


def eases(found: Findings, single: Judged, double: Judged) -> bool:
    """Return whether a frame that is another one with the first effect alone is itself with a likelier pair of effects.

    What the first effect leaves has then moved into stiffness and mass, where it shows as no misfit. Where the first one
    leaves nothing but noise its law is right, and a frame that is much likelier by its priors, or a parameter that has moved
    beyond calibration, says as much; the latter also where the law acts in one storey and the parameter is another's.

    Args:
        found: What the search found.
        single: The first effect alone.
        double: Both.
    """
    gained = double.ln_bayes - single.ln_bayes
    if any(effect.rival for effect in double.effects) or gained <= 0.0 or another_frame(found, double):
        return False
    if another_frame(found, single):
        return True
    if found.pair is not None:
        # What the contact's law gets wrong may bend a frame as well.
        return False
    needed = thresholds(found)[0]
    if gained < needed:
        return False
    right = not something_left(found, single)
    if right and log_prior_ratio(found.model, single.fit.filtered, double.fit.filtered) >= needed:
        return True
    return any(
        moved(found, single, double, effect)
        for effect in double.effects
        if effect not in single.effects and (right or _storeys_apart(effect, single.effects[0]))
    )


def _storeys_apart(one: Effect, other: Effect) -> bool:
    """Return whether effects act in one storey each, and not in the same."""
    return None not in (one.storey, other.storey) and (one.frame, one.storey) != (other.frame, other.storey)


def _together(judged: Judged) -> bool:
    """Return whether effects act in one storey, one in all storeys of a frame counting as in that of the other."""
    everywhere = any(effect.where == EVERY for effect in judged.effects)
    return len({(effect.frame, None if everywhere else effect.storey) for effect in judged.effects}) == 1


def _second_evidence(found: Findings, single: Judged, double: Judged) -> float:
    """Return the ln Bayes factor that a second effect needs beside a first one, whatever force acts instead of that one."""
    if found.pair is None:
        return SETTINGS.decision.second_evidence
    return SETTINGS.pair_decision.second_factor * _least_evidence(found, single, double)


def _least_evidence(found: Findings, single: Judged, double: Judged) -> float:
    """Return the ln Bayes factor that a second effect needs beside a first one as any first effect does."""
    absorbing = any(effect.absorbing for effect in double.effects if effect not in single.effects)
    return thresholds(found, absorbing)[0]
