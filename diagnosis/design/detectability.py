"""The smallest effect that a case's data could have shown: where its evidence and its size would reach a verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from msgspec import Struct

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.claims import Parameter, Place, fields, place_of
from pounding.diagnosis.decision.conclusion import parameters
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.false_alarms import thresholds
from pounding.diagnosis.effects.bases import Departure
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.coordinates import box_of
from pounding.diagnosis.inference.evidence import Score, Scores
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.model.forked import forked

ROUNDS = 8
LARGEST_STRIDE = 4.0
HALVINGS = 4
"""How often an amplitude that is not yet seen is raised, and at most by which factor; how often the way back is halved."""


@dataclass(frozen=True)
class Smallest:
    """The least of an effect at one place: its SI parameters, and the amplitude by which places are compared."""

    effect: Effect
    values: np.ndarray
    amplitude: float


class Sized(Place, frozen=True, kw_only=True):
    """An effect at a place with a size."""

    parameters: tuple[Parameter, ...]

    def size(self) -> str:
        """Return the size in words: `gap 0.3 mm, stiffness 400 N/m`."""
        return ", ".join(one.words(digits=2) for one in self.parameters)


class Detectability(Struct, frozen=True, kw_only=True):
    """How small an effect of the catalogue may be and still be found.

    Attributes:
        effect: Its name.
        places: At how many places it may be.
        shown: At how many of these some size could be shown.
        best, worst: Least size where it shows best and where it shows worst; None where no possible size could be shown.
    """

    effect: str
    places: int
    shown: int
    best: Sized | None
    worst: Sized | None


def smallest(case: Case, found: Findings, decision: Decision, sight: Sight) -> list[Detectability]:
    """Return for each effect of the catalogue how small it may be and still be found, at its best and worst place.

    Two things must be reached (see `decision.verdict.decide`): the evidence, which grows with the square of the
    amplitude over its standard error, and the share of a channel's noise that the effect makes up after the nuisance
    parameters have imitated what they can.

    Args:
        case: The case, for the units of its channels.
        found: What was found.
        decision: The verdict; the effects in it are part of the model about which this is worked out.
        sight: What changes of that model do to the channels.
    """
    kinds: dict[str, list[Smallest | None]] = {}
    about = _scores(found, decision)
    least = forked(lambda one: _least(found, *one, sight), about, shared=found.shared, at_once=found.is_light)
    for (one, _), size in zip(about, least, strict=True):
        kinds.setdefault(one.effect.name, []).append(size)
    return [_entry(case, found, name, places) for name, places in kinds.items()]


def threshold(information: np.ndarray, ln_bayes: float) -> np.ndarray:
    """Return the amplitude whose expected ln Bayes factor has a value [prior standard deviations], shape of `information`.

    The evidence of a pull I z is (I z)^2 / (2 (1 + I)) - log(1 + I) / 2 (see `pounding.diagnosis.inference.evidence.score`).

    Args:
        information: Information I of the data on the amplitude in prior standard deviations, shape (shapes,).
        ln_bayes: The ln Bayes factor.
    """
    needed = ln_bayes + 0.5 * np.log1p(information)
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(2 * needed * (1 + information)) / information)


def reach_beyond(information: float, own: np.ndarray, reach: float, ln_bayes: float) -> float:
    """Return the amplitude of a change that nuisance parameters are, too, at which its ln Bayes factor has a value.

    They imitate it as far as they may go (`box_of`), and what is beyond has the evidence of data that know no prior.

    Args:
        information: Information of the data on the amplitude, with these parameters free.
        own: Prior standard deviations of these parameters in that of the amplitude, shape (parameters,).
        reach: How far they may go [prior standard deviations].
        ln_bayes: The ln Bayes factor.
    """
    variance = 1.0 / information - float(np.sum(own**2))
    if variance <= 0:
        return float("inf")
    return reach * float(np.sum(own)) + float(threshold(np.array(1.0 / variance), ln_bayes))


def _scores(found: Findings, decision: Decision) -> list[tuple[Score, Scores]]:
    """Return every candidate's score about the model of the verdict, or about the null model where that is all."""
    about = [(one, found.scores) for one in found.scores.ranked]
    if found.later is not None and decision.judged is not found.null:
        later = {id(one.effect): (one, found.later) for one in found.later.ranked}
        about = [later.get(id(one.effect), (one, scores)) for one, scores in about]
    return [(one, scores) for one, scores in about if not one.effect.rival]


def _least(found: Findings, one: Score, scores: Scores, sight: Sight) -> Smallest | None:
    effect, model = one.effect, found.model
    ln_bayes, size = thresholds(found, effect.absorbing)
    shapes = effect.grid(found.sizes)
    first = one.column - next(i for i, shape in enumerate(shapes) if shape == one.shape)
    information = np.diag(scores.projected)[first : first + len(shapes)]
    widths = np.array([effect.size(model, found.sizes, shape) for shape in shapes])
    information = np.maximum(information, 1e-12)
    amplitudes = threshold(information, ln_bayes) * widths
    own = _own(effect, found)
    if own.size:
        reach = box_of(len(model.std))
        further = [
            reach_beyond(i, own / w, reach, ln_bayes) * w for i, w in zip(information, widths, strict=True)
        ]
        amplitudes = np.minimum(amplitudes, further)
    best = int(np.argmin(amplitudes / widths))
    sign = effect.sign or 1
    amplitude = _raised(
        float(amplitudes[best]),
        effect.largest(model),
        size,
        lambda tried: sight.of_effect(effect, effect.values(sign * tried, shapes[best])),
    )
    if amplitude is None:
        return None
    compared = amplitude / widths[best] if effect.where in ("channel", "logger") else amplitude
    return Smallest(effect, effect.values(sign * amplitude, shapes[best]), float(compared))


def _raised(amplitude: float, largest: float, size: float, seen: Callable[[float], float]) -> float | None:
    """Return an amplitude raised until it is seen, by no more than is needed; None where no possible one is.

    Args:
        amplitude: The amplitude that has enough evidence.
        largest: The largest that is possible.
        size: What must be seen [noise of a channel].
        seen: From an amplitude to what is seen of it.
    """
    below = 0.0
    for _ in range(ROUNDS):
        if not (np.isfinite(amplitude) and amplitude <= largest):
            return None
        shown = seen(amplitude)
        if shown >= size:
            break
        below = amplitude
        amplitude *= min(1.02 * size / max(shown, 1e-9), LARGEST_STRIDE)
    else:
        return None
    # What nuisance parameters imitate up to a bound is not seen in proportion: the stride may have been far too long.
    for _ in range(HALVINGS if below else 0):
        middle = float(np.sqrt(below * amplitude))
        below, amplitude = (below, middle) if seen(middle) >= size else (middle, amplitude)
    return amplitude


def _own(effect: Effect, found: Findings) -> np.ndarray:
    """Return the prior standard deviations [SI] of the nuisance parameters that are the same change, shape (parameters,).

    None beside reference runs, in which they act and the effect does not.
    """
    if not isinstance(effect, Departure) or len(effect.places) != 1 or found.reference:
        return np.zeros(0)
    kinds = (
        (effect.parameter, "base_stiffness")
        if effect.parameter == "storey_stiffness"
        else (effect.parameter,)
    )
    each = zip(found.model.parameters, found.model.std, strict=True)
    return np.array([std for one, std in each if one.kind in kinds and one.place == effect.places[0]])


def _entry(case: Case, found: Findings, name: str, places: list[Smallest | None]) -> Detectability:
    shown = sorted((one for one in places if one is not None), key=lambda one: one.amplitude)

    def sized(one: Smallest) -> Sized:
        nothing = np.zeros(len(one.values))
        sizes = parameters(case, found, one.effect, one.values, nothing)
        return Sized(
            **fields(place_of(one.effect)),
            parameters=tuple(Parameter(name=p.name, value=p.value, unit=p.unit) for p in sizes),
        )

    return Detectability(
        effect=name,
        places=len(places),
        shown=len(shown),
        best=sized(shown[0]) if shown else None,
        worst=sized(shown[-1]) if shown and len(shown) == len(places) else None,
    )
