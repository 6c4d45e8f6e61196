"""What is told of floors that turn about the vertical."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any


def turning_sentence(name: str, peaks: Sequence[dict[str, Any]]) -> Iterable[str]:
    """Say how far the edges of a frame's roof move, which floors that turn move further than their middle.

    Args:
        name: Name of the frame.
        peaks: What `FrameMotion.peaks` gives; nothing is said of floors that do not turn.
    """
    roof = peaks[-1]
    if "edge_mm" in roof:
        middle = max(roof["max_mm"], roof["min_mm"])
        yield (
            f"{name} turns: an end of its roof's edge moves by up to {roof['edge_mm']:.1f} mm along the shaking, the middle "
            f"by {middle:.1f} mm; the roof turns by up to {roof['rotation_mrad']:.2f} mrad"
        )
