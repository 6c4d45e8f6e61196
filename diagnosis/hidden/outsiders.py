"""What no catalogue has: things that must be called unknown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.hidden import laws
from pounding.diagnosis.hidden.beams import Appendage
from pounding.diagnosis.hidden.scenario import Load, Scenario, Spring
from pounding.diagnosis.hidden.setting import Effect, Parameters, Setting


def hidden_appendage(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Hang a light mass on a spring on a floor, in tune with one of the first modes."""
    beams = setting.beams
    frequency = setting.typical.first_hz * rng.choice([1.0, 2.9]) * rng.uniform(0.9, 1.1)
    mass = 0.15 * size * setting.at(beams.floor_mass)
    appendage = Appendage(setting.floor, mass, frequency, rng.uniform(0.005, 0.03))
    return setting.with_beams(appendage=appendage), {"mass": (mass, "kg"), "frequency": (frequency, "Hz")}


def hammer_knocks(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Knock on a floor a few times in each run."""
    momentum = 0.3 * size * setting.at(setting.beams.floor_mass) * setting.at(setting.typical.rms_velocity)
    when, strength = rng.uniform(0.1, 0.8, (16, 3)), rng.uniform(-1.5, 1.5, (16, 3))
    width = rng.uniform(0.003, 0.008)

    def history(run: int, time: np.ndarray) -> np.ndarray:
        pulses = np.zeros_like(time)
        for middle, part in zip(time[-1] * when[run % 16], strength[run % 16], strict=True):
            inside = np.abs(time - middle) < width / 2
            pulses[inside] += part * np.cos(np.pi * (time[inside] - middle) / width) ** 2
        return 2 * momentum / width * pulses

    load = Load(setting.frame, setting.floor, history)
    return replace(setting.scenario, loads=(*setting.scenario.loads, load)), {"momentum": (momentum, "N s")}


def running_fan(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let an unbalanced fan run on a floor, at its own speed."""
    frequency = setting.typical.first_hz * rng.uniform(0.6, 4.0)
    force = 0.02 * size * setting.at(setting.typical.stiffness) * setting.at(setting.typical.rms_drift)
    phases = rng.uniform(0, 2 * np.pi, 16)

    def history(run: int, time: np.ndarray) -> np.ndarray:
        return np.asarray(
            force * np.minimum(time, 1.0) * np.sin(2 * np.pi * frequency * time + phases[run % 16])
        )

    load = Load(setting.frame, setting.floor, history)
    scenario = replace(setting.scenario, loads=(*setting.scenario.loads, load))
    return scenario, {"force": (force, "N"), "frequency": (frequency, "Hz")}


def wrong_frame(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Measure a frame that is not the one model: tapered, and with its mass elsewhere."""
    beams = setting.beams
    along = np.linspace(-1.0, 1.0, beams.storeys)
    taper = 0.8 * size * rng.choice([-1.0, 1.0])
    heavy = rng.permutation(np.linspace(-1, 1, beams.storeys)) * 0.4 * size
    scenario = setting.with_beams(
        bending=beams.bending * np.exp(taper * along + 0.3 * size * rng.standard_normal(beams.storeys)),
        joint=beams.joint * np.exp(taper * np.append(along[0], along)),
        floor_mass=beams.floor_mass * np.exp(heavy),
    )
    return scenario, {"taper": (taper, "-")}


def breathing_stiffness(
    setting: Setting, size: float, rng: np.random.Generator
) -> tuple[Scenario, Parameters]:
    """Let a storey's stiffness come and go with time, whatever the frame does."""
    stiffness = setting.at(setting.typical.stiffness)
    frequency, phase = rng.uniform(0.4, 2.5), rng.uniform(0, 2 * np.pi)
    depth = 0.5 * size
    make = lambda _: laws.breathing(stiffness, depth, frequency, phase)  # noqa: E731
    return setting.with_storey_law(make), {"depth": (depth, "-"), "frequency": (frequency, "Hz")}


def snapping_magnets(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Pull a storey away from its middle with magnets of short reach."""
    stiffness = 0.6 * size * setting.at(setting.typical.stiffness)
    reach = rng.uniform(0.15, 0.4) * setting.at(setting.typical.rms_drift)
    scenario = setting.with_storey_law(lambda _: laws.snapping(stiffness, reach))
    return scenario, {"stiffness": (stiffness, "N/m"), "reach": (reach * 1e3, "mm")}


def weakening_friction(
    setting: Setting, size: float, rng: np.random.Generator
) -> tuple[Scenario, Parameters]:
    """Rub a storey so that fast sliding hardly resists."""
    level = size * setting.at(setting.typical.stiffness) * setting.at(setting.typical.rms_drift)
    fades = rng.uniform(0.15, 0.4) * setting.at(setting.typical.rms_rate)
    scenario = setting.with_storey_law(lambda _: laws.weakening(level, fades))
    return scenario, {"force": (level, "N"), "rate": (fades, "m/s")}


def slack_tie(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Stop two floors that are not neighbours from parting further than a slack tie lets them."""
    upper = max(setting.floor, 2)
    stiffness = size * float(setting.typical.stiffness.mean())
    reach = rng.uniform(0.3, 0.8) * float(setting.typical.peak_drift.sum()) * 2 / setting.beams.storeys
    make = lambda _: laws.stop(reach, stiffness, 0.05 * reach, 0.0)  # noqa: E731
    spring = Spring(setting.frame, upper, upper - 2, make)
    scenario = replace(setting.scenario, springs=(*setting.scenario.springs, spring))
    return scenario, {"stiffness": (stiffness, "N/m"), "slack": (reach * 1e3, "mm")}


OUTSIDE: dict[str, Effect] = {
    "hidden_appendage": Effect("floor", hidden_appendage, 3.0),
    "hammer_knocks": Effect("floor", hammer_knocks, 5.0),
    "running_fan": Effect("floor", running_fan, 10.0),
    "wrong_frame": Effect("frame", wrong_frame, 0.8),
    "breathing_stiffness": Effect("storey", breathing_stiffness, 1.2),
    "snapping_magnets": Effect("storey", snapping_magnets, 1.0),
    "weakening_friction": Effect("storey", weakening_friction, 2.0),
    "slack_tie": Effect("floor", slack_tie, 3.0),
}
