"""The scale of the frames on one table, and the time factor of the records that shake it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pounding import bounds
from pounding.experiments.errors import ExperimentError
from pounding.frames.definition import Frame
from pounding.frames.scale import known_scale, required_scale
from pounding.scale import THESIS, Scale, of_time_factor


@dataclass(frozen=True)
class TableScale:
    """The scale of a table and of its records.

    Attributes:
        scale: Scale of all frames on the table.
        time_factor: What the time of a record is multiplied by [-].
        basis: Where the factor comes from, in words.
    """

    scale: Scale
    time_factor: float
    basis: str

    @property
    def is_laboratory(self) -> bool:
        """Whether frames and records are those of the thesis' laboratory, so that its tables can be compared with."""
        return self.scale.is_near(THESIS) and self.time_factor == THESIS.time_factor

    def as_dict(self) -> dict[str, Any]:
        """Return it for the parameters of a result."""
        return {"scale": self.scale.length, "time_factor": self.time_factor, "time_factor_basis": self.basis}

    def __str__(self) -> str:
        """Return one line for a person."""
        return f"time of the record times {self.time_factor:.4g}: {self.basis}"


def table_scale(frames: Sequence[Frame], time_factor: float | None = None) -> TableScale:
    """Return the scale of frames on one table.

    Args:
        frames: Their definitions.
        time_factor: The factor on the record's time that the user states [-]; that of the frames' scale when None.

    Raises:
        ExperimentError: Frames of two scales, or a factor that is no factor.
        FrameError: A frame whose scale is not known, and no factor is stated.
    """
    if time_factor is None:
        scale = _common([(frame.name, required_scale(frame)) for frame in frames])
        return TableScale(scale, scale.time_factor, _in_words(frames, scale))
    bounds.TIME_FACTOR.check(time_factor, "the time factor", ExperimentError)
    known = [(frame.name, found) for frame in frames if (found := known_scale(frame)) is not None]
    scale = _common(known) if known else of_time_factor(time_factor)
    return TableScale(scale, time_factor, "as stated by --time-factor")


def _common(scales: Sequence[tuple[str, Scale]]) -> Scale:
    first, scale = scales[0]
    for name, other in scales[1:]:
        if not scale.is_near(other):
            raise ExperimentError(
                f"frame {first} ({scale}) and frame {name} ({other}) cannot stand on one table: a record has one time "
                "scale; state the same scale in both frame files"
            )
    return scale


def _in_words(frames: Sequence[Frame], scale: Scale) -> str:
    names = " and ".join(dict.fromkeys(frame.name for frame in frames))
    if all(frame.scale is None for frame in frames):
        return f"{names}: full scale, by the height of the storeys"
    return f"{names}: {scale}"
