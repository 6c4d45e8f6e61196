"""The gap between two frames on one table, with its basis, its spread and what the rules say."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments import published
from pounding.experiments.records import REFERENCES, Record
from pounding.experiments.rig.required_gap import (
    RequiredGap,
    contact_floors,
    detuned,
    fine_step,
    floor_motions,
    gaps_by_floor,
    motions,
    pair_gap,
    required_gap,
)
from pounding.experiments.separation.gaps.variants import modal_frame
from pounding.experiments.separation.rules.answers import Answer, Building, code_rules
from pounding.frames import ReducedFrame
from pounding.frames.response.exact import refine
from pounding.scale import THESIS

MM = 1000.0

FREQUENCY_UNCERTAINTY = 0.05
"""Share by which a first frequency may be off either way: free vibration and sweep differ by up to 10 %."""

HIGHEST_TESTED_PGA_G = 0.9


def gap_answer(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    *,
    floor: int | None = None,
    own_peak: bool = True,
    length_scale: float = THESIS.buildings_length,
) -> dict[str, Any]:
    """Return the required gap of two frames and what stands beside it.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale, see `Record.scaled`.
        floor: Floor of the lower frame; its roof when None.
        own_peak: Whether the record has its own peak: only then is there a published number to compare with.
        length_scale: Full-scale length over the frames' length, for the rules with a unit of their own.

    Returns:
        ``left``, ``right``, ``record``, ``pga_g``, ``floor``, ``required_gap_mm`` (largest closing motion),
        ``time_s``, ``equation_4_1_mm``, ``reversed_mm`` (the frames on swapped sides, or the record with the
        other sign), ``left_peak_mm``, ``right_peak_mm``, ``spread`` (``low_mm``, ``high_mm``, ``basis``),
        ``floors`` (the required gap at every shared floor), ``rules`` (``name``, ``gap_mm``, ``basis``,
        ``in_range``, ``reason``), ``published`` (or None) and ``warnings``.

    Raises:
        ExperimentError: A floor that cannot meet the other frame.
    """
    at_left, at_right = contact_floors(left, right, floor)
    gap = pair_gap(left, right, record, floor=floor)
    lower_floor = at_left if left.heights_m[-1] < right.heights_m[-1] else at_right
    floors = [
        {
            "floor": number,
            "required_gap_mm": MM * found.closing_m,
            "equation_4_1_mm": MM * found.equation_4_1_m,
        }
        for number, found in gaps_by_floor(left, right, record)
    ]
    return {
        "left": left.name,
        "right": right.name,
        "record": record.name,
        "pga_g": record.pga_g,
        "floor": lower_floor,
        "required_gap_mm": MM * gap.closing_m,
        "time_s": gap.time_s,
        "equation_4_1_mm": MM * gap.equation_4_1_m,
        "reversed_mm": MM * gap.opening_m,
        "left_peak_mm": MM * gap.left_peak_m,
        "right_peak_mm": MM * gap.right_peak_m,
        "spread": spread(left, right, record, floor=floor),
        "floors": floors,
        "rules": [asdict(answer) for answer in rules_beside(left, right, gap, record.pga_g, length_scale)],
        "published": published_gap(left.name, right.name, lower_floor, record.name) if own_peak else None,
        "warnings": _warnings(record, floors, lower_floor),
    }


def rules_beside(
    left: ReducedFrame, right: ReducedFrame, gap: RequiredGap, pga_g: float, length_scale: float
) -> list[Answer]:
    """Return every code rule's answer, asked with the peaks of the run at the floor of contact.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        gap: Their required gap and peaks.
        pga_g: Peak acceleration of the record [g].
        length_scale: Length of the model over that of the building [-].
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
    *,
    floor: int | None = None,
    share: float = FREQUENCY_UNCERTAINTY,
) -> dict[str, Any]:
    """Return the least and the largest required gap when each frame's frequencies are off by a share either
    way.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale.
        floor: Floor of the lower frame; its roof when None.
        share: Share of the frequencies, alike for all modes of a frame.

    Returns:
        ``low_mm``, ``high_mm`` over the nine combinations, and ``basis`` in words.
    """
    pair = contact_floors(left, right, floor)
    moved = [
        [_detuned(frame, record, at, factor) for factor in (1.0 - share, 1.0, 1.0 + share)]
        for frame, at in zip((left, right), pair, strict=True)
    ]
    step = record.step_s / fine_step(record.step_s)
    gaps = [MM * required_gap(a, b, step).closing_m for a in moved[0] for b in moved[1]]
    return {
        "low_mm": min(gaps),
        "high_mm": max(gaps),
        "basis": f"each frame's frequencies {100 * share:g} % lower, unchanged, and {100 * share:g} % higher",
    }


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
    left: ReducedFrame, right: ReducedFrame, record: Record, *, floor: int | None = None
) -> tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]], NDArray[np.floating[Any]]]:
    """Return times (m,) [s] and the displacements of both contact floors (m,) [m], for a picture.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale.
        floor: Floor of the lower frame; its roof when None.
    """
    at_left, at_right = contact_floors(left, right, floor)
    first = motions(left, record, [at_left])[:, 0]
    times = record.step_s / fine_step(record.step_s) * np.arange(len(first))
    return times, first, motions(right, record, [at_right])[:, 0]


def _detuned(frame: ReducedFrame, record: Record, floor: int, factor: float) -> NDArray[np.floating[Any]]:
    if frame.definition.storey_law:
        return motions(detuned(frame, factor), record, [floor])[:, 0]
    modal = modal_frame(frame)
    modal = replace(modal, circular=factor * modal.circular)
    parts = fine_step(record.step_s)
    history, step = refine(record.acceleration_m_s2, parts), record.step_s / parts
    return floor_motions(modal.poles(frame.damping_ratio), [int(frame.floor_x[floor - 1])], history, step)[
        :, 0
    ]


def _damping(ratio: float) -> float:
    """Return a damping ratio that the rules accept: an undamped frame counts as nearly undamped."""
    return max(ratio, 1e-6)


def _warnings(record: Record, floors: list[dict[str, Any]], floor: int) -> list[str]:
    found = []
    if record.pga_g > HIGHEST_TESTED_PGA_G:
        found.append(
            f"{record.pga_g:.3g} g is above anything tested ({HIGHEST_TESTED_PGA_G} g): the frames "
            "are linear here and "
            "would yield"
        )
    governing = max(floors, key=lambda entry: entry["required_gap_mm"])
    own = next(entry["required_gap_mm"] for entry in floors if entry["floor"] == floor)
    if governing["required_gap_mm"] > 1.02 * own:
        found.append(
            f"floor {governing['floor']} needs more than floor {floor}: {governing['required_gap_mm']:.3g} mm"
        )
    return found
