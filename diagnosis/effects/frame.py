"""Effects of a whole frame or of a floor: changed matrices, drag, and what the floors' displacements do not show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.effects.bases import FrameEffect, LawEffect
from pounding.diagnosis.effects.catalogue import CATALOGUE, Quantity, Scales
from pounding.diagnosis.effects.describing import Description, history, nothing, relation, same, sine
from pounding.diagnosis.effects.tuned import bandwidths, oscillator
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly, floor_mass
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, force_term, matrix_terms
from pounding.experiments.rig.storey_forces import DRAG_RATE, drag


@CATALOGUE.add
@dataclass(frozen=True)
class JointFlexibility(FrameEffect):
    """The rotational stiffness of each floor-column joint differs: the joints' part of the flexibility is rescaled."""

    name = "joint_flexibility"
    absorbing = True
    common_beside = True
    quantities = (Quantity("joint_stiffness", "N m/rad", logarithmic=True, symbol="k_j"),)
    typical = 0.5
    """Of the logarithm of the stiffness."""
    described = Description(
        "rotational stiffness $k_j$ of each joint between column and floor differs from the baseline model's: $K(k_j)$ by "
        "the frame's own model",
        "`stiffness_change` of all storeys, `p_delta`, `base_rocking`",
        relation("joints", "joint's turn", "moment", same, lambda x: 0.6 * x),
        told_by="A hammer test of the upper modes: soft joints lower the first mode more than the upper ones.",
        plain=("the joints of {where} have a stiffness of {size}, which is not the model's",),
    )

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the force of the stiffness' derivative with respect to the logarithm of the joints' stiffness."""
        derivative = self.storeys(model).joint_derivative
        assert derivative is not None
        return matrix_terms(motion, derivative, modes.floors, self.span(model))

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the joints' stiffness as a factor on that of the baseline model, shape (1,)."""
        return np.array([np.exp(np.clip(amplitude, -3.0, 3.0))])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Rescale the joints' part of the flexibility."""
        frame, span = self.storeys(model), self.span(model)
        assert frame.joint_derivative is not None
        flexibility = np.linalg.inv(frame.stiffness)
        joints = flexibility @ frame.joint_derivative @ flexibility
        changed = np.linalg.inv(flexibility + (1 / float(values[0]) - 1) * joints)
        assembly.stiffness[span, span] += changed - frame.stiffness


@CATALOGUE.add
@dataclass(frozen=True)
class BaseRocking(FrameEffect):
    """The base turns on a spring instead of being fixed: the flexibility grows by h h' / k."""

    name = "base_rocking"
    absorbing = True
    common_beside = True
    quantities = (Quantity("rotational_stiffness", "N m/rad", logarithmic=True, symbol="k_r"),)
    sign = 1
    described = Description(
        "the base turns on a spring $k_r$: "
        r"$K^{-1} \to K^{-1} + h h^\mathsf{T}/k_r$ with the floors' heights $h$",
        "`joint_flexibility`, `stiffness_change` of the lowest storey, `table_tilt`",
        relation("rock", "base moment", "base's turn", nothing, lambda x: 0.7 * x),
        told_by="Two vertical accelerometers at the ends of the base plate: only a rocking base moves them.",
        plain=("the base of {where} rocks on a spring of {size}",),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the compliance [rad/(N m)] that makes the roof a quarter more flexible."""
        frame = self.storeys(model)
        return 0.25 * float(np.linalg.inv(frame.stiffness)[-1, -1]) / float(frame.height_m[-1]) ** 2

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the force of a unit compliance of the base."""
        moment = self.storeys(model).stiffness @ self.storeys(model).height_m
        span = self.span(model)
        return [force_term(motion, lambda m: m.floor[:, span] @ moment, moment @ modes.floors[span])]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the base's stiffness."""
        return np.array([1 / max(amplitude, 1e-12)])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add the base's flexibility."""
        frame, span = self.storeys(model), self.span(model)
        flexibility = np.linalg.inv(frame.stiffness) + np.outer(frame.height_m, frame.height_m) / abs(
            float(values[0])
        )
        assembly.stiffness[span, span] += np.linalg.inv(flexibility) - frame.stiffness


@CATALOGUE.add
@dataclass(frozen=True)
class PDelta(FrameEffect):
    """Geometric stiffness of weight_factor times the frame's weight beyond what the model has."""

    name = "p_delta"
    absorbing = True
    common_beside = True
    linear = True
    quantities = (Quantity("weight_factor", "1", symbol=r"\phi"),)
    sign = 1
    described = Description(
        r"$K \to K - \phi\,K_g$, $K_g$ the geometric stiffness of the frame's weight",
        "`stiffness_change` of the lower storeys, `joint_flexibility`",
        relation("frame", "drift", "force", same, lambda x: 0.75 * x),
        ", beyond what the baseline model has",
        told_by="The same shaking with known weights added to the floors: the geometric stiffness follows the weight.",
        plain=("{size} times the weight of {where} softens it beyond the model",),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the factor that takes a fifth of the first mode's stiffness away."""
        frame = self.storeys(model)
        shape_of_first = np.linalg.solve(frame.stiffness, frame.floor_mass)
        share = (shape_of_first @ frame.geometric @ shape_of_first) / (
            shape_of_first @ frame.stiffness @ shape_of_first
        )
        return 0.2 / float(share)

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the force of the frame's own weight on its drifts."""
        return matrix_terms(motion, -self.storeys(model).geometric, modes.floors, self.span(model))

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Take the geometric stiffness away."""
        span = self.span(model)
        assembly.stiffness[span, span] -= float(values[0]) * self.storeys(model).geometric


@CATALOGUE.add
@dataclass(frozen=True)
class AddedMass(FrameEffect):
    """Mass on a floor beyond that of the baseline model."""

    name = "added_mass"
    linear = True
    where = "floor"
    quantities = (Quantity("mass", "kg", symbol="m"),)
    described = Description(
        r"$M_{ii} \to M_{ii} + m$ on floor $i$",
        "`stiffness_change` of the storeys below; a mass that is not rigidly fixed is *unknown*",
        relation("floor", "acceleration", "inertia", same, lambda x: 1.4 * x),
        told_by="The same shaking with a known mass added to that floor, or weighing it.",
        plain=("{where} is {size} lighter than in the model", "{where} is {size} heavier than in the model"),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return a quarter of the floor's mass."""
        return 0.25 * floor_mass(model.structure, self.index)

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the inertia of a unit mass."""
        return [force_term(motion, lambda m: -m.acceleration[:, self.index], modes.floors[self.index])]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add the mass."""
        lightest = -0.9 * floor_mass(model.structure, self.index)
        assembly.mass[self.index, self.index] += max(float(values[0]), lightest)


POWER_SPREAD, SHARE_SPREAD = 0.3, 0.3
"""Prior standard deviations of the power of the rate about the second, and of the table's share in the rate about one."""
BEYOND_TWO = (-1.0, 2.0)
"""Least and largest that the power of the rate may have beyond the second."""


@CATALOGUE.add
@dataclass(frozen=True)
class AirDrag(LawEffect, FrameEffect):
    """Drag c w abs(w) on each floor.

    Real drag grows by a power near the second, and the air may move with the table: the power and the table's share in the
    rate are refined with the rest.
    """

    name = "air_drag"
    law = drag
    quantities = (
        Quantity("coefficient", "N s^2/m^2", logarithmic=True, symbol="c"),
        Quantity("power_beyond_two", "1", reported=False, spread=POWER_SPREAD, ends=BEYOND_TWO),
        Quantity("table_share_beyond_one", "1", reported=False, spread=SHARE_SPREAD),
    )
    sign = 1
    nonlinear = True
    dissipates = True
    described = Description(
        r"$-c\,w\lvert w\rvert$ on each floor; the power of $w$ (near 2) and whether the air moves with the table are "
        f"refined and not reported; $c$ is that at {DRAG_RATE:g} m/s",
        "`damping_change`, `coulomb_friction`",
        relation("floors", "floor velocity", "force", nothing, lambda x: x * abs(x)),
        shapes={
            "power_beyond_two": (
                f"the drag, stated at {DRAG_RATE:g} m/s, grows by less than the catalogue's second power",
                f"the drag, stated at {DRAG_RATE:g} m/s, grows by more than the catalogue's second power",
            ),
            "table_share_beyond_one": (
                "the air moves with the table, which the catalogue's does not",
                "the air moves against the table, which the catalogue's does not",
            ),
        },
        plain=("the air drags on the floors of {where}, with {size}",),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return what makes a fifth of the inertia of a floor."""
        span = self.span(model)
        inertia = float(np.mean(self.storeys(model).floor_mass * scales.acceleration[span]))
        return 0.2 * inertia / float(np.mean(scales.rate[span] ** 2))

    def placed(self, model: Model, numbers: tuple[float, ...]) -> list[PlacedLaw]:
        """Return the drag of every floor, in the room or partly beside the table."""
        rows = np.eye(model.structure.floors)[self.span(model)]
        return [PlacedLaw(drag, row, numbers[:2], in_room=numbers[2]) for row in rows]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the coefficient, and what leaves power and rate as they are."""
        return np.array([amplitude, 0.0, 0.0])

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return coefficient, what the power has beyond the second, and the table's share."""
        return (abs(float(values[0])), float(values[1]), 1.0 + float(values[2]))


TORSIONAL = (0.6, 2.4)
"""Ratios of torsional to lateral frequency between which one is looked for: floors on columns at their edges have 1 to 2."""


@CATALOGUE.add
@dataclass(frozen=True)
class TorsionalEccentricity(FrameEffect):
    """Centres of mass and stiffness lie an eccentricity apart, so that the floors turn as they move.

    Displacements are those of the plan's centre, the centre of stiffness. Floors turn with the lateral shapes, at
    `ratio` times the lateral frequencies where the centres coincide; neither that ratio nor the damping of turning, a
    multiple of the lateral, is in the baseline model: the one is scored on a grid, both are refined with the eccentricity.
    """

    name = "torsional_eccentricity"
    absorbing = True
    common = True
    quantities = (
        Quantity("eccentricity", "m", logarithmic=True, symbol="e"),
        Quantity("torsional_frequency_ratio", "1", reported=False, logarithmic=True),
        Quantity("torsional_damping_factor", "1", reported=False, logarithmic=True),
    )
    sign = 1
    described = Description(
        "centres of mass and stiffness apart by $e$: every floor turns too",
        "*unknown* (a mass on a spring), a second mode close by",
        history("plan", "floor's edge", sine, lambda t: sine(t) + 0.4 * np.sin(5 * np.pi * t)),
        told_by="A second accelerometer on the other side of the same floor: only torsion parts the two.",
        plain=("{where} turns as it sways, because its mass lies {size} off its stiffness",),
    )

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return ratios of torsional to lateral frequency, a bandwidth apart."""
        return [(float(ratio),) for ratio in bandwidths(*TORSIONAL)]

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the square of a fifth of the radius of gyration."""
        return (0.2 * self.storeys(model).gyration_m) ** 2

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the inertia of the turning floors for a unit squared eccentricity."""
        span = self.span(model)
        radius = self.storeys(model).gyration_m
        found = []
        for mode in range(span.start, span.stop):
            omega, ratio = float(modes.omega[mode]), float(modes.ratio[mode])

            def turning(
                m: Motion, mode: int = mode, omega: float = omega, ratio: float = ratio
            ) -> np.ndarray:
                moved = -(omega**2) * m.eta[:, mode] - 2 * ratio * omega * m.eta_rate[:, mode]
                own = shape[0] * omega
                driven = oscillator(moved, own, motion.run.step_s)
                return np.asarray((moved - own**2 * driven) / radius**2)

            found.append(force_term(motion, turning, np.eye(len(modes.omega))[mode], linear=False))
        return found

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return eccentricity, frequency ratio and a damping as that of the lateral motion."""
        return np.array([np.sqrt(max(amplitude, 1e-12)), shape[0], 1.0])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add the floors' rotations, scaled by the radius of gyration to displacements."""
        span, floors = self.span(model), model.structure.floors
        offset = float(values[0]) / self.storeys(model).gyration_m
        ratio, damped = float(values[1]), float(values[2])
        n = span.stop - span.start

        def extend(
            mass: np.ndarray, stiffness: np.ndarray, damping: np.ndarray
        ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            before = len(mass)
            larger = [np.zeros((before + n, before + n)) for _ in range(3)]
            for new, old in zip(larger, (mass, stiffness, damping), strict=True):
                new[:before, :before] = old
            own = stiffness[span, span]
            new_part = slice(before, before + n)
            larger[0][new_part, new_part] = (1 + offset**2) * mass[span, span]
            larger[0][span, new_part] = offset * mass[span, span]
            larger[0][new_part, span] = offset * mass[span, span]
            larger[1][new_part, new_part] = ratio**2 * own
            larger[2][new_part, new_part] = damped * ratio * damping[span, span]
            return larger[0], larger[1], larger[2]

        assert floors >= n
        assembly.extensions.append(extend)
        assembly.influence.extend([0.0] * n)
