"""How well a contact fitted to some impacts predicts others, and the most that these could have told."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.contact_force import contacts
from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.contact_force.hypotheses import baseline_law
from pounding.diagnosis.contact_force.impacts import Bodies, Law, sharper
from pounding.diagnosis.contact_force.pair import ContactFindings, met_in
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class HeldOutImpacts:
    """How well held-out impacts are predicted, root mean square in standard deviations of the forces: 1 is as it should be.

    Attributes:
        impacts: How many impacts.
        model: With the contact of the baseline model.
        likeliest: With the likeliest other contact, as fitted to the training runs.
        gained: Gain of log likelihood of the likeliest over the contact of the baseline model with its scatter, as fitted to
            the training runs too; what goes further than scatter is what may be missing.
        expected: The gain that these impacts would give if the likeliest contact had made them.
    """

    impacts: int
    model: float
    likeliest: float
    gained: float
    expected: float

    @property
    def supports(self) -> bool:
        """Whether the likeliest contact may have made these impacts, so far as they can tell it from the baseline's.

        If it did, the gain is normal about `expected` with twice that as its variance, as of any likelihood ratio.
        """
        needs = SETTINGS.pair_decision
        least = self.expected - needs.held_out_spread * math.sqrt(2.0 * self.expected)
        return self.gained > min(least, needs.held_out_most)


def predicted_impacts(
    case: Case, found: Findings, filtered: Filtered, contact_findings: ContactFindings
) -> HeldOutImpacts | None:
    """Return how well the contact of the baseline model and the likeliest one predict held-out impacts; None without any.

    Each impact is predicted from the measured motion before it: a run through several impacts departs from the measured
    one after the first few whatever the contact.

    Args:
        case: The case.
        found: What the search found.
        filtered: The frames as the decision on them has them.
        contact_findings: What the impacts of the training runs say of the contact.
    """
    if found.pair is None or contact_findings.null is None or not found.held_out:
        return None
    _, _, met = met_in(found.pair, filtered.values, filtered.effects, found.held_out)
    if len(met.impacts) < SETTINGS.impacts.least:
        return None
    met = sharper(met, contact_findings.error)
    model = contacts.held(met, baseline_law(case.contacts[0], met.mass))
    baseline, other = contacts.within_scatter(contact_findings.null), contact_findings.ranked[0][1].law
    nuisance, likeliest = compared(met, baseline, other)
    expected = expected_gain(met, baseline, likeliest)
    return HeldOutImpacts(
        len(met.impacts), model.misfit, likeliest.misfit, nuisance.cost - likeliest.cost, expected
    )


def compared(met: Bodies, one: Law, other: Law) -> tuple[Fitted, Fitted]:
    """Return two laws held on the same impacts, each fitted also from where the other has filter and impacts.

    Alone a descent may end in a local optimum, and the difference of two costs would be that of two such optima.

    Args:
        met: The impacts.
        one, other: The laws.
    """
    first, second = contacts.held(met, one), contacts.held(met, other)
    each = [(first, contacts.again(met, first, second)), (second, contacts.again(met, second, first))]
    left, right = (min(tried, key=lambda fitted: fitted.cost) for tried in each)
    return left, right


def expected_gain(met: Bodies, law: Law, likeliest: Fitted) -> float:
    """Return the gain of log likelihood over a law that impacts would give if the likeliest contact had made them.

    Args:
        met: The impacts.
        law: The law.
        likeliest: The likeliest contact, held on these impacts.
    """
    missed, made = compared(contacts.as_fitted(met, likeliest), law, likeliest.law)
    return max(missed.cost - made.cost, 0.0)
