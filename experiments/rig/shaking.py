"""One frame on the shaking table: its peaks, its stresses, and whether the model is valid there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding.experiments.rig.ductility import ductilities
from pounding.experiments.rig.motion import FrameMotion, Motion
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.ringing import cut_short
from pounding.frames.definition import PlateFrame
from pounding.frames.response.stress import Largest, largest_stress

if TYPE_CHECKING:
    from pounding.experiments.records import Record
    from pounding.frames.reduction.reduced_frame import ReducedFrame

SMALL_DRIFT = 0.05
"""Largest storey drift over storey height for small-rotation kinematics: the cosine is off by 0.1 % there."""


@dataclass(frozen=True)
class Shaking:
    """A frame that was shaken alone.

    Attributes:
        reduced: The frame.
        record: The shaking, at the scale of the frames.
        motion: The run.
        stress: Its largest stress; None for a stick, which has no plates, and for a frame that may yield, whose
            stress does not follow from its displacement.
        warnings: Sentences on what the model leaves its validity by; empty if nothing.
    """

    reduced: ReducedFrame
    record: Record
    motion: Motion
    stress: Largest | None
    warnings: list[str]

    def __repr__(self) -> str:
        return f"Shaking({self.reduced!r}, {self.record!r})"

    def result(self) -> dict[str, Any]:
        """Return the numbers of the run, units in the keys."""
        return {
            "frame": self.reduced.name,
            "record": self.record.name,
            "pga_g": self.record.pga_g,
            "damping_ratio": self.reduced.damping_ratio,
            "peaks": self.motion.frames[0].peaks(),
            "ductility": ductilities(self.motion.frames[0]),
            "max_stress_mpa": None if self.stress is None else self.stress.stress_pa / 1e6,
            "wall_s": self.motion.wall_s,
            "model_s": self.motion.model_s,
            "warnings": self.warnings,
        }


def shake(
    reduced: ReducedFrame, record: Record, *, progress: Callable[[float], None] | None = None
) -> Shaking:
    """Shake a frame alone on the table, in exudyn.

    Args:
        reduced: The frame.
        record: The shaking, at the scale of the frames.
        progress: Called now and then with the model time [s].

    Raises:
        ExperimentError: The motion grows without bound.
        FrameError: The record is not finite.
    """
    motion = Rig([reduced]).run(record, progress=progress)
    moved = motion.frames[0]
    stress = linear_stress(moved)
    return Shaking(reduced, record, motion, stress, validity(moved, stress))


def linear_stress(motion: FrameMotion) -> Largest | None:
    """Return the largest stress of a motion; None for a stick and for a frame that may yield.

    Args:
        motion: Motion of the frame.
    """
    reduced = motion.reduced
    if not reduced.is_mesh or reduced.definition.yielding is not None:
        return None
    return largest_stress(reduced, motion.displacement_m)


def validity(motion: FrameMotion, stress: Largest | None) -> list[str]:
    """Return a sentence for each limit of the linear model that a motion passes, and one where it ends too early.

    The limits: von Mises' stress of the motion below the yield stress, and storey drifts below `SMALL_DRIFT`
    of the storey height. The stress of gravity, some 3 MPa, is not counted.
    """
    warnings = []
    definition = motion.reduced.definition
    if stress is not None and isinstance(definition, PlateFrame):
        limit = definition.material.yield_stress_mpa
        if stress.stress_pa / 1e6 >= limit:
            when = motion.time_s[stress.instant]
            warnings.append(
                f"{motion.name}: the stress reaches {stress.stress_pa / 1e6:.0f} MPa ({stress.place}, at "
                f"{when:.3f} s), above the yield stress of {limit:.0f} MPa; the model does not yield "
                "without a table 'yielding' in its file, so its motion is not to be trusted from there on"
            )
    drift, storey, at = largest_drift(motion)
    if drift > SMALL_DRIFT:
        warnings.append(
            f"{motion.name}: storey {storey} drifts by {100 * drift:.1f} % of its height at {at:.3f} s, "
            f"beyond the {100 * SMALL_DRIFT:.0f} % up to which small rotations may be assumed"
        )
    roof = motion.displacement_m[:, motion.reduced.floor_x[-1]]
    return warnings + cut_short(motion.reduced, roof, motion.displacement_m[-1], motion.velocity_m_s[-1])


def largest_drift(motion: FrameMotion) -> tuple[float, int, float]:
    """Return the largest storey drift over its height, its storey and its time [s]; of floors that turn, at their edges."""
    reduced = motion.reduced
    heights = np.diff(reduced.heights_m, prepend=0.0)
    floors = motion.displacement_m[:, reduced.floor_x]
    places = [floors]
    if reduced.turns:
        sideways = reduced.plan_m[1] / 2.0 * motion.displacement_m[:, reduced.floor_rz]
        places = [floors - sideways, floors + sideways]
    drifts = np.max([np.abs(np.diff(one, prepend=0.0, axis=1)) for one in places], axis=0) / heights
    place, storey = np.unravel_index(int(drifts.argmax()), drifts.shape)
    return float(drifts[place, storey]), int(storey) + 1, float(motion.time_s[place])
