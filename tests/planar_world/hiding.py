"""Where effects are put, and how large they are made: to a size by what they change in the readings."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tests.planar_world.baseline import Real, modes
from tests.planar_world.effects import EFFECTS, Told, Where
from tests.planar_world.frame import Frame
from tests.planar_world.refits import over_channels, sizes
from tests.planar_world.setting import Setting, Taken
from tests.planar_world.structure import Structure, drift

TUNED = {
    "coulomb_friction": (0.05, 60.0),
    "cubic_stiffness": (1e7, 1e11),
    "hysteresis": (0.8, 12.0),
    "air_drag": (0.05, 300.0),
    "bumper": (2e3, 2e6),
    "damping_change": (0.5, 800.0),
    "rattle": (0.1, 1.5),
    "dfriction": (1e2, 1e5),
}
"""Effects that are tuned, with their least and largest sizes, in the units of `effects`."""
TARGETS, TARGETS_OF_DAMPING = (0.12, 0.30), (0.3, 0.4)
"""What a tuned effect changes in the readings [-]; a damper alone hides behind the damping of the modes, so it is larger."""
SOFTER = (0.05, 0.07)
"""By how much a rocking foot lowers the first frequency [-]."""
BISECTIONS, NEAR, BISECTIONS_OF_ROCKING = 8, 0.06, 60
DIVERGED = 9.0
"""Size that stands for readings that are not finite."""
ON_UPPER_FLOORS = ("added_mass", "appendage", "rattle")
"""What has little effect near the table."""
NOT_UNDER_THE_ROOF = (
    "coulomb_friction",
    "cubic_stiffness",
    "hysteresis",
    "bumper",
    "damping_change",
    "dfriction",
    "loss12",
    "loss30",
    "loosening",
)
"""What has little effect in the highest storey of five; in higher frames no effect is in the two highest."""


@dataclass(frozen=True)
class Placed:
    """An effect with its size, in the unit of its function in `effects`, and its place."""

    kind: str
    size: float
    where: Where

    def put(self, frame: Frame, structure: Structure) -> tuple[Structure, Told]:
        """Put the effect into a structure of a frame."""
        return EFFECTS[self.kind](frame, structure, self.size, self.where)


def placed(setting: Setting, frame: Frame, bare: Taken, rng: np.random.Generator) -> list[Placed]:
    """Draw where the effects of a case are, and tune each of them as if it were alone.

    Args:
        setting: Of the case.
        frame: Without effects.
        bare: What is read of it.
        rng: Source of chance.
    """
    found: list[Placed] = []
    for kind in setting.plan.kinds:
        taken = {one.where.storey for one in found}
        where = _where(kind, setting, bare, taken, rng)
        alone = len(setting.plan.kinds) == 1
        # All are drawn for every effect, so that what is drawn after them does not hang on what it is.
        fixed = _fixed_sizes(rng, alone and kind == "added_mass")
        target = rng.uniform(*(TARGETS_OF_DAMPING if alone and kind == "damping_change" else TARGETS))
        if kind == "base_rocking":
            size = _rocking(frame, rng.uniform(*SOFTER))
        elif kind in fixed:
            size = fixed[kind]
        else:
            size = _tuned(Placed(kind, 0.0, where), setting, frame, bare.responses, target)
        found.append(Placed(kind, size, where))
    return found


def _where(kind: str, setting: Setting, bare: Taken, taken: set[int], rng: np.random.Generator) -> Where:
    """Draw a place for an effect, in none of the storeys that are taken."""
    storeys, five = setting.plan.storeys, setting.plan.storeys == 5
    while True:
        storey = int(rng.integers(1, storeys + 1 if five else storeys - 1))
        floor = int(rng.integers(1, storeys + 1))
        low = kind in ON_UPPER_FLOORS and floor < max(2, storeys // 3)
        high = kind in NOT_UNDER_THE_ROOF and five and storey == storeys
        if not low and not high and storey not in taken:
            break
    where = Where(storey, floor)
    if kind == "hysteresis":
        peak = bare.largest(drift(storeys, storey))
        return replace(where, share=float(rng.uniform(0.25, 0.45)), peak=peak)
    if kind == "bumper":
        gap = rng.uniform(0.4, 0.65) * bare.largest(drift(storeys, storey)) * rng.choice([-1, 1])
        return replace(where, gap=float(gap))
    if kind in ("sensor_gain", "sensor_delay"):
        upper = setting.accelerated[-max(1, len(setting.accelerated) * 2 // 3) :]
        return replace(where, channel=f"{setting.plan.frame}_a{int(rng.choice(upper))}")
    if kind == "appendage":
        mode, tune = int(rng.integers(1, 3)), float(rng.uniform(0.93, 1.05))
        return replace(where, mode=mode, tune=tune, ratio=float(rng.uniform(0.01, 0.03)))
    if kind == "rattle":
        return replace(where, gap=float(rng.uniform(0.3, 0.9) * 1e-3))
    return where


def _fixed_sizes(rng: np.random.Generator, mass_alone: bool) -> dict[str, float]:
    """Return the sizes of the effects that are not tuned, in the units of `effects`.

    A mass alone is larger: what it changes is little beside what is uncertain of the masses.
    """
    return {
        "loss30": -0.30,
        "loss12": -0.12,
        "added_mass": float(rng.uniform(0.16 if mass_alone else 0.10, 0.20)),
        "joint_flexibility": float(rng.uniform(0.55, 0.7)),
        "sensor_gain": float(rng.choice([-0.1, 0.1])),
        "sensor_delay": float(rng.uniform(3, 5)),
        "loosening": -0.20,
        "appendage": 0.05,
    }


def _tuned(effect: Placed, setting: Setting, frame: Frame, bare: Real, target: float) -> float:
    """Return the size of an effect with which it changes the readings by a share [-], found by bisection.

    Args:
        effect: Of any size.
        setting: Of the case.
        frame: Without effects.
        bare: What is read of it but for the table (times of all runs, channels).
        target: Root mean square over the channels of the change over the readings with the effect [-].
    """
    low, high = np.log(TUNED[effect.kind])
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        structure, _ = replace(effect, size=np.exp(middle)).put(frame, frame.structure())
        read = setting.taken(structure).responses
        size = over_channels(sizes(read, bare)) if np.isfinite(read).all() else DIVERGED
        if abs(size / target - 1) < NEAR:
            break
        if size > target:
            high = middle
        else:
            low = middle
    return float(np.exp(middle))


def _rocking(frame: Frame, softer: float) -> float:
    """Return the stiffness of a rocking foot [N m/rad] that lowers the first frequency by a share [-]."""
    mass, stiffness = frame.matrices()
    wanted = modes(mass, stiffness)[0][0] * (1 - softer)
    lower = np.linalg.cholesky(mass)
    low, high = np.log(2e2), np.log(1e7)
    for _ in range(BISECTIONS_OF_ROCKING):
        middle = (low + high) / 2
        rocks = frame.matrices(rocking=np.exp(middle))[1]
        # On too soft a foot the frame falls over: its first square is negative.
        square = np.linalg.eigvalsh(np.linalg.solve(lower, np.linalg.solve(lower, rocks).T))[0]
        if np.sqrt(max(square, 0)) / 2 / np.pi < wanted:
            low = middle
        else:
            high = middle
    return float(np.exp(middle))
