"""What can be hidden, each with a physical realisation of its own; sizes are relative, 1 is plain.

The names are those of the case format, so that a truth can be compared with a verdict; nothing else is
shared.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from pounding.constants import STANDARD_GRAVITY
from pounding.diagnosis.hidden import laws
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.contacts import Touch
from pounding.diagnosis.hidden.modes import lone_storey_stiffness, storey_stiffness
from pounding.diagnosis.hidden.reference import Typical
from pounding.diagnosis.hidden.scenario import Scenario, Spring


@dataclass(frozen=True)
class Setting:
    """Where an effect is put: the scenario so far, the frame's typical sizes, and the place.

    `storey` and `floor` count from 1; `channel` is a name, with its root mean square in SI. `stated_contact`
    is the contact as the case states it, `nearness` how near the frames' `floor`s come to each other over
    how near those of the stated contact come, if nothing stops them.
    """

    scenario: Scenario
    typical: Typical
    frame: str
    storey: int = 0
    floor: int = 0
    channel: str = ""
    channel_rms: float = 0.0
    channel_to_si: float = 1.0
    stated_contact: Touch | None = None
    nearness: float = 0.0

    @property
    def beams(self) -> Beams:
        """The frame as it is."""
        return self.scenario.frames[self.frame]

    def at(self, values: np.ndarray) -> float:
        """Return a storey's or floor's value.

        Args:
            values: A value for each storey or floor of the frame, shape (storeys,).
        """
        return float(values[(self.storey or self.floor) - 1])

    def with_beams(self, **fields: Any) -> Scenario:
        """Return the scenario with the frame changed."""
        changed = {**self.scenario.frames, self.frame: replace(self.beams, **fields)}
        return replace(self.scenario, frames=changed)

    def with_storey_law(self, make: Callable[[float], Any]) -> Scenario:
        """Return the scenario with a law between the storey's two floors."""
        spring = Spring(self.frame, self.storey, self.storey - 1, make)
        return replace(self.scenario, springs=(*self.scenario.springs, spring))


Parameters = dict[str, tuple[Any, ...]]
"""Value and unit by name, as the truth states them.

After these come the values by other definitions in use: in a frame whose joints turn, a storey's stiffness is
its shear over drift under lateral load, or its shear for a drift of it alone, or that of its columns.
"""

Put = Callable[[Setting, float, np.random.Generator], tuple[Scenario, Parameters]]


@dataclass(frozen=True)
class Effect:
    """Something that can be hidden.

    Attributes:
        place: ``storey``, ``floor``, ``frame``, ``table``, ``channel`` or ``contact``.
        put: Puts it into a scenario and returns the true parameters too. Its arguments are the `setting` to
            change, the signed relative `size` [-], and `rng`, which draws what the size leaves open.
        largest: Largest size that still makes sense, upwards.
        smallest: The same downwards; 0 where a negative size has no meaning.
    """

    place: str
    put: Put
    largest: float
    smallest: float = 0.0


def stiffness_change(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Stiffen or soften the columns of a storey until its shear over drift has changed by `size`."""
    before = setting.at(storey_stiffness(setting.beams))

    def bent(log: float) -> np.ndarray:
        bending = setting.beams.bending.copy()
        bending[setting.storey - 1] *= np.exp(log)
        return bending

    def missing(log: float) -> float:
        return setting.at(storey_stiffness(replace(setting.beams, bending=bent(log)))) / before - 1 - size

    log = brentq(missing, -3.0, 3.0)
    scenario = setting.with_beams(bending=bent(log))
    changed = setting.at(lone_storey_stiffness(scenario.frames[setting.frame]))
    lone = changed / setting.at(lone_storey_stiffness(setting.beams)) - 1
    return scenario, {"relative_change": (size, "-", lone, float(np.exp(log)) - 1)}


def joint_flexibility(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Change all joints by the same factor; a little unevenly."""
    uneven = rng.normal(1.0, 0.03, len(setting.beams.joint))
    factor = np.exp(size)
    baseline = setting.beams.joint_stated
    value = baseline * factor * float(np.mean(uneven))
    return setting.with_beams(joint=setting.beams.joint * factor * uneven), {
        "joint_stiffness": (value, "N m/rad")
    }


def base_rocking(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let the base turn; the softness is relative to the frame's own in its first mode."""
    beams = setting.beams
    mass = beams.storeys * (beams.floor_mass.mean() + beams.column_mass)
    arm = 0.7 * beams.heights_m[-1]
    stiffness = 0.8 * mass * (2 * np.pi * setting.typical.first_hz) ** 2 * arm**2 / size
    return setting.with_beams(base=stiffness), {"rotational_stiffness": (stiffness, "N m/rad")}


def p_delta(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Press the columns with more weight than the model has."""
    factor = 10 * size
    return setting.with_beams(axial=setting.beams.axial * (1 + factor)), {"weight_factor": (factor, "-")}


def added_mass(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Put mass on a floor, with the weight that it has."""
    mass = size * setting.at(setting.beams.floor_mass)
    floors = setting.beams.floor_mass.copy()
    floors[setting.floor - 1] += mass
    axial = setting.beams.axial.copy()
    axial[: setting.floor] += STANDARD_GRAVITY * mass
    return setting.with_beams(floor_mass=floors, axial=axial), {"mass": (mass, "kg")}


def damping_change(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Put a dashpot into a storey, or take some of its damping."""
    damper = size * setting.at(setting.typical.storey_damper)
    dashpots = (
        np.zeros(setting.beams.storeys) if not setting.beams.dashpots.size else setting.beams.dashpots.copy()
    )
    dashpots[setting.storey - 1] += damper
    return setting.with_beams(dashpots=dashpots), {"damping": (damper, "N s/m")}


def coulomb_friction(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Rub two parts of a storey, with bristles that are stiff against it and a small breakaway."""
    stiffness = setting.at(setting.typical.stiffness)
    level = 0.5 * size * stiffness * setting.at(setting.typical.rms_drift)
    bristles, breakaway = stiffness * rng.uniform(15, 40), rng.uniform(1.0, 1.1)
    fades = rng.uniform(0.05, 0.2) * setting.at(setting.typical.rms_rate)
    scenario = setting.with_storey_law(lambda _: laws.LuGre(level, bristles, breakaway, fades))
    return scenario, {"friction_force": (level, "N")}


def air_drag(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Drag all floors through the room's air, each a little differently."""
    beams = setting.beams
    speed = float(setting.typical.rms_velocity.mean())
    mass = float(beams.floor_mass.mean())
    coefficient = size * 2 * beams.ratios[0] * 2 * np.pi * setting.typical.first_hz * mass / speed
    each = coefficient * rng.normal(1.0, 0.03, beams.storeys)
    drags = tuple(
        Spring(setting.frame, floor + 1, 0, lambda _, c=float(c): laws.drag(c), absolute=True)  # type: ignore[misc]
        for floor, c in enumerate(each)
    )
    scenario = replace(setting.scenario, springs=(*setting.scenario.springs, *drags))
    return scenario, {"coefficient": (float(each.mean()), "N s^2/m^2")}


def cubic_stiffness(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Harden or soften a storey with its drift."""
    coefficient = size * setting.at(setting.typical.stiffness) / setting.at(setting.typical.peak_drift) ** 2
    scenario = setting.with_storey_law(lambda _: laws.cubic(coefficient))
    return scenario, {"cubic_stiffness": (coefficient, "N/m^3")}


def hysteresis(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a part of a storey yield, with a rounded knee."""
    stiffness = rng.uniform(0.15, 0.6) * setting.at(setting.typical.stiffness)
    force = stiffness * setting.at(setting.typical.peak_drift) / (1 + 4 * size)
    sharpness = rng.uniform(2.5, 8.0)
    scenario = setting.with_storey_law(lambda _: laws.BoucWen(force, stiffness, sharpness))
    return scenario, {"yield_force": (force, "N"), "stiffness": (stiffness, "N/m")}


def loosening(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a storey lose stiffness over each run."""
    stiffness = setting.at(storey_stiffness(setting.beams))
    scenario = setting.with_storey_law(lambda duration: laws.fading(stiffness, size, duration))
    lone = size * stiffness / setting.at(lone_storey_stiffness(setting.beams))
    return scenario, {"final_relative_change": (size, "-", lone)}


def bumper(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Stop a storey's drift on one side, with a rounded onset and some loss."""
    side = rng.choice([-1.0, 1.0])
    gap = side * rng.uniform(0.25, 0.7) * setting.at(setting.typical.peak_drift)
    stiffness = 4 * size * setting.at(setting.typical.stiffness)
    softness, loss = 0.02 * abs(gap), rng.uniform(0.0, 2e-4)
    scenario = setting.with_storey_law(lambda _: laws.stop(gap, stiffness, softness, loss))
    return scenario, {"gap": (gap * 1e3, "mm"), "stiffness": (stiffness, "N/m")}


def torsional_eccentricity(
    setting: Setting, size: float, rng: np.random.Generator
) -> tuple[Scenario, Parameters]:
    """Move the centres of mass away from those of stiffness, in a frame that is not stiff in torsion."""
    offset = 0.12 * size
    scenario = setting.with_beams(eccentricity_m=offset, torsion_ratio=rng.uniform(1.2, 1.9))
    return scenario, {"eccentricity": (offset, "m")}


def table_gain(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Shake the frames more than the table channel says."""
    gain = setting.scenario.table_gain + size
    return replace(setting.scenario, table_gain=gain), {"relative_change": (gain, "-")}


def table_delay(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Shake the frames later than the table channel says."""
    delay = setting.scenario.table_delay_s + 0.02 * size
    return replace(setting.scenario, table_delay_s=delay), {"delay": (delay * 1e3, "ms")}


def table_tilt(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Pitch the table with its acceleration."""
    tilt = 2e-3 * size
    return replace(setting.scenario, table_tilt=tilt), {"tilt": (tilt, "rad s^2/m")}


def sensor_gain(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a sensor read too much or too little."""
    gain = setting.scenario.sensor_gain.get(setting.channel, 0.0) + size
    faults = {**setting.scenario.sensor_gain, setting.channel: gain}
    return replace(setting.scenario, sensor_gain=faults), {"relative_change": (gain, "-")}


def sensor_delay(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a sensor read late."""
    delay = 0.02 * size
    faults = {**setting.scenario.sensor_delay_s, setting.channel: delay}
    return replace(setting.scenario, sensor_delay_s=faults), {"delay": (delay * 1e3, "ms")}


def sensor_offset(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a sensor read a constant too much."""
    offset = size * setting.channel_rms
    faults = {**setting.scenario.sensor_offset, setting.channel: offset}
    return replace(setting.scenario, sensor_offset=faults), {
        "offset": (offset / setting.channel_to_si, "channel")
    }


def table_clock_rate(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let the clock of the table channel go wrong."""
    rate = 0.02 * size
    return replace(setting.scenario, table_clock=rate), {"relative_change": (rate, "-")}


def clock_rate(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let the clock of a sensor go wrong."""
    rate = 0.02 * size
    faults = {**setting.scenario.sensor_clock, setting.channel: rate}
    return replace(setting.scenario, sensor_clock=faults), {"relative_change": (rate, "-")}


def quadratic_damping(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Damp a storey by the square of its drift's rate, in all storeys alike as much as the first mode is damped."""
    first = 2 * np.pi * setting.typical.first_hz
    share = 2 * size * float(setting.beams.ratios[0]) / first / setting.at(setting.typical.rms_rate)
    damper = share * setting.at(setting.typical.stiffness)
    return setting.with_storey_law(lambda _: laws.drag(damper, 1e-4)), {"damping": (damper, "N s^2/m^2")}


BEYOND, DAMPING_BEYOND = 0.5, 1.0
"""Logarithm of a whole frame's stiffness or mass, and of its damping, over what was believed, within which it is no effect
but what a calibration is for: frame, storeys, joints and floors together may depart by three of their prior standard
deviations each, and one of 0.35 disappeared there."""

State = Callable[[Sequence[Parameters], np.ndarray], Parameters]
"""Says of all storeys what the truth states: from the parameters of each and their stiffness [N/m], shape (storeys,)."""


def in_all_storeys(put: Put, state: State) -> Put:
    """Return what puts an effect of a storey into all storeys of a frame, a little unevenly.

    Args:
        put: Puts it into one storey. In each it is drawn alike, as if all drifted as much as the storey that drifts most.
        state: Says what is stated.
    """

    def everywhere(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
        chance, own = int(rng.integers(2**32)), setting.typical
        uneven = rng.normal(1.0, 0.03, setting.beams.storeys)
        alike = replace(
            own,
            peak_drift=np.full_like(uneven, own.peak_drift.max()),
            rms_drift=np.full_like(uneven, own.rms_drift.max()),
            rms_rate=np.full_like(uneven, own.rms_rate.max()),
        )
        even, scenario, told = replace(setting, typical=alike), setting.scenario, []
        for storey, share in enumerate(uneven, 1):
            here = replace(even, scenario=scenario, storey=storey)
            scenario, parameters = put(here, share * size, np.random.default_rng(chance))
            told.append(parameters)
        values = state(told, own.stiffness)
        lone = state(told, lone_storey_stiffness(setting.beams))
        return scenario, {name: (*value, lone[name][0]) for name, value in values.items()}

    return everywhere


def _mean(told: Sequence[Parameters], name: str) -> np.ndarray:
    return np.array([parameters[name][0] for parameters in told])


def slip_drift(told: Sequence[Parameters], stiffness: np.ndarray) -> Parameters:
    """State friction by the drift at which it would be reached elastically.

    Args:
        told: Parameters of the effect in each storey.
        stiffness: Stiffness of the storeys [N/m], shape (storeys,).
    """
    return {"slip_drift": (float(np.mean(_mean(told, "friction_force") / stiffness)) * 1e6, "um")}


def yielding(told: Sequence[Parameters], stiffness: np.ndarray) -> Parameters:
    """State what yields by its drift and its share of the stiffness.

    Args:
        told: Parameters of the effect in each storey.
        stiffness: Stiffness of the storeys [N/m], shape (storeys,).
    """
    force, own = _mean(told, "yield_force"), _mean(told, "stiffness")
    return {
        "yield_drift": (float(np.mean(force / own)) * 1e3, "mm"),
        "stiffness_share": (float(np.mean(own / stiffness)), "-"),
    }


def over_stiffness(name: str, stated: str, unit: str) -> State:
    """Return what states a parameter of the storeys over their stiffness.

    Args:
        name: Name of the parameter in a storey.
        stated: Name of what is stated.
        unit: Its unit.
    """
    return lambda told, stiffness: {stated: (float(np.mean(_mean(told, name) / stiffness)), unit)}


def loosened(told: Sequence[Parameters], stiffness: np.ndarray) -> Parameters:
    """State the mean change at the end of a run.

    Args:
        told: Parameters of the effect in each storey.
        stiffness: Stiffness of the storeys [N/m], shape (storeys,).
    """
    return {"final_relative_change": (float(np.mean(_mean(told, "final_relative_change"))), "-")}


def _beyond(size: float, least: float) -> float:
    """Return a factor that is further from one than `least` (of its logarithm), by `size` more on the same side."""
    return float(np.exp(np.copysign(least, size))) * (1 + size)


def all_stiffness_change(
    setting: Setting, size: float, rng: np.random.Generator
) -> tuple[Scenario, Parameters]:
    """Stiffen or soften columns and joints of a whole frame alike, further than a calibration is for."""
    beams, factor = setting.beams, _beyond(size, BEYOND)
    changed = setting.with_beams(bending=factor * beams.bending, joint=factor * beams.joint)
    return changed, {"relative_change": (factor - 1, "-")}


def all_damping_change(
    setting: Setting, size: float, rng: np.random.Generator
) -> tuple[Scenario, Parameters]:
    """Damp all modes more or less than any guess of it, a little unevenly."""
    factor = _beyond(size, DAMPING_BEYOND)
    each = factor * rng.normal(1.0, 0.03, len(setting.beams.ratios))
    return setting.with_beams(ratios=each * setting.beams.ratios), {"damping_factor": (factor, "-")}


def all_added_mass(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Put mass on all floors or take it away, further than a calibration is for, with the weight that it has."""
    beams, factor = setting.beams, _beyond(size, BEYOND)
    mass = (factor - 1) * (beams.floor_mass + beams.column_mass)
    axial = beams.axial + STANDARD_GRAVITY * np.cumsum(mass[::-1])[::-1]
    changed = setting.with_beams(floor_mass=beams.floor_mass + mass, axial=axial)
    return changed, {"relative_change": (factor - 1, "-")}


STATES: dict[str, State] = {
    "all_coulomb_friction": slip_drift,
    "all_hysteresis": yielding,
    "all_cubic_stiffness": over_stiffness("cubic_stiffness", "cubic_share", "1/m^2"),
    "all_loosening": loosened,
    "all_quadratic_damping": over_stiffness("damping", "quadratic_damping", "s^2/m^2"),
}
"""What says what the truth states of a law in all storeys, whatever the law in a storey is."""


CATALOGUE: dict[str, Effect] = {
    "stiffness_change": Effect("storey", stiffness_change, 0.2, -0.5),
    "joint_flexibility": Effect("frame", joint_flexibility, 1.0, -1.0),
    "base_rocking": Effect("frame", base_rocking, 0.6),
    "p_delta": Effect("frame", p_delta, 1.0),
    "added_mass": Effect("floor", added_mass, 0.6),
    "damping_change": Effect("storey", damping_change, 12.0, -0.7),
    "coulomb_friction": Effect("storey", coulomb_friction, 3.0),
    "air_drag": Effect("frame", air_drag, 12.0),
    "cubic_stiffness": Effect("storey", cubic_stiffness, 5.0, -0.25),
    "hysteresis": Effect("storey", hysteresis, 3.0),
    "loosening": Effect("storey", loosening, 0.0, -0.6),
    "bumper": Effect("storey", bumper, 6.0),
    "torsional_eccentricity": Effect("frame", torsional_eccentricity, 1.0),
    "all_coulomb_friction": Effect(
        "frame", in_all_storeys(coulomb_friction, STATES["all_coulomb_friction"]), 3.0
    ),
    "all_hysteresis": Effect("frame", in_all_storeys(hysteresis, STATES["all_hysteresis"]), 3.0),
    "all_cubic_stiffness": Effect(
        "frame", in_all_storeys(cubic_stiffness, STATES["all_cubic_stiffness"]), 5.0, -0.25
    ),
    "all_loosening": Effect("frame", in_all_storeys(loosening, STATES["all_loosening"]), 0.0, -0.6),
    "all_quadratic_damping": Effect(
        "frame", in_all_storeys(quadratic_damping, STATES["all_quadratic_damping"]), 12.0
    ),
    "table_gain": Effect("table", table_gain, 0.4, -0.4),
    "table_delay": Effect("table", table_delay, 1.0, -1.0),
    "table_tilt": Effect("table", table_tilt, 1.0, -1.0),
    "sensor_gain": Effect("channel", sensor_gain, 0.5, -0.5),
    "sensor_delay": Effect("channel", sensor_delay, 1.0, -1.0),
    "sensor_offset": Effect("channel", sensor_offset, 1.0, -1.0),
}

ASKED_FOR: dict[str, Effect] = {
    "table_clock_rate": Effect("table", table_clock_rate, 1.0, -1.0),
    "clock_rate": Effect("channel", clock_rate, 1.0, -1.0),
    "all_stiffness_change": Effect("frame", all_stiffness_change, 0.3, -0.3),
    "all_damping_change": Effect("frame", all_damping_change, 1.0, -0.4),
    "all_added_mass": Effect("frame", all_added_mass, 0.3, -0.15),
}
"""What is hidden only where it is asked for: a benchmark does not draw it."""
