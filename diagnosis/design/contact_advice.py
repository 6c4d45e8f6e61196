"""Which other recording of a contact's impacts would part what these cannot, by simulation.

The likelier rival is taken for true and makes the impacts of a further test; both are then fitted to them. By so much as the
difference of their evidence grows, the further test is expected to bring.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.contact_force.contacts import Fitted, again, best_fit, spectra
from pounding.diagnosis.contact_force.impacts import Bodies, Impact, Law
from pounding.diagnosis.contact_force.pair import ContactFindings
from pounding.diagnosis.contact_force.striking import STEP_S
from pounding.diagnosis.design.contenders import Advice, Gain, advised, contenders
from pounding.diagnosis.settings import SETTINGS

TESTS = (
    ("the same shaking recorded at twice the sampling rate, force cell included", 2.0, 1.0, False),
    ("the same shaking recorded at four times the sampling rate, force cell included", 4.0, 1.0, False),
    ("as many impacts at twice the speed", 1.0, 2.0, True),
    ("as many impacts again", 1.0, 1.0, True),
)
FINER = (1.0, 2.0, 4.0)
"""Further tests: in words, by how much finer the sampling is, by how much faster the floors meet, and whether these impacts
come to those that are there; shares of the finest frequencies that are compared."""
NAMES = {
    "": "the contact of the baseline model",
    "gap_offset": "another gap of the contact",
    "contact_stiffness": "another stiffness of the contact",
    "contact_damping": "another loss of the contact",
}


def rivals(contact_findings: ContactFindings, needed: float) -> tuple[Fitted, Fitted] | None:
    """Return what the impacts like best and what they cannot tell from it, or None where they are clear.

    Args:
        contact_findings: What the impacts say.
        needed: ln Bayes factor from which the best is claimed.
    """
    if contact_findings.null is None or not contact_findings.ranked:
        return None
    first, *others = contact_findings.ranked
    effect = first[1].hypothesis.effect
    of_another_kind = [one for one in others if one[1].hypothesis.effect != effect]
    return contenders(first, of_another_kind, contact_findings.null, claimed=first[0] >= needed)


def advice(contact_findings: ContactFindings, needed: float) -> list[Advice]:
    """Return what to say of the tests that would part the rivals, best first; none where the impacts are clear.

    Args:
        contact_findings: What the impacts say.
        needed: ln Bayes factor from which the best is claimed.
    """
    bodies = contact_findings.bodies
    if bodies is None:
        return []
    return advised(rivals(contact_findings, needed), name, lambda true, other: expected(bodies, true, other))


def name(fitted: Fitted) -> str:
    """Return a hypothesis in words."""
    return NAMES.get(fitted.hypothesis.effect) or f"the contact law {fitted.law.name}"


def expected(bodies: Bodies, true: Fitted, other: Fitted) -> list[Gain]:
    """Return what each further test is expected to bring, most first.

    Args:
        bodies: The two floors and their impacts.
        true: The rival that is taken for true.
        other: The rival that tries to imitate it.
    """
    here = made(bodies, true.law, 1.0, 1.0)
    now = _apart(here, true, other)
    gains = []
    for what, finer, faster, more in TESTS:
        # A finer record has what a coarser one has, too, and high frequencies may be too faint to be compared.
        tried = [made(bodies, true.law, share, faster) for share in FINER if share <= finer]
        before = here.impacts if more else ()
        apart = [_apart(replace(there, impacts=(*before, *there.impacts)), true, other) for there in tried]
        gains.append(Gain(what, max(apart) - now))
    return sorted(gains, key=lambda gain: -gain.ln_bayes)


def made(bodies: Bodies, law: Law, finer: float, faster: float) -> Bodies:
    """Return the strongest impacts as a law makes them, sampled more finely and met at a higher velocity.

    Args:
        bodies: The two floors and their impacts.
        law: The contact law.
        finer: Sampling rate over that of the measurement.
        faster: Velocity of the impacts over the measured one.
    """
    moved = tuple(_moved(impact, law, finer, faster) for impact in bodies.impacts[: SETTINGS.design.impacts])
    found = []
    for one, seen in zip(moved, spectra(replace(bodies, impacts=moved), law), strict=True):
        strong = np.exp(seen[:4] - seen[0]) > SETTINGS.impacts.faint
        whiten = np.diag(np.concatenate([strong, strong[1:]]) / SETTINGS.impacts.model_error)
        found.append(replace(one, seen=seen, whiten=whiten))
    return replace(bodies, impacts=tuple(found))


def _moved(impact: Impact, law: Law, finer: float, faster: float) -> Impact:
    onset = impact.free[min(impact.onset, len(impact.free) - 1)]
    return replace(
        impact,
        free=law.gap_m + faster * (impact.free - onset),
        free_rate=faster * impact.free_rate,
        prior=(impact.prior[0], faster * impact.prior[1]),
        turn=_turn(impact, finer),
    )


def _turn(impact: Impact, finer: float) -> np.ndarray:
    hertz = -np.angle(impact.turn[:, 1] / impact.turn[:, 0]) / (2 * np.pi * STEP_S)
    middle = (np.arange(impact.turn.shape[1]) + 0.5) * STEP_S
    return np.asarray(STEP_S * np.exp(-2j * np.pi * finer * np.outer(hertz, middle)))


def _apart(bodies: Bodies, true: Fitted, other: Fitted) -> float:
    # What made the data fits them from where it is; the rival may look for its best.
    right = again(bodies, true)
    return right.log_evidence - best_fit(bodies, other.hypothesis).log_evidence
