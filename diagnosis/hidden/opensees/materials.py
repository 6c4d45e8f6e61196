"""Force laws of the second world, as OpenSees' uniaxial materials state them; none is the law of the diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

SLIDERS = 12
"""Points of Ramberg and Osgood's curve, between which it is straight."""

POINTS = 401
"""Points of a curve that is made of straight lines."""


@dataclass(frozen=True)
class Materials:
    """Materials that act side by side.

    Attributes:
        parts: Name of a material in OpenSees and its parameters, for each.
        mirrored: Whether they act the other way round, compression where others have tension.
        modulus: The first material's Young's modulus as a function of time [s], for one that changes.
    """

    parts: tuple[tuple[Any, ...], ...]
    mirrored: bool = False
    modulus: Callable[[float], float] | None = None


@dataclass(frozen=True)
class Slider:
    """Dry friction of a sliding bearing, which grips more firmly the slower it slides.

    Attributes:
        level: Force of fast sliding [N].
        stiffness: Of the bearing before it slides [N/m].
        breakaway: Force at which sliding begins over that of fast sliding.
        fades: Rate of sliding at which the difference has fallen to 1/e [m/s].
    """

    level: float
    stiffness: float
    breakaway: float
    fades: float


Law = Materials | Slider


def steel(yield_force: float, stiffness: float, hardening: float, roundness: float) -> Materials:
    """Return the departure of a yielding spring from an elastic one, by Menegotto and Pinto (1973).

    Args:
        yield_force: Force at which it yields [N].
        stiffness: Its elastic stiffness [N/m], which the storey itself keeps.
        hardening: Stiffness after yielding over that before.
        roundness: Parameter of the knee at first yielding; large is sharp.
    """
    return Materials(
        (("Steel02", yield_force, stiffness, hardening, roundness, 0.925, 0.15), ("Elastic", -stiffness))
    )


def ramberg_osgood(yield_force: float, stiffness: float, offset: float, power: float) -> Materials:
    """Return the same by Ramberg and Osgood (1943), with Masing's loops: sliders side by side (Iwan 1966).

    Args:
        yield_force: Force at which the plastic deformation is `offset` times the elastic one [N].
        stiffness: Its stiffness at small amplitude [N/m].
        offset: Plastic over elastic deformation at the yield force.
        power: Exponent of the plastic deformation.
    """
    forces = yield_force * np.linspace(0.4, 1.7, SLIDERS)
    at = forces / stiffness * (1 + offset * (forces / yield_force) ** (power - 1))
    # The first slides where the curve leaves its first tangent; the last tangent stays elastic.
    at[0] = forces[0] / stiffness
    slopes = np.append(stiffness, np.diff(forces) / np.diff(at))
    sliders = [
        ("ElasticPP", float(k), float(d)) for k, d in zip(slopes[:-1] - slopes[1:], at[:-1], strict=True)
    ]
    return Materials((*sliders, ("Elastic", float(slopes[-1]) - stiffness)))


def curve(force: Callable[[np.ndarray], np.ndarray], reach: float) -> Materials:
    """Return an elastic law of many straight lines.

    Args:
        force: Force [N] over deformation [m].
        reach: Largest deformation that is tabulated [m]; beyond it goes straight on.
    """
    # Finer in the middle, where a frame is most of the time.
    even = np.linspace(-1.0, 1.0, POINTS)
    at = reach * even * (0.5 + 0.5 * even**2)
    return _lines(at, np.asarray(force(at)))


def progressive_stop(gap: float, stiffness: float, reach: float) -> Materials:
    """Return a stop of rubber that stiffens as it is pressed: half, once and twice its stiffness.

    Args:
        gap: Free travel [m]; negative on the other side.
        stiffness: Middle stiffness [N/m].
        reach: Depth in which each of the first two is spent [m].
    """
    side, free = np.sign(gap), abs(gap)
    depth = np.array([-free - reach, -free, 0.0, reach, 2 * reach, 3 * reach])
    force = stiffness * reach * np.array([0.0, 0.0, 0.0, 0.5, 1.5, 3.5])
    at, against = side * (free + depth), side * force
    order = np.argsort(at)
    return _lines(at[order], against[order])


def lossy_stop(gap: float, stiffness: float, loss_s: float) -> Materials:
    """Return a stop with a dashpot beside its spring, both only while it is closed.

    Args:
        gap: Free travel [m]; negative on the other side.
        stiffness: Of the spring [N/m].
        loss_s: Damping of the dashpot over that stiffness [s].
    """
    # The material knows compression only: it closes at negative deformation.
    return Materials((("ViscoelasticGap", stiffness, loss_s * stiffness, -abs(gap)),), mirrored=gap > 0)


def tie(slack: float, stiffness: float) -> Materials:
    """Return a tie that pulls back where two floors part by more than its slack [m], with a stiffness [N/m]."""
    return _lines(np.array([-slack, 0.0, slack, 2 * slack]), stiffness * np.array([0.0, 0.0, 0.0, slack]))


def cage(play: float, stiffness: float, damping: float) -> Materials:
    """Return a box in which something rattles: stops on both sides and a little drag.

    Args:
        play: Free travel to either side [m].
        stiffness: Of the stops [N/m].
        damping: Of the drag [N s/m].
    """
    at = play * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    lines = _lines(at, stiffness * play * np.array([-1.0, 0.0, 0.0, 0.0, 1.0]))
    return Materials((*lines.parts, ("Viscous", damping, 1.0)))


def viscous(coefficient: float, power: float = 1.0) -> Materials:
    """Return a dashpot whose force is `coefficient` [N (s/m)^power] times the rate to a power."""
    return Materials((("Viscous", coefficient, power),))


def varying(modulus: Callable[[float], float]) -> Materials:
    """Return a spring whose stiffness [N/m] is a function of time [s]."""
    return Materials((("Elastic", modulus(0.0)),), modulus=modulus)


def _lines(at: np.ndarray, force: np.ndarray) -> Materials:
    return Materials((("ElasticMultiLinear", "-strain", *at.tolist(), "-stress", *force.tolist()),))


def contact(
    law: str, stiffness: float, gap: float, ratio: float, damping: float, mass: float
) -> tuple[Any, ...]:
    """Return OpenSees' own material for what two floors do to each other.

    Args:
        law: Its name in the case format.
        stiffness: [N/m], for the Hertz family [N/m^1.5].
        gap: [m].
        ratio: Damping ratio or factor of the law.
        damping: Damping of the linear viscoelastic law [N s/m].
        mass: Effective mass of the two floors [kg].
    """
    closed = -max(gap, 1e-9)
    return {
        "linear_spring": ("ElasticPPGap", stiffness, -1e12, closed, 0.0),
        "linear_viscoelastic": ("ViscoelasticGap", stiffness, damping, closed),
        "hertz": ("Hertzdamp", stiffness, 0.0, closed, 1.5),
        "nonlinear_viscoelastic": ("JankowskiImpact", stiffness, ratio, mass, closed, 1.5),
        "hertz_damp": ("Hertzdamp", stiffness, ratio, closed, 1.5),
    }[law]
