"""The gap between two frames on one table, with its basis, its spread and what the rules say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments import published
from pounding.experiments.records import REFERENCES, Record
from pounding.experiments.rig.column_hits import place_of
from pounding.experiments.rig.contacts import place_row
from pounding.experiments.rig.required_gap import (
    RequiredGap,
    contact_floors,
    detuned,
    fine_step,
    gap_at,
    gaps_by_floor,
    is_left_lower,
    place_motions,
    required_gap,
)
from pounding.experiments.rig.ringing import cut_short
from pounding.experiments.separation.gaps.answer import EdgeGap, FloorGap, GapAnswer, Spread
from pounding.experiments.separation.rules.answers import Answer, Building, code_rules
from pounding.frames import ReducedFrame
from pounding.frames.floors import level_floors
from pounding.frames.response.exact import linear_response
from pounding.scale import THESIS

MM = 1000.0

FREQUENCY_UNCERTAINTY = 0.05
"""Share by which a first frequency may be off either way: free vibration and sweep differ by up to 10 %."""

HIGHEST_TESTED_PGA_G = 0.9


@dataclass(frozen=True)
class Where:
    """Where two frames may meet.

    Attributes:
        floor: Floor of the lower frame; its roof when None.
        y_m: Place along the floors' edge, from the middle [m].
        on_columns: Whether the floor faces the columns of the other frame.
    """

    floor: int | None = None
    y_m: float = 0.0
    on_columns: bool = False

    def floors(self, left: ReducedFrame, right: ReducedFrame) -> tuple[float, float]:
        """Return the floors of the left and the right frame; on columns, one lies between two whole numbers.

        Args:
            left: Frame that moves in +x towards the other.
            right: The other frame.

        Raises:
            ExperimentError: The floor is not there, or faces something else.
        """
        if self.on_columns:
            return place_of(left, right, self.floor).floors
        return contact_floors(left, right, self.floor)


AT_THE_ROOF = Where()
"""The middle of the lower frame's roof."""


def gap_answer(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    where: Where = AT_THE_ROOF,
    *,
    own_peak: bool = True,
    length_scale: float = THESIS.buildings_length,
) -> GapAnswer:
    """Return the required gap of two frames and what stands beside it.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale, see `Record.scaled`.
        where: Where they may meet.
        own_peak: Whether the record has its own peak: only then is there a published number to compare with.
        length_scale: Full-scale length over the frames' length, for the rules with a unit of their own.

    Raises:
        ExperimentError: A floor that cannot meet the other frame.
        FrameError: A place off the floors, or off the middle of floors that do not turn.
    """
    places = where.floors(left, right)
    gap = gap_at(left, right, record, places, where.y_m)
    lower_floor = int(places[0] if is_left_lower(left, right) else places[1])
    floors = [
        FloorGap(number, MM * found.closing_m, MM * found.equation_4_1_m)
        for number, found in _shared(left, right, record, where.y_m)
    ]
    edges = _edges(left, right, record, places)
    return GapAnswer(
        left=left.name,
        right=right.name,
        record=record.name,
        pga_g=record.pga_g,
        floor=lower_floor,
        on_columns=where.on_columns,
        y_m=where.y_m,
        required_gap_mm=MM * gap.closing_m,
        time_s=gap.time_s,
        equation_4_1_mm=MM * gap.equation_4_1_m,
        reversed_mm=MM * gap.opening_m,
        left_peak_mm=MM * gap.left_peak_m,
        right_peak_mm=MM * gap.right_peak_m,
        spread=spread(left, right, record, where),
        floors=floors,
        edges=edges,
        rules=rules_beside(left, right, gap, record.pga_g, length_scale),
        published=published_gap(left.name, right.name, lower_floor, record.name) if own_peak else None,
        warnings=_warnings((left, right), record, floors, edges, lower_floor, MM * gap.closing_m),
    )


def _shared(
    left: ReducedFrame, right: ReducedFrame, record: Record, y_m: float
) -> list[tuple[int, RequiredGap]]:
    """Return the required gap at every shared floor; none where all floors face columns."""
    shared = level_floors(left.heights_m, right.heights_m)
    return gaps_by_floor(left, right, record, y_m) if shared else []


def _edges(
    left: ReducedFrame, right: ReducedFrame, record: Record, places: tuple[float, float]
) -> list[EdgeGap]:
    """Return the required gap at both ends of the edge that two frames share; none for frames that do not turn.

    Between the ends the closing motion is straight, so that no place between them needs more than both.
    """
    if not (left.turns or right.turns) or not all(float(floor).is_integer() for floor in places):
        return []
    half = min(left.plan_m[1], right.plan_m[1]) / 2.0
    step = record.step_s / fine_step(record.step_s)
    found = []
    for y_m in (-half, half):
        # Without contact a frame that does not turn moves alike along its whole edge.
        one, other = (
            place_motions(frame, record, place_row(frame, floor, y_m if frame.turns else 0.0)[None, :])[:, 0]
            for frame, floor in zip((left, right), places, strict=True)
        )
        found.append(EdgeGap(y_m, MM * required_gap(one, other, step).closing_m))
    return found


def rules_beside(
    left: ReducedFrame, right: ReducedFrame, gap: RequiredGap, pga_g: float, length_scale: float
) -> list[Answer]:
    """Return every code rule's answer, asked with the peaks of the run at the floor of contact.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        gap: Their required gap and peaks.
        pga_g: Peak acceleration of the record [g].
        length_scale: Length of the building over that of the model [-].
    """
    buildings = [
        Building(
            float(frame.heights_m[-1]), float(frame.frequencies_hz[0]), _damping(frame.damping_ratio), peak
        )
        for frame, peak in ((left, gap.left_peak_m), (right, gap.right_peak_m))
    ]
    short, tall = sorted(buildings, key=lambda building: building.height_m)
    return code_rules(tall, short, pga_g, length_scale=length_scale)


def spread(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    where: Where = AT_THE_ROOF,
    *,
    share: float = FREQUENCY_UNCERTAINTY,
) -> Spread:
    """Return the least and the largest required gap when each frame's frequencies are off by a share either
    way.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale.
        where: Where they may meet.
        share: Share of the frequencies, alike for all modes of a frame.

    Returns:
        The least and the largest over the nine combinations.
    """
    pair = where.floors(left, right)
    moved = [
        [
            place_motions(detuned(frame, factor), record, place_row(frame, at, where.y_m)[None, :])[:, 0]
            for factor in (1.0 - share, 1.0, 1.0 + share)
        ]
        for frame, at in zip((left, right), pair, strict=True)
    ]
    step = record.step_s / fine_step(record.step_s)
    gaps = [MM * required_gap(a, b, step).closing_m for a in moved[0] for b in moved[1]]
    basis = f"each frame's frequencies {100 * share:g} % lower, unchanged, and {100 * share:g} % higher"
    return Spread(min(gaps), max(gaps), basis)


def published_gap(left: str, right: str, floor: int, record: str) -> dict[str, Any] | None:
    """Return the thesis' measured and computed gap of a pair [mm], or None where it has none.

    Args:
        left: Name of the left frame.
        right: Name of the right frame.
        floor: Floor of contact.
        record: Name of the record.
    """
    if record not in REFERENCES:
        return None
    printed = published.table("4.2")
    for pair in ((left, right), (right, left)):
        if (*pair, floor) in printed.index:
            both = (float(printed[(record, name)][(*pair, floor)]) for name in ("experiment", "numerical"))
            return dict(zip(("experiment_mm", "numerical_mm"), both, strict=True)) | {
                "source": printed.attrs["source"]
            }
    return None


def history(
    left: ReducedFrame, right: ReducedFrame, record: Record, where: Where = AT_THE_ROOF
) -> tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]], NDArray[np.floating[Any]]]:
    """Return times (m,) [s] and the displacements of both places that may meet (m,) [m], for a picture.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale.
        where: Where they may meet.
    """
    first, second = (
        place_motions(frame, record, place_row(frame, at, where.y_m)[None, :])[:, 0]
        for frame, at in zip((left, right), where.floors(left, right), strict=True)
    )
    times = record.step_s / fine_step(record.step_s) * np.arange(len(first))
    return times, first, second


def _damping(ratio: float) -> float:
    """Return a damping ratio that the rules accept: an undamped frame counts as nearly undamped."""
    return max(ratio, 1e-6)


def _warnings(
    pair: tuple[ReducedFrame, ReducedFrame],
    record: Record,
    floors: list[FloorGap],
    edges: list[EdgeGap],
    floor: int,
    own_mm: float,
) -> list[str]:
    found = []
    linear = [frame.name for frame in pair if frame.definition.yielding is None]
    if record.pga_g > HIGHEST_TESTED_PGA_G and linear:
        found.append(
            f"{record.pga_g:.3g} g is above anything tested ({HIGHEST_TESTED_PGA_G} g): "
            f"{'the frames are' if len(linear) == 2 else f'{linear[0]} is'} linear here and would yield"
        )
    governing = max(floors, key=lambda entry: entry.required_gap_mm, default=None)
    if governing is not None and governing.required_gap_mm > 1.02 * own_mm:
        found.append(
            f"floor {governing.floor} needs more than floor {floor}: {governing.required_gap_mm:.3g} mm"
        )
    widest = max(edges, key=lambda entry: entry.required_gap_mm, default=None)
    if widest is not None and widest.required_gap_mm > 1.02 * own_mm:
        found.append(
            f"the floors turn, and at the end of their edge (y = {widest.y_m:g} m) floor {floor} needs "
            f"{widest.required_gap_mm:.4g} mm"
        )
    for frame in pair:
        moved, rate = linear_response(frame, record.acceleration_m_s2, record.step_s)
        found += cut_short(frame, moved[:, frame.floor_x[-1]], moved[-1], rate[-1])
    return found
