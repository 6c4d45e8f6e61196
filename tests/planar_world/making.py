"""A case is made: its frame is drawn, an effect is hidden, the motion is computed until it has converged, and measured."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.planar_world.effects import Told
from tests.planar_world.frame import Frame, Style, drawn_frame
from tests.planar_world.hiding import Placed, placed
from tests.planar_world.integration import STEP_S
from tests.planar_world.measuring import noisy
from tests.planar_world.plan import Plan
from tests.planar_world.refits import Calibration, Left, sizes
from tests.planar_world.setting import Setting, Taken, drawn_setting
from tests.planar_world.structure import Structure
from tests.planar_world.writing import write_case

STRONGEST, TRIES, NEAR = 2.2, 5, 0.25
"""Largest strength of a style [-], how often it is halved between, and how near its target is near enough [-]."""
LEFT = (0.012, 0.028)
"""What the calibrated baseline frame leaves of the readings of a strange construction [-]."""
WITHIN = 2.0
"""Prior standard deviations of the parameters within which a bounded calibration stays."""
STEPS, STEPS_OF_A_NULL, STEPS_WITHOUT_BOUND = 10, 12, 7
HALVINGS, CONVERGED = 4, 0.1
"""How often the step may be halved, and what it may change in a channel, over its noise [-]."""


@dataclass(frozen=True)
class Rig:
    """What a case shakes.

    Attributes:
        setting: How it is shaken and measured.
        frame: Without effects.
        structure: With them.
        effects: The truth of each.
        bare: What is read without effects.
        taken: What is read with them, at the usual step.
        placed: The effects with size and place.
        strength: Of the style of a frame in which nothing is hidden [-].
        left: What a bounded calibration of the baseline frame leaves of the readings of such a frame.
    """

    setting: Setting
    frame: Frame
    structure: Structure
    effects: tuple[Told, ...]
    bare: Taken
    taken: Taken
    placed: tuple[Placed, ...] = ()
    strength: float = 0.0
    left: Left | None = None


@dataclass(frozen=True)
class Made:
    """A case that was written.

    Attributes:
        plan: What it is.
        rig: What was shaken.
        taken: What is read without noise.
        convergence: What the last halving of the step changed, in the worst channel [-].
    """

    plan: Plan
    rig: Rig
    taken: Taken
    convergence: float


def rig_of(plan: Plan, rng: np.random.Generator) -> Rig:
    """Return what a case shakes; plan and source of chance say all about it."""
    setting = drawn_setting(plan, rng)
    return _rig_of_null(setting, plan.style, rng) if plan.style else _rig_of_effects(setting, rng)


def _rig_of_effects(setting: Setting, rng: np.random.Generator) -> Rig:
    plan = setting.plan
    frame = drawn_frame(plan.frame, np.random.default_rng(plan.seed + 2))
    bare = setting.taken(frame.structure())
    effects = placed(setting, frame, bare, rng)
    structure, told = frame.structure(), []
    for one in effects:
        structure, truth = one.put(frame, structure)
        told.append(truth)
    return Rig(setting, frame, structure, tuple(told), bare, setting.taken(structure), tuple(effects))


def _rig_of_null(setting: Setting, style: Style, rng: np.random.Generator) -> Rig:
    """Return a frame whose construction is as strange as a calibration leaves a share of its readings.

    The share need not grow with the strength, so the nearest of a few tries is taken.
    """
    plan, target = setting.plan, rng.uniform(*LEFT)
    low, high, strength = 0.0, STRONGEST, 1.0
    best: tuple[float, Rig] | None = None
    for _ in range(TRIES):
        frame = drawn_frame(plan.frame, np.random.default_rng(plan.seed + 2), style, strength)
        read = setting.taken(frame.structure())
        left = calibrated(setting, read, STEPS_OF_A_NULL, WITHIN)
        off = left.rms / target
        if best is None or abs(np.log(off)) < best[0]:
            rig = Rig(setting, frame, frame.structure(), (), read, read, strength=strength, left=left)
            best = abs(np.log(off)), rig
        if abs(off - 1) < NEAR:
            break
        low, high = (low, strength) if off > 1 else (strength, high)
        strength = (low + high) / 2
    assert best is not None
    return best[1]


def calibrated(setting: Setting, read: Taken, steps: int, bound: float | None = None) -> Left:
    """Return what the baseline frame leaves of readings when it is calibrated in so many steps within a bound [-]."""
    return Calibration(setting.scene, read.responses, setting.plan.noise, bound).fit(steps)


def converged(rig: Rig) -> tuple[Taken, float]:
    """Return the readings in steps that are small enough, and what the last halving changed in the worst channel [-]."""
    step, coarse = STEP_S, rig.taken
    for _ in range(HALVINGS):
        step /= 2
        fine = rig.setting.taken(rig.structure, step)
        changed = float(sizes(fine.responses, coarse.responses).max())
        if changed < CONVERGED * rig.setting.plan.noise:
            break
        coarse = fine
    return fine, changed


def make(folder: Path, plan: Plan) -> Made:
    """Write a case into a folder of its own and return what was made."""
    rng = np.random.default_rng(plan.seed)
    rig = rig_of(plan, rng)
    taken, changed = converged(rig)
    runs = noisy(taken.readings, plan.noise, plan.coloured, rng)
    write_case(folder, plan.name, plan.frame, rig.setting.channels, runs)
    return Made(plan, rig, taken, changed)
