"""From findings and the decision on them to what is concluded of a case, a contact's impacts included."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.contact_force.held_out import predicted_impacts
from pounding.diagnosis.contact_force.pair import ContactFindings, judge_contact
from pounding.diagnosis.decision.conclusion import Conclusion, of_frames
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.pair_decision import claims_of, joined
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.inference.findings import Findings


@dataclass(frozen=True)
class Diagnosis:
    """A case that was diagnosed, with all that a report, further measurements and a calibration are made from.

    Attributes:
        case: What was measured.
        found: What the search found.
        decision: The verdict on the frames.
        conclusion: What is concluded, of what is between the frames too.
        contact: What the impacts say; None for frames that do not touch.
    """

    case: Case
    found: Findings
    decision: Decision
    conclusion: Conclusion
    contact: ContactFindings | None = None


def conclude(case: Case, found: Findings, decision: Decision) -> Diagnosis:
    """Return what is concluded of findings and the decision on them.

    Where something between the frames is missing, effects of the frames need more evidence, and the findings are decided
    again.

    Args:
        case: The case.
        found: What the search found.
        decision: The decision on the frames.
    """
    pair = found.pair
    if pair is None:
        return Diagnosis(case, found, decision, of_frames(case, found, decision))
    contact = judge_contact(case, found, decision.judged)
    held_out = predicted_impacts(case, found, decision.judged.fit.filtered, contact)
    if decision.named and claims_of(case, pair, contact, decision.verdict, held_out):
        found = replace(found, pair=replace(pair, contact_claimed=True))
        before, decision = decision, decide(found)
        if decision.judged is not before.judged:
            contact = judge_contact(case, found, decision.judged)
            held_out = predicted_impacts(case, found, decision.judged.fit.filtered, contact)
    frames = of_frames(case, found, decision)
    conclusion = joined(case, pair, contact, frames, held_out, decision.objections)
    return Diagnosis(case, found, decision, conclusion, contact)
