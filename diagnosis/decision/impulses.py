"""Short pushes on a floor that nothing in a model makes: blows, or a part that strikes.

They show in the innovations as the response to a push of one sample, wherever a matched filter answers far more strongly
than at other times. Noise and slow model errors do not: a filter forgets them from one sample to the next.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from pounding.diagnosis.contact_force.pairs import answers
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class Impulses:
    """The pushes on the floor on which they are strongest.

    Attributes:
        place: Frame and floor, from 1.
        times: For each of them the run's name and the time from its start [s].
        strength: Sum of the answers.
    """

    place: tuple[str, int]
    times: tuple[tuple[str, float], ...]
    strength: float

    def sentence(self) -> str:
        """Return what to say of them."""
        run = self.times[0][0]
        here = [f"{time:.2f}" for name, time in self.times if name == run][: SETTINGS.pushes.listed]
        frame, floor = self.place
        return (
            f"{run}: short pushes at floor {floor} of {frame} or near it, at {', '.join(here)} s from the start, "
            "which nothing in the model makes; was the frame struck, or does a part of it hit another?"
        )


def impulses(model: Model, filtered: Filtered) -> Impulses | None:
    """Return the pushes that a baseline leaves unexplained, or None if there are too few."""
    contact_events = [
        answers(model, filtered, filtered.modes.floors[right] - filtered.modes.floors[left])
        for left, right in model.observed.contact_floors
    ]
    best: Impulses | None = None
    for floor in range(model.structure.floors):
        times, strength = [], 0.0
        for name, step_s, answer in _answers(model, filtered, floor, contact_events):
            for k in _peaks(answer, max(1, round(SETTINGS.pushes.apart_s / step_s))):
                times.append((name, k * step_s))
                strength += float(answer[k])
        if len(times) >= SETTINGS.pushes.least and (best is None or strength > best.strength):
            best = Impulses(model.structure.place(floor), tuple(times), strength)
    return best


def _answers(
    model: Model,
    filtered: Filtered,
    floor: int,
    contact_events: Sequence[Sequence[tuple[np.ndarray, np.ndarray]]],
) -> Iterator[tuple[str, float, np.ndarray]]:
    """Yield name, sampling step [s] and answers, in usual standard deviations, of each run to pushes on a floor.

    Args:
        model, filtered: The model and its filter.
        floor: The floor among all.
        contact_events: The answers to pushes on both floors of each contact, which are told apart from blows.
    """
    for number, (matched, own) in enumerate(answers(model, filtered, filtered.modes.floors[floor])):
        run = model.observed.runs[filtered.runs[number]]
        answer = np.abs(matched) / np.sqrt(own[0])
        apart = max(1, round(SETTINGS.pushes.apart_s / run.step_s))
        highest = maximum_filter1d(answer, 2 * apart + 1)
        answer[_touching(run.contact, run.step_s)] = 0.0
        # A filter begins from rest, and a low-pass knows nothing beyond a run's ends.
        answer[:apart] = answer[-apart:] = 0.0
        below = float(np.quantile(answer, SETTINGS.pushes.usual_share))
        usual = max(1.0, below / SETTINGS.pushes.usual_deviations)
        for event in contact_events:
            # What pushes both frames is a touch that the force cell did not show.
            other = event[number][0] / np.sqrt(event[number][1][0])
            answer[answer**2 < other**2 + 2 * SETTINGS.pushes.alone] = 0.0
        # The force of a touch is never quite right: what rises toward it is its flank.
        answer[answer < highest] = 0.0
        yield run.name, run.step_s, answer / usual


def _peaks(answer: np.ndarray, apart: int) -> list[int]:
    """Return the samples of plain answers, the largest of those that are near each other."""
    left, peaks = answer.copy(), []
    while (k := int(left.argmax())) >= 0 and left[k] > SETTINGS.pushes.plain:
        peaks.append(k)
        left[max(0, k - apart) : k + apart + 1] = 0.0
    return sorted(peaks)


def _touching(contact: np.ndarray, step_s: float) -> np.ndarray:
    """Return where two floors touch or have just done so, shape (samples,)."""
    near = np.zeros(len(contact), bool)
    for force in contact.T:
        size = np.abs(force)
        near |= size > SETTINGS.forces.least_share * size.max(initial=0.0)
    reach = max(1, round(SETTINGS.pushes.beside_contact_s / step_s))
    return np.asarray(maximum_filter1d(near.astype(np.uint8), 2 * reach + 1, mode="constant") > 0)
