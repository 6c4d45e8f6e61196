"""The rig of a hidden case, drawn before any effect is put in: frames, contacts, sensors, shakings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pounding.diagnosis.case.case import Channel
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden import motions
from pounding.diagnosis.hidden.contacts import DAMPED, STIFFNESS, Touch
from pounding.diagnosis.hidden.instruments import PAIR_RATES_HZ, Logger, logger, place, sampled
from pounding.diagnosis.hidden.motions import Motion
from pounding.diagnosis.hidden.scatter import set_up
from pounding.diagnosis.hidden.scenario import Happened, Scenario, happen, observed
from pounding.diagnosis.hidden.world import Sight, World

DURATION_S = (6.0, 8.0)
PAIR_DURATION_S = (4.0, 5.5)
RUNS = 3

SIGHT_HZ = 1000.0
"""Most samples per second of the motions by which the size of a model error is found [Hz]: tables move up to 60 Hz."""

GAPS = (0.25, 0.6)
"""Range of the gap over how near the floors would come to each other in the strongest run."""


@dataclass(frozen=True)
class Rig:
    """All that is drawn before any effect is put in."""

    bare: Scenario
    baseline: tuple[Touch, ...]
    channels: tuple[Channel, ...]
    log: Logger
    shakings: tuple[Motion, ...]
    world: World
    model_error: Mapping[str, Any] | None = None
    _last: list[tuple[Scenario, Happened]] = field(default_factory=list, repr=False, compare=False)

    @cached_property
    def apart(self) -> Scenario:
        """The rig without contacts, and before any effect."""
        return replace(self.bare, touches=()) if self.bare.touches else self.bare

    @cached_property
    def free(self) -> Happened:
        """Its strongest run."""
        return self.world.happen(self.apart, self.shakings[0], 0)

    def happened(self, scenario: Scenario, run: int) -> Happened:
        """Return a run of a scenario."""
        if scenario is self.apart and not run:
            return self.free
        if run:
            return self.world.happen(scenario, self.shakings[run], run)
        # An effect whose size was found is recorded next.
        if not self._last or self._last[0][0] is not scenario:
            self._last[:] = [(scenario, self.world.happen(scenario, self.shakings[0], 0))]
        return self._last[0][1]

    def clean(self, scenario: Scenario, run: int, *, coarsely: bool = False) -> np.ndarray:
        """Return what ideal sensors read in a run at the logger's rate, in SI, (samples, channels).

        Args:
            scenario: What is simulated.
            run: Number of the run, from 0.
            coarsely: Take the motion at the logger's rate too, and the frames in their modes: good for the
                difference of two linear scenarios.
        """
        if coarsely:
            shaking = _coarse(self.shakings[run], self.log.finer)
            return observed(scenario, happen(scenario, shaking, run), self.channels)
        return observed(scenario, self.happened(scenario, run), self.channels)[:: self.log.finer]

    def errors(self, bare: np.ndarray) -> np.ndarray:
        """Return what hides an effect in each channel of the strongest run: its noise and the model's error, (channels,).

        Args:
            bare: What ideal sensors read without the effect, in SI, shape (samples, channels).
        """
        noise = self.log.noise_of(self.channels, bare)
        if self.model_error is None:
            return noise
        left = [self.model_error["channels"].get(channel.name, 0.0) for channel in self.channels]
        return np.asarray(np.hypot(noise, left * bare.std(axis=0)))

    def behind_sensors(self, scenario: Scenario, run: int) -> np.ndarray:
        """Return what the real sensors and the logger make of it, (samples, channels), still without noise."""
        return sampled(observed(scenario, self.happened(scenario, run), self.channels), self.log)


def _coarse(shaking: Motion, stride: int) -> Motion:
    """Return a motion with one sample in so many."""
    return Motion(shaking.source, shaking.step_s * stride, shaking.acceleration[::stride])


def _sight(shaking: Motion, log: Logger) -> Motion:
    """Return a motion at the logger's rate, or at `SIGHT_HZ` where that is lower: free frames have no impacts."""
    return _coarse(shaking, max(log.finer, int(1 / (shaking.step_s * SIGHT_HZ))))


def draw_rig(
    rng: np.random.Generator,
    names: Sequence[str],
    source: str,
    duration_s: float | None = None,
    *,
    world: World,
    damped: bool = False,
    noise: float | None = None,
    model_error: float | None = None,
) -> Rig:
    """Draw a rig.

    Args:
        rng: Source of chance.
        names: One frame, or two that may touch at the roof of the lower one, the left one first.
        source: Of the motions (see `motions.draw`).
        duration_s: Length of each run [s]; drawn when None.
        world: The world in which it stands.
        damped: Whether the contact's law has to be one with damping.
        noise: Noise of every response channel over its root mean square [-]; drawn when None.
        model_error: Misfit that the model error leaves after calibration, over the motion [-]; drawn when None.

    Raises:
        CaseError: A model error in a world without; more than two frames, or the same twice.
    """
    if not 1 <= len(names) <= 2 or len(set(names)) < len(names):
        raise CaseError(f"frames {', '.join(names)}: give one, or two different ones that stand side by side")
    if model_error is not None and world.settle is None:
        raise CaseError(
            f"the engine {world.name} has no model error to ask for; use --engine opensees or leave it out"
        )
    frames = {name: world.built(rng, name) for name in names}
    pair = len(frames) == 2
    channels = place(rng, frames)
    rates = world.pair_rates_hz or PAIR_RATES_HZ
    log = logger(rng, channels, pair=pair, noise=noise, pair_rates_hz=rates, fine_hz=world.fine_hz)
    duration = duration_s or float(rng.uniform(*(PAIR_DURATION_S if pair else DURATION_S)))
    shakings = tuple(motions.draw(rng, RUNS, duration, log.fine_step_s, source))
    bare, error = set_up(rng, frames, channels, world.scenario), None
    if world.settle is not None:
        seen = Sight(channels, tuple(_sight(shaking, log) for shaking in shakings))
        bare, error = world.settle(rng, bare, seen, model_error)
    if not pair:
        return Rig(bare, (), channels, log, shakings, world, error)
    free = world.happen(bare, shakings[0], 0)
    stated = _stated_contact(rng, bare, free, DAMPED if damped else tuple(STIFFNESS))
    touching = replace(bare, touches=(_built(rng, stated),))
    return Rig(touching, (stated,), channels, log, shakings, world, error)


def approach(scenario: Scenario, happened: Happened, left: str, right: str, floor: int) -> float:
    """Return how near two floors come to each other [m], from where they stand at rest.

    Args:
        scenario: What was simulated.
        happened: How everything moved.
        left: Name of the frame on the left.
        right: Name of the frame on the right.
        floor: Number of the floor on both, from 1.
    """
    nearer = (
        happened.displacement[scenario.row(left, floor)] - happened.displacement[scenario.row(right, floor)]
    )
    return float(nearer.max())


def _stated_contact(rng: np.random.Generator, bare: Scenario, free: Happened, laws: Sequence[str]) -> Touch:
    left, right = bare.frames
    floor = min(beams.storeys for beams in bare.frames.values())
    gap = rng.uniform(*GAPS) * approach(bare, free, left, right, floor)
    law = str(rng.choice(laws))
    restitution = float(rng.uniform(0.6, 0.85)) if law in DAMPED else None
    damping = None
    if law == "linear_viscoelastic" and rng.random() < 0.5:
        restitution, damping = None, float(rng.uniform(800.0, 2500.0))
    # As on a drawing: to a tenth of a millimetre.
    gap_m = 1e-4 * round(1e4 * gap)
    return Touch(left, right, floor, gap_m, law, STIFFNESS[law] * rng.uniform(0.7, 1.4), damping, restitution)


def _built(rng: np.random.Generator, stated: Touch) -> Touch:
    """Return a contact as it may have been set up."""
    scatter = rng.normal(0.0, 1.0, 3)
    return replace(
        stated,
        gap_m=stated.gap_m + 2e-5 * scatter[0],
        stiffness=stated.stiffness * (1 + 0.02 * scatter[1]),
        damping=None if stated.damping is None else stated.damping * (1 + 0.03 * scatter[2]),
        restitution=None if stated.restitution is None else stated.restitution + 0.005 * scatter[2],
    )
