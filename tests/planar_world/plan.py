"""The set of a seed: what each case hides, in which frame, with how much noise and how few sensors; nothing is made yet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.planar_world.baseline import STOREYS
from tests.planar_world.frame import Style

SINGLES = (
    "coulomb_friction",
    "cubic_stiffness",
    "loss30",
    "loss12",
    "hysteresis",
    "air_drag",
    "bumper",
    "added_mass",
    "damping_change",
    "joint_flexibility",
    "base_rocking",
    "sensor_gain",
    "sensor_delay",
    "loosening",
)
"""One case each; a loss is a stiffness change of so many per cent."""
DOUBLES = (
    ("coulomb_friction", "added_mass"),
    ("cubic_stiffness", "loss30"),
    ("air_drag", "sensor_gain"),
    ("bumper", "damping_change"),
    ("hysteresis", "added_mass"),
    ("cubic_stiffness", "damping_change"),
)
"""Of these two are drawn."""
OUTSIDE = ("appendage", "rattle", "dfriction")
"""What is in no catalogue: a tuned appendage, a rattling mass, friction in proportion to the drift."""
NULLS = (
    ("5A", 0.005, Style("joints", weight=0.0, foot=3.0, roof=0.8, fitting=2e4)),
    ("5B", 0.01, Style("rayleigh", weight=0.6, foot=1.6, fitting=3e4)),
    ("10", 0.01, Style("joints", weight=0.0, foot=0.6, roof=0.6)),
    ("15A", 0.02, Style("rayleigh", weight=0.4, foot=2.5, fitting=3e4)),
    ("15B", 0.02, Style("joints", weight=1.5, roof=0.6, foot=0.5)),
)
"""Nothing is hidden, but the construction is strange: frame, noise [-] and style."""
FRAMES = ["5A"] * 5 + ["5B"] * 5 + ["10"] * 5 + ["15A"] * 2 + ["15B"] * 2
"""Of the cases with something hidden, in a random order."""
NOISES = [0.005] * 2 + [0.01] * 5 + [0.015] * 2 + [0.02] * 6 + [0.03] * 3 + [0.015]
"""Noise of the same [-]."""
SEEN_IN_LOW_FRAMES = ("loss12", "rattle")
"""What cannot be seen in frames of 15 storeys."""
ALWAYS_WELL_MEASURED = ("joint_flexibility", "loss12", "sensor_gain")
"""Singles that no draw gives few accelerometers."""
FEW = {"added_mass": None, "base_rocking": None, "cubic_stiffness": 1, "sensor_gain": 3}
"""Number of accelerometers of some singles, whatever was drawn; None is one on every floor."""
CASES, COLOURED = 24, 4
"""Number of cases, and of those whose noise is coloured."""


@dataclass(frozen=True)
class Plan:
    """A case before it is made.

    Attributes:
        name: Of its folder; it says nothing of what is hidden.
        frame: Its name in the project.
        kinds: What is hidden; nothing where empty.
        style: The construction of a frame in which nothing is hidden.
        noise: Over each channel's rms [-].
        coloured: Whether half of its variance is first-order noise.
        accelerometers: How many there are; one on every floor where None.
        seed: From which all else is drawn.
    """

    name: str
    frame: str
    kinds: tuple[str, ...]
    style: Style | None
    noise: float
    coloured: bool
    accelerometers: int | None
    seed: int

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return STOREYS[self.frame]


def plans(seed: int) -> list[Plan]:
    """Return the cases of a seed, in the order of their names."""
    rng = np.random.default_rng(seed)
    pairs = [DOUBLES[number] for number in rng.permutation(len(DOUBLES))[:2]]
    hidden = [*((kind,) for kind in SINGLES), *pairs, *((kind,) for kind in OUTSIDE)]
    frames = _frames(rng, hidden)
    order = rng.permutation(CASES).tolist()
    noises = rng.permutation(NOISES).tolist()
    few = _accelerometers(rng)
    coloured = set(rng.permutation(CASES)[:COLOURED].tolist())
    seeds = rng.integers(1, 2**31, CASES).tolist()
    stems: list[tuple[str, tuple[str, ...], Style | None, float, int | None]] = [
        (frame, (), style, noise, None) for frame, noise, style in NULLS
    ]
    stems += [
        (frame, kinds, None, noise, few.get(kinds[0]) if len(kinds) == 1 else None)
        for frame, kinds, noise in zip(frames, hidden, noises, strict=True)
    ]
    found = [
        Plan(f"c{order.index(number) + 1:02d}", frame, kinds, style, noise, number in coloured, sensors, seed)
        for number, ((frame, kinds, style, noise, sensors), seed) in enumerate(zip(stems, seeds, strict=True))
    ]
    return sorted(found, key=lambda plan: plan.name)


def _frames(rng: np.random.Generator, hidden: list[tuple[str, ...]]) -> list[str]:
    """Return the frames of the cases with something hidden."""
    low = [hidden.index((kind,)) for kind in SEEN_IN_LOW_FRAMES]
    while True:
        frames = [FRAMES[number] for number in rng.permutation(len(FRAMES))]
        if all(STOREYS[frames[number]] < 15 for number in low):
            return frames


def _accelerometers(rng: np.random.Generator) -> dict[str, int]:
    """Return how many accelerometers there are, for the singles that do not have one on every floor."""
    may = [number for number, kind in enumerate(SINGLES) if kind not in ALWAYS_WELL_MEASURED]
    drawn = sorted(rng.permutation(may)[:4].tolist())
    counts: dict[str, int | None] = {
        SINGLES[number]: count
        for number, count in zip(drawn, rng.permutation([1, 2, 3, 3]).tolist(), strict=True)
    }
    return {kind: count for kind, count in (counts | FEW).items() if count is not None}
