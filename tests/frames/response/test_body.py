import exudyn
import numpy as np
import pytest
from exudyn import itemInterface as items

from pounding.frames.errors import FrameError
from pounding.frames.response import exact
from pounding.frames.response.body import FrameBody, Table, longest_step, settings, solve

STEP = 0.02 / np.sqrt(30)


@pytest.fixture
def mbs():
    container = exudyn.SystemContainer()
    yield container.AddSystem()
    container.Reset()


def shaking(samples=300):
    """Noise under an envelope, starting with a jump: harder than any record."""
    history = 5.0 * np.random.default_rng(3).normal(size=samples) * np.hanning(samples)
    history[0] = 2.0
    return history


def error(reduced, history, displacement):
    expected, _ = exact.linear_response(reduced, history, STEP)
    return (np.abs(displacement - expected).max(axis=0) / np.abs(expected).max(axis=0)).max()


@pytest.mark.parametrize("per_sample", [1, 3])
def test_every_displacement_within_a_thousandth_of_the_exact_solution(mbs, shear_building, per_sample):
    reduced = shear_building(storeys=5)
    table = Table(mbs, shaking(), STEP)
    body = FrameBody(mbs, reduced, table)
    solve(mbs, settings(table, longest_step([reduced]), stored_per_sample=per_sample))
    history = body.history()
    np.testing.assert_allclose(history.time_s, np.arange(299 * per_sample + 1) * STEP / per_sample, atol=1e-9)
    assert error(reduced, shaking(), history.displacement[::per_sample]) < 1e-3


def test_velocity_and_acceleration_are_those_of_the_exact_solution(mbs, shear_building):
    reduced = shear_building()
    table = Table(mbs, shaking(), STEP)
    body = FrameBody(mbs, reduced, table)
    solve(mbs, settings(table, 1e-4))
    history = body.history()
    displacement, velocity = exact.linear_response(reduced, shaking(), STEP)
    total = exact.absolute_acceleration(reduced, displacement, velocity)
    engine = history.acceleration + table.acceleration(history.time_s)[:, None] * reduced.influence
    np.testing.assert_allclose(history.velocity, velocity, atol=1e-4 * np.abs(velocity).max())
    np.testing.assert_allclose(engine, total, atol=1e-4 * np.abs(total).max())


def test_two_frames_on_one_table_do_not_feel_each_other(mbs, shear_building):
    light, heavy = shear_building(storeys=2), shear_building(storeys=3, mass_kg=60.0)
    table = Table(mbs, shaking(), STEP)
    bodies = [FrameBody(mbs, reduced, table) for reduced in (light, heavy)]
    solve(mbs, settings(table, 2e-4))
    for reduced, body in zip((light, heavy), bodies, strict=True):
        assert error(reduced, shaking(), body.history().displacement) < 1e-4


def test_a_marker_holds_a_spring_between_two_floors(mbs, shear_building):
    # A spring so stiff that the two equal roofs move together, while one frame alone is twice as stiff.
    soft, stiff = shear_building(storeys=1), shear_building(storeys=1, stiffness=40e3)
    table = Table(mbs, shaking(), STEP)
    left, right = FrameBody(mbs, soft, table), FrameBody(mbs, stiff, table)
    mbs.AddObject(
        items.ObjectConnectorCoordinateSpringDamper(
            markerNumbers=[left.marker(1), right.marker(1)], stiffness=1e8
        )
    )
    solve(mbs, settings(table, 5e-5))
    apart = left.history().displacement - right.history().displacement
    assert np.abs(apart).max() < 1e-2 * np.abs(left.history().displacement).max()
    together = shear_building(storeys=1, mass_kg=13.0, stiffness=60e3, damping=soft.damping + stiff.damping)
    expected, _ = exact.linear_response(together, shaking(), STEP)
    np.testing.assert_allclose(left.history().displacement, expected, atol=1e-2 * np.abs(expected).max())


def test_a_point_off_the_middle_becomes_a_coordinate(mbs, shear_building):
    # The second coordinate of this little frame stands for a rotation of its only floor.
    reduced = shear_building(storeys=2)
    reduced.storeys, reduced.floor_x = 1, np.array([0])
    reduced.point_row = lambda floor, y_m: np.array([1.0, -y_m])
    table = Table(mbs, shaking(), STEP)
    body = FrameBody(mbs, reduced, table, points=[(1, 0.2)])
    middle, edge = body.marker(1), body.marker(1, 0.2)
    assert middle != edge
    sensor = mbs.AddSensor(
        items.SensorMarker(
            markerNumber=edge, outputVariableType=exudyn.OutputVariableType.Coordinates, storeInternal=True
        )
    )
    solve(mbs, settings(table, 1e-4))
    history = body.history()
    assert error(reduced, shaking(), history.displacement) < 1e-4
    row = history.displacement @ reduced.point_row(1, 0.2)
    np.testing.assert_allclose(mbs.GetSensorStoredData(sensor)[:, 1], row, atol=1e-12)


def test_places_that_do_not_exist_are_named(mbs, shear_building):
    reduced = shear_building(storeys=2)
    reduced.point_row = lambda floor, y_m: np.eye(2)[floor - 1]
    table = Table(mbs, shaking(), STEP)
    body = FrameBody(mbs, reduced, table)
    with pytest.raises(FrameError, match="floors 1 to 2"):
        body.marker(3)
    with pytest.raises(FrameError, match="not among the points"):
        body.marker(1, 0.1)
    with pytest.raises(FrameError, match=r"cannot move at y = 0\.1"):
        FrameBody(mbs, reduced, table, points=[(1, 0.1)])


def test_a_step_that_is_too_long_is_told(mbs, shear_building):
    reduced = shear_building(storeys=2, stiffness=200e6)
    assert longest_step([reduced]) < 5e-4
    table = Table(mbs, shaking(2000), STEP)
    body = FrameBody(mbs, reduced, table)

    def run():
        solve(mbs, settings(table, STEP))
        body.history()

    with pytest.raises(FrameError, match="shorter step"):
        run()


@pytest.mark.parametrize(("samples", "words"), [([1.0], "two samples"), ([0.0, np.nan], "sample 1 is nan")])
def test_a_table_refuses_what_it_cannot_follow(mbs, samples, words):
    with pytest.raises(FrameError, match=words):
        Table(mbs, samples, STEP)


def test_the_table_is_straight_between_samples_and_still_after_the_last(mbs):
    table = Table(mbs, [1.0, 3.0, -1.0], 0.5)
    np.testing.assert_allclose(table.acceleration([0.0, 0.25, 0.75, 1.0, 1.5]), [1.0, 2.0, 1.0, -1.0, 0.0])
    load = table._load
    np.testing.assert_allclose(
        [load(None, t, 0.0) / 1e9 for t in (0.0, 0.25, 0.75, 1.0, 1.5)], [1, 2, 1, -1, 0]
    )


def test_a_run_may_go_on_after_the_record(mbs, shear_building):
    reduced = shear_building()
    table = Table(mbs, shaking(), STEP)
    body = FrameBody(mbs, reduced, table)
    solve(mbs, settings(table, 2e-4, duration_s=table.duration_s + 20 * STEP))
    padded = np.r_[shaking(), np.zeros(20)]
    assert body.history().time_s[-1] == pytest.approx(table.duration_s + 20 * STEP)
    # hanning ends at zero, so the padded history is the same as the table's.
    assert error(reduced, padded, body.history().displacement) < 1e-4
