"""Changes of a whole frame, beyond what its calibration may give it: its stiffness, its damping, its mass.

A frame of one storey has none of these, as they would be those of its storey.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.effects.bases import Departure, FrameEffect
from pounding.diagnosis.effects.catalogue import CATALOGUE, Effect, Quantity
from pounding.diagnosis.effects.describing import Description, relation, same
from pounding.diagnosis.effects.every_storey import EVERY
from pounding.diagnosis.effects.storey import LARGEST_LOSS
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, force_term


@CATALOGUE.add
@dataclass(frozen=True)
class AllStiffnessChange(FrameEffect, Departure):
    """The stiffness of a whole frame times (1 + x), beyond what calibration may give it."""

    name = "all_stiffness_change"
    where = EVERY
    common = True
    parameter = "frame_stiffness"
    typical = 0.3
    absorbing = True
    quantities = (Quantity("relative_change", "1", symbol="x"),)
    described = Description(
        r"$K \to (1 + x)\,K$ beyond the prior of the frame's stiffness",
        "`all_added_mass`, which the motion of a shaken table cannot tell from it, `joint_flexibility`, `p_delta`, "
        "`base_rocking`",
        relation("frame", "drift", "force", same, lambda x: 0.6 * x),
        told_by="A push on the roof with a known force, or weighing a floor: only one of stiffness and mass has changed.",
        plain=(
            "the whole of {where} is {size} softer than the model",
            "the whole of {where} is {size} stiffer than the model",
        ),
    )

    def largest(self, model: Model) -> float:
        """Return nearly all of the stiffness."""
        del model
        return LARGEST_LOSS


@CATALOGUE.add
@dataclass(frozen=True)
class AllDampingChange(FrameEffect, Departure):
    """The damping ratios of all modes of a frame times a factor, beyond what calibration may give them."""

    name = "all_damping_change"
    where = EVERY
    common = True
    parameter = "frame_damping"
    linear = False
    typical = 0.7
    """Of the factor's logarithm."""
    absorbing = True
    dissipates = True
    quantities = (Quantity("damping_factor", "1", logarithmic=True, symbol="c"),)
    described = Description(
        r"$\zeta \to c\,\zeta$ in all modes beyond the prior of the frame's damping",
        "`damping_change` in the storey that drifts most, `air_drag`, `all_quadratic_damping` and `all_coulomb_friction` "
        "at one amplitude",
        relation("frame", "drift rate", "force", lambda x: 0.3 * x, lambda x: 0.8 * x),
        plain=("the damping of {where} is {size} times that of the model",),
    )

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the factor, shape (1,)."""
        return np.array([np.exp(np.clip(amplitude, -3.0, 3.0))])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Multiply the damping ratios."""
        assembly.log_damping[self.span(model)] += np.log(float(values[0]))


@CATALOGUE.add
@dataclass(frozen=True)
class AllAddedMass(FrameEffect):
    """The mass of a whole frame times (1 + x), beyond what calibration may give it."""

    name = "all_added_mass"
    where = EVERY
    common = True
    linear = True
    typical = 0.3
    absorbing = True
    quantities = (Quantity("relative_change", "1", symbol="x"),)
    described = Description(
        r"$M \to (1 + x)\,M$ beyond the priors of the floors' masses",
        "`all_stiffness_change`, which the motion of a shaken table cannot tell from it, `p_delta`",
        relation("floors", "acceleration", "inertia", same, lambda x: 1.4 * x),
        told_by="Weighing a floor, or a push on the roof with a known force: only one of stiffness and mass has changed.",
        plain=(
            "the whole of {where} is {size} lighter than the model",
            "the whole of {where} is {size} heavier than the model",
        ),
    )

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the inertia of as much mass again."""
        span, rows = self.span(model), self.storeys(model).mass

        def inertia(row: np.ndarray) -> Callable[[Motion], np.ndarray]:
            return lambda m: -(m.acceleration[:, span] @ row)

        floors = modes.floors[span]
        return [force_term(motion, inertia(row), floor) for row, floor in zip(rows, floors, strict=True)]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Scale the mass."""
        span = self.span(model)
        assembly.mass[span, span] += max(float(values[0]), -LARGEST_LOSS) * self.storeys(model).mass


def same_motion(effect: Effect) -> Effect | None:
    """Return the effect of a whole frame whose every size moves it as one of this one does; None where there is none.

    A shaken table knows the ratio of stiffness and mass only: stiffness times (1 + x) is mass over (1 + x).

    Args:
        effect: The effect.
    """
    kinds: dict[type[Effect], type[Effect]] = {
        AllStiffnessChange: AllAddedMass,
        AllAddedMass: AllStiffnessChange,
    }
    kind = kinds.get(type(effect))
    return None if kind is None else kind(index=effect.index, frame=effect.frame)
