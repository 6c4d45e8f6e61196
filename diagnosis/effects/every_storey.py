"""Laws in every storey of a frame at once: real frames yield, rub, soften and loosen everywhere.

A law of one storey acts in every storey with forces in proportion to the storey's stiffness k, so that one or two numbers
say what it does: a friction force k x is stated by the drift x at which it would be reached elastically, a cubic spring
k b by b. How uneven a real frame is remains as misfit. A frame of one storey has none of these, as they would be those of
its storey.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from pounding.diagnosis.effects.bases import FrameEffect, LawEffect
from pounding.diagnosis.effects.catalogue import CATALOGUE, Quantity, Scales
from pounding.diagnosis.effects.describing import Description, history, loop, relation
from pounding.diagnosis.effects.storey import (
    LARGEST_LOSS,
    CoulombFriction,
    CubicStiffness,
    Hysteresis,
    Loosening,
    StoreyEffect,
    law_error_of_yielding,
)
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.rig.storey_forces import cubic_spring, friction, quadratic_damper, yielding

EVERY = "all storeys"
"""Where these effects are: a frame of more than one storey."""
TAPER_SPREAD = 0.4
"""Prior standard deviation of the logarithm by which a law of all storeys is stronger at the roof, and weaker at the base,
than in proportion to their stiffness: frames are weaker towards the roof by their own rule."""
TAPER = Quantity("taper", "1", reported=False, spread=TAPER_SPREAD)
TAPERS = {
    "taper": (
        "towards the roof it falls by more than the storeys' stiffness does",
        "towards the roof it falls by less than the storeys' stiffness does",
    )
}


@dataclass(frozen=True)
class EveryStorey(LawEffect, FrameEffect):
    """The law of a storey in every storey of a frame; the amplitude times a storey's stiffness is that storey's.

    The last of its parameters is how it tapers: the law is exp(taper) times as strong in the highest storey, as much
    weaker in the lowest, and evenly between. It is refined with the rest.

    Attributes:
        alone: The effect in one storey; shapes and prior widths are those of the storey that drifts most.
    """

    where = EVERY
    common = True
    alone: ClassVar[type[StoreyEffect]]
    tapered: ClassVar[int | None] = None
    """Which parameter tapers: the amplitude when None."""

    def each(self, model: Model) -> Iterator[StoreyEffect]:
        """Yield the effect in each storey."""
        span = self.span(model)
        for index in range(span.start, span.stop):
            yield self.alone(index=index, frame=self.frame, storey=index - span.start + 1)

    def law_error(self, model: Model, values: np.ndarray, scales: Scales) -> float:
        """Return that of a law over a stiffness that a storey has not alone."""
        del model, values, scales
        return SETTINGS.refinement.law_error_everywhere

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the parameters of one storey, and no taper."""
        return np.append(self.alone().values(amplitude, shape), 0.0)

    def weight(self, model: Model, storey: StoreyEffect) -> float:
        """Return what the amplitude of the whole is multiplied by in one storey: its stiffness [N/m]."""
        return storey.stiffness(model)

    def tapering(self, values: np.ndarray, model: Model, storey: StoreyEffect) -> np.ndarray:
        """Return the SI parameters of the whole with the taper in them at one storey, shape (parameters - 1,).

        Args:
            values: SI parameters of the whole in the order of `quantities`, shape (parameters,).
            model: The baseline model.
            storey: The effect in that storey.
        """
        place = np.linspace(-1.0, 1.0, self.storeys(model).floors)[int(storey.storey or 1) - 1]
        there = np.array(values[:-1], float)
        there[self.amplitude if self.tapered is None else self.tapered] *= np.exp(values[-1] * place)
        return there

    def of_one(self, values: np.ndarray, weight: float) -> np.ndarray:
        """Return the SI parameters of one storey, shape (parameters - 1,).

        Args:
            values: SI parameters of the whole in the order of `quantities`, less the taper, shape (parameters - 1,).
            weight: That of the storey.
        """
        scaled = np.array(values, float)
        scaled[self.amplitude] *= weight
        return scaled

    def leading(self, scales: Scales) -> StoreyEffect:
        """Return the effect in the storey that drifts most."""
        floors = [len(omega) for omega in scales.omega]
        first = sum(floors[: self.index])
        drift = scales.drift[first : first + floors[self.index]]
        return self.alone(index=first + int(np.argmax(drift)), frame=self.frame)

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return every second shape of the storey that drifts most: storeys that drift less bring in the others."""
        return self.leading(scales).grid(scales)[-1::-2]

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the amplitude that is usual in the storey that drifts most."""
        storey = self.leading(scales)
        return storey.size(model, scales, shape) / self.weight(model, storey)

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the terms of a unit amplitude, one a storey."""
        return [
            replace(term, force=self.weight(model, storey) * np.asarray(term.force))
            for storey in self.each(model)
            for term in storey.terms(model, modes, motion, shape)
        ]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add the law of every storey to the assembly."""
        for storey in self.each(model):
            there = self.tapering(values, model, storey)
            storey.apply(assembly, self.of_one(there, self.weight(model, storey)), model)


@CATALOGUE.add
@dataclass(frozen=True)
class AllCoulombFriction(EveryStorey):
    """Friction k x in every storey: x is the slip drift, at which the storey's own elastic force is as large."""

    name = "all_coulomb_friction"
    alone = CoulombFriction
    quantities = (
        Quantity("slip_drift", "um", 1e6, logarithmic=True, symbol="x_s"),
        *CoulombFriction.quantities[1:],
        TAPER,
    )
    sign = 1
    nonlinear = True
    dissipates = True
    described = Description(
        r"$f = k\,x_s\,\mathrm{sign}(v)$ in every storey, stuck below, stuck joints refined as in one storey, and how it "
        "tapers towards the roof",
        "`all_damping_change` and `all_quadratic_damping` at one amplitude, `air_drag`, `coulomb_friction` in the storey "
        "that drifts most",
        replace(loop(friction, 0.3, 30.0, 0.0, np.inf, 0.0), mark="frame"),
        shapes=TAPERS,
        plain=("friction in every storey of {where}, which slides from a drift of {size} on",),
    )


@CATALOGUE.add
@dataclass(frozen=True)
class AllHysteresis(EveryStorey):
    """A share of the stiffness of every storey yields at one drift; small motions feel nothing of it."""

    name = "all_hysteresis"
    alone = Hysteresis
    absorbing = True
    amplitude = 1
    tapered = 0
    quantities = (
        Quantity("yield_drift", "mm", 1000.0, logarithmic=True, symbol="d_y"),
        Quantity("stiffness_share", "1", logarithmic=True, symbol="s"),
        *Hysteresis.quantities[2:],
        TAPER,
    )
    sign = 1
    nonlinear = True
    dissipates = True
    described = Description(
        "a share $s$ of the stiffness of every storey yields at the drift $d_y$: $F_y = s\\,k\\,d_y$; knee, unloading "
        "and a taper of $d_y$ towards the roof are refined",
        "`hysteresis` in the storey that drifts most, `all_coulomb_friction`, `all_cubic_stiffness` below zero, `air_drag`",
        replace(loop(yielding, 0.25, 0.6, 8.0, 0.0), mark="frame"),
        told_by="The same shaking at a third of its amplitude: below yield nothing is left of it.",
        shapes=TAPERS,
        plain=("every storey of {where} yields at a drift of {size}",),
    )

    def law_error(self, model: Model, values: np.ndarray, scales: Scales) -> float:
        """Return what the law may get wrong, by the storey that drifts furthest beyond yielding."""
        return min(
            law_error_of_yielding(scales, storey.index, abs(float(self.tapering(values, model, storey)[0])))
            for storey in self.each(model)
        )

    def largest(self, model: Model) -> float:
        """Return the whole of the stiffness."""
        del model
        return 1.0

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return yield drift, share of the stiffness, knee and unloading as in one storey, and no taper."""
        return np.array([shape[0], amplitude, *self.alone().values(amplitude, shape)[2:], 0.0])

    def of_one(self, values: np.ndarray, weight: float) -> np.ndarray:
        """Return yield force and stiffness of one storey, and what shapes its loop."""
        stiffness = values[1] * weight
        return np.array([values[0] * stiffness, stiffness, *values[2:]])


@CATALOGUE.add
@dataclass(frozen=True)
class AllCubicStiffness(EveryStorey):
    """A spring k b d^3 in every storey: the frame's stiffness changes with the square of its amplitude."""

    name = "all_cubic_stiffness"
    alone = CubicStiffness
    quantities = (Quantity("cubic_share", "1/m^2", symbol="b"), TAPER)
    nonlinear = True
    described = Description(
        r"$f = k\,b\,d^3$ in every storey; how it tapers towards the roof is refined",
        "`cubic_stiffness` in the storey that drifts most, `all_hysteresis` (where $b < 0$)",
        replace(loop(cubic_spring, 0.8), mark="frame"),
        told_by="The same shaking at half and at twice its amplitude: frequencies move with the square of it.",
        shapes=TAPERS,
        plain=(
            "every storey of {where} gets softer the further it drifts, by {size}",
            "every storey of {where} gets stiffer the further it drifts, by {size}",
        ),
    )


@CATALOGUE.add
@dataclass(frozen=True)
class AllLoosening(EveryStorey):
    """The stiffness of every storey falls linearly over each run to (1 + x) of itself."""

    name = "all_loosening"
    alone = Loosening
    quantities = (*Loosening.quantities, TAPER)
    sign = -1
    described = Description(
        r"$f = x\,k\,(t/T)\,d$ in every storey, in each run anew; how it tapers towards the roof is refined",
        "`loosening` in the storey that drifts most, `all_hysteresis` in a run that grows, `all_stiffness_change`",
        history("frame", "stiffness", np.ones_like, lambda t: 1 - 0.5 * t, "time in the run"),
        told_by="The same shaking twice, or a hammer test before and after: only what loosens ends softer than it began.",
        shapes=TAPERS,
        plain=("every storey of {where} loses {size} of its stiffness in the course of a run",),
    )

    def largest(self, model: Model) -> float:
        """Return nearly all of the stiffness."""
        del model
        return LARGEST_LOSS

    def weight(self, model: Model, storey: StoreyEffect) -> float:
        """Return one: the amplitude is a share of the storey's stiffness already."""
        del model, storey
        return 1.0


@dataclass(frozen=True)
class QuadraticDamper(StoreyEffect):
    """A damper c v abs(v) in one storey, which is no effect of its own: what grows so is known of whole frames."""

    law = quadratic_damper
    quantities = (Quantity("damping", "N s^2/m^2", logarithmic=True),)

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return what makes 0.1 of the storey's elastic force at the usual drift and rate."""
        elastic = self.stiffness(model) * float(scales.drift[self.index])
        return 0.1 * elastic / float(scales.drift_rate[self.index]) ** 2


@CATALOGUE.add
@dataclass(frozen=True)
class AllQuadraticDamping(EveryStorey):
    """A damper k q v abs(v) in every storey: the frame's damping grows with its amplitude."""

    name = "all_quadratic_damping"
    alone = QuadraticDamper
    quantities = (Quantity("quadratic_damping", "s^2/m^2", logarithmic=True, symbol="q"), TAPER)
    sign = 1
    nonlinear = True
    dissipates = True
    described = Description(
        r"$f = k\,q\,v\lvert v\rvert$ in every storey: damping that grows with the amplitude; how it tapers "
        "towards the roof is refined",
        "`air_drag`, `all_damping_change` at one amplitude, `all_coulomb_friction`",
        relation("frame", "drift rate", "force", lambda x: 0.0 * x, lambda x: x * abs(x)),
        shapes=TAPERS,
        plain=("the damping of {where} grows with its amplitude, by {size}",),
    )
