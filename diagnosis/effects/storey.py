"""Effects that act in one storey, as a force that opposes its drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from pounding.diagnosis.effects.bases import Departure, LawEffect
from pounding.diagnosis.effects.catalogue import CATALOGUE, Effect, Quantity, Scales
from pounding.diagnosis.effects.describing import Description, history, loop, relation, same
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import (
    USUAL_DRIFT,
    Assembly,
    column_drift,
    floor_mass,
    storey_stiffness,
    usual_drift_rate,
)
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.rig.storey_forces import (
    PRESSED_M,
    cubic_spring,
    damper,
    friction,
    growing_spring,
    stop,
    yielding,
)

AT_ITS_RATE = f"whose size is that at a drift of {100 * USUAL_DRIFT:g} % of the storey at the first frequency"
AT_ITS_DEPTH = f"whose stiffness is that {1e3 * PRESSED_M:g} mm deep"
"""At what motion a law that grows by another power is as strong as it is stated."""
SHARPNESS = 8.0
SHARPEST = 30.0
UNLOADING_SPREAD = 0.5
"""Exponent of a yielding part's knee: where its refinement starts, and where it is as good as infinite; prior
standard deviation of how it unloads, from elastic until its force changes sign (0) to rounding from where it turns (1)."""
LARGEST_LOSS = 0.95
"""Share of its stiffness that a storey can lose and still stand."""
STIFFEST = 60.0
STICKING = 15.0
"""Stiffness of a stuck friction joint as a multiple of the storey's: stiff, yet within the simulator's step."""
LOOSE = 0.01
"""The same of a joint that creeps instead of sticking: hardly any."""
STICKING_RATIO = 0.3
STICKING_RATIO_SPREAD = 0.5
"""Damping ratio of a floor on a stuck joint of that stiffness, and the prior standard deviation of its logarithm."""
BREAKAWAY_SPREAD = 0.15
BREAKAWAY_RANGE = (-0.5, 1.0)
"""Prior standard deviation of what static friction has beyond the sliding one as a share of it, and how far it may go."""
POWER_SPREAD = 0.3
POWER_RANGE = (-0.8, 2.0)
"""Prior standard deviation of what the power of a damper has beyond the first, and how far it may go: from nearly dry
friction to the cube."""
AT_REST = 0.1
"""A stop whose gap is a smaller share of the largest drift touches at rest, and is none."""
LOSS_SPREAD, PROGRESS_SPREAD = 1.0, 0.3
PROGRESS_RANGE = (-0.5, 1.5)
COLUMNS_SPREAD, COLUMNS_RANGE = 0.5, (-0.5, 1.5)
"""Prior standard deviation of how far what loosens is the columns (1) and not the storey as a whole (0), and its range."""
DASHPOT_SPREAD, DASHPOT_RANGE = 0.5, (-0.5, 1.0)
"""Prior standard deviations of a stop's loss [s/m], of what the power of its depth has beyond the first and of how far its
loss is a dashpot's [-], and how far the latter two may go."""


def stiffness_of_storey(effect: Effect, model: Model) -> list[int]:
    """Return the numbers of the nuisance parameters that change the stiffness of an effect's storey.

    Args:
        effect: The effect.
        model: The baseline model.
    """
    whole = model.structure.index(str(effect.frame))
    ours = {("storey_stiffness", effect.index), ("base_stiffness", effect.index), ("frame_stiffness", whole)}
    return [number for number, one in enumerate(model.parameters) if (one.kind, one.place) in ours]


@dataclass(frozen=True)
class StoreyEffect(LawEffect):
    """An effect with a force f(d, v, t) in a storey, given by a law."""

    where = "storey"

    def stiffness(self, model: Model) -> float:
        """Return the stiffness of the storey in the baseline model [N/m]."""
        return storey_stiffness(model.structure, self.index)


@CATALOGUE.add
@dataclass(frozen=True)
class StiffnessChange(Departure):
    """The storey's stiffness times (1 + x) at all times: the force x k d."""

    name = "stiffness_change"
    where = "storey"
    parameter = "storey_stiffness"
    typical = 0.3
    quantities = (Quantity("relative_change", "1", symbol="x"),)
    described = Description(
        r"$f = x\,k\,d$ at all times",
        "the same in a neighbouring storey, `joint_flexibility`, `p_delta`, `base_rocking`; `added_mass` where only the "
        "lowest mode is seen. Small ones vanish in the prior of the storey's stiffness",
        relation("storey", "drift", "force", same, lambda x: 0.6 * x),
        told_by="A hammer test of the upper modes: one storey's stiffness moves each mode by its own drift there.",
        plain=("{where} is {size} softer than the model", "{where} is {size} stiffer than the model"),
    )

    def largest(self, model: Model) -> float:
        """Return nearly all of the storey's stiffness."""
        return LARGEST_LOSS

    def relative_to(self, model: Model) -> list[int]:
        """Return what calibration does to the storey: the change is one of the frame at hand, not of the baseline model."""
        return stiffness_of_storey(self, model)


@CATALOGUE.add
@dataclass(frozen=True)
class DampingChange(StoreyEffect):
    """A viscous damper: c v, negative where the frame has less than the baseline model.

    Real dampers grow by a power near the first, which is refined with the rest; c is that at the usual rate of a storey's
    drift.
    """

    name = "damping_change"
    law = damper
    quantities = (
        Quantity("damping", "N s/m", symbol="c"),
        Quantity("power_beyond_one", "1", reported=False, spread=POWER_SPREAD, ends=POWER_RANGE),
    )
    dissipates = True
    described = Description(
        r"$f = c\,v$; the power of $v$ (near 1) is refined and not reported; $c$ is that at the rate of a drift of "
        f"{100 * USUAL_DRIFT:g} % of the storey's height at the first frequency",
        "the same in another storey (at light damping a mode feels only the sum), `coulomb_friction` if all runs are of "
        "one size, `air_drag`",
        loop(damper, 0.035, 0.0, 1.0),
        ", negative where the frame has less than the baseline model",
        shapes={
            "power_beyond_one": (
                f"the damper, {AT_ITS_RATE}, grows by less than the catalogue's first power of the rate",
                f"the damper, {AT_ITS_RATE}, grows by more than the catalogue's first power of the rate",
            )
        },
        plain=(
            "{where} has less damping than the model, by a damper of {size}",
            "{where} has more damping than the model, by a damper of {size}",
        ),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the damper that gives the storey alone five per cent of critical in the first mode."""
        first = float(scales.omega[model.structure.index(str(self.frame))][0])
        return 0.1 * self.stiffness(model) / first

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return a linear damper."""
        return np.array([amplitude, 0.0])

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return the damper, what its power has beyond the first, and the rate at which it is as strong as a linear one."""
        return (float(values[0]), float(values[1]), usual_drift_rate(model.structure, self.index))


@CATALOGUE.add
@dataclass(frozen=True)
class CoulombFriction(StoreyEffect):
    """Friction F sign(v), stuck below F, or below a little more or less: what breaks it loose is refined with the rest.

    So are stiffness and damping of the stuck joint. Where one of them was fixed at a wrong size, masses and stiffness of the
    frame, of which a table tells only the ratio, took what it lacked, and the force went with them.
    """

    name = "coulomb_friction"
    law = friction
    quantities: ClassVar[tuple[Quantity, ...]] = (
        Quantity("friction_force", "N", logarithmic=True, symbol="F"),
        Quantity("sticking_stiffness", "1", reported=False, logarithmic=True, ends=(0.0, STIFFEST)),
        Quantity("breakaway_beyond_one", "1", reported=False, spread=BREAKAWAY_SPREAD, ends=BREAKAWAY_RANGE),
        Quantity(
            "sticking_damping_ratio", "1", reported=False, logarithmic=True, spread=STICKING_RATIO_SPREAD
        ),
    )
    sign = 1
    nonlinear = True
    dissipates = True
    described = Description(
        r"$f = F\,\mathrm{sign}(v)$, stuck while $\lvert f\rvert < F$; what breaks it loose beyond $F$, and how stiff and "
        "damped it is while stuck, is refined and not reported",
        "`damping_change` at one amplitude, `hysteresis` with an early yield; a stiffer storey while it sticks",
        loop(friction, 0.3, 30.0, 0.0, np.inf, 0.0),
        shapes={
            "sticking_stiffness": (
                "the joint gives more before it slides than the catalogue's",
                "the joint gives less before it slides than the catalogue's",
            )
        },
        plain=("friction of {size} in {where}",),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3 of the storey's rms shear."""
        return 0.3 * float(scales.shear[self.index])

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return drifts at which the joint begins to slide [m], standing for its stiffness against its force."""
        return [(float(scales.drift[self.index]) * share,) for share in (0.005, 0.02, 0.1, 0.3)]

    def unit(self, model: Model, shape: tuple[float, ...]) -> tuple[float, ...]:
        """Return friction of 1 N that slides from the drift `shape`, without damping: it is scored on noisy rates."""
        return (1.0, 1 / shape[0], 0.0, np.inf, 0.0)

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return friction force, stiffness while stuck over the storey's, no breakaway, and damping ratio while stuck."""
        return np.array([amplitude, STICKING, 0.0, STICKING_RATIO])

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return a stiff joint that slides at F, damped while stuck.

        A joint twice as stiff is damped twice as much: on the way to a rigid one both grow, along one coordinate.
        """
        times = float(values[1])
        damping = float(values[3] * self._critical(model) * times / STICKING)
        return (abs(float(values[0])), times * self.stiffness(model), damping, np.inf, float(values[2]))

    def creeping(self, model: Model, force: float, rate: float) -> np.ndarray:
        """Return parameters (4,) of friction that never sticks: below its force it creeps, in proportion to what pulls.

        Args:
            model: The baseline model.
            force: Friction force [N].
            rate: Rate of the drift from which it slides [m/s].
        """
        ratio = force / rate * STICKING / (self._critical(model) * LOOSE)
        return np.array([force, LOOSE, 0.0, ratio])

    def _critical(self, model: Model) -> float:
        """Return the damping [N s/m] that is critical for a floor on a stuck joint."""
        mass = floor_mass(model.structure, self.index)
        return float(2 * np.sqrt(STICKING * self.stiffness(model) * mass / 2))


@CATALOGUE.add
@dataclass(frozen=True)
class CubicStiffness(StoreyEffect):
    """A spring k3 d^3."""

    name = "cubic_stiffness"
    law = cubic_spring
    quantities = (Quantity("cubic_stiffness", "N/m^3", symbol="k_3"),)
    nonlinear = True
    described = Description(
        r"$f = k_3\,d^3$",
        "a `bumper` on each side, `hysteresis` (where $k_3 < 0$)",
        loop(cubic_spring, 0.8),
        plain=(
            "{where} gets softer the further it drifts, by a cubic spring of {size}",
            "{where} gets stiffer the further it drifts, by a cubic spring of {size}",
        ),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return what makes 0.3 of the linear force at twice the rms drift."""
        return 0.3 * self.stiffness(model) / (2 * float(scales.drift[self.index])) ** 2


def law_error_of_yielding(scales: Scales, index: int, yield_drift: float) -> float:
    """Return the share of its size that the law of what yields may get wrong [-]: the more, the less it yields.

    Laws that agree far beyond yielding have forces of their own about the knee, and what hardly yields shows no more of it.

    Args:
        scales: Typical sizes of the motion.
        index: The storey, among those of all frames.
        yield_drift: Drift from which it yields [m].
    """
    furthest = float(max(scales.highest[index], -scales.lowest[index]))
    ours = SETTINGS.refinement
    return float(np.hypot(ours.law_error_of_yielding, ours.law_error_of_knee * yield_drift / furthest))


@CATALOGUE.add
@dataclass(frozen=True)
class Hysteresis(StoreyEffect):
    """A part k_y of the storey's stiffness yields at F_y; small motions feel nothing of it.

    How sharp the knee is and how it unloads no catalogue says, so both are refined with the rest: between the laws of Bouc
    and Wen and those that follow Masing's rule, as Ramberg and Osgood's and Menegotto and Pinto's do.
    """

    name = "hysteresis"
    law = yielding
    absorbing = True
    quantities = (
        Quantity("yield_force", "N", logarithmic=True, symbol="F_y"),
        Quantity("stiffness", "N/m", logarithmic=True, symbol="k_y"),
        Quantity("sharpness", "1", reported=False, logarithmic=True, ends=(1.0, SHARPEST)),
        Quantity("unloading", "1", reported=False, spread=UNLOADING_SPREAD, ends=(0.0, 1.0)),
    )
    sign = 1
    nonlinear = True
    dissipates = True
    described = Description(
        "a part $k_y$ of the storey's stiffness yields at $F_y$; small motions feel nothing of it; how sharp its knee is "
        "(Bouc and Wen's exponent) and whether it unloads by their rule or by Masing's are refined and not reported",
        "`coulomb_friction`, `loosening` in a run that grows, `cubic_stiffness` with $k_3 < 0$",
        loop(yielding, 0.25, 0.6, 8.0, 0.0),
        told_by="The same shaking at a third of its amplitude: below yield nothing is left of it.",
        shapes={
            "sharpness": (
                "the loop is rounder than the catalogue's",
                "the loop has a sharper knee than the catalogue's",
            ),
            "unloading": (
                "the loop unloads as steeply as the catalogue's",
                "the loop rounds as it unloads, as Menegotto and Pinto's does and the catalogue's does not",
            ),
        },
        plain=("a part of {where} yields at {size}",),
    )

    def law_error(self, model: Model, values: np.ndarray, scales: Scales) -> float:
        """Return what the law may get wrong, the less, the further the storey drifts beyond yielding."""
        del model
        return law_error_of_yielding(scales, self.index, abs(float(values[0] / values[1])))

    def largest(self, model: Model) -> float:
        """Return the storey's stiffness."""
        return self.stiffness(model)

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3 of the storey's stiffness."""
        return 0.3 * self.stiffness(model)

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return yield drifts [m]."""
        largest = float(max(scales.highest[self.index], -scales.lowest[self.index]))
        return [(largest * share,) for share in (0.06, 0.12, 0.2, 0.32, 0.46, 0.62, 0.8)]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return yield force, stiffness and the sharpness of the knee."""
        return np.array([amplitude * shape[0], amplitude, SHARPNESS, 0.0])


@CATALOGUE.add
@dataclass(frozen=True)
class Loosening(StoreyEffect):
    """The storey's stiffness falls linearly over each run to (1 + x) of itself: x k (t / T) d.

    What loosens is the storey as a whole or its columns, which bend otherwise where joints turn: that is refined, too.
    """

    name = "loosening"
    law = growing_spring
    quantities: ClassVar[tuple[Quantity, ...]] = (
        Quantity("final_relative_change", "1", symbol="x"),
        Quantity("of_columns", "1", reported=False, spread=COLUMNS_SPREAD, ends=COLUMNS_RANGE),
    )
    typical = 0.3
    sign = -1
    described = Description(
        r"$f = x\,k\,(t/T)\,d$, in each run anew; whether $d$ is the storey's drift or what its columns bend by is refined "
        "and not reported",
        "`hysteresis` in a run that grows, `stiffness_change`",
        history("storey", "stiffness", np.ones_like, lambda t: 1 - 0.5 * t, "time in the run"),
        told_by="The same shaking twice, or a hammer test before and after: only what loosens ends softer than it began.",
        shapes={
            "of_columns": (
                "the floors beside the storey take more part in it than the catalogue's storey",
                "it is the storey's columns that loosen, bending more or less than it drifts where joints turn",
            )
        },
        plain=("{where} loses {size} of its stiffness in the course of a run",),
    )

    def law_error(self, model: Model, values: np.ndarray, scales: Scales) -> float:
        """Return that of a law over a stiffness that a storey has not alone: its columns loosen, and its joints do not."""
        del model, values, scales
        return SETTINGS.refinement.law_error_everywhere

    def largest(self, model: Model) -> float:
        """Return nearly all of the storey's stiffness."""
        return LARGEST_LOSS

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the change of the storey as a whole."""
        return np.array([amplitude, 0.0])

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return the stiffness at the end of the run, which is when it is whole."""
        return (max(float(values[0]), -LARGEST_LOSS) * self.stiffness(model), float("nan"))

    def relative_to(self, model: Model) -> list[int]:
        """Return what calibration does to the storey."""
        return stiffness_of_storey(self, model)

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add a law along the drift, or along what the columns bend by."""
        drift, columns = self.row(model), column_drift(model.structure, self.index)
        row = drift + float(values[1]) * (columns - drift)
        assembly.laws.append(PlacedLaw(self.law, row, self.numbers(model, values)))


@CATALOGUE.add
@dataclass(frozen=True)
class Bumper(StoreyEffect):
    """A stop: k (d - g) beyond the gap g, or its mirror where g is negative.

    Rubber loses energy and stiffens as it is pressed: loss and power of the depth are refined with the rest.
    """

    name = "bumper"
    amplitude = 1
    law = stop
    quantities: ClassVar[tuple[Quantity, ...]] = (
        Quantity("gap", "mm", 1000.0, symbol="g"),
        Quantity("stiffness", "N/m", logarithmic=True, symbol="k_b"),
        Quantity("loss", "s/m", reported=False, spread=LOSS_SPREAD),
        Quantity("power_beyond_one", "1", reported=False, spread=PROGRESS_SPREAD, ends=PROGRESS_RANGE),
        Quantity("dashpot", "1", reported=False, spread=DASHPOT_SPREAD, ends=DASHPOT_RANGE),
    )
    sign = 1
    nonlinear = True
    described = Description(
        r"$f = k_b\,(d - g)$ for $d > g$, or its mirror where $g < 0$; its loss, from a dashpot's to one that grows with "
        "the depth, and the power of its depth (near 1) are refined and not reported; $k_b$ is that "
        f"{1e3 * PRESSED_M:g} mm deep",
        "`cubic_stiffness`; another gap with another stiffness, if it is hardly touched",
        loop(stop, 0.5, 2.0, 0.0, 0.0),
        shapes={
            "power_beyond_one": (
                f"the stop, {AT_ITS_DEPTH}, grows by less than the catalogue's first power of the depth",
                f"the stop, {AT_ITS_DEPTH}, grows by more than the catalogue's first power of the depth",
            )
        },
        told_by="The same shaking at an amplitude that stays inside the gap, or paper in the gap that shows marks.",
        plain=(
            "{where} meets a stop at a drift of {size} to -x",
            "{where} meets a stop at a drift of {size} to +x",
        ),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the storey's stiffness."""
        return self.stiffness(model)

    def is_common(self, values: np.ndarray, scales: Scales) -> bool:
        """Return whether it touches at rest: a storey that is a little stiffer one way, as one with bowed columns is."""
        ends = abs(scales.highest[self.index]), abs(scales.lowest[self.index])
        return bool(abs(values[0]) < AT_REST * max(ends))

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return gaps [m] on both sides."""
        shares = (0.1, 0.25, 0.4, 0.55, 0.7, 0.84, 0.95)
        ends = (float(scales.highest[self.index]), float(scales.lowest[self.index]))
        return [(end * share,) for end in ends for share in shares]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return gap and stiffness of a straight stop without loss."""
        return np.array([shape[0], amplitude, 0.0, 0.0, 0.0])
