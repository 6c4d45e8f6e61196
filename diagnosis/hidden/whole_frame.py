"""What is hidden in all storeys of a frame at once, or in a frame as a whole."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pounding.constants import STANDARD_GRAVITY
from pounding.diagnosis.hidden.modes import lone_storey_stiffness
from pounding.diagnosis.hidden.scenario import Scenario
from pounding.diagnosis.hidden.setting import Parameters, Put, Setting

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
        stated, lone = state(told, own.stiffness), lone_storey_stiffness(setting.beams)
        # A force is one over the stiffness of a storey alone, too, whatever else the storeys state of it.
        beside = [state(each, lone) for each in ([_of_lone_storey(one) for one in told], told)]
        others = {name: dict.fromkeys(one[name][0] for one in beside) for name in stated}
        return scenario, {
            name: (*value, *(other for other in others[name] if other != value[0]))
            for name, value in stated.items()
        }

    return everywhere


def _of_lone_storey(told: Parameters) -> Parameters:
    """Return the parameters of a storey with its shares over the stiffness of a storey alone, where they state these."""
    return {name: (one[2], one[1]) if len(one) > 2 else one for name, one in told.items()}


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
