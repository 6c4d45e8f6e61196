"""How a frame of the second world differs from what is believed: its damping, and a model error of a wanted size."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pounding.diagnosis.case.case import Channel, Prior
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.modes import frequencies_hz
from pounding.diagnosis.hidden.opensees.flaws import drawn_flaws
from pounding.diagnosis.hidden.opensees.plane_frame import PlaneFrame, plane_frame, tuned
from pounding.diagnosis.hidden.opensees.remainder import Believed, Seen, beyond_calibration
from pounding.diagnosis.hidden.opensees.shaking import PlaneScenario, happen
from pounding.diagnosis.hidden.reference import typical
from pounding.diagnosis.hidden.scenario import Happened, Scenario, observed
from pounding.diagnosis.hidden.world import Sight

MODEL_ERROR = (0.005, 0.05)
"""Range from which the model error is drawn, log-uniform: misfit over the motion that a calibration leaves."""

RAYLEIGH_SHARE = 0.5
"""Share of the frames with Rayleigh's damping; the others have one ratio for each lateral mode."""

UPPER_SHARE = 0.2
"""Of the modal ratio: what stiffness-proportional damping adds in the highest lateral mode, and above in proportion."""

SPREAD = {"storeys": 0.02, "joints": 0.03, "base": 0.10, "floors": 0.10, "masses": 0.004, "sides": 0.05}
"""Standard deviations of a model error of scale 1, each on its own (relative)."""

LINEAR = (0.3, 1.0)
"""Range from which the scale of those errors is drawn."""

LARGEST_SCALE = 20.0
TRIALS = 8
NEAR = 0.1
"""Misfit found over misfit wanted at which the search ends (logarithm)."""

DERIVATIVES = {
    "relative_displacement": 0,
    "absolute_displacement": 0,
    "relative_velocity": 1,
    "absolute_acceleration": 2,
}
"""What sensors see of a floor's motion relative to the table: how often it is derived."""

STIFFENED = 0.01
"""Change of a storey's columns by which its part of a frame's stiffness is found (relative)."""


def built(rng: np.random.Generator, name: str) -> PlaneFrame:
    """Return a frame with a damping of its own in every mode, still without model error.

    Args:
        rng: Draws the damping.
        name: Frame of the thesis.
    """
    frame = plane_frame(name)
    ratio = float(frame.ratios[0]) * float(np.exp(rng.normal(0.0, 0.1)))
    circular = 2 * np.pi * frequencies_hz(frame, 2 * frame.storeys)
    modal = np.zeros(0)
    if rng.random() < RAYLEIGH_SHARE:
        # The same ratio in the first mode and in one of the next three.
        low, high = circular[0], circular[int(rng.integers(1, min(4, frame.storeys)))]
        rayleigh = (2 * ratio * low * high / (low + high), 2 * ratio / (low + high))
    else:
        modal = ratio * np.exp(rng.normal(0.0, rng.uniform(0.05, 0.15), frame.storeys))
        rayleigh = (0.0, 2 * UPPER_SHARE * ratio / circular[frame.storeys - 1])
    ratios = rayleigh[0] / (2 * circular) + rayleigh[1] * circular / 2
    ratios[: len(modal)] += modal
    still = np.zeros(frame.storeys)
    return replace(frame, rayleigh=rayleigh, modal=modal, ratios=ratios, dashpots=still)


@dataclass(frozen=True)
class Errors:
    """Unit errors of one frame; storeys (n,), joints (n + 1,), floors (n,), masses (n,), sides ()."""

    storeys: np.ndarray
    joints: np.ndarray
    floors: np.ndarray
    masses: np.ndarray
    sides: float

    def on(self, frame: PlaneFrame, scale: float) -> PlaneFrame:
        """Return the frame with these errors of a scale, its first frequency as it was."""
        joints = SPREAD["joints"] * self.joints
        joints[0] *= SPREAD["base"] / SPREAD["joints"]
        return tuned(
            replace(
                frame,
                bending=frame.bending * np.exp(scale * SPREAD["storeys"] * self.storeys),
                joint=frame.joint * np.exp(scale * joints),
                floor_bending=frame.floor_bending * np.exp(scale * SPREAD["floors"] * self.floors),
                floor_mass=frame.floor_mass * np.exp(scale * SPREAD["masses"] * self.masses),
                side_area=frame.side_area * float(np.exp(scale * SPREAD["sides"] * self.sides)),
            )
        )


def drawn_errors(rng: np.random.Generator, storeys: int) -> Errors:
    """Draw the unit errors of a frame of so many storeys."""
    normal = rng.standard_normal
    return Errors(normal(storeys), normal(storeys + 1), normal(storeys), normal(storeys), float(normal()))


def settle(
    rng: np.random.Generator, bare: Scenario, sight: Sight, wanted: float | None
) -> tuple[Scenario, Mapping[str, Any]]:
    """Give the frames a model error: errors that a calibration takes, and flaws that it cannot, as large as wanted.

    The misfit is what the frame without them leaves when its stiffness, mass and damping are calibrated to all runs but the
    last (`beyond_calibration`): mean over these runs and the last, median over the channels, of the frame that has most.

    Args:
        rng: Draws the errors and, where none is wanted, their size.
        bare: The rig without them.
        sight: What is seen.
        wanted: Misfit over the motion [-]; drawn when None.

    Returns:
        The rig with them, and what the truth says of them.

    Raises:
        TypeError: The rig is none of this world.
    """
    if not isinstance(bare, PlaneScenario):
        raise TypeError("a rig of the own world was given the model errors of the second")
    target = wanted or float(np.exp(rng.uniform(*np.log(MODEL_ERROR))))
    size = float(rng.uniform(*LINEAR))
    errors = {name: drawn_errors(rng, frame.storeys) for name, frame in bare.frames.items()}
    off = replace(bare, frames={name: errors[name].on(_plane(bare, name), size) for name in bare.frames})
    flaws = {name: drawn_flaws(rng, frame.storeys) for name, frame in bare.frames.items()}
    strongest = sight.motions[0]
    free = happen(off, strongest, 0)
    usual = {name: typical(off, name, free, strongest.velocity) for name in off.frames}

    def flawed(scale: float) -> PlaneScenario:
        scenario = off
        for name, one in flaws.items():
            scenario = one.on(scenario, name, usual[name], scale)
        return scenario

    known = {name: believed(_plane(bare, name)) for name in bare.frames}
    channels: dict[float, dict[str, float]] = {}

    def misfit(scale: float) -> float:
        channels[scale] = _left(flawed(scale), sight, known)
        return _of_frame_with_most(channels[scale], sight)

    scale, found = search(misfit, target)
    return flawed(scale), {
        "wanted": target,
        "misfit": found,
        "channels": channels[scale],
        "scale": scale,
        "flaws": {name: one.stated() for name, one in flaws.items()},
        "linear_scale": size,
        "spread": SPREAD,
        "unit_errors": {
            name: {key: np.asarray(value).tolist() for key, value in vars(one).items()}
            for name, one in errors.items()
        },
        "damping": {name: _damping(_plane(bare, name)) for name in bare.frames},
    }


def _plane(scenario: Scenario, name: str) -> PlaneFrame:
    frame = scenario.frames[name]
    if not isinstance(frame, PlaneFrame):
        raise TypeError(f"the second world consists of plane frames, and {name} is none")
    return frame


def _left(scenario: PlaneScenario, sight: Sight, believed: Mapping[str, Believed]) -> dict[str, float]:
    """Return the misfit over the motion of each channel on a frame; infinite where that runs away."""
    happened = [happen(scenario, motion, 0) for motion in sight.motions]
    left: dict[str, float] = {}
    for name in scenario.frames:
        channels = _on(sight, name)
        runs = [_seen(scenario, one, name, channels) for one in happened]
        misfits = np.full(len(channels), np.inf)
        if all(np.isfinite(run.channels).all() for run in runs):
            misfits = beyond_calibration(runs, believed[name], Prior()).mean(axis=0)
        left |= {channel.name: float(one) for channel, one in zip(channels, misfits, strict=True)}
    return left


def _of_frame_with_most(left: Mapping[str, float], sight: Sight) -> float:
    frames = {str(channel.frame) for channel in sight.channels if channel.name in left}
    return max(float(np.median([left[one.name] for one in _on(sight, name)])) for name in frames)


def _on(sight: Sight, frame: str) -> tuple[Channel, ...]:
    return tuple(channel for channel in sight.channels if channel.frame == frame)


def _seen(scenario: PlaneScenario, happened: Happened, name: str, channels: tuple[Channel, ...]) -> Seen:
    still = np.zeros_like(happened.displacement)
    rigid = replace(happened, displacement=still, velocity=still, acceleration=still + happened.table)
    return Seen(
        happened.motion.step_s,
        happened.table,
        observed(scenario, happened, channels),
        observed(scenario, rigid, channels),
        np.array([int(channel.floor or 0) - 1 for channel in channels]),
        np.array([DERIVATIVES[channel.quantity] for channel in channels]),
    )


def believed(frame: PlaneFrame) -> Believed:
    """Return a frame as a calibration knows it: a mass at each floor, and the stiffness that each storey's columns give."""

    def stiffness(one: PlaneFrame) -> np.ndarray:
        matrices = one.matrices()
        return np.asarray(
            np.linalg.inv(matrices.floors @ np.linalg.solve(matrices.stiffness, matrices.floors.T))
        )

    here = stiffness(frame)
    storeys = [
        (stiffness(replace(frame, bending=frame.bending * (1 + STIFFENED * one))) - here) / STIFFENED
        for one in np.eye(frame.storeys)
    ]
    mass = frame.floor_mass + frame.column_mass * np.append(np.ones(frame.storeys - 1), 0.5)
    return Believed(mass, here, np.array(storeys), frame.ratios[: frame.storeys])


def _damping(frame: PlaneFrame) -> dict[str, Any]:
    alpha, beta = frame.rayleigh
    return {"mass_proportional": alpha, "stiffness_proportional": beta, "modal": frame.modal.tolist()}


def search(misfit: Callable[[float], float], target: float) -> tuple[float, float]:
    """Return the scale of flaws whose misfit comes nearest to the target, and that misfit.

    Args:
        misfit: Misfit of a scale [-]; may raise `CaseError` where no frame stands.
        target: What it is to be [-].

    Raises:
        CaseError: No frame stands at any scale that was tried.
    """
    tried: dict[float, float] = {}
    low, high, scale = 0.0, LARGEST_SCALE, min(100 * target, 0.5 * LARGEST_SCALE)
    for _ in range(TRIALS):
        try:
            found = misfit(scale)
        except CaseError:
            found = np.inf
        if np.isfinite(found):
            tried[scale] = found
            if abs(np.log(found / target)) < NEAR:
                break
        low, high = (scale, high) if found < target else (low, scale)
        step = scale * target / found if np.isfinite(found) else 0.0
        # In proportion, unless that leaves what is known to be too little and too much.
        scale = step if low < step < high else 0.5 * (low + high)
    if not tried:
        raise CaseError("the hidden frame runs away with any model error that was tried; use another seed")
    best = min(tried, key=lambda one: abs(np.log(tried[one] / target)))
    return best, tried[best]
