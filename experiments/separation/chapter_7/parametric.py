"""The parametric study of section 7.3.1: 9,768 required gaps of three pairs with changed damping, mass and
stiffness.

The text names the levels (damping 1 to 5 %, masses of 2, 1 and 1 kg added to every floor one after the other,
stiffness raised by 10 and 20 %), the counts (3,081, 3,081 and 3,606 cases in the three classes) and not the
design. Chosen here, for every pair and record alike: all combinations of five dampings and four masses of
both frames (400), and, with the damping of Table 3.1 and no added mass, the frames as they are and with the
stiffness of the taller, the lower or both raised by 10 and by 20 % (7). 407 cases, three pairs, eight
records: 9,768.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from pounding.experiments import published
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record, find
from pounding.experiments.rig.required_gap import contact_floors, fine_step, floor_motions
from pounding.experiments.separation.gaps.variants import ModalFrame, modal_frame
from pounding.experiments.sweeps.sweep import sweep
from pounding.frames import ReducedFrame, build, load
from pounding.frames.response.exact import refine
from pounding.scale import THESIS

PAIR_NAMES = ("15B-10", "15B-5B", "10-5B")
"""Taller and lower frame of each pair of the study."""

DAMPINGS = (0.01, 0.02, 0.03, 0.04, 0.05)
ADDED_MASSES_KG = (0.0, 2.0, 3.0, 4.0)
STIFFENINGS = (1.1, 1.2)

STAND_INS = {
    "sap1": "hollywood-pel180",
    "sap2": "coolwater-ln",
    "sap3": "elcentro-array7-230",
    "sap4": "beverlyhills-mul279",
    "sap5": "sylmar-syl360",
}
"""Nearest motions that can be had for SAP 1 to 5, whose samples are not public; they are not the same."""

EVENTS = {
    "hollywood-pel180": "San Fernando 1971",
    "hachinohe": "Tokachi-oki 1968",
    "coolwater-ln": "Landers 1992",
    "elcentro": "Imperial Valley 1940",
    "elcentro-array7-230": "Imperial Valley 1979",
    "beverlyhills-mul279": "Northridge 1994",
    "kobe": "Hyogo-ken Nanbu 1995",
    "northridge": "Northridge 1994",
    "sylmar-syl360": "Northridge 1994",
}
"""Earthquake of each motion: two motions of one event are no independent evidence."""

VALIDATION_LABEL = "sap5"


@dataclass(frozen=True)
class Variant:
    """A frame of the study.

    Attributes:
        damping_ratio: Damping of every mode, a fraction; None is the frame's own.
        added_floor_mass_kg: Mass added to every floor [kg].
        stiffness_factor: Factor of its stiffness.
    """

    damping_ratio: float | None = None
    added_floor_mass_kg: float = 0.0
    stiffness_factor: float = 1.0


Case = tuple[Variant, Variant]
"""The taller and the lower frame of one case."""


def design_of_cases() -> list[Case]:
    """Return the 407 cases of each pair and record, see the module."""
    levels = list(product(DAMPINGS, ADDED_MASSES_KG))
    crossed = [(Variant(*tall), Variant(*short)) for tall, short in product(levels, levels)]
    plain = Variant()
    stiffened = [
        case
        for factor in STIFFENINGS
        for case in (
            (Variant(stiffness_factor=factor), plain),
            (plain, Variant(stiffness_factor=factor)),
            (Variant(stiffness_factor=factor), Variant(stiffness_factor=factor)),
        )
    ]
    return [*crossed, (plain, plain), *stiffened]


def motions_of_the_study(*, with_validation: bool = False) -> pd.DataFrame:
    """Return the motions of Table 7.1, one row each, by their label there.

    Args:
        with_validation: Also SAP 5, which the thesis keeps for validation.

    Returns:
        ``record`` (name to ask `pounding.experiments.records.find` for), ``level``, ``pga_g`` (Table 7.1), ``event``.
    """
    printed = published.table("7.1")
    chosen = printed if with_validation else printed.drop(index=VALIDATION_LABEL)
    names = [STAND_INS.get(label, label) for label in chosen.index]
    return pd.DataFrame(
        {
            "record": names,
            "level": chosen["level"].to_numpy(),
            "pga_g": chosen["pga_g"].to_numpy(float),
            "event": [EVENTS[name] for name in names],
        },
        index=chosen.index,
    )


def pair_gaps(
    tall: ReducedFrame, short: ReducedFrame, record: Record, cases: list[Case], *, floor: int | None = None
) -> pd.DataFrame:
    """Return the required gaps of many variants of one pair under one record.

    Every distinct variant moves once, exactly, mode by mode; the pairs are then differences of histories.

    Args:
        tall: The taller frame, on the left.
        short: The lower frame.
        record: Table motion at the frames' scale.
        cases: Variants of the two.
        floor: Floor of the lower frame; its roof when None.

    Returns:
        One row a case: the regressors HT, HS [mm], E [g], FT, FS [Hz], DT, DS [%], ST, SS [kN/mm], MT, MS
        [kg], and ``gap_mm`` (equation 4.1), ``closing_mm``, ``tall_peak_mm``, ``short_peak_mm``.
    """
    at_tall, at_short = contact_floors(tall, short, floor)
    moved_tall = _histories(tall, record, at_tall, {case[0] for case in cases})
    moved_short = _histories(short, record, at_short, {case[1] for case in cases})
    rows = []
    for variant_tall, variant_short in cases:
        one, other = moved_tall[variant_tall], moved_short[variant_short]
        difference = one.motion_mm - other.motion_mm
        closing, opening = max(float(difference.max()), 0.0), max(float(-difference.min()), 0.0)
        rows.append(
            one.regressors("T")
            | other.regressors("S")
            | {"E": record.pga_g, "gap_mm": max(closing, opening), "closing_mm": closing}
            | {"tall_peak_mm": one.peak_mm, "short_peak_mm": other.peak_mm}
        )
    return pd.DataFrame(rows)


@dataclass(frozen=True)
class _Moved:
    """A variant, what describes it, and how it moved."""

    height_mm: float
    frequency_hz: float
    damping_percent: float
    stiffness_kn_per_mm: float
    mass_kg: float
    motion_mm: NDArray[np.floating[Any]]
    peak_mm: float

    def regressors(self, letter: str) -> dict[str, float]:
        return {
            f"H{letter}": self.height_mm,
            f"F{letter}": self.frequency_hz,
            f"D{letter}": self.damping_percent,
            f"S{letter}": self.stiffness_kn_per_mm,
            f"M{letter}": self.mass_kg,
        }


def _histories(
    frame: ReducedFrame, record: Record, floor: int, variants: set[Variant]
) -> dict[Variant, _Moved]:
    parts = fine_step(record.step_s)
    history, step = refine(record.acceleration_m_s2, parts), record.step_s / parts
    shapes: dict[tuple[float, float], ModalFrame] = {}
    moved = {}
    for variant in variants:
        key = (variant.added_floor_mass_kg, variant.stiffness_factor)
        if key not in shapes:
            shapes[key] = modal_frame(frame, added_floor_mass_kg=key[0], stiffness_factor=key[1])
        modal = shapes[key]
        ratio = frame.damping_ratio if variant.damping_ratio is None else variant.damping_ratio
        motion = 1e3 * floor_motions(modal.poles(ratio), [int(frame.floor_x[floor - 1])], history, step)[:, 0]
        moved[variant] = _Moved(
            height_mm=1e3 * float(frame.heights_m[-1]),
            frequency_hz=modal.frequency_hz,
            damping_percent=100.0 * ratio,
            stiffness_kn_per_mm=1e-6 * variant.stiffness_factor * frame.roof_stiffness_n_per_m,
            mass_kg=frame.moving_mass_kg + frame.storeys * variant.added_floor_mass_kg,
            motion_mm=motion,
            peak_mm=float(np.abs(motion).max()),
        )
    return moved


def block(
    *,
    pair: str,
    label: str,
    records: str = "",
    joints: Literal["calibrated", "rigid"] = "calibrated",
    p_delta: bool = True,
) -> dict[str, xr.DataArray]:
    """Return all cases of one pair under one motion: the unit of work of the study's sweep.

    Args:
        pair: Taller and lower frame, as ``15B-10``.
        label: Label of the motion in Table 7.1.
        records: Folder of records; empty: the usual places.
        joints: As `frames.build`.
        p_delta: As `frames.build`.

    Raises:
        ExperimentError: The motion is not at hand; the sweep records it and goes on.
    """
    motion = motions_of_the_study(with_validation=True).loc[label]
    record = find(str(motion["record"]), records or None).scaled(
        THESIS.time_factor, pga_g=float(str(motion["pga_g"]))
    )
    tall, short = (build(load(name), joints=joints, p_delta=p_delta) for name in pair.split("-"))
    gaps = pair_gaps(tall, short, record, design_of_cases())
    return {str(name): xr.DataArray(gaps[name].to_numpy(), dims="variant") for name in gaps}


def study(
    labels: Sequence[str] | None = None,
    pairs: Sequence[str] = PAIR_NAMES,
    *,
    settings: Mapping[str, Any] | None = None,
    **options: Any,
) -> tuple[pd.DataFrame, dict[str, str]]:
    """Return the study's cases, and why some are missing.

    Args:
        labels: Labels of motions in Table 7.1; the eight of the study when None.
        pairs: Taller and lower frame, as ``15B-10``.
        settings: Further arguments of `block`.
        options: Arguments of `pounding.experiments.sweeps.sweep.sweep`: ``folder``, ``workers``, ``scheduler``, ...

    Returns:
        One row a case (columns of `pair_gaps` and ``pair``, ``label``, ``record``, ``level``, ``event``),
        and a sentence for each ``pair label`` that failed.

    Raises:
        ExperimentError: Nothing at all could be run.
    """
    motions = motions_of_the_study(with_validation=True)
    chosen = list(motions.drop(index=VALIDATION_LABEL).index if labels is None else labels)
    grid = {"pair": list(pairs), "label": chosen}
    results = sweep(block, grid, settings=dict(settings or {}), **options)
    tables, failures = [], {}
    for pair, label in product(*grid.values()):
        done = results.sel(pair=pair, label=label)
        if str(done["failure"].item()):
            failures[f"{pair} {label}"] = str(done["failure"].item())
            continue
        table = done.drop_vars("failure").to_dataframe().drop(columns=["pair", "label"])
        tables.append(
            table.assign(pair=pair, label=label, **motions.loc[label, ["record", "level", "event"]])
        )
    if not tables:
        raise ExperimentError(f"no case of the study could be run: {next(iter(failures.values()))}")
    return pd.concat(tables, ignore_index=True), failures
