"""What modal data say of each frame: which effect explains frequencies, roof stiffness and mass."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from scipy.stats import chi2

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.modal_evidence import (
    Weighed,
    foretold_from_others,
    modal_candidates,
    weigh,
)
from pounding.diagnosis.inference.modal_model import Joints, alone, joints
from pounding.diagnosis.inference.search import Progress
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class ModalFindings:
    """What was found of one frame: data, the baseline model, single effects and pairs, best first."""

    model: Model
    data: tuple[ModalDatum, ...]
    null: Weighed
    singles: tuple[Weighed, ...]
    pairs: tuple[Weighed, ...]

    @property
    def frame(self) -> str:
        """The frame's name."""
        return self.model.structure.frames[0].name

    @cached_property
    def foretold(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Each datum as predicted from the others, SI, and how far it lies off [standard deviations], each (data,)."""
        chosen = {"null": self.null, "best": self.best}
        return {key: foretold_from_others(self.model, self.data, one.acting) for key, one in chosen.items()}

    @property
    def best(self) -> Weighed:
        """What is claimed: nothing, a single effect, or a pair that is worth its second effect."""
        single = self.singles[0]
        if single.log_evidence < self.null.log_evidence + SETTINGS.modal.evidence:
            return self.null
        if self.pairs and self.pairs[0].log_evidence > single.log_evidence + SETTINGS.modal.evidence:
            return self.pairs[0]
        return single

    @property
    def alike(self) -> tuple[Weighed, ...]:
        """Other explanations of the same number of effects that these data cannot tell from the best."""
        rivals = {0: (), 1: self.singles, 2: self.pairs}[len(self.best.acting)]
        return tuple(
            one
            for one in rivals
            if one is not self.best and one.log_evidence > self.best.log_evidence - SETTINGS.modal.evidence
        )

    @property
    def fits(self) -> bool:
        """Whether the best explanation leaves no more than the stated uncertainties."""
        freedom = max(len(self.data) - len(self.best.acting), 1)
        return bool(chi2.sf(self.best.misfit, freedom) > SETTINGS.modal.unlikely)


def examine(
    model: Model,
    flexible: Joints | None,
    data: Sequence[ModalDatum],
    told: Callable[[str], None] = lambda what: None,
) -> ModalFindings:
    """Return what modal data of one frame say of single effects and of pairs with the best one.

    Args:
        model: The baseline model.
        flexible: Its joints as an effect, or None for a frame without any.
        data: Modal data of the frame.
        told: Called with what is being tried.
    """
    candidates = modal_candidates(model, flexible, data)
    null = weigh(model, data)
    singles = []
    for one in candidates:
        told(one.label())
        singles.append(weigh(model, data, [one]))
    singles.sort(key=lambda one: -one.log_evidence)
    pairs: list[Weighed] = []
    if singles[0].log_evidence > null.log_evidence + SETTINGS.modal.evidence:
        for first in leaders(singles):
            for one in candidates:
                if (
                    (one.where == "frame" or one.test)
                    and one != first
                    and {one, first} not in [set(pair.acting) for pair in pairs]
                ):
                    told(f"{first.label()} with {one.label()}")
                    pairs.append(weigh(model, data, [first, one]))
    pairs.sort(key=lambda one: -one.log_evidence)
    return ModalFindings(model, tuple(data), null, tuple(singles), tuple(pairs))


def leaders(singles: Sequence[Weighed]) -> list[Effect]:
    """Return what the pairs are built on: the best single effect, and the best that acts in every test."""
    everywhere = next(one.acting[0] for one in singles if one.acting[0].test is None)
    return list(dict.fromkeys([singles[0].acting[0], everywhere]))


def search_modal(case: Case, progress: Progress) -> list[ModalFindings]:
    """Return what a case's modal data say of each frame that has any.

    Args:
        case: The case.
        progress: Called with what is being done and the share that is done.
    """
    found = []
    for number, (frame, storeys) in enumerate(zip(case.frames, baseline_frames(case), strict=True)):
        data = [datum for datum in case.modal if datum.frame == frame.name]
        if data:
            told = partial(_told, progress, 0.1 + 0.8 * number / len(case.frames))
            found.append(examine(alone(storeys, case.prior), joints(frame), data, told))
    return found


def _told(progress: Progress, share: float, what: str) -> None:
    progress(what, share)
