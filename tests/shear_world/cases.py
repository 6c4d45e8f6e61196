"""The cases by name: the frame that is stated, what is hidden in the true one, and which floors are measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from tests.shear_world.building import Building, stated
from tests.shear_world.laws import CreepingFriction, Cubic, Damper, Elastoplastic, Law, ProgressiveStop

THREE = stated([6.0, 6.0, 5.0], [16e3, 15e3, 14e3])
FIVE = stated([6.0, 6.0, 6.0, 6.0, 5.0], [26e3, 25e3, 24e3, 22e3, 20e3])
SIX = stated([6.0] * 5 + [5.0], [32e3, 31e3, 30e3, 28e3, 26e3, 24e3])
EIGHT = stated([6.0] * 7 + [5.0], [45e3, 44e3, 42e3, 40e3, 38e3, 36e3, 33e3, 30e3])
"""Floors of 5 and 6 kg in storeys of 0.3 m; the first frequencies are 3.6, 3.0, 2.8 and 2.5 Hz."""

USUAL_DRIFT = 0.005
"""Drift over a storey's height at which the size of a damper is stated, at the frame's first frequency [-]."""
YIELDING_SHARE = 0.3
"""Share of a storey's stiffness that yields."""
STICKING = 20.0
"""Stiffness of a friction joint that sticks, over the storey's."""


@dataclass(frozen=True)
class Hidden:
    """What is hidden in a frame.

    Attributes:
        effect: Its name in the diagnosis' catalogue; empty for nothing.
        place: Storey or floor, counted from 1; None where it is in the whole frame.
        frame: The building with it, as far as that is linear.
        laws: Forces in storeys beside it.
        truth: By the names of the diagnosis' parameters, in their units; least and largest where it is not the same in
            all storeys or at all depths.
        words: What the truth leaves out.
    """

    effect: str
    place: int | None
    frame: Building
    laws: tuple[tuple[int, Law], ...] = ()
    truth: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    words: str = ""


@dataclass(frozen=True)
class Case:
    """A case: the stated frame, what is hidden in one of its kind, and the floors that are measured.

    Attributes:
        believed: The frame as stated.
        hide: Puts the effect into the true frame.
        accelerometers: Floors with one; all where empty.
    """

    believed: Building
    hide: Callable[[Building], Hidden]
    accelerometers: tuple[int, ...] = ()

    @property
    def floors(self) -> tuple[int, ...]:
        """Floors with an accelerometer."""
        return self.accelerometers or tuple(range(1, self.believed.storeys + 1))


def nothing(frame: Building) -> Hidden:
    """Hide nothing."""
    return Hidden("", None, frame)


def loss(storey: int, share: float) -> Callable[[Building], Hidden]:
    """Hide the loss of a share [-] of a storey's stiffness."""

    def hide(frame: Building) -> Hidden:
        left = frame.stiffnesses.copy()
        left[storey - 1] *= 1 - share
        truth = {"relative_change": (-share,)}
        return Hidden("stiffness_change", storey, replace(frame, stiffnesses=left), truth=truth)

    return hide


def mass(floor: int, kilograms: float) -> Callable[[Building], Hidden]:
    """Hide a mass [kg] on a floor."""

    def hide(frame: Building) -> Hidden:
        heavier = frame.masses.copy()
        heavier[floor - 1] += kilograms
        return Hidden("added_mass", floor, replace(frame, masses=heavier), truth={"mass": (kilograms,)})

    return hide


def friction(storey: int, newtons: float) -> Callable[[Building], Hidden]:
    """Hide elastoplastic friction [N] in a storey."""

    def hide(frame: Building) -> Hidden:
        law = Elastoplastic(newtons, STICKING * float(frame.stiffnesses[storey - 1]))
        return Hidden("coulomb_friction", storey, frame, ((storey, law),), {"friction_force": (newtons,)})

    return hide


def creeping(storey: int, newtons: float, rate: float) -> Callable[[Building], Hidden]:
    """Hide friction [N] in a storey that creeps below a rate [m/s]."""

    def hide(frame: Building) -> Hidden:
        law = CreepingFriction(newtons, rate)
        words = f"{newtons:g} tanh(v / {1e3 * rate:g} mm/s)"
        return Hidden(
            "coulomb_friction", storey, frame, ((storey, law),), {"friction_force": (newtons,)}, words
        )

    return hide


def damper(storey: int, usual: float, power: float = 1.0) -> Callable[[Building], Hidden]:
    """Hide a damper of a power in a storey, of a size [N s/m] at the usual rate."""

    def hide(frame: Building) -> Hidden:
        rate = USUAL_DRIFT * frame.storey_height * float(frame.modes()[0][0])
        law = Damper(usual / rate ** (power - 1), power)
        words = "" if power == 1.0 else f"{law.coefficient:.3g} |v|^{power:g} sgn v"
        return Hidden("damping_change", storey, frame, ((storey, law),), {"damping": (usual,)}, words)

    return hide


def yielding(forces: dict[int, float], effect: str) -> Callable[[Building], Hidden]:
    """Hide that a share of the stiffness of some storeys yields at forces [N] of their own."""

    def hide(frame: Building) -> Hidden:
        elastic, laws = frame.stiffnesses.copy(), []
        for storey, force in forces.items():
            part = YIELDING_SHARE * float(frame.stiffnesses[storey - 1])
            elastic[storey - 1] -= part
            laws.append((storey, Elastoplastic(force, part)))
        softer = replace(frame, stiffnesses=elastic)
        truth: dict[str, tuple[float, ...]]
        if effect == "hysteresis":
            (storey, law), *_ = laws
            truth = {"yield_force": (law.limit,), "stiffness": (law.stiffness,)}
            return Hidden(effect, storey, softer, tuple(laws), truth)
        drifts = [1e3 * law.limit / law.stiffness for _, law in laws]
        truth = {"yield_drift": (min(drifts), max(drifts)), "stiffness_share": (YIELDING_SHARE,)}
        words = f"{', '.join(f'{force:g}' for force in forces.values())} N"
        return Hidden(effect, None, softer, tuple(laws), truth, words)

    return hide


def cubic(coefficient: float) -> Callable[[Building], Hidden]:
    """Hide the same cubic spring [N/m^3] in all storeys."""

    def hide(frame: Building) -> Hidden:
        laws = tuple((storey, Cubic(coefficient)) for storey in range(1, frame.storeys + 1))
        shares = coefficient / frame.stiffnesses
        truth = {"cubic_share": (float(shares.min()), float(shares.max()))}
        return Hidden("all_cubic_stiffness", None, frame, laws, truth, f"{coefficient:g} N/m^3 in each")

    return hide


def stop(storey: int, law: ProgressiveStop, deepest: float) -> Callable[[Building], Hidden]:
    """Hide a progressive stop in a storey; its stiffness is stated as force over depth, up to a depth [m]."""

    def hide(frame: Building) -> Hidden:
        truth = {"gap": (1e3 * law.gap,), "stiffness": (law.first, law.first + law.second * deepest)}
        words = f"{law.first:g} x + {law.second:g} x^2"
        return Hidden("bumper", storey, frame, ((storey, law),), truth, words)

    return hide


CASES: dict[str, Case] = {
    "null-3": Case(THREE, nothing),
    "null-6": Case(SIX, nothing),
    "null-8": Case(EIGHT, nothing, (2, 5, 8)),
    "loss-3": Case(THREE, loss(2, 0.30)),
    "loss-6": Case(SIX, loss(4, 0.25)),
    "mass": Case(FIVE, mass(4, 1.5)),
    "friction": Case(FIVE, friction(3, 2.0)),
    "creeping-friction": Case(FIVE, creeping(3, 2.0, 1e-3)),
    "damper": Case(FIVE, damper(2, 30.0)),
    "power-damper": Case(FIVE, damper(2, 30.0, 1.5)),
    "hysteresis": Case(THREE, yielding({1: 6.0}, "hysteresis")),
    "all-yielding": Case(FIVE, yielding({1: 9.0, 2: 9.5, 3: 6.0, 4: 6.5, 5: 3.0}, "all_hysteresis")),
    "all-cubic": Case(FIVE, cubic(1.5e7)),
    "stop": Case(FIVE, stop(3, ProgressiveStop(2e-3, 8e3, 4e6), 2e-3)),
}
