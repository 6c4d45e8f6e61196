"""How sure a verdict is: the odds that it is right, from its evidence and margins, by coefficients fitted to cases.

The form is logistic regression, one set of coefficients a verdict, in `confidence.toml` with a note where they come
from. ``python -m pounding.diagnosis.benchmark.fitting PAIRS.jsonl NOTE`` fits them: each line of the file is a report's
`confidence_basis` `features` with a key `right` (whether type and place of every effect were right and nothing else was
claimed).
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np
from msgspec import UNSET, Struct, UnsetType
from scipy.optimize import minimize
from scipy.special import expit

from pounding.diagnosis.decision.decision import NAMED, Decision, Verdict
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.settings import SETTINGS
from pounding.frames.files import write_whole

Kind = Literal[Verdict, "contact_named", "pair_nothing_missing"]
NOTHING: Kind = "nothing_missing"
CONTACT: Kind = "contact_named"
PAIR_NOTHING: Kind = "pair_nothing_missing"
TERMS = ("intercept", "ln_bayes", "margin", "signal_to_noise", "explained", "several")
FORMER = {
    "gap": "misfit",
    "nats": "ln_bayes",
    "visible": "signal_to_noise",
    "closed": "explained",
    "believed": "baseline",
    "foretold": "predicted",
}
"""Names of today by those of reports of schema 1 and of calibrations of that time; they are still read."""
SIGNS: dict[str, int] = {
    NOTHING: -1,
    "effect_named": 1,
    "effect_class": 1,
    "unknown_effect": 0,
    CONTACT: 1,
    PAIR_NOTHING: -1,
}
"""Which way evidence may move the confidence in a verdict, whatever a few cases say."""
VERDICTS: tuple[str, ...] = tuple(SIGNS)
"""Kinds of verdicts on frames, a claim on what is between two of them, and none: a contact hides much."""
FILE = Path(__file__).with_name("confidence.toml")


@dataclass(frozen=True)
class Features:
    """What a verdict's confidence rests on.

    Attributes:
        verdict: Its kind.
        ln_bayes: Logarithm of the Bayes factor of the best candidate against 'nothing missing'.
        margin: How far the best of another type or place lies behind, as an ln Bayes factor.
        signal_to_noise: What the effect takes out of the channel where it shows most, in units of its noise.
        explained: Share of the explainable misfit that the effects explain.
        effects: How many effects are claimed.
    """

    verdict: Kind
    ln_bayes: float
    margin: float
    signal_to_noise: float
    explained: float
    effects: int

    def terms(self) -> np.ndarray:
        """Return the terms that the coefficients multiply, shape (terms,), in the order of `TERMS`."""
        return np.array(
            [
                1.0,
                np.log1p(max(_finite(self.ln_bayes), 0.0) / 10),
                np.log1p(max(_finite(self.margin), 0.0) / 10),
                np.log(np.clip(_finite(self.signal_to_noise), 0.05, 50.0)),
                np.clip(_finite(self.explained), -1.0, 1.0),
                float(self.effects > 1),
            ]
        )


def _finite(value: float) -> float:
    return float(value) if np.isfinite(value) else 0.0


@dataclass(frozen=True)
class Calibration:
    """Coefficients of each verdict in the order of `TERMS`, and where they come from."""

    source: str
    coefficients: Mapping[str, Sequence[float]]


@cache
def shipped() -> Calibration:
    """Return the calibration that comes with the package."""
    return read_calibration(FILE)


def read_calibration(path: Path) -> Calibration:
    """Read a calibration.

    Raises:
        CaseError: It lacks a verdict or a term.
    """
    raw = with_new_names(tomllib.loads(path.read_text(encoding="utf-8")))
    try:
        found = {verdict: [float(raw[verdict][term]) for term in TERMS] for verdict in VERDICTS}
        return Calibration(str(raw["source"]), found)
    except KeyError as error:
        raise CaseError(f"{path}: the key {error} is missing; fit the calibration anew") from error


def confidence(features: Features, calibration: Calibration | None = None) -> float:
    """Return the probability that a verdict with these features is right."""
    weights = np.asarray((calibration or shipped()).coefficients[features.verdict], float)
    return float(np.clip(expit(weights @ features.terms()), *SETTINGS.confidence.limits))


def features_of(found: Findings, decision: Decision, signal_to_noise: float, explained: float) -> Features:
    """Return the features of a verdict.

    Args:
        found: What the search found.
        decision: The verdict.
        signal_to_noise: Of the effects in question (see `pounding.diagnosis.decision.measures.signal_to_noise`).
        explained: Share of the explainable misfit that they explain.
    """
    best = decision.judged
    if decision.verdict == NOTHING:
        singles = [one for one in found.judged if len(one.effects) == 1]
        ln_bayes = singles[0].ln_bayes if singles else 0.0
        kind = NOTHING if found.pair is None else PAIR_NOTHING
        return Features(kind, _finite(ln_bayes), 0.0, _finite(signal_to_noise), _finite(explained), 0)
    mine = best.places.union(*(one.places for one in decision.alike))
    others = [one.ln_bayes for one in found.claimable() if not one.places & mine]
    refined = {effect for one in found.judged for effect in one.effects}
    others += [
        one.ln_bayes
        for one in found.scores.ranked
        if one.effect not in refined and one.effect.key not in mine
    ]
    margin = best.ln_bayes - max(others, default=0.0)
    return Features(
        decision.verdict,
        _finite(best.ln_bayes),
        _finite(margin),
        _finite(signal_to_noise),
        _finite(explained),
        len(best.effects),
    )


def features_from(entry: Mapping[str, Any]) -> Features:
    """Return features from JSON, also from that of schema 1, whose names were others.

    Raises:
        msgspec.ValidationError: They are no features.
    """
    given = {key: 0.0 if value is None else value for key, value in with_new_names(entry).items()}
    return msgspec.convert(given, Features)


def with_new_names(entry: Any) -> Any:
    """Return what was read from JSON or TOML, its keys of schema 1 by their names of today."""
    if isinstance(entry, list):
        return [with_new_names(one) for one in entry]
    if not isinstance(entry, Mapping):
        return entry
    return {FORMER.get(key, key): with_new_names(value) for key, value in entry.items()}


class SimulatedTruth(Struct, frozen=True, kw_only=True):
    """How many cases that hid `truth` were simulated on a rig, and how many of their verdicts were right."""

    truth: str
    right: int
    cases: int


class Basis(Struct, frozen=True, kw_only=True):
    """What stands behind a stated confidence.

    Attributes:
        calibration: Where its coefficients come from.
        features: Of the verdict on the frames; unset where confidence is a posterior probability.
        contact: Of claims on what is between the frames and on its force cell.
        simulated: The cases of a calibration on the rig.
    """

    calibration: str
    features: Features | UnsetType = UNSET
    contact: Features | UnsetType = UNSET
    simulated: tuple[SimulatedTruth, ...] | UnsetType = UNSET

    def behind(self) -> tuple[Features, ...]:
        """Return the features that the confidence rests on: the frames', the contact's, or those of claims on both."""
        frames, contact = self.features, self.contact
        if isinstance(frames, UnsetType):
            return ()
        if isinstance(contact, UnsetType):
            return (frames,)
        return (frames, contact) if frames.verdict in NAMED else (contact,)

    def confidence(self, calibration: Calibration | None = None) -> float:
        """Return the confidence that a calibration states for these features: the shipped one when None."""
        return float(np.prod([confidence(one, calibration) for one in self.behind()]))


def basis(features: Features) -> Basis:
    """Return what stands behind a confidence that the shipped calibration states."""
    return Basis(calibration=shipped().source, features=features)


def fit(
    pairs: Iterable[tuple[Features, bool]], source: str, around: Calibration | None = None
) -> Calibration:
    """Return coefficients by logistic regression with shrinkage, a verdict at a time.

    Args:
        pairs: Features of verdicts, and whether each was right.
        source: Where the cases come from, for the report's reader.
        around: Calibration towards which the coefficients shrink; without one towards the odds over all verdicts.

    Raises:
        CaseError: There is no case at all.
    """
    known = list(pairs)
    if not known:
        raise CaseError("no case to fit the confidence to; give at least one line of features with `right`")
    overall = float(np.clip(np.mean([right for _, right in known]), 0.05, 0.95))
    found = {}
    for verdict in VERDICTS:
        chosen = [(features, right) for features, right in known if features.verdict == verdict]
        prior = np.log(overall / (1 - overall)) * np.eye(len(TERMS))[0]
        spread = np.array([SETTINGS.confidence.intercept] + [SETTINGS.confidence.slope] * (len(TERMS) - 1))
        if around is not None:
            # A rig's own rate may well be another one; how it depends on the features is the other cases' to say.
            prior, spread[0] = np.asarray(around.coefficients[verdict], float), SETTINGS.confidence.rig
        found[verdict] = _regression(chosen, prior, spread, SIGNS[verdict])
    return Calibration(source, found)


def refitted(
    pairs: Iterable[tuple[Features, bool]], source: str, verdicts: Sequence[str] = ()
) -> Calibration:
    """Return the shipped calibration with the coefficients of some verdicts fitted anew.

    Args:
        pairs: Features of verdicts, and whether each was right.
        source: Where the coefficients of all verdicts come from, for the report's reader.
        verdicts: Which are fitted; those that occur when empty.

    Raises:
        CaseError: There is no case at all, a verdict is not known, or no case has it.
    """
    known = list(pairs)
    occurring = {features.verdict for features, _ in known}
    for verdict in verdicts:
        if verdict not in VERDICTS:
            raise CaseError(f"verdict {verdict!r} is not known; use one of {', '.join(VERDICTS)}")
        if verdict not in occurring:
            raise CaseError(f"no case has the verdict {verdict!r}; leave it out, or give cases that have it")
    learnt = fit(known, source).coefficients
    return Calibration(
        source, dict(shipped().coefficients) | {one: learnt[one] for one in verdicts or occurring}
    )


def _regression(
    pairs: Sequence[tuple[Features, bool]], prior: np.ndarray, spread: np.ndarray, sign: int
) -> list[float]:
    """Return the coefficients of one verdict, shrunk to a prior of that spread; without a case, the prior."""
    if not pairs:
        return [float(weight) for weight in prior]
    rows = np.array([features.terms() for features, _ in pairs])
    right = np.array([right for _, right in pairs], float)
    centre = rows.mean(axis=0)
    centre[0] = 0.0
    shifted = rows - centre
    # The intercept's prior is that of the odds at the mean of the cases.
    middle = prior + np.eye(len(prior))[0] * (centre @ prior)

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        odds = shifted @ weights
        off = (weights - middle) / spread
        value = float(np.sum(np.logaddexp(0.0, odds) - right * odds)) + 0.5 * float(off @ off)
        return value, shifted.T @ (expit(odds) - right) + off / spread

    either, one_way = (None, None), (0.0, None) if sign > 0 else (None, 0.0)
    bounds = [one_way if term in ("ln_bayes", "margin") and sign else either for term in TERMS]
    weights = minimize(loss, middle, jac=True, method="L-BFGS-B", bounds=bounds).x
    weights[0] -= centre @ weights
    return [float(weight) for weight in weights]


def write_calibration(calibration: Calibration, path: Path = FILE) -> None:
    """Write a calibration where `read_calibration` finds it, the comment at the head of the old one kept."""
    old = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    lines = [line for line in old if line.startswith("#")]
    lines.append(f"source = {json.dumps(calibration.source)}")
    for verdict in VERDICTS:
        lines += ["", f"[{verdict}]"]
        numbers = zip(TERMS, calibration.coefficients[verdict], strict=True)
        lines += [f"{term} = {weight:.4f}" for term, weight in numbers]
    write_whole(path, ("\n".join(lines) + "\n").encode())


def read_pairs(path: Path) -> list[tuple[Features, bool]]:
    """Read features with `right`, a JSON object a line.

    Raises:
        CaseError: A line is not such an object.
    """
    found = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip():
            continue
        try:
            entry = json.loads(line)
            right = bool(entry.pop("right"))
            found.append((features_from(entry), right))
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise CaseError(f"{path} line {number}: not features with `right`: {error}") from error
    return found
