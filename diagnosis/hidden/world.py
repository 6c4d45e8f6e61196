"""What a world of hidden cases consists of: its frames, how a run happens in it, and what can be hidden."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from pounding.diagnosis.case.case import Channel
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.instruments import FINE_HZ
from pounding.diagnosis.hidden.motions import Motion
from pounding.diagnosis.hidden.scenario import Happened, Scenario
from pounding.diagnosis.hidden.setting import Effect

Happen = Callable[[Scenario, Motion, int], Happened]


@dataclass(frozen=True)
class Sight:
    """What is looked at to see how large a model error is: channels, and motions at their rate, the last held out."""

    channels: tuple[Channel, ...]
    motions: tuple[Motion, ...]


class Settle(Protocol):
    """Gives the frames of a rig their errors; returns the rig and what the truth says of them."""

    def __call__(
        self, rng: np.random.Generator, bare: Scenario, sight: Sight, wanted: float | None
    ) -> tuple[Scenario, Mapping[str, Any]]:
        """Settle the rig `bare`; `rng` draws, `wanted` is the size of the error [-], drawn when None."""


@dataclass(frozen=True)
class World:
    """A world of hidden cases.

    Attributes:
        name: As `--engine` names it.
        catalogue: Effects of the catalogue that can be hidden, by name.
        asked_for: Those that are hidden only where they are asked for.
        contact: What can be hidden where two frames touch.
        outside: What is in no catalogue.
        built: Draws a frame of the thesis as it was built.
        scenario: The kind of `Scenario` that its effects change.
        happen: Lets a run happen.
        settle: Gives the frames a model error; None where `built` is all.
        require: Refuses where the world's simulator is not installed.
        pair_rates_hz: Samples per second of a pair; those of `instruments` when empty.
        fine_hz: Least rate at which the truth of one frame is computed [Hz].
    """

    name: str
    catalogue: Mapping[str, Effect]
    asked_for: Mapping[str, Effect]
    contact: Mapping[str, Effect]
    outside: Mapping[str, Effect]
    built: Callable[[np.random.Generator, str], Beams]
    scenario: type[Scenario]
    happen: Happen
    settle: Settle | None = None
    require: Callable[[], None] | None = None
    pair_rates_hz: tuple[float, ...] = ()
    fine_hz: float = FINE_HZ

    @property
    def effects(self) -> dict[str, Effect]:
        """All that can be hidden in it, by name."""
        return {**self.catalogue, **self.asked_for, **self.contact, **self.outside}
