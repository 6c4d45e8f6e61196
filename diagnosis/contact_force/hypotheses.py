"""What a contact may be: that of the baseline model with its scatter, or with another gap, stiffness, loss or law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.contact.laws import DAMPED
from pounding.diagnosis.case.case import Contact
from pounding.diagnosis.contact_force.impacts import LAWS, Law

GAP_M, GAP_SHARE = 3e-5, 0.003
STIFFNESS, DAMPING, RESTITUTION = 0.03, 0.05, 0.01
"""How well a contact is known that is as model: its gap [m] and as a share, stiffness, damping, restitution."""
WIDE_GAP, WIDE_STIFFNESS, WIDE_DAMPING, WIDE_RESTITUTION = 0.4, 1.0, 1.0, 0.2
"""The same where it is what is missing; the first a share of the gap, the next two of logarithms."""
USUAL_RESTITUTION, USUAL_SPREAD = 0.75, 0.12
RESTITUTION_ENDS = (0.05, 0.995)
"""Least and largest restitution that is fitted or simulated."""
UNLISTED_STIFFNESS, UNLISTED_RESTITUTION = 2e7, 0.7
UNLISTED_GAP_M, UNLISTED_SPREAD = 1e-3, 0.15
"""A contact that the case does not list: stiffness [N/m] and restitution, and the spreads of its gap [m] and restitution;
that of its stiffness is `WIDE_STIFFNESS`."""


@dataclass(frozen=True)
class Hypothesis:
    """A contact as it may be: law, centres and spreads of gap [m], log stiffness and loss (log damping or restitution)."""

    effect: str
    law: Law
    gap: float
    stiffness: float
    loss: float


def baseline_law(contact: Contact, mass: float) -> Law:
    """Return a case's contact as a law."""
    nan = float("nan")
    return Law(
        contact.law,
        contact.gap_m,
        contact.stiffness,
        nan if contact.damping is None else contact.damping,
        nan if contact.restitution is None else contact.restitution,
        mass,
    )


def null(law: Law) -> Hypothesis:
    """Return the contact of the baseline model with its scatter."""
    gap = float(np.hypot(GAP_M, GAP_SHARE * law.gap_m))
    return Hypothesis("", law, gap, STIFFNESS, _loss(law, DAMPING, RESTITUTION))


def _loss(law: Law, damping: float, restitution: float) -> float:
    if law.name not in DAMPED:
        return 0.0
    return restitution if np.isnan(law.damping) else damping


def hypotheses(law: Law, speed: float) -> list[Hypothesis]:
    """Return what a contact can be instead; `speed` [m/s] is typical of the impacts."""
    plain = null(law)
    found = [
        replace(plain, effect="gap_offset", gap=max(WIDE_GAP * law.gap_m, 1e-3)),
        replace(plain, effect="contact_stiffness", stiffness=WIDE_STIFFNESS),
    ]
    if law.name in DAMPED:
        found.append(
            replace(plain, effect="contact_damping", loss=_loss(law, WIDE_DAMPING, WIDE_RESTITUTION))
        )
    for name in LAWS:
        if name != law.name:
            other = Law(
                name,
                law.gap_m,
                equivalent(law, name, speed),
                float("nan"),
                USUAL_RESTITUTION if name in DAMPED else float("nan"),
                law.mass,
            )
            spread = USUAL_SPREAD if name in DAMPED else 0.0
            found.append(Hypothesis("contact_law", other, plain.gap, WIDE_STIFFNESS, spread))
    return found


def equivalent(law: Law, name: str, speed: float) -> float:
    """Return the stiffness with which another law stores as much at the same depth in a typical impact.

    Args:
        law: The law, with its stiffness.
        name: Name of the other law.
        speed: Velocity of a typical impact [m/s].
    """
    if law.name.startswith("linear") == name.startswith("linear"):
        return law.stiffness
    energy = 0.5 * law.mass * speed**2
    if law.name.startswith("linear"):
        depth = np.sqrt(2 * energy / law.stiffness)
        return float(2.5 * energy / depth**2.5)
    depth = (2.5 * energy / law.stiffness) ** 0.4
    return float(2 * energy / depth**2)


def at(hypothesis: Hypothesis, x: Sequence[float] | np.ndarray) -> Law:
    """Return the law at scaled gap, log stiffness and loss.

    Args:
        hypothesis: The hypothesis, with centres and spreads.
        x: Gap, log stiffness and loss about their centres in units of their spreads, shape (3,).
    """
    law = hypothesis.law
    damping, restitution = law.damping, law.restitution
    if law.name in DAMPED:
        if np.isnan(damping):
            restitution = float(np.clip(restitution + hypothesis.loss * x[2], *RESTITUTION_ENDS))
        else:
            damping = float(damping * np.exp(np.clip(hypothesis.loss * x[2], -5, 5)))
    return replace(
        law,
        gap_m=float(law.gap_m + hypothesis.gap * x[0]),
        stiffness=float(law.stiffness * np.exp(np.clip(hypothesis.stiffness * x[1], -5, 5))),
        damping=damping,
        restitution=restitution,
    )


def near(hypothesis: Hypothesis, law: Law, reach: float) -> tuple[float, float, float]:
    """Return scaled gap, log stiffness and loss (see `at`) with which a hypothesis comes nearest to a law of its kind.

    Args:
        hypothesis: The hypothesis.
        law: A law of the same name.
        reach: How far each may go [standard deviations].
    """
    own = hypothesis.law
    if law.name not in DAMPED or hypothesis.loss == 0:
        loss = 0.0
    elif np.isnan(own.damping):
        loss = (law.restitution - own.restitution) / hypothesis.loss
    else:
        loss = float(np.log(law.damping / own.damping)) / hypothesis.loss
    gap = (law.gap_m - own.gap_m) / hypothesis.gap
    stiffness = float(np.log(law.stiffness / own.stiffness)) / hypothesis.stiffness
    found = np.clip([gap, stiffness, loss], -reach, reach)
    return float(found[0]), float(found[1]), float(found[2])
