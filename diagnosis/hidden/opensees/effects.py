"""What can be hidden in the second world: laws of OpenSees' materials, and what needs no law as in the own world."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import gamma

import numpy as np

from pounding.diagnosis.hidden import effects, outsiders
from pounding.diagnosis.hidden.contact_effects import CONTACT as OWN_CONTACT
from pounding.diagnosis.hidden.modes import lone_storey_stiffness, storey_stiffness
from pounding.diagnosis.hidden.opensees import materials
from pounding.diagnosis.hidden.opensees.shaking import Link, PlaneScenario, Rider
from pounding.diagnosis.hidden.scenario import Scenario
from pounding.diagnosis.hidden.setting import Effect, Parameters, Put, Setting
from pounding.diagnosis.hidden.whole_frame import STATES, in_all_storeys


def _with_links(setting: Setting, *makes: Callable[[float], Link]) -> Scenario:
    scenario = _plane(setting)
    return replace(scenario, links=(*scenario.links, *makes))


def _plane(setting: Setting) -> PlaneScenario:
    if not isinstance(setting.scenario, PlaneScenario):
        raise TypeError("an effect of the second world was put into another")
    return setting.scenario


def _with_storey_law(setting: Setting, law: materials.Law) -> Scenario:
    link = Link(setting.frame, setting.storey, setting.storey - 1, law)
    return _with_links(setting, lambda _: link)


def coulomb_friction(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Rub two parts of a storey on a sliding bearing with breakaway."""
    stiffness = setting.at(setting.typical.stiffness)
    level = 0.5 * size * stiffness * setting.at(setting.typical.rms_drift)
    bearing, breakaway = stiffness * rng.uniform(15, 40), rng.uniform(1.05, 1.3)
    fades = rng.uniform(0.05, 0.2) * setting.at(setting.typical.rms_rate)
    law = materials.Slider(level, bearing, breakaway, fades)
    return _with_storey_law(setting, law), {"friction_force": (level, "N", breakaway * level)}


def air_drag(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Drag all floors through the room's air, by a power of the velocity that is not quite two.

    The coefficient that is stated is that of the quadratic drag which takes the same power from a floor that
    moves at random with its typical velocity, and also that which is as large as it at `STATED_AT`, where the catalogue
    states drag of another power; the other parameter is that of the law itself.
    """
    beams = setting.beams
    speed = float(setting.typical.rms_velocity.mean())
    mass = float(beams.floor_mass.mean())
    coefficient = size * 2 * float(beams.ratios[0]) * 2 * np.pi * setting.typical.first_hz * mass / speed
    power = float(rng.choice([rng.uniform(1.6, 1.9), rng.uniform(2.1, 2.4)]))
    own = coefficient * speed ** (2 - power) * _moment(3.0) / _moment(power + 1)
    each = own * rng.normal(1.0, 0.03, beams.storeys)
    links = [
        Link(setting.frame, floor, 0, materials.viscous(float(c), power), absolute=True)
        for floor, c in enumerate(each, 1)
    ]
    scenario = _with_links(setting, *[lambda _, link=link: link for link in links])
    drawn = float(each.mean())
    return scenario, {
        "coefficient": (coefficient * drawn / own, "N s^2/m^2", drawn * STATED_AT ** (power - 2)),
        "power": (power, "-"),
    }


STATED_AT = 0.3
"""Velocity [m/s] at which the documented catalogue states a drag of another power than the second."""


def _moment(power: float) -> float:
    """Return the mean of the absolute value of a standard normal number to a power."""
    return float(2 ** (power / 2) * gamma((power + 1) / 2) / np.sqrt(np.pi))


def cubic_stiffness(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Harden or soften a storey with its drift, along many straight lines."""
    peak = setting.at(setting.typical.peak_drift)
    coefficient = size * setting.at(setting.typical.stiffness) / peak**2
    law = materials.curve(lambda d: coefficient * d**3, 5 * peak)
    return _with_storey_law(setting, law), {"cubic_stiffness": (coefficient, "N/m^3")}


def hysteresis(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a part of a storey yield by Menegotto and Pinto's law or by Ramberg and Osgood's."""
    stiffness = rng.uniform(0.15, 0.6) * setting.at(setting.typical.stiffness)
    force = stiffness * setting.at(setting.typical.peak_drift) / (1 + 4 * size)
    menegotto, hardening = rng.random() < 0.5, rng.uniform(0.005, 0.03)
    roundness, offset, power = rng.uniform(10.0, 20.0), rng.uniform(0.1, 0.3), rng.uniform(6.0, 12.0)
    law = (
        materials.steel(force, stiffness, hardening, roundness)
        if menegotto
        else materials.ramberg_osgood(force, stiffness, offset, power)
    )
    return _with_storey_law(setting, law), {"yield_force": (force, "N"), "stiffness": (stiffness, "N/m")}


def quadratic_damping(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Damp a storey by the square of its drift's rate."""
    _, stated = effects.quadratic_damping(setting, size, rng)
    return _with_storey_law(setting, materials.viscous(stated["damping"][0], 2.0)), stated


def loosening(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a storey lose stiffness over each run."""
    stiffness = setting.at(storey_stiffness(setting.beams))

    def make(duration: float) -> Link:
        law = materials.varying(lambda time: size * stiffness * min(time / duration, 1.0))
        return Link(setting.frame, setting.storey, setting.storey - 1, law)

    lone = size * stiffness / setting.at(lone_storey_stiffness(setting.beams))
    return _with_links(setting, make), {"final_relative_change": (size, "-", lone)}


def bumper(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Stop a storey's drift on one side, by a stop with loss or one that stiffens as it is pressed."""
    side = rng.choice([-1.0, 1.0])
    peak = setting.at(setting.typical.peak_drift)
    gap = float(side * rng.uniform(0.25, 0.7) * peak)
    stiffness = 4 * size * setting.at(setting.typical.stiffness)
    lossy, loss, reach = rng.random() < 0.5, rng.uniform(2e-4, 1e-3), rng.uniform(0.1, 0.2) * peak
    others: tuple[float, ...] = ()
    if lossy:
        law = materials.lossy_stop(gap, stiffness, loss)
    else:
        law, others = materials.progressive_stop(gap, stiffness, reach), (0.5 * stiffness, 2 * stiffness)
    return _with_storey_law(setting, law), {
        "gap": (gap * 1e3, "mm"),
        "stiffness": (stiffness, "N/m", *others),
    }


def breathing_stiffness(
    setting: Setting, size: float, rng: np.random.Generator
) -> tuple[Scenario, Parameters]:
    """Let a storey's stiffness come and go with time, whatever the frame does."""
    stiffness, depth = setting.at(setting.typical.stiffness), 0.5 * size
    frequency, phase = rng.uniform(0.4, 2.5), rng.uniform(0, 2 * np.pi)
    law = materials.varying(
        lambda time: depth * stiffness * float(np.sin(2 * np.pi * frequency * time + phase))
    )
    return _with_storey_law(setting, law), {"depth": (depth, "-"), "frequency": (frequency, "Hz")}


def snapping_magnets(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Pull a storey away from its middle with magnets of short reach."""
    stiffness = 0.6 * size * setting.at(setting.typical.stiffness)
    reach = rng.uniform(0.15, 0.4) * setting.at(setting.typical.rms_drift)
    law = materials.curve(lambda d: -stiffness * d / (1 + (d / reach) ** 2) ** 2, 30 * reach)
    return _with_storey_law(setting, law), {"stiffness": (stiffness, "N/m"), "reach": (reach * 1e3, "mm")}


def weakening_friction(
    setting: Setting, size: float, rng: np.random.Generator
) -> tuple[Scenario, Parameters]:
    """Rub a storey so that fast sliding hardly resists."""
    level = size * setting.at(setting.typical.stiffness) * setting.at(setting.typical.rms_drift)
    fades = rng.uniform(0.15, 0.4) * setting.at(setting.typical.rms_rate)
    bearing, left = setting.at(setting.typical.stiffness) * rng.uniform(15, 40), rng.uniform(0.02, 0.1)
    law = materials.Slider(left * level, bearing, 1 / left, fades)
    return _with_storey_law(setting, law), {"force": (level, "N"), "rate": (fades, "m/s")}


def slack_tie(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Stop two floors that are not neighbours from parting further than a slack tie lets them."""
    upper = max(setting.floor, 2)
    stiffness = size * float(setting.typical.stiffness.mean())
    slack = rng.uniform(0.3, 0.8) * float(setting.typical.peak_drift.sum()) * 2 / setting.beams.storeys
    link = Link(setting.frame, upper, upper - 2, materials.tie(slack, stiffness))
    scenario = _with_links(setting, lambda _: link)
    return scenario, {"stiffness": (stiffness, "N/m"), "slack": (slack * 1e3, "mm")}


def rattling_mass(setting: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
    """Let a loose mass rattle between two stops on a floor."""
    scenario = _plane(setting)
    mass = 0.1 * size * setting.at(setting.beams.floor_mass)
    play = rng.uniform(0.3, 1.0) * float(setting.typical.rms_drift.sum())
    circular = 2 * np.pi * setting.typical.first_hz
    stiffness, damping = (
        mass * (rng.uniform(15, 30) * circular) ** 2,
        mass * circular * rng.uniform(0.02, 0.1),
    )
    rider = Rider(setting.frame, setting.floor, mass, materials.cage(play, stiffness, damping))
    whole = replace(scenario, riders=(*scenario.riders, rider))
    return whole, {"mass": (mass, "kg"), "play": (play * 1e3, "mm")}


_LAWS: dict[str, Put] = {
    "coulomb_friction": coulomb_friction,
    "air_drag": air_drag,
    "cubic_stiffness": cubic_stiffness,
    "hysteresis": hysteresis,
    "loosening": loosening,
    "bumper": bumper,
    "breathing_stiffness": breathing_stiffness,
    "snapping_magnets": snapping_magnets,
    "weakening_friction": weakening_friction,
    "slack_tie": slack_tie,
}
_IN_ONE: dict[str, Put] = {
    "all_coulomb_friction": coulomb_friction,
    "all_hysteresis": hysteresis,
    "all_cubic_stiffness": cubic_stiffness,
    "all_loosening": loosening,
    "all_quadratic_damping": quadratic_damping,
}
"""What is put into each storey for an effect of all of them."""
_LAWS |= {name: in_all_storeys(put, STATES[name]) for name, put in _IN_ONE.items()}

_PLANE_CANNOT = ("torsional_eccentricity",)


def _here(known: dict[str, Effect]) -> dict[str, Effect]:
    """Return effects of the own world with the laws of this one, without those that a plane frame cannot have."""
    return {
        name: replace(effect, put=_LAWS.get(name, effect.put))
        for name, effect in known.items()
        if name not in _PLANE_CANNOT
    }


CATALOGUE = _here(effects.CATALOGUE)
ASKED_FOR = _here(effects.ASKED_FOR)
CONTACT = _here(OWN_CONTACT)
OUTSIDE = {**_here(outsiders.OUTSIDE), "rattling_mass": Effect("floor", rattling_mass, 3.0)}
