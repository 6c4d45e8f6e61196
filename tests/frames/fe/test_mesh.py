import numpy as np
import pytest

from pounding import frames
from pounding.frames.errors import FrameError
from pounding.frames.fe.mesh import Density, build_mesh
from pounding.frames.fe.shells import Sections, assemble


def test_two_elements_or_more_across_a_column():
    mesh = build_mesh(frames.load("5A"))
    strip = mesh.quads[mesh.is_column & (mesh.level == 1)]
    sides = np.ptp(mesh.nodes[strip], axis=1)
    assert sides[:, 1].max() <= 0.02 + 1e-12
    with pytest.raises(FrameError, match="two elements or more across"):
        Density(0.02, 1, 6)


def test_columns_meet_floors_node_by_node():
    frame = frames.load("10")
    mesh = build_mesh(frame)
    floor, column = mesh.joints.T
    assert np.allclose(mesh.nodes[floor], mesh.nodes[column])
    # 10 storeys, 4 columns, 2 ends, 3 nodes across; each joint's shares sum to 1.
    assert len(floor) == 10 * 4 * 2 * 3
    assert mesh.joint_share.reshape(-1, 3).sum(axis=1) == pytest.approx(1.0)
    assert (mesh.node_part[floor] >= 0).all()
    assert (mesh.node_part[column] < 0).all()


def test_area_is_that_of_the_plates():
    frame = frames.load("5B")
    mesh = build_mesh(frame, Density(0.03, 3, 4))
    a, b, _, d = (mesh.nodes[mesh.quads[:, i]] for i in range(4))
    area = np.linalg.norm(np.cross(b - a, d - a), axis=1)
    assert area[~mesh.is_column].sum() == pytest.approx(5 * 0.16)
    assert area[mesh.is_column].sum() == pytest.approx(4 * 0.5 * 0.04)


@pytest.mark.parametrize("places", [[(-0.1, 0.05), (0.13, -0.11)], [(0.0, 0.18), (0.2, -0.18), (-0.2, 0.0)]])
def test_columns_may_stand_anywhere_on_the_floor(places):
    frame = frames.load("5A")
    columns = frames.Columns(width_m=0.04, thickness_m=0.002, places_m=places)
    mesh = build_mesh(frames.changed(frame, columns=columns))
    assert np.allclose(mesh.nodes[mesh.joints[:, 0]], mesh.nodes[mesh.joints[:, 1]])


def test_distorted_elements_are_refused():
    frame = frames.load("5A")
    mesh = build_mesh(frame)
    nodes = mesh.nodes.copy()
    inside = np.flatnonzero((mesh.node_part == 2) & (np.abs(nodes[:, :2]).max(axis=1) < 0.01))[0]
    nodes[inside, 0] += 0.004
    ones = np.ones(len(mesh.quads))
    sections = Sections(frame.material, 0.002 * ones, ones, 0.0 * ones)
    with pytest.raises(FrameError, match=r"is not a rectangle \(4 of"):
        assemble(nodes, mesh.quads, sections)
