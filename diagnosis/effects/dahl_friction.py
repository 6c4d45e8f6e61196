"""Dahl's friction: a joint that gives way before it slides.

It is not tried by default. `coulomb_friction` has a stuck joint's stiffness among its parameters and fits nearly the same
data, so the two would only make a class of each other; where the way into sliding is the question, it is asked for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.effects.catalogue import CATALOGUE, Quantity, Scales
from pounding.diagnosis.effects.describing import Description, loop
from pounding.diagnosis.effects.storey import StoreyEffect
from pounding.diagnosis.model.model import Model
from pounding.experiments.rig.storey_forces import bristles

SHORTEST_M = 1e-9
"""Shortest drift [m] over which the friction may build up."""


@CATALOGUE.add
@dataclass(frozen=True)
class DahlFriction(StoreyEffect):
    """Friction that builds up over a drift x0: it never quite sticks."""

    name = "dahl_friction"
    law = bristles
    default = False
    quantities = (
        Quantity("friction_force", "N", logarithmic=True, symbol="F"),
        Quantity("build_up_drift", "mm", 1000.0, logarithmic=True, symbol="x_0"),
    )
    sign = 1
    nonlinear = True
    dissipates = True
    described = Description(
        r"$\mathrm{d}f/\mathrm{d}d = \bigl(F\,\mathrm{sign}(v) - f\bigr) / \bigl(x_0\,\mathrm{sign}(v)\bigr)$",
        "`coulomb_friction` (where $x_0$ is small), `hysteresis`, and `damping_change` at one amplitude",
        loop(bristles, 0.3, 0.25),
        told_by="The same shaking at a tenth of its amplitude: what builds up is then a spring that hardly loses energy.",
        plain=("friction of {size} in {where}, which builds up with the drift",),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3 of the storey's rms shear."""
        return 0.3 * float(scales.shear[self.index])

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return drifts [m] over which it builds up, from hardly any to the usual one."""
        return [(float(scales.drift[self.index]) * share,) for share in (0.03, 0.1, 0.3, 1.0)]

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return friction force and drift."""
        return (abs(float(values[0])), max(abs(float(values[1])), SHORTEST_M))
