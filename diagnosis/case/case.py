"""A measured case: baseline frames, runs as measured, channels, contacts and priors, all in SI.

The format is `case.toml` with one CSV file a run (docs/diagnosis/case-format.md). Units are converted here
and nowhere else; what cannot be read is a `CaseError` of one sentence that names file, line and channel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import numpy as np

from pounding.diagnosis.case.numbers import ModalDatum, Peak
from pounding.diagnosis.case.quantities import DISPLACEMENTS, OF_THE_TABLE, UNITS

REFERENCE = "reference"
"""Role of a run of the frame as it was before."""


class Prior(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Prior standard deviations of the nuisance parameters, as fractions; the delay in ms.

    `base_stiffness` is that of a plate frame's first storey beyond the other storeys', `joint_stiffness` that of its joints
    (a logarithm): how rigidly a base is clamped, and how a frame's flexibility is shared by columns and joints, no test of
    the thesis says; models that agree in all frequencies differ in both.
    `model_error` is what the model of any real frame may leave after its calibration, rms over the motion: models of frames
    on shaking tables leave 1 to 5 %.
    """

    storey_stiffness: float = 0.03
    frame_stiffness: float = 0.08
    base_stiffness: float = 0.04
    joint_stiffness: float = 0.05
    floor_mass: float = 0.01
    damping_ratio: float = 0.2
    table_gain: float = 0.02
    table_delay_ms: float = 1.0
    model_error: float = 0.05


@dataclass(frozen=True)
class CaseFrame:
    """A frame of the baseline model, as it is thought to be before the test.

    Exactly one of three: a frame of the thesis (only `name`), a frame file (`file`), or masses and modes
    (`floor_mass_kg`, `frequency_hz`, `damping_ratio`). The former two may have ``rigid`` joints and no
    P-Delta. `scale` of the third is its length over its building's, ``"1:30"`` or a number: the frames of a case have
    one scale, and measurements are taken as they are.
    """

    name: str
    storeys: int
    file: Path | None = None
    storey_height_m: float | None = None
    floor_mass_kg: tuple[float, ...] = ()
    frequency_hz: tuple[float, ...] = ()
    damping_ratio: tuple[float, ...] = ()
    joints: str = "calibrated"
    p_delta: bool = True
    scale: str | float | None = None

    @property
    def kind(self) -> str:
        """``thesis``, ``file`` or ``modal``: masses and modes."""
        if self.floor_mass_kg:
            return "modal"
        return "file" if self.file else "thesis"


@dataclass(frozen=True)
class Channel:
    """A measured column. `floor` counts from 1, 0 is the table; `contact` counts from 1 as in the file.

    `interpolation` says how the table's acceleration goes on between its samples: ``zoh``, ``linear``, or None: smoothly.
    """

    name: str
    quantity: str
    unit: str
    frame: str | None = None
    floor: int | None = None
    contact: int | None = None
    interpolation: str | None = None

    @property
    def to_si(self) -> float:
        """Factor from the channel's unit to SI."""
        return UNITS[self.quantity][self.unit]

    @property
    def is_table(self) -> bool:
        """Whether the channel says how the table moved (a table quantity, or floor 0)."""
        return self.quantity in OF_THE_TABLE or self.floor == 0

    @property
    def is_table_acceleration(self) -> bool:
        """Whether the channel is the table's acceleration."""
        return self.is_table and self.quantity in ("table_acceleration", "absolute_acceleration")


@dataclass(frozen=True)
class Contact:
    """A contact of the baseline model: `left` moves in +x towards `right`.

    Stiffness [N/m] ([N/m^1.5] for the Hertz family), `damping` [N s/m] or `restitution` or neither.
    """

    left: str
    right: str
    floor: int
    gap_m: float
    law: str
    stiffness: float
    damping: float | None = None
    restitution: float | None = None


@dataclass(frozen=True, eq=False)
class Run:
    """One shaking as measured.

    Attributes:
        file: Name of the CSV file, also the name of the run.
        role: ``reference``, ``held_out``, ``training`` or None where the case does not say.
        time_s: Uniform times [s], shape (samples,).
        step_s: Sampling step [s].
        values: Channels in SI in the case's order, NaN where a sample dropped out, shape (samples, channels).
    """

    file: str
    role: str | None
    time_s: np.ndarray
    step_s: float
    values: np.ndarray

    def __repr__(self) -> str:
        samples, channels = self.values.shape
        return f"Run({self.file!r}, {samples} samples at {self.step_s:.4g} s, {channels} channels)"

    @property
    def reference(self) -> bool:
        """Whether it is of the frame as it was before: what is asked is what changed since."""
        return self.role == REFERENCE


@dataclass(frozen=True, eq=False)
class Case:
    """The baseline model and all that was measured; `warnings` say what is odd but can be read."""

    title: str
    folder: Path
    frames: tuple[CaseFrame, ...]
    runs: tuple[Run, ...]
    channels: tuple[Channel, ...]
    contacts: tuple[Contact, ...] = ()
    prior: Prior = field(default_factory=Prior)
    warnings: tuple[str, ...] = ()
    modal: tuple[ModalDatum, ...] = ()
    peaks: tuple[Peak, ...] = ()

    def __repr__(self) -> str:
        frames = ", ".join(frame.name for frame in self.frames)
        measured = {
            "runs": self.runs,
            "channels": self.channels,
            "modal data": self.modal,
            "peaks": self.peaks,
        }
        counts = ", ".join(f"{len(values)} {what}" for what, values in measured.items() if values)
        return f"Case({self.title!r}: {frames}; {counts})"

    def channel_index(self, name: str) -> int:
        """Return the column of a channel in every run's `values`."""
        return [channel.name for channel in self.channels].index(name)

    def split(self) -> tuple[tuple[Run, ...], tuple[Run, ...]]:
        """Return the runs to learn from, reference runs among them, and those held out.

        With two or more runs since and no role named the last one is held out that does not move the frames most; with a
        single one nothing is. What acts in the largest motion alone shows in no other run, so that one is learnt from. Runs
        of the frame as it was before are learnt from, too.
        """
        held_out = tuple(run for run in self.runs if run.role == "held_out")
        since = [run for run in self.runs if not run.reference]
        if not held_out and len(since) > 1:
            largest = since[int(np.argmax(self._sizes(since)))]
            free = [run for run in since if run.role is None]
            held_out = tuple([run for run in free if run is not largest][-1:] or free)
        return tuple(run for run in self.runs if run not in held_out), held_out

    def _sizes(self, runs: Sequence[Run]) -> np.ndarray:
        """Return how large the motion of each run is beside that of the largest, shape (runs,).

        That is the farthest a channel goes from its middle, and of the channels the median: one with a fault has no say.
        Where displacements were measured these say it alone: what yields, rubs or strikes asks for drift.
        """
        shaken = [number for number, one in enumerate(self.channels) if one.frame and not one.is_table]
        drifting = [number for number in shaken if self.channels[number].quantity in DISPLACEMENTS]
        moving = drifting or shaken
        peaks = np.array([[_farthest(run.values[:, number]) for number in moving] for run in runs])
        known = np.isfinite(peaks).all(axis=0) & (peaks > 0.0).any(axis=0)
        if not known.any():
            return np.ones(len(runs))
        return np.asarray(np.median(peaks[:, known] / peaks[:, known].max(axis=0), axis=1))


def _farthest(values: np.ndarray) -> float:
    """Return how far a channel goes from its middle, values of shape (samples,); NaN where nothing was measured."""
    known = values[np.isfinite(values)]
    return float(np.abs(known - np.median(known)).max()) if known.size else np.nan
