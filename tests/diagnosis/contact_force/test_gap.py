"""The gap of a contact: how certain it is, and what is said of one that never closes."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.contact_force.pair import ContactFindings, contact_findings, prepare
from pounding.diagnosis.decision.pair_decision import contact_claims
from pounding.diagnosis.settings import SETTINGS
from tests.diagnosis.pair_models import CONTACT, colliding, model_of


def test_what_all_distances_have_in_common_no_number_of_impacts_makes_certain() -> None:
    """Where a floor is when it is hit is as wrong as the model of its frame, every time."""
    case = colliding(CONTACT)
    pair = prepare(case, model_of(case))
    still = np.zeros(len(model_of(case).std))

    def found(*errors: float) -> Fitted:
        null = contact_findings(case, pair, still, (), (0, 1), np.array(errors)).null
        assert null is not None
        return null

    plain, one, other, both = found(0.0, 0.0), found(0.02, 0.0), found(0.0, 0.02), found(0.02, 0.02)
    left, right = (np.sqrt(each.std[0] ** 2 - plain.std[0] ** 2) / 0.02 for each in (one, other))
    # When they touch, the floors have come nearer by the gap.
    assert min(abs(left + right - CONTACT.gap_m), abs(left - right - CONTACT.gap_m)) < 0.3 * CONTACT.gap_m
    assert both.std[0] ** 2 - plain.std[0] ** 2 == pytest.approx(0.02**2 * (left**2 + right**2))
    assert both.std[1:] == plain.std[1:]
    assert both.log_evidence == plain.log_evidence


@pytest.mark.parametrize(("beyond", "claimed"), [(-1.0, False), (3.0, True), (6.0, True)])
def test_a_contact_that_never_closes_is_wider_by_as_much_as_floors_came_beyond_it(
    beyond: float, claimed: bool
) -> None:
    case, spread = colliding(CONTACT), 5e-5
    nearest = CONTACT.gap_m + beyond * spread
    found = contact_claims(case, ContactFindings(None, nearest_m=nearest, spread_m=spread))
    assert bool(found) == claimed
    for one in found:
        assert one.effect == "gap_offset"
        assert one.parameters[0].value == pytest.approx(1e3 * beyond * spread)
        assert one.log_evidence == pytest.approx(0.5 * beyond**2 - SETTINGS.pair_decision.parameter_cost)
