"""The measured runs as the predictor wants them: SI arrays, channels at floors of the structure, one table input."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from pounding.diagnosis.case.case import Case, Run
from pounding.diagnosis.case.numbers import ModalDatum, Peak
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.dropouts import filled
from pounding.diagnosis.model.kalman import TABLE_NOISE_RATE
from pounding.diagnosis.model.noise import largest_noise
from pounding.diagnosis.model.predictor import (
    ABSOLUTE_DISPLACEMENT,
    ACCELERATION,
    DISPLACEMENT,
    TABLE_DISPLACEMENT,
    VELOCITY,
)
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.model.table_motion import SMOOTH

QUANTITIES = {
    "absolute_acceleration": ACCELERATION,
    "relative_displacement": DISPLACEMENT,
    "relative_velocity": VELOCITY,
    "absolute_displacement": ABSOLUTE_DISPLACEMENT,
    "table_displacement": TABLE_DISPLACEMENT,
}
SUBSTEP_S = 5e-4
"""Longest substep [s]: a tenth of a radian at 30 Hz, where the midpoint rule errs by less than 0.1 %."""


@dataclass(frozen=True)
class RunData:
    """One run.

    Attributes:
        name: The CSV file.
        step_s: Sampling step [s].
        time_s: Times [s], shape (samples,).
        table: Table acceleration [m/s^2], gaps filled, shape (samples,).
        measured: Channels in SI, NaN where missing, shape (samples, channels).
        contact: Measured contact forces [N], compression positive, shape (samples, contacts measured).
        table_between: How the table's acceleration goes on between samples (`pounding.diagnosis.model.table_motion`).
        fine_contact, fine_step_s: Contact forces on a finer grid, if any: between samples a short force is no line.
        reference: Whether it is of the frame as it was before: effects act in the runs since.
    """

    name: str
    step_s: float
    time_s: np.ndarray
    table: np.ndarray
    measured: np.ndarray
    contact: np.ndarray
    table_between: str = SMOOTH
    fine_contact: np.ndarray | None = None
    fine_step_s: float = 0.0
    reference: bool = False

    @cached_property
    def largest_noise(self) -> np.ndarray:
        """The largest noise that each channel can have in SI, shape (channels,); infinite where samples were made fewer."""
        if self.fine_step_s > 0.0:
            return np.full(self.measured.shape[1], np.inf)
        return np.array([largest_noise(column, self.step_s, self.table) for column in self.measured.T])

    @cached_property
    def largest_table_noise(self) -> float:
        """The largest noise that the table's channel can have [m/s^2], as slow as the model's table noise is."""
        if self.fine_step_s > 0.0:
            return float("inf")
        white = largest_noise(self.table, self.step_s, self.table)
        return float(white * np.sqrt(TABLE_NOISE_RATE * self.step_s / 2))

    def contact_at(self, times_s: np.ndarray, column: int) -> np.ndarray:
        """Return a contact force [N] at times [s] from the start of the run."""
        series, step = self.contact, self.step_s
        if self.fine_contact is not None:
            series, step = self.fine_contact, self.fine_step_s
        return np.asarray(np.interp(times_s, np.arange(len(series)) * step, series[:, column]))

    @property
    def substeps(self) -> int:
        """Substeps a sample."""
        return max(2, int(np.ceil(self.step_s / SUBSTEP_S - 1e-9)))

    @property
    def instants(self) -> tuple[np.ndarray, np.ndarray]:
        """Times since the run began [s] of the samples, (samples,), and of the substeps' middles, (samples, substeps)."""
        at = np.arange(len(self.table)) * self.step_s
        return at, at[:, None] + (np.arange(self.substeps) + 0.5) * self.step_s / self.substeps


@dataclass(frozen=True)
class ContactEvent:
    """A time in which two floors touch: its run, the column of its force, first and last moment [s] from the run's start.

    `std` is how well the size of the force is known there, relative.
    """

    run: int
    column: int
    first_s: float
    last_s: float
    std: float

    def within(self, times_s: np.ndarray) -> np.ndarray:
        """Return which of some times [s] from the start of the run lie in it."""
        return (times_s >= self.first_s) & (times_s <= self.last_s)


@dataclass(frozen=True)
class Observations:
    """All that was measured on a structure.

    Attributes:
        names: Channel names. `to_si`: factor from the channel's own unit.
        quantity, floor: Kind (see `pounding.diagnosis.model.predictor`) and floor of each channel, shape (channels,).
        runs: The runs.
        contact_floors: Left and right floor of each contact force, measured or found.
        touching: Whether frames may touch: contact forces, measured or found, have a clock of their own.
        slower: How many samples of the logger one of these stands for, if they were made fewer.
        contact_events: Times in which floors touch; the size of the force in each is a nuisance parameter.
        modal, peaks: Numbers that stand beside the runs.
        warnings: What was odd.
    """

    names: tuple[str, ...]
    to_si: np.ndarray
    quantity: np.ndarray
    floor: np.ndarray
    runs: tuple[RunData, ...]
    contact_floors: tuple[tuple[int, int], ...] = ()
    touching: bool = False
    contact_events: tuple[ContactEvent, ...] = ()
    slower: int = 1
    modal: tuple[ModalDatum, ...] = ()
    peaks: tuple[Peak, ...] = ()
    warnings: list[str] = field(default_factory=list)

    def rms(self, run: RunData) -> np.ndarray:
        """Return the rms of each channel in a run in SI, shape (channels,); NaN where nothing was measured."""
        return root_mean_square(run.measured)

    def seen(self) -> np.ndarray:
        """Return which channels measured anything in any run, shape (channels,)."""
        return np.asarray(np.isfinite([self.rms(run) for run in self.runs]).any(axis=0))


def root_mean_square(values: np.ndarray) -> np.ndarray:
    """Return the rms over the first axis, shape (...,), of what is not NaN; NaN where there is nothing.

    Args:
        values: Series, shape (samples, ...).
    """
    count = np.isfinite(values).sum(axis=0)
    with np.errstate(over="ignore"):
        total = np.nansum(np.square(values), axis=0)
    mean = np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
    return np.asarray(np.sqrt(mean))


def observe(case: Case, structure: Structure) -> Observations:
    """Return the observations of a case.

    Raises:
        CaseError: No channel says how the table moved, or none measures a frame.
    """
    warnings: list[str] = []
    columns, quantity, floor = [], [], []
    for column, channel in enumerate(case.channels):
        if channel.quantity == "table_displacement" or (
            channel.floor == 0 and channel.quantity == "absolute_displacement"
        ):
            columns.append(column)
            quantity.append(TABLE_DISPLACEMENT)
            floor.append(0)
        elif not channel.is_table and channel.quantity in QUANTITIES:
            columns.append(column)
            quantity.append(QUANTITIES[channel.quantity])
            frame = structure.index(str(channel.frame))
            floor.append(structure.first(frame) + int(channel.floor or 1) - 1)
    if all(kind == TABLE_DISPLACEMENT for kind in quantity):
        raise CaseError(
            f"{case.folder / 'case.toml'}: no channel measures a frame; add at least one floor's motion"
        )
    forces = [i for i, channel in enumerate(case.channels) if channel.quantity == "contact_force"]
    pairs = tuple(_contact_floors(case, structure, int(case.channels[i].contact or 1)) for i in forces)
    runs = tuple(_run(case, run, columns, forces, warnings) for run in case.runs)
    return Observations(
        names=tuple(case.channels[i].name for i in columns),
        to_si=np.array([case.channels[i].to_si for i in columns]),
        quantity=np.array(quantity),
        floor=np.array(floor),
        runs=runs,
        contact_floors=pairs,
        touching=bool(case.contacts),
        modal=case.modal,
        peaks=case.peaks,
        warnings=warnings,
    )


def _contact_floors(case: Case, structure: Structure, contact: int) -> tuple[int, int]:
    model = case.contacts[contact - 1]
    left, right = structure.index(model.left), structure.index(model.right)
    return structure.first(left) + model.floor - 1, structure.first(right) + model.floor - 1


def _run(case: Case, run: Run, columns: list[int], forces: list[int], warnings: list[str]) -> RunData:
    contact = np.nan_to_num(run.values[:, forces]) if forces else np.zeros((len(run.values), 0))
    table, between = _table(case, run, warnings)
    return RunData(
        name=run.file,
        step_s=run.step_s,
        time_s=run.time_s,
        table=table,
        table_between=between,
        measured=np.ascontiguousarray(run.values[:, columns]),
        contact=contact,
        reference=run.reference,
    )


def _table(case: Case, run: Run, warnings: list[str]) -> tuple[np.ndarray, str]:
    """Return the table's acceleration and how it goes on between samples.

    It is that of its channel, or else the second derivative of its displacement.
    """
    for column, channel in enumerate(case.channels):
        if channel.is_table_acceleration and np.isfinite(run.values[:, column]).sum() > 10:
            series = _filled(run.values[:, column], f"{run.file}: channel {channel.name}", warnings)
            return series, channel.interpolation or SMOOTH
    for column, channel in enumerate(case.channels):
        if channel.is_table and np.isfinite(run.values[:, column]).sum() > 10:
            warnings.append(
                f"{run.file}: no table acceleration was measured; it is the second derivative of {channel.name}"
            )
            series = _filled(run.values[:, column], f"{run.file}: channel {channel.name}", warnings)
            return np.asarray(CubicSpline(run.time_s, series)(run.time_s, 2)), SMOOTH
    raise CaseError(
        f"{case.folder / run.file}: no channel says how the table moved; add its acceleration or displacement"
    )


def _filled(series: np.ndarray, where: str, warnings: list[str]) -> np.ndarray:
    missing = ~np.isfinite(series)
    if not missing.any():
        return np.array(series, float)
    warnings.append(f"{where}: {missing.sum()} dropouts of the table's motion were interpolated")
    return filled(series)
