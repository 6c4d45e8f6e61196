"""What effects have in common: a whole frame, a logger, a law at its places, the departure of a nuisance parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.describing import Description
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly, vary
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes, StoreyFrame
from pounding.diagnosis.model.terms import Motion, law_term, parameter_terms
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.rig.laws import Law


@dataclass(frozen=True)
class FrameEffect(Effect):
    """An effect of a whole frame, or of one of its floors."""

    where = "frame"

    def storeys(self, model: Model) -> StoreyFrame:
        """Return the frame."""
        return model.structure.frames[model.structure.index(str(self.frame))]

    def span(self, model: Model) -> slice:
        """Return its floors among all."""
        return model.structure.span(model.structure.index(str(self.frame)))


@dataclass(frozen=True)
class LoggerEffect(Effect):
    """An effect of a sensor that several channels share, as those of one logger do: named before the sensor's own class.

    Attributes:
        members, channels: The channels' indices among all, and their names.
    """

    where = "logger"
    described: ClassVar[Description | None] = None
    members: tuple[int, ...] = ()
    channels: tuple[str, ...] = ()

    @property
    def places(self) -> tuple[int, ...]:
        """The channels."""
        return self.members

    def entries(self) -> list[dict[str, Any]]:
        """Return the sensor's effect on each channel."""
        return [self.place() | {"channel": channel} for channel in self.channels]


@dataclass(frozen=True)
class LawEffect(Effect):
    """An effect with a force f(d, v, t) in a storey or on a floor, given by a law."""

    law: ClassVar[Law]

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return the law's parameters [SI], which are those of the effect; what is positive stays so.

        Args:
            model: The baseline model.
            values: SI parameters of the effect in the order of `quantities`, shape (parameters,).
        """
        del model
        each = zip(self.quantities, values, strict=True)
        return tuple(abs(float(value)) if one.logarithmic else float(value) for one, value in each)

    def unit(self, model: Model, shape: tuple[float, ...]) -> tuple[float, ...]:
        """Return the law's parameters [SI] for a unit amplitude."""
        return self.numbers(model, self.values(1.0, shape))

    def row(self, model: Model) -> np.ndarray:
        """Return the row of floors that gives the drift or displacement the law acts on, (floors,)."""
        rows = np.eye(model.structure.floors) if self.where == "floor" else model.structure.drift
        return np.asarray(rows[self.index])

    def placed(self, model: Model, numbers: tuple[float, ...]) -> list[PlacedLaw]:
        """Return the law at each of its places, with its parameters [SI]."""
        return [PlacedLaw(self.law, self.row(model), numbers)]

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the force at each place as a term."""
        return [law_term(motion, modes, one) for one in self.placed(model, self.unit(model, shape))]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add the law to the assembly."""
        assembly.laws.extend(self.placed(model, self.numbers(model, values)))


@dataclass(frozen=True)
class Departure(Effect):
    """What a nuisance parameter stands for departs by more than its prior allows, by the same amount at all its places."""

    parameter: ClassVar[str]
    """Kind of the nuisance parameter (see `pounding.diagnosis.model.nuisance`)."""
    linear = True

    @property
    def places(self) -> tuple[int, ...]:
        """Indices of the places at which it departs."""
        return (self.index,)

    def departed(self, model: Model, without: np.ndarray, beside: np.ndarray) -> bool:
        """Return whether its nuisance parameter is beyond calibration without it, and none of the kind beside it."""
        kind = np.array([one.kind == self.parameter for one in model.parameters])
        here = kind & np.array([one.place in self.places for one in model.parameters])
        far, still = (
            np.abs(each / model.std) > SETTINGS.decision.beyond_calibration for each in (without, beside)
        )
        return bool(np.any(far & here) and not np.any(still & kind))

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the nuisance parameter's own terms."""
        each = (parameter_terms(model, modes, motion, self.parameter, place) for place in self.places)
        return [term for terms in each for term in terms]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Change what the nuisance parameter changes, downwards by no more than `largest`."""
        for place in self.places:
            vary(
                assembly, model.structure, self.parameter, place, max(float(values[0]), -self.largest(model))
            )
