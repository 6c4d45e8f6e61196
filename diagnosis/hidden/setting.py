"""Where an effect is hidden, and what hides it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.contacts import Touch
from pounding.diagnosis.hidden.reference import Typical
from pounding.diagnosis.hidden.scenario import Scenario, Spring


@dataclass(frozen=True)
class Setting:
    """Where an effect is put: the scenario so far, the frame's typical sizes, and the place.

    `storey` and `floor` count from 1; `channel` is a name, with its root mean square in SI. `stated_contact`
    is the contact as the case states it, `nearness` how near the frames' `floor`s come to each other over
    how near those of the stated contact come, if nothing stops them.
    """

    scenario: Scenario
    typical: Typical
    frame: str
    storey: int = 0
    floor: int = 0
    channel: str = ""
    channel_rms: float = 0.0
    channel_to_si: float = 1.0
    stated_contact: Touch | None = None
    nearness: float = 0.0

    @property
    def beams(self) -> Beams:
        """The frame as it is."""
        return self.scenario.frames[self.frame]

    def at(self, values: np.ndarray) -> float:
        """Return a storey's or floor's value.

        Args:
            values: A value for each storey or floor of the frame, shape (storeys,).
        """
        return float(values[(self.storey or self.floor) - 1])

    def with_beams(self, **fields: Any) -> Scenario:
        """Return the scenario with the frame changed."""
        changed = {**self.scenario.frames, self.frame: replace(self.beams, **fields)}
        return replace(self.scenario, frames=changed)

    def with_storey_law(self, make: Callable[[float], Any]) -> Scenario:
        """Return the scenario with a law between the storey's two floors."""
        spring = Spring(self.frame, self.storey, self.storey - 1, make)
        return replace(self.scenario, springs=(*self.scenario.springs, spring))


Parameters = dict[str, tuple[Any, ...]]
"""Value and unit by name, as the truth states them.

After these come the values by other definitions in use: in a frame whose joints turn, a storey's stiffness is
its shear over drift under lateral load, or its shear for a drift of it alone, or that of its columns.
"""

Put = Callable[[Setting, float, np.random.Generator], tuple[Scenario, Parameters]]


@dataclass(frozen=True)
class Effect:
    """Something that can be hidden.

    Attributes:
        place: ``storey``, ``floor``, ``frame``, ``table``, ``channel`` or ``contact``.
        put: Puts it into a scenario and returns the true parameters too. Its arguments are the `setting` to
            change, the signed relative `size` [-], and `rng`, which draws what the size leaves open.
        largest: Largest size that still makes sense, upwards.
        smallest: The same downwards; 0 where a negative size has no meaning.
    """

    place: str
    put: Put
    largest: float
    smallest: float = 0.0
