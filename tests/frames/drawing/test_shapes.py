import meshio
import numpy as np
import pytest

from pounding import frames
from pounding.frames.drawing import vtk
from pounding.frames.drawing.shapes import shape_of
from pounding.frames.errors import FrameError


@pytest.fixture(scope="module")
def plate():
    return frames.build(frames.load("5A"))


@pytest.fixture(scope="module")
def stick():
    frame = frames.StickFrame(
        name="s",
        storeys=2,
        storey_height_m=0.2,
        floor_mass_kg=[5.0, 5.0],
        damping_ratio=0.01,
        frequency_hz=[2.0],
    )
    return frames.build(frame)


@pytest.mark.parametrize("which", ["plate", "stick"])
def test_drawn_floors_follow_their_coordinates(which, request):
    reduced = request.getfixturevalue(which)
    shape = shape_of(reduced)
    q = np.zeros(len(reduced.mass))
    q[reduced.floor_x] = np.arange(1.0, reduced.storeys + 1)
    moved = shape.moved(q)
    for floor in range(1, reduced.storeys + 1):
        corners = shape.quads[(shape.level == floor) & ~shape.is_column]
        np.testing.assert_allclose(moved[np.unique(corners), 0], float(floor), rtol=1e-6)


def test_a_sticks_columns_end_on_its_floors(stick):
    shape = shape_of(stick)
    moved = shape.moved(np.array([1.0, 3.0]))[:, 0]
    ends = np.isclose(shape.nodes[:, 2] % 0.2, 0.0) | np.isclose(shape.nodes[:, 2] % 0.2, 0.2)
    for height, expected in ((0.0, 0.0), (0.2, 1.0), (0.4, 3.0)):
        np.testing.assert_allclose(moved[ends & np.isclose(shape.nodes[:, 2], height)], expected, atol=1e-12)


def test_outline_of_a_sheet_is_its_border(stick):
    # 10 plates of 4 edges; 8 strips of 8 pieces have 2 * 8 + 2 edges each.
    assert len(shape_of(stick).outline) == 2 * 4 + 8 * (2 * 8 + 2)


def test_vtk_files_read_back(plate, tmp_path):
    vtk.write_mesh(plate, tmp_path / "mesh.vtu")
    vtk.write_modes(plate, tmp_path / "modes.vtu")
    q = 0.01 * plate.shapes[:, 0]
    stress = np.linspace(0.0, 1e8, len(plate.mesh.quads))
    vtk.write_deformed(plate, q, tmp_path / "deformed.vtu", stress_pa=stress)
    mesh = meshio.read(tmp_path / "mesh.vtu")
    np.testing.assert_allclose(mesh.points, plate.mesh.nodes)
    assert set(mesh.cell_data["part"][0]) == {1, 2, 3, 4, 5}
    modes = meshio.read(tmp_path / "modes.vtu").point_data
    assert [name.partition(",")[0] for name in modes] == ["mode 1", "mode 2", "mode 3"]
    assert all(np.linalg.norm(field, axis=1).max() == pytest.approx(1.0) for field in modes.values())
    deformed = meshio.read(tmp_path / "deformed.vtu")
    np.testing.assert_allclose(deformed.point_data["displacement [m]"], plate.expand(q))
    np.testing.assert_allclose(deformed.cell_data["von Mises stress [Pa]"][0], stress)


def test_a_folder_that_cannot_be_written_is_told(plate, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FrameError, match=r"mesh\.vtu: cannot be written"):
        vtk.write_mesh(plate, tmp_path / "file" / "mesh.vtu")
