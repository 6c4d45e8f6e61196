"""What can be hidden, each with a physical realisation of its own; sizes are relative, 1 is plain.

The names are those of the case format, so that a truth can be compared with a verdict; nothing else is
shared.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from pounding.constants import STANDARD_GRAVITY
from pounding.diagnosis.hidden import laws
from pounding.diagnosis.hidden.modes import lone_storey_stiffness, storey_stiffness
from pounding.diagnosis.hidden.scenario import Scenario, Spring
from pounding.diagnosis.hidden.setting import Effect, Parameters, Setting
from pounding.diagnosis.hidden.whole_frame import (
    STATES,
    all_added_mass,
    all_damping_change,
    all_stiffness_change,
    in_all_storeys,
)


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
    """Change all joints by the same factor; a little unevenly, and the less so the smaller the change is."""
    factors = np.exp(size * rng.normal(1.0, 0.03, len(setting.beams.joint)))
    value = setting.beams.joint_stated * float(np.mean(factors))
    return setting.with_beams(joint=setting.beams.joint * factors), {"joint_stiffness": (value, "N m/rad")}


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
