"""The engine's own flexible body and ours, from one mesh."""

import numpy as np
import pytest

from pounding import frames
from pounding.experiments.records.record import Record
from pounding.experiments.studies import engine_body
from pounding.frames.fe.assembly import Options, assemble
from pounding.frames.fe.mesh import Density
from pounding.frames.reduction.translations import without_rotations

COARSE = Density(floor_m=0.2, along=3)


@pytest.mark.slow
def test_the_engines_own_flexible_body_has_the_frequencies_and_peaks_of_ours():
    times = np.arange(400) * 0.005
    sweep = Record("sweep", 3.0 * np.sin(2 * np.pi * (2.0 + 8.0 * times) * times), 0.005)
    found = engine_body.compare(frames.load("5B"), sweep, COARSE)
    rows = found["frequencies"] + found["peaks_mm"]
    assert len(rows) == 10
    assert max(abs(row["difference"]) for row in rows) < engine_body.WANTED


def test_condensed_rotations_keep_the_static_stiffness_and_the_mass():
    frame = frames.load("5B")
    model = assemble(frame, Options(rigid_floors=False, density=COARSE))
    condensed = without_rotations(model)
    free = np.setdiff1d(np.arange(len(condensed.nodes)), condensed.base)
    push = np.zeros(3 * len(free))
    push[3 * condensed.floor[-1]] = 1.0
    pushed = np.linalg.solve(condensed.stiffness.toarray()[: len(push), : len(push)], push)
    ours = frames.build(frame, rigid_floors=False, density=COARSE, use_cache=False)
    assert 1.0 / pushed[3 * condensed.floor[-1]] == pytest.approx(ours.roof_stiffness_n_per_m, rel=1e-6)
    # Less what stands on the base: half of a column's lowest strips.
    assert condensed.mass.diagonal()[: len(push) : 3].sum() == pytest.approx(frame.moving_mass_kg, rel=2e-3)


def test_a_mesh_too_fine_or_rigid_floors_are_refused():
    frame = frames.load("5B")
    with pytest.raises(frames.FrameError, match="take a coarser mesh"):
        without_rotations(
            assemble(frame, Options(rigid_floors=False, density=Density(floor_m=0.01, along=8)))
        )
    with pytest.raises(frames.FrameError, match="floors that can stretch"):
        without_rotations(assemble(frame, Options(density=COARSE)))
