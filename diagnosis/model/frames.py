"""From the frames a case names to what the diagnosis believes of them."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from pounding import frames
from pounding.diagnosis.case.case import Case, CaseFrame
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.storeys import StoreyFrame, from_reduced

SMALL = 0.05
"""Relative change of a stiffness by which derivatives are taken."""


def definition(frame: CaseFrame) -> frames.Frame:
    """Return the definition of a case's frame.

    Raises:
        CaseError: The frame is not known, or its file cannot be used.
    """
    if frame.kind == "modal":
        return frames.StickFrame(
            name=frame.name,
            storeys=frame.storeys,
            storey_height_m=float(frame.storey_height_m or 0.1),
            floor_mass_kg=list(frame.floor_mass_kg),
            damping_ratio=list(frame.damping_ratio),
            frequency_hz=list(frame.frequency_hz),
            scale=frame.scale,
        )
    return frames.load(str(frame.file) if frame.file else frame.name)


def baseline_frames(case: Case) -> tuple[StoreyFrame, ...]:
    """Return the storeys of every frame of a case, in the case's order.

    Raises:
        CaseError: A frame cannot be built.
    """
    found = []
    for frame in case.frames:
        try:
            found.append(_damped(_storeys(definition(frame), frame)))
        except frames.FrameError as error:
            # Most sentences on a frame begin with its name already.
            subject = "" if str(error).startswith("frame ") else f"frame {frame.name!r}: "
            raise CaseError(f"{case.folder / 'case.toml'}: {subject}{error}") from error
    return tuple(found)


def _damped(frame: StoreyFrame) -> StoreyFrame:
    if not np.all(frame.damping_ratio > 0.0):
        raise frames.FrameError(
            "its damping_ratio is 0, and a diagnosis asks by which factor the damping is off; state what such frames have "
            "(0.5 % is 0.005)"
        )
    return frame


def _storeys(defined: frames.Frame, frame: CaseFrame) -> StoreyFrame:
    if defined.storey_law:
        raise frames.FrameError(
            "its file has [[storey_law]], and a baseline model is linear, so that what it lacks can be told; take these "
            "tables out"
        )
    if isinstance(defined, frames.StickFrame) and defined.torsion and not defined.torsion.is_symmetric:
        raise frames.FrameError(
            "its file has an eccentricity, and a baseline model sways without turning; take it out of 'torsion': floors "
            "that turn are an effect that the diagnosis looks for"
        )
    if isinstance(defined, frames.PlateFrame):
        return _plates(msgspec_key(defined), frame.name, frame.joints == "rigid", frame.p_delta)
    return from_reduced(frames.build(defined, p_delta=frame.p_delta), frame.name)


def msgspec_key(defined: frames.PlateFrame) -> bytes:
    """Return a frame as bytes that can be hashed."""
    import msgspec

    return msgspec.json.encode(defined)


@lru_cache(maxsize=16)
def _plates(encoded: bytes, name: str, rigid: bool = False, p_delta: bool = True) -> StoreyFrame:
    import msgspec

    plain = msgspec.json.decode(encoded, type=frames.PlateFrame)
    options: dict[str, Any] = {"joints": "rigid" if rigid else "calibrated", "p_delta": p_delta}
    base = from_reduced(frames.build(plain, **options), name)

    def change(**fields: object) -> np.ndarray:
        changed = from_reduced(frames.build(frames.changed(plain, **fields), **options), name)
        return np.asarray((changed.stiffness - base.stiffness) / np.log1p(SMALL))

    # Rigid joints have no stiffness that could differ by a factor.
    joints = None if rigid else change(joint_factor=plain.joint_factor * (1 + SMALL))
    patterns = []
    for storey in range(plain.storeys):
        factors = list(plain.storey_stiffness_factor) or [1.0] * plain.storeys
        factors[storey] *= 1 + SMALL
        pattern = change(storey_stiffness_factor=factors)
        above = (np.arange(plain.storeys) >= storey).astype(float)
        # Scaled so that a unit of it is a unit of the storey's own shear over drift.
        patterns.append(pattern * base.storey_stiffness[storey] / (above @ pattern @ above))
    return StoreyFrame(
        name=name,
        mass=base.mass,
        stiffness=base.stiffness,
        damping_ratio=base.damping_ratio,
        height_m=base.height_m,
        joint_derivative=joints,
        joint_stiffness=float("inf") if rigid else plain.joint_stiffness(),
        patterns=np.array(patterns),
        gyration_m=float(np.hypot(plain.plate.length_m, plain.plate.width_m) / np.sqrt(12)),
    )
