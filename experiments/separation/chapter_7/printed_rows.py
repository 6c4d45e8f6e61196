"""The 120 printed rows of Tables 7.2 to 7.4 computed again, at the thesis' own frequencies and at ours."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pounding.experiments import published
from pounding.experiments.records import Record
from pounding.experiments.rig.required_gap import contact_floors, fine_step, floor_motions, required_gap
from pounding.experiments.separation.chapter_7.parametric import motions_of_the_study
from pounding.experiments.separation.gaps.variants import effective_base_mass, modal_frame, tuned_frame
from pounding.frames import ReducedFrame
from pounding.frames.response.exact import refine

Moved = dict[tuple[Any, ...], NDArray[np.floating[Any]]]

LEVELS = {"low": "7.2", "moderate": "7.3", "high": "7.4"}
FRAME_OF_HEIGHT = {1500: "15B", 1000: "10", 500: "5B"}
PLAIN_MASS_KG = {"15B": (104.2, 104.24), "10": (72.0,), "5B": (34.85,)}
"""Mass of the frames of the printed rows before any was added; Table 3.1 has 104, 72 and 36.5 kg."""


def printed_rows() -> pd.DataFrame:
    """Return the printed rows of the three tables with ``level``, ``label`` (Table 7.1), ``tall`` and
    ``short``.

    Added masses are worked out from the printed ones: ``tall_added_kg`` and ``short_added_kg`` a floor.
    """
    motions = motions_of_the_study()
    tables = []
    for level, number in LEVELS.items():
        rows = published.table(number).reset_index()
        of_level = motions[motions["level"] == level]
        labels = dict(zip(of_level["pga_g"].to_numpy(float), of_level.index.astype(str), strict=True))
        rows["level"] = level
        rows["label"] = [labels[float(pga)] for pga in rows["pga_g"]]
        for side in ("tall", "short"):
            rows[side] = [FRAME_OF_HEIGHT[int(height)] for height in rows[f"{side}_height_mm"]]
            rows[f"{side}_added_kg"] = [
                _added(frame, float(mass))
                for frame, mass in zip(rows[side], rows[f"{side}_mass_kg"], strict=True)
            ]
        tables.append(rows)
    return pd.concat(tables, ignore_index=True)


def compare(
    rows: pd.DataFrame, frames: Mapping[str, ReducedFrame], records: Mapping[str, Record]
) -> pd.DataFrame:
    """Return the rows with ``tuned_mm`` (our frames at the printed frequencies) and ``ours_mm`` (our frames
    as they are).

    Both are equation 4.1 with the printed damping and added masses.

    Args:
        rows: See `printed_rows`.
        frames: The frames by name.
        records: Motions at model scale by their label in Table 7.1; rows of others are left out.
    """
    kept = rows[rows["label"].isin(records)].copy()
    moved: Moved = {}
    for column, tune in (("tuned_mm", True), ("ours_mm", False)):
        gaps = []
        for _, row in kept.iterrows():
            record = records[str(row["label"])]
            one, other = (_motion(row, side, frames, record, tune, moved) for side in ("tall", "short"))
            gaps.append(1e3 * required_gap(one, other, record.step_s).equation_4_1_m)
        kept[column] = gaps
    return kept


def moving_masses(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the mass that moves in the thesis' own models, by how its added masses lower its frequencies.

    Returns:
        One row a frame: ``stated_kg`` and the least and largest ``moving_kg`` over the added masses.
    """
    found: dict[str, list[float]] = {}
    for side in ("tall", "short"):
        pairs = rows[[side, f"{side}_frequency_hz", f"{side}_mass_kg", f"{side}_added_kg"]].drop_duplicates()
        for frame, group in pairs.groupby(side):
            plain = group[group[f"{side}_added_kg"] == 0.0]
            for _, loaded in group[group[f"{side}_added_kg"] > 0.0].iterrows():
                base = plain[f"{side}_frequency_hz"].max() if len(plain) else None
                if base is not None:
                    added = float(loaded[f"{side}_mass_kg"]) - PLAIN_MASS_KG[str(frame)][0]
                    found.setdefault(str(frame), []).append(
                        effective_base_mass(base, float(loaded[f"{side}_frequency_hz"]), added)
                    )
    return pd.DataFrame(
        {
            frame: {"stated_kg": PLAIN_MASS_KG[frame][0], "moving_low_kg": min(m), "moving_high_kg": max(m)}
            for frame, m in found.items()
        }
    ).T.rename_axis("frame")


def _added(frame: str, mass_kg: float) -> float:
    storeys = {"15B": 15, "10": 10, "5B": 5}[frame]
    nearest = min(PLAIN_MASS_KG[frame], key=lambda plain: abs(mass_kg - plain))
    return round((mass_kg - nearest) / storeys, 3)


def _motion(
    row: pd.Series,
    side: str,
    frames: Mapping[str, ReducedFrame],
    record: Record,
    tune: bool,
    moved: Moved,
) -> NDArray[np.floating[Any]]:
    """Return the motion of one frame of a row; many rows share a frame."""
    frame = frames[row[side]]
    added, damping = float(row[f"{side}_added_kg"]), float(row[f"{side}_damping_percent"]) / 100.0
    frequency = float(row[f"{side}_frequency_hz"]) if tune else None
    at = contact_floors(frames[row["tall"]], frames[row["short"]])[0 if side == "tall" else 1]
    key = (frame.name, at, record.name, added, damping, frequency)
    if key not in moved:
        modal = (
            modal_frame(frame, added_floor_mass_kg=added)
            if frequency is None
            else tuned_frame(frame, frequency, added_floor_mass_kg=added)
        )
        parts = fine_step(record.step_s)
        history, step = refine(record.acceleration_m_s2, parts), record.step_s / parts
        coordinate = int(frame.floor_x[at - 1])
        moved[key] = floor_motions(modal.poles(damping), [coordinate], history, step)[:, 0]
    return moved[key]
