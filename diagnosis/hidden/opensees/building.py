"""How a frame of the second world differs from what is believed: its damping, and a model error of a wanted size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.baseline import baseline
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.modes import frequencies_hz
from pounding.diagnosis.hidden.opensees.plane_frame import PlaneFrame, plane_frame, tuned
from pounding.diagnosis.hidden.scenario import Scenario
from pounding.diagnosis.hidden.visibility import Eye, Patience, nudged, ordinary_parameters, rooms
from pounding.diagnosis.hidden.world import Sight

MODEL_ERROR = (0.005, 0.05)
"""Range from which the model error is drawn, log-uniform: misfit of a null after calibration over the motion."""

RAYLEIGH_SHARE = 0.5
"""Share of the frames with Rayleigh's damping; the others have one ratio for each lateral mode."""

UPPER_SHARE = 0.2
"""Of the modal ratio: what stiffness-proportional damping adds in the highest lateral mode, and above in proportion."""

SPREAD = {"storeys": 0.02, "joints": 0.03, "base": 0.10, "floors": 0.10, "masses": 0.004, "sides": 0.05}
"""Standard deviations of a model error of scale 1, each on its own (relative)."""

PATIENCE = Patience(refits=40, enough=0.03, reach=2.0)
"""Of the refit, whose misfit decides how large the errors are made: no parameter goes further than a frame may be off."""

FREQUENCY_WEIGHT = 2000.0
"""Weight of a frequency's logarithm beside the prior in the refit's first guess."""

LARGEST_SCALE = 3.0
TRIALS = 8
NEAR = 0.1
"""Misfit found over misfit wanted at which the search ends (logarithm)."""


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
    """Give the frames a model error, as large as wanted: see `MODEL_ERROR`.

    The misfit is that of the strongest run to the beams of the own world, the diagnosis' belief, with their
    nuisance parameters refitted inside the priors; its median over the channels.

    Args:
        rng: Draws the errors and, where none is wanted, their size.
        bare: The rig without them.
        sight: What is seen of the strongest run.
        wanted: Misfit over the motion [-]; drawn when None.

    Returns:
        The rig with them, and what the truth says of them.
    """
    target = wanted or float(np.exp(rng.uniform(*np.log(MODEL_ERROR))))
    errors = {name: drawn_errors(rng, frame.storeys) for name, frame in bare.frames.items()}
    believed = replace(bare, frames={name: _believed(name) for name in bare.frames})
    seen = [not channel.is_table and channel.quantity != "contact_force" for channel in sight.channels]
    noise = np.where(seen, sight.noise_of(sight.clean(bare)), np.inf)
    eye = Eye(lambda scenario, coarsely: sight.clean(scenario), believed, noise)

    def wrong(scale: float) -> Scenario:
        frames = {name: _on(errors[name], frame, scale) for name, frame in bare.frames.items()}
        return replace(bare, frames=frames)

    def misfit(scenario: Scenario) -> float:
        truth = sight.clean(scenario)[:, seen]
        start = _first_guess(believed, scenario)
        left = eye.unexplained(sight.clean(scenario), start, PATIENCE)[:, seen] * noise[seen]
        return float(np.median(_rms(left) / _rms(truth - truth.mean(axis=0))))

    scale, found = search(lambda scale: misfit(wrong(scale)), target)
    said = {
        name: {key: np.asarray(value).tolist() for key, value in vars(one).items()}
        for name, one in errors.items()
    }
    return wrong(scale), {
        "wanted": target,
        "misfit": found,
        "scale": scale,
        "spread": SPREAD,
        "unit_errors": said,
        "damping": {name: _damping(frame) for name, frame in bare.frames.items()},
    }


def _believed(name: str) -> Beams:
    """Return a frame as the diagnosis believes it, with a damping ratio of its own for every mode to refit."""
    beams = baseline(name)
    return replace(beams, ratios=np.full(beams.storeys, beams.ratios[0]))


def _first_guess(believed: Scenario, true: Scenario) -> np.ndarray:
    """Return nuisance parameters that bring the believed frames' frequencies and damping near to the true ones.

    The refit starts there: from the priors' middle it would lose its way where the phases have gone apart.
    """
    ordinary = ordinary_parameters(believed)
    start, stiff = np.zeros(ordinary), np.zeros(ordinary, bool)
    for name, (damping, stiffness) in rooms(believed).items():
        modes = damping.stop - damping.start
        ratios = true.frames[name].ratios[:modes] / believed.frames[name].ratios[:modes]
        start[damping] = np.log(ratios) / Prior().damping_ratio
        stiff[stiffness] = True

    def logs(scenario: Scenario) -> np.ndarray:
        return np.concatenate([np.log(frequencies_hz(one, one.storeys)) for one in scenario.frames.values()])

    wanted = logs(true)

    def misfit(moved: np.ndarray) -> np.ndarray:
        at = start.copy()
        at[stiff] = moved
        return np.append(FREQUENCY_WEIGHT * (logs(nudged(believed, at)) - wanted), moved)

    start[stiff] = least_squares(misfit, np.zeros(stiff.sum()), diff_step=1e-4, max_nfev=20).x
    return np.clip(start, -0.99 * PATIENCE.reach, 0.99 * PATIENCE.reach)


def _on(errors: Errors, frame: Any, scale: float) -> PlaneFrame:
    return errors.on(frame, scale)


def _damping(frame: Any) -> dict[str, Any]:
    alpha, beta = frame.rayleigh
    return {"mass_proportional": alpha, "stiffness_proportional": beta, "modal": frame.modal.tolist()}


def _rms(values: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))


def search(misfit: Any, target: float) -> tuple[float, float]:
    """Return the scale whose misfit comes nearest to the target, and that misfit."""
    tried = {0.0: misfit(0.0)}
    low, high, scale = 0.0, LARGEST_SCALE, 1.0
    for _ in range(TRIALS):
        # What the element model alone does is the least.
        if tried[0.0] >= target or min(abs(np.log(one / target)) for one in tried.values()) < NEAR:
            break
        try:
            tried[scale] = misfit(scale)
        except CaseError:
            high = scale
        else:
            low, high = (max(low, scale), high) if tried[scale] < target else (low, min(high, scale))
        step = scale * target / tried[scale] if scale in tried else low
        scale = step if low < step < high else 0.5 * (low + high)
    best = min(tried, key=lambda one: abs(np.log(tried[one] / target)))
    return best, tried[best]
