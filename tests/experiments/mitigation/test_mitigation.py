"""Measures against pounding: what links and walls do to a row, and the search for a setting."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding.contact.parameters import thesis_law
from pounding.contact.rubber import RubberBlock
from pounding.experiments.errors import ExperimentError
from pounding.experiments.mitigation.measures import NAMES, measures
from pounding.experiments.mitigation.response import response, worst
from pounding.experiments.mitigation.search import compare, cost, possible
from pounding.experiments.mitigation.standing import Hit, Link, Standing, joined
from pounding.experiments.records import find
from pounding.experiments.rig.column_hits import Columns, borne, place_of, softened
from pounding.experiments.rig.contact_checks import contact_warnings
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.street import bumped
from pounding.frames import StickFrame, build
from pounding.frames.definition import Yielding
from tests.experiments.rig.models import shear, two_sines

RECORD = two_sines(1.2)


def street(gap_m: float = 0.002) -> Standing:
    law = thesis_law("linear_viscoelastic", "printed", masses=(6.0, 6.0))
    return Standing((shear(2, 3.0), shear(3, 6.4)), (Contact(law, gap_m, 2, 0),))


def test_as_it_is_the_response_is_that_of_the_rig() -> None:
    stand = street()
    found = response(stand, RECORD)
    motion = Rig(stand.frames, stand.contacts).run(RECORD, solver="exact")
    assert found.touches > 2
    assert found.peak_force_n == pytest.approx(motion.contacts[0].sampled()[1].max(), rel=0.02)
    apart = Rig(stand.frames).run(RECORD, solver="exact")
    left, right = (frame.displacement_m[:, frame.floor(2)] for frame in apart.frames)
    assert found.required_gap_mm[0] == pytest.approx(1e3 * (left - right).max())


def test_a_link_of_no_stiffness_changes_nothing() -> None:
    plain = response(street(), RECORD)
    linked = response(dataclasses.replace(street(), links=(Link(0, (2, 2), 0.0, 0.0),)), RECORD)
    assert linked.drift == pytest.approx(plain.drift, rel=1e-3)
    assert linked.acceleration_g == pytest.approx(plain.acceleration_g, rel=2e-2)
    assert linked.required_gap_mm == pytest.approx(plain.required_gap_mm, rel=1e-6)


def test_a_hard_link_makes_two_buildings_one() -> None:
    """Its first frequency is that of the two chains coupled by a constraint."""
    stand = street()
    (hard,) = (one for one in measures(stand, [1.0]) if one.name == "hard-links")
    body, _ = joined(hard.apply(()))
    mass = np.diag([6.0] * 5)
    springs = joined(stand)[0].stiffness
    tie = np.delete(np.eye(5), 3, axis=1)
    tie[3, 1] = 1.0  # the right building's second floor moves as the left one's roof
    squares = np.linalg.eigvals(np.linalg.solve(tie.T @ mass @ tie, tie.T @ springs @ tie))
    assert body.frequencies_hz[0] == pytest.approx(np.sqrt(min(squares.real)) / (2 * np.pi), rel=2e-3)


def test_walls_have_their_share_of_the_stiffness_in_the_first_mode() -> None:
    stand = street()
    (walls,) = (one for one in measures(stand, [1.0]) if one.name == "walls")
    for before, after in zip(stand.frames, walls.apply([1.0]).frames, strict=True):
        sway = before.shapes[:, 0]
        assert sway @ after.stiffness @ sway == pytest.approx(2.0 * sway @ before.stiffness @ sway)
        # Rayleigh: in its own shape the frame with the wall is softer than in the old one.
        assert 1.0 < (after.frequencies_hz[0] / before.frequencies_hz[0]) ** 2 <= 2.0


def test_a_widened_gap_is_just_wide_enough() -> None:
    needed = response(street(), RECORD).required_gap_mm
    (wider,) = (one for one in measures(street(), needed) if one.name == "wider-gap")
    assert response(wider.apply([wider.settings[0].high]), RECORD).touches == 0
    assert response(wider.apply([0.9]), RECORD).touches > 0


def test_each_measure_is_no_worse_than_its_other_settings_and_bumpers_are_not_flat() -> None:
    answers = compare(street(), [RECORD], evaluations=7)
    assert [answer.measure.name for answer in answers] == ["none", *possible(street())]
    assert set(NAMES) - set(possible(street())) == {"collision-walls"}
    for answer in answers:
        costs = [cost(one.response, "acceleration") for one in answer.tried]
        assert cost(answer.best.response, "acceleration") == min(costs)
        assert all(0.0 <= share <= 1.0 for one in answer.tried for share in one.shares)
    by_name = {answer.measure.name: answer.best.response for answer in answers}
    assert by_name["dampers"].acceleration_g < by_name["none"].acceleration_g
    assert by_name["bumpers"].compression <= 0.8
    assert by_name["bumpers"].peak_force_n < by_name["none"].peak_force_n


def test_a_bumper_is_warned_of_when_it_is_flat_and_not_for_being_soft() -> None:
    stand = street()
    for area_m2, sentences in ((1e-3, 0), (1e-6, 1)):
        contact = bumped(stand.contacts[0], RubberBlock.of(area_m2, 0.0015))
        warnings = contact_warnings(Rig(stand.frames, [contact]).run(RECORD, solver="exact"))
        assert len(warnings) == sentences
        assert all("counts as flat" in sentence for sentence in warnings)


def hit_columns() -> Standing:
    """Return a low frame whose roof hits the columns of the second storey of a higher one."""
    stand = street()
    frames = (stand.frames[0], dataclasses.replace(stand.frames[1], heights_m=np.array([0.13, 0.26, 0.39])))
    place, columns = place_of(*frames, None), Columns(4, 0.02, 0.03, 200.0)
    law = softened(stand.contacts[0].law, place, columns)
    return Standing(frames, (Contact(law, 0.002, place.floors, 0),), hits=(Hit(0, place, columns),))


def test_columns_that_are_hit_bear_what_pound_says_and_behind_a_wall_their_drift_alone() -> None:
    stand = hit_columns()
    (hit,) = stand.hits
    found = response(stand, RECORD)
    motion = Rig(stand.frames, stand.contacts).run(RECORD, solver="exact")
    expected = borne(motion, stand.contacts[0], hit.place, hit.columns, 0)
    assert (found.column_shear_kn, found.column_moment_kn_m) == (
        pytest.approx(expected["shear_kn"]),
        pytest.approx(expected["moment_kn_m"]),
    )
    assert found.touches > 2
    (walls,) = (one for one in measures(stand, [1.0]) if one.name == "collision-walls")
    behind = walls.apply(())
    assert behind.contacts[0].law.stiffness == pytest.approx(street().contacts[0].law.stiffness)
    assert behind.contacts[0].law.damping == pytest.approx(street().contacts[0].law.damping)
    motion = Rig(behind.frames, behind.contacts).run(RECORD, solver="exact")
    drift = borne(motion, behind.contacts[0], hit.place, hit.columns, 0)["shear_of_drift_kn"]
    assert response(behind, RECORD).column_shear_kn == pytest.approx(drift)


def test_links_where_a_floor_hits_columns_and_walls_where_none_does_are_refused() -> None:
    for stand, name, why in (
        (hit_columns(), "links", "floors hit columns"),
        (street(), "collision-walls", "no gap states columns"),
    ):
        with pytest.raises(ExperimentError, match=f"measure {name}: {why}"):
            compare(stand, [RECORD], names=[name])
    answers = compare(hit_columns(), [RECORD], evaluations=3)
    assert [answer.measure.name for answer in answers] == ["none", *possible(hit_columns())]


def test_links_beside_contacts_off_the_middle_are_refused_before_any_run() -> None:
    stand = street()
    contact = dataclasses.replace(stand.contacts[0], y_m=0.1)
    twisted = dataclasses.replace(stand, contacts=(contact,))
    with pytest.raises(
        ExperimentError, match=r"name the other measures .wider-gap, bumpers, damping, walls. by"
    ):
        compare(twisted, [RECORD])


def test_where_nothing_touches_nothing_is_tried() -> None:
    answers = compare(street(gap_m=1.0), [RECORD])
    assert [answer.measure.name for answer in answers] == ["none"]


def test_floors_that_lie_against_each_other_are_refused() -> None:
    with pytest.raises(ExperimentError, match="leave no room for a measure between them"):
        compare(street(gap_m=0.0), [RECORD])


def test_no_second_block_is_put_into_a_gap() -> None:
    stand = street()
    contact = bumped(stand.contacts[0], RubberBlock.of(1e-3, 0.0015))
    with_block = dataclasses.replace(stand, contacts=(contact,))
    assert "bumpers" not in [one.name for one in measures(with_block, [1.0])]


def test_of_several_records_the_worst_counts() -> None:
    quiet, loud = (response(street(), one) for one in (RECORD, RECORD.flipped()))
    both = worst([quiet, loud])
    assert both.drift == max(quiet.drift, loud.drift)
    assert both.required_gap_mm[0] == max(quiet.required_gap_mm[0], loud.required_gap_mm[0])


def test_events_closer_than_the_clock_tells_leave_no_step_of_no_length() -> None:
    """Found by a search: with these walls a floor parts and touches at one moment, and the run could not be read."""
    law = thesis_law("linear_viscoelastic", "printed", masses=(250e3, 250e3))
    law = dataclasses.replace(law, stiffness=3.75e9, damping=6233282.046861561)
    flats = build(
        StickFrame(
            name="flats",
            storeys=6,
            storey_height_m=[4.0, 3.2, 3.2, 3.2, 3.2, 3.2],
            floor_mass_kg=[340e3, 320e3, 320e3, 320e3, 320e3, 270e3],
            frequency_hz=[0.7, 2.0],
            damping_ratio=0.05,
        )
    )
    office = build(
        StickFrame(
            name="office",
            storeys=4,
            storey_height_m=[4.0, 3.2, 3.2, 3.2],
            floor_mass_kg=[310e3, 290e3, 290e3, 250e3],
            frequency_hz=[1.1, 3.2],
            damping_ratio=[0.03, 0.04],
        )
    )
    stand = Standing((flats, office), (Contact(law, 0.05, 4, 0),))
    (walls,) = (one for one in measures(stand, [1.0]) if one.name == "walls")
    run = Rig(walls.apply([3.0 / 11.0]).frames, stand.contacts).run(find("elcentro-chopra"), solver="exact")
    assert np.diff(run.time_s).min() > 0.0


def test_a_building_that_yields_is_refused() -> None:
    soft = build(
        StickFrame(
            name="soft",
            storeys=2,
            storey_height_m=0.1,
            floor_mass_kg=[6.0] * 2,
            frequency_hz=[3.0],
            damping_ratio=0.01,
            yielding=Yielding(storey_shear_n=10.0, hardening_ratio=0.05),
        )
    )
    stand = dataclasses.replace(street(), frames=(soft, shear(3, 6.4)))
    with pytest.raises(
        ExperimentError,
        match=r"soft is not linear, .* take 'yielding' out",
    ):
        compare(stand, [RECORD])
