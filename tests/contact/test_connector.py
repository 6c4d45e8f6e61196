"""A law inside exudyn: the same force as the plain function, and free bodies that collide there."""

from __future__ import annotations

from typing import Any

import exudyn
import numpy as np
import pytest
from exudyn import itemInterface as items

from pounding.contact import ContactError, Law, collide
from pounding.contact.connector import ContactConnector, PointContact, checked_gap, force_function

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


@pytest.mark.parametrize("how", [{}, {"stepped": True}, {"record": False}], ids=str)
def test_force_equals_the_plain_function(law: Law, how: dict[str, bool]) -> None:
    """Over random deformations and rates, with and without tension, recorded or called, to 1e-12."""
    draw = np.random.default_rng(20240607)
    for _ in range(40):
        deformation, rate = draw.uniform(-1e-3, 3e-3), draw.uniform(-2.0, 2.0)
        container, mbs, _, markers = two_masses((1.0, 1.0), (deformation + GAP, 0.0), (rate, 0.0))
        contact = ContactConnector(mbs, law, GAP, *markers, **how)
        mbs.Assemble()
        if contact.latch:
            contact.latch(mbs)
        # The engine subtracts the gap from the coordinates, which rounds: so does the plain function.
        expected = float(law.force((deformation + GAP) - GAP, rate, max(rate, 0.0)))
        found = float(mbs.GetObjectOutput(contact.item, FORCE))
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)
        del container


def test_laws_are_recorded_where_they_can_be(law: Law) -> None:
    container, mbs, _, markers = two_masses((1.0, 1.0), (0.0, 0.0), (0.0, 0.0))
    assert ContactConnector(mbs, law, GAP, *markers).recorded is (law.name != "hertz_damp")
    stepped = ContactConnector(mbs, law, GAP, *markers, stepped=True)
    assert stepped.recorded
    assert (stepped.latch is not None) is (law.name == "hertz_damp")
    del container


@pytest.mark.parametrize("ratio", [1.0, 100.0])
@pytest.mark.parametrize("way", ["connector", "stepped", "points"])
def test_free_bodies_collide_in_the_engine(law: Law, ratio: float, way: str) -> None:
    """Momentum to 1e-9, and the same velocities as the collision integrated by scipy."""
    masses, speed = (6.2, 6.2 / ratio), 0.3
    container, mbs, nodes, markers = two_masses(masses, (0.0, 0.0), (speed, 0.0))
    if way == "points":
        kept: Any = PointContact(mbs, law, GAP, (nodes[0], np.ones(1)), (nodes[1], np.ones(1)))
    else:
        kept = ContactConnector(mbs, law, GAP, *markers, stepped=way == "stepped")
    latch = kept.latch
    if latch is not None:
        mbs.SetPreStepUserFunction(lambda system, _t: latch(system) or True)
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


def test_a_latch_gives_a_recorded_law_its_velocity_at_first_touch(law_with: Any) -> None:
    """On the straight line between the last moment apart and the first in touch, once a touch."""
    law = law_with("hertz_damp")
    container, mbs, _, markers = two_masses((1.0, 1.0), (GAP, 0.0), (0.0, 0.0))
    contact = ContactConnector(mbs, law, GAP, *markers, stepped=True)
    mbs.Assemble()

    def force(deformation: float, rate: float) -> float:
        mbs.systemData.SetODE2Coordinates([deformation + GAP, 0.0])
        mbs.systemData.SetODE2Coordinates_t([rate, 0.0])
        assert contact.latch is not None
        contact.latch(mbs)
        return float(mbs.GetObjectOutput(contact.item, FORCE))

    def plain(deformation: float, rate: float, approach: float) -> float:
        return float(law.force((deformation + GAP) - GAP, rate, approach))

    force(-1.0, 0.5)
    force(-1e-4, 0.3)
    assert force(1e-4, 0.31) == pytest.approx(plain(1e-4, 0.31, 0.305), rel=1e-9)
    assert force(2e-4, -0.1) == pytest.approx(plain(2e-4, -0.1, 0.305), rel=1e-9)
    force(-1e-4, -0.2)
    force(-1e-4, 0.1)
    assert force(1e-4, 0.1) == pytest.approx(plain(1e-4, 0.1, 0.1), rel=1e-9)
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
