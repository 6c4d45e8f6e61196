"""What may be hidden: each function puts an effect of a size into a structure and says what the truth is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from tests.planar_world import laws
from tests.planar_world.baseline import Real, baseline_of, modes
from tests.planar_world.frame import Frame
from tests.planar_world.structure import Structure, drift, hung

FLOOR_KG = 6.48
"""Mass of a floor, of which added masses are shares [kg]."""
STOREY_STIFFNESS = 2.3e5
"""Of which yielding parts are shares [N/m]."""
STOP_MASS_KG, STOP_LOSS = 6.5, 0.25
"""The dashpot of a stop is so many square roots of its stiffness times a mass."""
RATTLE_STIFFNESS, RATTLE_SLIDING = 1e4, 3.0
"""Of the stops of a loose mass [N/m], and the dashpot of its sliding [N s/m]."""


@dataclass(frozen=True)
class Where:
    """Where an effect is, and what of it is no size; only what the effect needs is drawn.

    Attributes:
        storey, floor: Counted from 1.
        channel: Name of a channel.
        share: Of a storey's stiffness, for a part that yields [-].
        peak: Largest drift of the storey without the effect [m].
        gap: Clearance of a stop [m].
        mode, tune, ratio: Of an appendage: the mode near which it is, counted from 1, its frequency over the mode's
            [-], and its damping ratio [-].
    """

    storey: int
    floor: int
    channel: str = ""
    share: float = 0.0
    peak: float = 0.0
    gap: float = 0.0
    mode: int = 0
    tune: float = 0.0
    ratio: float = 0.0


@dataclass(frozen=True)
class Told:
    """The truth of an effect, as it is written.

    Attributes:
        effect: Its name in the diagnosis' catalogue, or words that begin with `outside`.
        parameters: In the units that their names end with.
        storey, floor: Where it is, counted from 1; None where it is in no single one.
        channel: Of a sensor's fault.
        more: What is no parameter of the catalogue.
    """

    effect: str
    parameters: dict[str, float]
    storey: int | None = None
    floor: int | None = None
    channel: str | None = None
    more: dict[str, float | str] = field(default_factory=dict)

    def entry(self) -> dict[str, object]:
        """Return the truth as an object of JSON."""
        places = {name: getattr(self, name) for name in ("storey", "floor", "channel")}
        said = {name: place for name, place in places.items() if place is not None}
        return {"effect": self.effect, **said, "parameters": asdict(self)["parameters"], **self.more}


Hidden = tuple[Structure, Told]
Hide = Callable[[Frame, Structure, float, Where], Hidden]
"""Takes the frame, the structure so far, the size, and where; returns the structure with the effect, and the truth."""


def coulomb_friction(frame: Frame, structure: Structure, force: float, where: Where) -> Hidden:
    """Hide Coulomb friction of a force [N] in a storey."""
    law = laws.friction(drift(frame.storeys, where.storey), force)
    return structure.with_law(law), Told("coulomb_friction", {"friction_force_N": force}, where.storey)


def drift_friction(frame: Frame, structure: Structure, slope: float, where: Where) -> Hidden:
    """Hide friction that grows with the drift of a storey [N/m]."""
    law = laws.drift_friction(drift(frame.storeys, where.storey), slope)
    name = "outside: friction proportional to |drift|"
    return structure.with_law(law), Told(name, {"N_per_m": slope}, where.storey)


def cubic_stiffness(frame: Frame, structure: Structure, stiffness: float, where: Where) -> Hidden:
    """Hide a cubic spring [N/m^3] in a storey."""
    law = laws.cubic(drift(frame.storeys, where.storey), stiffness)
    return structure.with_law(law), Told(
        "cubic_stiffness", {"cubic_stiffness_N_per_m3": stiffness}, where.storey
    )


def stiffness_change(frame: Frame, structure: Structure, change: float, where: Where) -> Hidden:
    """Hide a relative change [-] of a storey's stiffness, made by its columns."""
    factor = frame.columns_factor(where.storey, change)
    told = Told(
        "stiffness_change", {"relative_change": change}, where.storey, more={"columns_factor": factor}
    )
    return replace(structure, stiffness=_with_columns(frame, where.storey, factor)), told


def hysteresis(frame: Frame, structure: Structure, ductility: float, where: Where) -> Hidden:
    """Hide that a share of a storey yields, at its largest drift without it over a ductility [-]."""
    stiffness = where.share * STOREY_STIFFNESS
    force = stiffness * where.peak / ductility
    law = laws.yielding(drift(frame.storeys, where.storey), force, stiffness)
    told = Told(
        "hysteresis",
        {"yield_force_N": force, "stiffness_N_per_m": stiffness},
        where.storey,
        more={"law": "Menegotto-Pinto b=0.02 R0=6 a1=4 a2=0.3"},
    )
    return structure.with_law(law), told


def air_drag(frame: Frame, structure: Structure, coefficient: float, where: Where) -> Hidden:
    """Hide drag [N s^2/m^2] on all floors."""
    told = Told(
        "air_drag",
        {"coefficient_N_s2_per_m2": coefficient},
        more={"law": "velocity relative to the table"},
    )
    return structure.with_law(laws.drag(np.ones(frame.storeys), coefficient)), told


def bumper(frame: Frame, structure: Structure, stiffness: float, where: Where) -> Hidden:
    """Hide a stop of a stiffness [N/m] on one side of a storey."""
    dashpot = float(STOP_LOSS * np.sqrt(stiffness * STOP_MASS_KG))
    law = laws.stop(drift(frame.storeys, where.storey), where.gap, stiffness, dashpot)
    told = Told(
        "bumper",
        {"gap_mm": where.gap * 1e3, "stiffness_N_per_m": stiffness},
        where.storey,
        more={"law": f"with loss, dashpot {dashpot:.1f} N s/m while in contact, no pull"},
    )
    return structure.with_law(law), told


def added_mass(frame: Frame, structure: Structure, share: float, where: Where) -> Hidden:
    """Hide a mass on a floor, as a share of a floor's [-]."""
    kilograms, mass = share * FLOOR_KG, structure.mass.copy()
    mass[where.floor - 1, where.floor - 1] += kilograms
    return replace(structure, mass=mass), Told("added_mass", {"mass_kg": kilograms}, floor=where.floor)


def damping_change(frame: Frame, structure: Structure, dashpot: float, where: Where) -> Hidden:
    """Hide a dashpot [N s/m] in a storey."""
    direction = drift(frame.storeys, where.storey)
    damped = structure.damping + dashpot * np.outer(direction, direction)
    told = Told("damping_change", {"damping_N_s_per_m": dashpot}, where.storey)
    return replace(structure, damping=damped), told


def joint_flexibility(frame: Frame, structure: Structure, factor: float, where: Where) -> Hidden:
    """Hide that all joints are softer by a factor [-]."""
    told = Told(
        "joint_flexibility",
        {"joint_stiffness_Nm_per_rad": baseline_of(frame.name).joint * factor},
        more={"own_joint_per_column": frame.build.joint / 4 * factor, "factor": factor},
    )
    return replace(structure, stiffness=frame.matrices(joint=factor)[1]), told


def base_rocking(frame: Frame, structure: Structure, stiffness: float, where: Where) -> Hidden:
    """Hide that the foot rocks on a spring [N m/rad]."""
    told = Told("base_rocking", {"rotational_stiffness_Nm_per_rad": stiffness})
    return replace(structure, stiffness=frame.matrices(rocking=stiffness)[1]), told


def loosening(frame: Frame, structure: Structure, change: float, where: Where) -> Hidden:
    """Hide that a storey changes by a share [-] in the course of every run.

    The stiffness is not linear in the columns' share that is lost, because their end fittings go with them and the joints
    do not: it is a polynomial of second degree through the frame before, half-way and after.
    """
    lost = frame.columns_factor(where.storey, change) - 1
    after, half_way = (
        _with_columns(frame, where.storey, 1 + part) - structure.stiffness for part in (lost, lost / 2)
    )
    second = (after - 2 * half_way) * 2 / lost**2
    first = (after - lost * lost * second) / lost
    told = Told(
        "loosening",
        {"final_relative_change": change},
        where.storey,
        more={"columns_factor_at_end": 1 + lost},
    )
    loosened = replace(structure, loosening=(np.ascontiguousarray(first), np.ascontiguousarray(second)))
    return loosened.with_law(laws.loosening(frame.storeys, lost)), told


def sensor_gain(frame: Frame, structure: Structure, change: float, where: Where) -> Hidden:
    """Hide that a channel reads too much, by a share [-]."""
    told = Told("sensor_gain", {"relative_change": change}, channel=where.channel)
    return replace(structure, gain=(where.channel, 1 + change)), told


def sensor_delay(frame: Frame, structure: Structure, late_ms: float, where: Where) -> Hidden:
    """Hide that a channel is late [ms]."""
    told = Told("sensor_delay", {"delay_ms": late_ms}, channel=where.channel)
    return replace(structure, delay=(where.channel, late_ms * 1e-3)), told


def appendage(frame: Frame, structure: Structure, share: float, where: Where) -> Hidden:
    """Hide an oscillator on a floor, near a mode, of a mass that is a share of a floor's [-]."""
    mass = share * FLOOR_KG
    frequency = float(modes(structure.mass, structure.stiffness)[0][where.mode - 1] * where.tune)
    stiffness = mass * (2 * np.pi * frequency) ** 2
    dashpot = 2 * where.ratio * mass * 2 * np.pi * frequency
    larger = structure.with_hung(mass)
    direction = hung(larger.freedoms, where.floor)
    held = replace(
        larger,
        stiffness=larger.stiffness + stiffness * np.outer(direction, direction),
        damping=larger.damping + dashpot * np.outer(direction, direction),
    )
    numbers = {
        "mass_kg": mass,
        "frequency_hz": frequency,
        "damping_ratio": where.ratio,
        "near_mode": where.mode,
    }
    return held, Told("outside: tuned appendage", numbers, floor=where.floor)


def rattle(frame: Frame, structure: Structure, mass: float, where: Where) -> Hidden:
    """Hide a loose mass [kg] between two stops on a floor."""
    stops = float(2.0 * np.sqrt(RATTLE_STIFFNESS * mass))
    larger = structure.with_hung(mass)
    direction = hung(larger.freedoms, where.floor)
    law = laws.rattle(direction, where.gap, RATTLE_STIFFNESS, stops, RATTLE_SLIDING)
    numbers = {
        "mass_kg": mass,
        "half_gap_mm": where.gap * 1e3,
        "stop_stiffness": RATTLE_STIFFNESS,
        "stop_dashpot": stops,
        "sliding_dashpot": RATTLE_SLIDING,
    }
    return larger.with_law(law), Told("outside: rattling mass", numbers, floor=where.floor)


def _with_columns(frame: Frame, storey: int, factor: float) -> Real:
    """Return the stiffness (floors, floors) [N/m] with a factor on a storey's columns [-]."""
    factors = np.ones(frame.storeys)
    factors[storey - 1] = factor
    return frame.matrices(storeys=factors)[1]


EFFECTS: dict[str, Hide] = {
    "coulomb_friction": coulomb_friction,
    "cubic_stiffness": cubic_stiffness,
    "loss30": stiffness_change,
    "loss12": stiffness_change,
    "hysteresis": hysteresis,
    "air_drag": air_drag,
    "bumper": bumper,
    "added_mass": added_mass,
    "damping_change": damping_change,
    "joint_flexibility": joint_flexibility,
    "base_rocking": base_rocking,
    "loosening": loosening,
    "sensor_gain": sensor_gain,
    "sensor_delay": sensor_delay,
    "appendage": appendage,
    "rattle": rattle,
    "dfriction": drift_friction,
}
