"""What is said of the gap between two frames, as `gap` prints it and as `--json` writes it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from pounding.experiments.separation.rules.answers import Answer


@dataclass(frozen=True)
class Spread:
    """The least and the largest required gap when the frames' frequencies are somewhat off.

    Attributes:
        low_mm, high_mm: Least and largest [mm].
        basis: What was varied, in words.
    """

    low_mm: float
    high_mm: float
    basis: str


@dataclass(frozen=True)
class FloorGap:
    """The required gap at a floor that both frames have.

    Attributes:
        floor: Number of the floor.
        required_gap_mm: Largest closing motion [mm].
        equation_4_1_mm: Largest motion apart or together, as equation 4.1 has it [mm].
    """

    floor: int
    required_gap_mm: float
    equation_4_1_mm: float


@dataclass(frozen=True)
class EdgeGap:
    """The required gap at one end of the edge that two frames share.

    Attributes:
        y_m: Place along the edge, from the middle [m].
        required_gap_mm: Largest closing motion there [mm].
    """

    y_m: float
    required_gap_mm: float


@dataclass(frozen=True, repr=False)
class GapAnswer:
    """The required gap of two frames under a record, and what stands beside it. Lengths are those of the frames.

    Attributes:
        left, right: Names of the frames; the left one moves in +x towards the right one.
        record: Name of the ground motion.
        pga_g: Its peak acceleration [g].
        floor: Floor of the lower frame at which they may meet.
        on_columns: Whether this floor faces columns of the other frame.
        y_m: Place along the floors' edge, from the middle [m].
        required_gap_mm: Largest closing motion [mm].
        time_s: When it occurs, on the model's clock [s].
        equation_4_1_mm: Largest motion apart or together, as equation 4.1 has it [mm].
        reversed_mm: Required gap with the frames on swapped sides, or under the record with the other sign [mm].
        left_peak_mm, right_peak_mm: Largest displacement of each frame there, relative to the table [mm].
        spread: The required gap when the frequencies are somewhat off.
        floors: The required gap at every floor that both frames have.
        edges: The required gap at both ends of the shared edge; empty unless a frame turns.
        rules: What each code rule says, asked with the peaks of this run.
        published: ``experiment_mm`` and ``numerical_mm`` of the thesis and their ``source``; None where it has none.
        warnings: What to mind, a sentence each.
    """

    left: str
    right: str
    record: str
    pga_g: float
    floor: int
    on_columns: bool
    y_m: float
    required_gap_mm: float
    time_s: float
    equation_4_1_mm: float
    reversed_mm: float
    left_peak_mm: float
    right_peak_mm: float
    spread: Spread
    floors: list[FloorGap]
    edges: list[EdgeGap]
    rules: list[Answer]
    published: dict[str, Any] | None
    warnings: list[str]

    def __repr__(self) -> str:
        pair = f"{self.left!r} beside {self.right!r}, floor {self.floor}, {self.record}"
        least, most = f"{self.spread.low_mm:.2f}", f"{self.spread.high_mm:.2f}"
        return (
            f"GapAnswer({pair}: {self.required_gap_mm:.2f} mm, {least} to {most} mm if frequencies are off)"
        )

    def as_dict(self) -> dict[str, Any]:
        """Return all fields, those of the parts too, as `pounding gap --json` writes them."""
        return asdict(self)
