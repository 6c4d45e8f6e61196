from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.contact_force.pairs import shared_floors
from pounding.diagnosis.model.storeys import StoreyFrame, Structure


def storeys(name: str, height_m: float, floors: int) -> StoreyFrame:
    chain = 1e4 * (2.0 * np.eye(floors) - np.eye(floors, k=1) - np.eye(floors, k=-1))
    return StoreyFrame(
        name=name,
        mass=6.0 * np.eye(floors),
        stiffness=chain,
        damping_ratio=np.full(floors, 0.01),
        height_m=height_m * np.arange(1, floors + 1),
    )


@pytest.mark.parametrize(
    ("height_m", "pairs"),
    [(0.10, [(0, 6), (1, 7), (2, 8), (3, 9)]), (0.15, [(2, 7), (5, 9)]), (0.23, [])],
)
def test_frames_could_touch_where_their_floors_are_level(height_m, pairs) -> None:
    structure = Structure((storeys("left", 0.10, 6), storeys("right", height_m, 4)))
    assert shared_floors(structure, 0, 1) == pairs
