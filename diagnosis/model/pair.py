"""Two frames that touch, as they are modelled: at the rate of the logger and below that of the contact."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from pounding.diagnosis.model.model import Model


@dataclass
class Pair:
    """A pair as its frames and its contact are judged.

    Attributes:
        full: The baseline model with observations at the logger's rate, all contact forces filled in.
        slow: The same for the frames, below `forces.rate_hz`.
        column: Column of the stated contact's force. noise: Its standard deviation in each run [N].
        cell: The errors of the force cell, or None where there is none that can be used.
        second: Floor (from 1) of a contact that the case does not list, its ln Bayes factor, and its column; or None.
        warnings: What was odd.
        contact_claimed: Whether something between the frames is known to be missing.
    """

    full: Model
    slow: Model
    column: int
    noise: list[float]
    cell: Cell | None
    second: tuple[int, float, int] | None = None
    warnings: list[str] = field(default_factory=list)
    contact_claimed: bool = False

    @property
    def blind(self) -> bool:
        """Whether a contact's force is what the motion asks for, no cell having measured it."""
        return self.cell is None or self.second is not None


TURNED_ROUND = -2.0
"""Relative change of such a cell's gain."""


@dataclass(frozen=True)
class Cell:
    """A force channel and its errors: name of the effect, value in SI, standard error, ln Bayes factor."""

    channel: str
    column: int
    faults: tuple[tuple[str, float, float, float], ...] = ()

    @property
    def corrected(self) -> bool:
        """Whether its gain or its delay was put right by the motion."""
        return bool(self._told_by_motion())

    def with_evidence(self, ln_bayes: float) -> Cell:
        """Return the cell whose gain or delay has the evidence of calibrated frames, where only one was put right.

        Args:
            ln_bayes: How much likelier the calibrated frames are with the cell put right, ln Bayes factor [-].
        """
        told = self._told_by_motion()
        faults = tuple((*one[:3], max(one[3], ln_bayes)) if told == [one] else one for one in self.faults)
        return replace(self, faults=faults)

    def _told_by_motion(self) -> list[tuple[str, float, float, float]]:
        return [
            one for one in self.faults if one[0] in ("sensor_gain", "sensor_delay") and one[1] != TURNED_ROUND
        ]
