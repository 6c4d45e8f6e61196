"""A law inside exudyn: the same force as the plain function, and free bodies that collide there."""

from __future__ import annotations

from typing import Any

import exudyn
import numpy as np
import pytest
from exudyn import itemInterface as items

from contact import ContactError, Law, collide
from contact.connector import ContactConnector, PointContact, checked_gap, force_function

GAP = 1e-4
FORCE = exudyn.OutputVariableType.Force


def two_masses(
    masses: tuple[float, float], places: tuple[float, float], speeds: tuple[float, float]
) -> tuple[Any, Any, list[int], list[int]]:
    container = exudyn.SystemContainer()
    mbs = container.AddSystem()
    nodes = []
    for mass, place, speed in zip(masses, places, speeds, strict=True):
        node = mbs.AddNode(
            items.Node1D(referenceCoordinates=[0.0], initialCoordinates=[place], initialVelocities=[speed])
        )
        mbs.AddObject(items.ObjectMass1D(mass=mass, nodeNumber=node))
        nodes.append(node)
    markers = [mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)) for node in nodes]
    return container, mbs, nodes, markers


@pytest.mark.parametrize("record", [True, False])
def test_force_equals_the_plain_function(law: Law, record: bool) -> None:
    """Over random deformations and rates, with and without tension, to 1e-12."""
    draw = np.random.default_rng(20240607)
    for _ in range(40):
        deformation, rate = draw.uniform(-1e-3, 3e-3), draw.uniform(-2.0, 2.0)
        container, mbs, _, markers = two_masses((1.0, 1.0), (deformation + GAP, 0.0), (rate, 0.0))
        contact = ContactConnector(mbs, law, GAP, *markers, record=record)
        mbs.Assemble()
        # The engine subtracts the gap from the coordinates, which rounds: so does the plain function.
        expected = float(law.force((deformation + GAP) - GAP, rate, max(rate, 0.0)))
        found = float(mbs.GetObjectOutput(contact.item, FORCE))
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)
        del container


def test_laws_are_recorded_where_they_can_be(law: Law) -> None:
    container, mbs, _, markers = two_masses((1.0, 1.0), (0.0, 0.0), (0.0, 0.0))
    assert ContactConnector(mbs, law, GAP, *markers).recorded is (law.name != "hertz_damp")
    del container


@pytest.mark.parametrize("ratio", [1.0, 100.0])
@pytest.mark.parametrize("points", [False, True])
def test_free_bodies_collide_in_the_engine(law: Law, ratio: float, points: bool) -> None:
    """Momentum to 1e-9, and the same velocities as the collision integrated by scipy."""
    masses, speed = (6.2, 6.2 / ratio), 0.3
    container, mbs, nodes, markers = two_masses(masses, (0.0, 0.0), (speed, 0.0))
    if points:
        kept: Any = PointContact(mbs, law, GAP, (nodes[0], np.ones(1)), (nodes[1], np.ones(1)))
    else:
        kept = ContactConnector(mbs, law, GAP, *markers)
    mbs.Assemble()
    chosen = exudyn.SimulationSettings()
    chosen.timeIntegration.endTime = 5e-3
    chosen.timeIntegration.numberOfSteps = 100
    chosen.timeIntegration.minimumStepSize = 1e-13
    chosen.timeIntegration.relativeTolerance = 1e-8
    chosen.timeIntegration.absoluteTolerance = 1e-10
    chosen.solution.file.write = False
    exudyn.config.suppressWarnings = True
    mbs.SolveDynamic(chosen, solverType=exudyn.DynamicSolverType.DOPRI5)
    after = [float(mbs.GetNodeOutput(node, exudyn.OutputVariableType.Coordinates_t)) for node in nodes]
    expected = collide(law, *masses, speed)
    assert np.dot(masses, after) == pytest.approx(masses[0] * speed, rel=1e-9)
    np.testing.assert_allclose(after, expected.after_m_s, atol=2e-5 * speed)
    assert kept.law is law
    del container


def test_the_latch_survives_a_step_that_is_taken_back(law_with: Any) -> None:
    law = law_with("hertz_damp")
    force = force_function(law)
    force(-1e-4, 0.3)
    far = force(1e-4, 0.31)  # a long step, which the engine then refuses
    force(-0.5e-4, 0.3)
    assert force(1e-4, 0.31) == pytest.approx(far, rel=0.02)


def test_the_latch_keeps_its_touch_on_the_way_out(law_with: Any) -> None:
    """A stage of the integrator that sees the floors already apart is no new touch at a negative speed."""
    law = law_with("hertz_damp")
    force = force_function(law)
    force(-1e-5, 0.3)
    force(1e-5, 0.3)
    parting = force(1e-5, -0.2)
    force(-1e-6, -0.2)
    assert force(1e-5, -0.2) == parting


@pytest.mark.parametrize("gap", [-1e-3, float("nan"), float("inf")])
def test_overlapping_bodies_are_refused(gap: float) -> None:
    with pytest.raises(ContactError, match="overlap"):
        checked_gap(gap)
