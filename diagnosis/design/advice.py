"""More data, better answer: which further measurement would tell apart what the data of a diagnosis cannot."""

from __future__ import annotations

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.design import contact_advice, frame_advice
from pounding.diagnosis.design.contenders import Advice
from pounding.diagnosis.settings import SETTINGS


def advice(diagnosis: Diagnosis) -> list[Advice]:
    """Return what to say of further measurements, the best first; none for a clear verdict.

    Of frames that pound it is their impacts that are in question.
    """
    if diagnosis.contact is not None:
        return contact_advice.advice(diagnosis.contact, SETTINGS.pair_decision.contact_evidence)
    return frame_advice.advice(diagnosis.found, diagnosis.decision)
