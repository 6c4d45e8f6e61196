"""At which intensity each record brings floors together, and what it does beyond."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.contacts import Contact, sides_of
from pounding.experiments.rig.many import Case, Outcome, many
from pounding.experiments.rig.required_gap import place_motions
from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Limit:
    """A limit that a run may pass.

    Attributes:
        kind: ``force`` of a contact [N] or ``drift`` of a storey over its height [-].
        value: The limit.
    """

    kind: Literal["force", "drift"]
    value: float

    def passed(self, found: Outcome, frames: Sequence[ReducedFrame]) -> bool:
        """Return whether a run passes it.

        Args:
            found: What is kept of the run.
            frames: Its frames.
        """
        if self.kind == "force":
            return bool(found.peak_force_n.max(initial=0.0) > self.value)
        ratios = [
            drift / np.diff(frame.heights_m, prepend=0.0)
            for drift, frame in zip(found.drift_m, frames, strict=True)
        ]
        return bool(np.concatenate(ratios).max() > self.value)


def closings(frames: Sequence[ReducedFrame], contacts: Sequence[Contact], record: Record) -> Real:
    """Return how far the floors of each contact would close without it (c,) [m]; all runs are linear and exact.

    Args:
        frames: Frames in a row.
        contacts: Contacts between neighbours.
        record: The shaking at their scale.

    Raises:
        ExperimentError: A frame yields.
    """
    sides = [sides_of(frames, contact) for contact in contacts]
    moved = []
    for body, frame in enumerate(frames):
        rows = [side.row for pair in sides for side in pair if side.body == body]
        moved.append(iter(place_motions(frame, record, np.stack(rows)).T if rows else ()))
    # Each frame gives its places in the order of the contacts.
    return np.array([max(0.0, float((next(moved[a.body]) - next(moved[b.body])).max())) for a, b in sides])


def touching_intensity(
    closing_m: Real, contacts: Sequence[Contact], record: str, intensity_g: float
) -> float:
    """Return the intensity at which a record just brings floors together [g].

    Until the first touch linear buildings move in proportion to the shaking, so that one run says it for all gaps.

    Args:
        closing_m: How far the floors of each contact close under the record as it is (c,) [m]; see `closings`.
        contacts: The contacts.
        record: Name of the record.
        intensity_g: Its intensity as it is [g].

    Raises:
        ExperimentError: The floors never approach each other.
    """
    near = closing_m > 0.0
    if not near.any():
        raise ExperimentError(f"record {record}: while it lasts the floors do not approach each other")
    gaps = np.array([contact.gap_m for contact in contacts])
    return float(intensity_g * np.min(gaps[near] / closing_m[near]))


def touching_intensities(
    frames: Sequence[ReducedFrame],
    contacts: Sequence[Sequence[Contact]],
    records: Sequence[Record],
    strengths_g: Real,
    *,
    progress: Callable[[int], None],
) -> NDArray[np.float64]:
    """Return the intensity at which each record brings floors together, for each set of gaps (sets, records) [g].

    Args:
        frames: Frames in a row.
        contacts: Contacts between neighbours, once for each set of gaps; they differ in these alone.
        records: The shakings at their scale.
        strengths_g: The intensity of each record as it is (n,) [g].
        progress: Called with the number of records that are done.

    Raises:
        ExperimentError: A frame yields, or floors never approach each other.
    """
    found = []
    for number, (one, strength) in enumerate(zip(records, strengths_g, strict=True), 1):
        closing = closings(frames, contacts[0], one)
        found.append([touching_intensity(closing, places, one.name, float(strength)) for places in contacts])
        progress(number)
    return np.array(found).T


def passing(
    frames: Sequence[ReducedFrame],
    contacts: Sequence[Contact],
    records: Sequence[Record],
    factors: Real,
    limits: Sequence[Limit],
    *,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> NDArray[np.bool_]:
    """Return whether each record at each level passes each limit (limits, records, levels), by runs with contact.

    Args:
        frames: Frames in a row.
        contacts: Contacts between neighbours.
        records: The shakings at their scale.
        factors: What each record's acceleration is multiplied by at each level (records, levels).
        limits: The limits.
        workers: Threads; one a core when None.
        progress: Called with the number of runs that are done.

    Raises:
        ExperimentError: A run that grows without bound.
    """
    cases = (
        Case(frames, contacts, factor * record.acceleration_m_s2, record.step_s)
        for record, row in zip(records, factors, strict=True)
        for factor in row
    )
    found = [
        [limit.passed(outcome, frames) for limit in limits]
        for outcome in many(cases, workers=workers, progress=progress)
    ]
    return np.array(found, bool).T.reshape(len(limits), *factors.shape)
