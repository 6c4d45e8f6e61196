"""What a verdict is worth against the truth: one case at a time, no averages here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pounding.diagnosis.decision.claims import Claim, Place
from pounding.diagnosis.hidden.places import EFFECTS
from pounding.diagnosis.report.report import Misfit, Report

NOTHING, UNKNOWN, OUTSIDE = "nothing_missing", "unknown_effect", "outside"

PLACES = {
    "storey": ("frame", "storey"),
    "floor": ("frame", "floor"),
    "frame": ("frame",),
    "table": (),
    "channel": ("channel",),
    "contact": ("contact",),
    "between": ("left", "right", "floor"),
}
"""The keys that say where, by kind of place."""


@dataclass(frozen=True)
class Judged:
    """One case, judged.

    Attributes:
        kind: ``nothing``, ``single``, ``double``, ``several`` or ``outside``, of the truth.
        effects: Names of what is hidden.
        called: What the verdict says: an effect's name, ``nothing_missing`` or ``unknown_effect``.
        frames: Frames on the table.
        signal_to_noise: Largest change of a channel by the weakest hidden effect over its noise and the model's error
            together; NaN without an effect.
        detected: Something was found missing.
        exact: Type and place of every hidden effect are right and nothing else is claimed; for nothing
            hidden that nothing was found, for an outsider that it was called unknown.
        in_class: Every hidden effect is in one of the stated classes (exact verdicts are too).
        confidence: The stated one.
        misfit_explained: Share of the explainable held-out misfit that the effects explain; NaN where none was explainable.
        misfit_closed: The same of the best candidate, whether or not it is claimed.
        parameter_errors: Relative error of each parameter of the effects that were exact; from the
            nearest where a parameter has more than one definition in use.
        parameter_deviations: The same errors, each over the standard error that is stated with it.
        seconds: What the diagnosis took [s].
    """

    kind: str
    effects: tuple[str, ...]
    called: str
    frames: tuple[str, ...]
    signal_to_noise: float
    detected: bool
    exact: bool
    in_class: bool
    confidence: float
    misfit_explained: float
    misfit_closed: float
    parameter_errors: tuple[float, ...]
    parameter_deviations: tuple[float, ...]
    seconds: float


def judge(truth: Mapping[str, Any], report: Report, seconds: float = np.nan) -> Judged:
    """Judge a report by the truth.

    Args:
        truth: What was hidden (see `pounding.diagnosis.hidden.hide`).
        report: What was found.
        seconds: What it took [s].
    """
    hidden, verdict = truth["effects"], report.verdict
    claims = report.effects if report.named else ()
    detected = verdict != NOTHING
    if truth["kind"] == "nothing":
        exact = in_class = not detected
    elif truth["kind"] == OUTSIDE:
        exact = in_class = verdict == UNKNOWN
    else:
        exact = len(claims) == len(hidden) and all(_named(effect, claims) for effect in hidden)
        in_class = exact or (bool(claims) and all(_classed(effect, claims) for effect in hidden))
    weakest = min((effect["visibility"] for effect in hidden), default=np.nan)
    closed = _closed(report)
    errors = _parameter_errors(hidden, claims)
    return Judged(
        truth["kind"],
        tuple(effect["effect"] for effect in hidden),
        claims[0].effect if claims else verdict,
        tuple(truth["frames"]),
        weakest,
        detected,
        exact,
        in_class,
        np.nan if report.confidence is None else report.confidence,
        # What is not claimed explains nothing.
        closed if report.named or np.isnan(closed) else 0.0,
        closed,
        tuple(relative for relative, _ in errors),
        tuple(deviations for _, deviations in errors if np.isfinite(deviations)),
        seconds,
    )


def same(truth: Mapping[str, Any], claim: Place) -> bool:
    """Return whether type and place agree."""
    if truth["effect"] != claim.effect:
        return False
    return all(truth.get(key) == getattr(claim, key) for key in PLACES[EFFECTS[truth["effect"]].place])


def _named(truth: Mapping[str, Any], claims: Sequence[Claim]) -> Claim | None:
    return next((claim for claim in claims if same(truth, claim)), None)


def _classed(truth: Mapping[str, Any], claims: Sequence[Claim]) -> bool:
    return any(same(truth, member) for claim in claims for member in (claim, *claim.members))


def _closed(report: Report) -> float:
    """Return the share of the held-out misfit above the noise floor that the best effects explain, NaN where it has none.

    What is named of a contact alone is judged by the held-out impacts: forces are known inputs to the frames' motion.
    """
    misfit: Misfit | None = report.misfit.held_out
    if report.effects and all(_of_a_contact(one) for one in report.effects):
        impacts = report.misfit.contact
        misfit = Misfit(before=impacts.before, after=impacts.after, noise_floor=1.0) if impacts else None
    share = None if misfit is None else misfit.share()
    return np.nan if share is None else share


def _of_a_contact(claim: Claim) -> bool:
    """Whether a claim is one on a contact; what nobody can hide, as a candidate of the user's, acts on frames."""
    known = EFFECTS.get(claim.effect)
    return known is not None and known.place in ("contact", "between")


def _parameter_errors(
    hidden: Sequence[Mapping[str, Any]], claims: Sequence[Claim]
) -> list[tuple[float, float]]:
    """Return the error of each parameter of what is named, relative and in standard errors (NaN where none is stated)."""
    errors = []
    for effect in hidden:
        claim = _named(effect, claims)
        if claim is None:
            continue
        found = {parameter.name: (parameter.value, parameter.std) for parameter in claim.parameters}
        for parameter in effect["parameters"]:
            value, std = found.get(parameter["name"], (None, None))
            if isinstance(value, int | float) and isinstance(parameter["value"], int | float):
                stated = [parameter["value"], *parameter.get("also", ())]
                off = min((abs(value - one) for one in stated if one), default=np.nan)
                errors.append((min(abs(value / one - 1) for one in stated), off / std if std else np.nan))
    return errors
