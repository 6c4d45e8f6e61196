"""The first page of a report: the verdict in plain words, and the frames with what was found marked at its place."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from msgspec import structs

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Contact
from pounding.diagnosis.decision.claims import Claim, Parameter, Place, claim
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.report.frame_sketch import frame_sketch
from pounding.diagnosis.report.plain_words import description, finding, headline, size
from pounding.experiments.pictures.palette import ORANGE
from tests.diagnosis.report.test_report import of_modal_data, of_runs

PLAIN = [kind for kind in kinds() if not kind.rival and kind.described is not None]


def found(effect: str, name: str, value: float | str, std: float | None, unit: str, **place: object) -> Claim:
    where = structs.replace(Place(effect=effect), **place)
    return claim(where, [Parameter(name=name, value=value, std=std, unit=unit)], 50.0)


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        (
            found("stiffness_change", "relative_change", -0.304, 0.021, "1", frame="5A", storey=2),
            "storey 2 of 5A is 30 ± 2 % softer than the model",
        ),
        (
            found("coulomb_friction", "friction_force", 0.532, 0.041, "N", frame="5A", storey=3),
            "friction of 0.53 ± 0.04 N in storey 3 of 5A",
        ),
        (
            found("sensor_delay", "delay", 4.0, None, "ms", channel="a1, a2"),
            "channels a1, a2 read 4 ms late",
        ),
        (
            found("contact_law", "law", "hertz", None, "-", contact=1),
            "contact law in contact 1 (law hertz)",
        ),
    ],
)
def test_a_finding_is_said_in_plain_words(effect: Claim, said: str) -> None:
    assert finding(effect) == said


def test_the_headline_says_what_the_verdict_is() -> None:
    report = of_runs()
    assert headline(report) == (
        "Friction of 12.1 ± 0.4 N in storey 3 of 5B, or something else that this data cannot tell from it."
    )
    assert "nothing is missing" in headline(structs.replace(report, verdict="nothing_missing", effects=()))
    assert "not in the catalogue" in headline(structs.replace(report, verdict="unknown_effect"))
    # What has no words of its own is named with its number.
    assert headline(of_modal_data()).startswith("A part of 5B, only in the free vibration yields at")


@pytest.mark.parametrize("kind", PLAIN, ids=lambda kind: kind.__name__)
def test_every_effect_has_plain_words_for_both_signs(kind: type) -> None:
    described = description(kind.name)
    assert described is not None
    for value in (-0.5, 0.5):
        one = found(
            kind.name, kind.quantities[0].name, value, 0.1, kind.quantities[0].unit, frame="5A", storey=1
        )
        said = finding(one)
        assert "{" not in said
        assert said != one.sized()


def test_a_share_is_said_in_per_cent_and_a_factor_as_it_is() -> None:
    assert size(Parameter(name="final_relative_change", value=-0.2, std=0.01, unit="1")) == "20 ± 1 %"
    assert size(Parameter(name="damping_factor", value=1.8, std=0.1, unit="1")) == "1.8 ± 0.1"


@pytest.mark.parametrize(
    ("value", "std", "unit", "said"),
    [
        (3.47e8, 2.7e6, "N/m^3", "(3.47 ± 0.03)·10⁸ N/m³"),
        (-3.34, 0.99, "ms", "3 ± 1 ms"),
        (1234.5, 31.0, "N s^2/m^2", "1230 ± 30 N s²/m²"),
        (4.2e-5, None, "rad s^2/m", "4.2·10⁻⁵ rad s²/m"),
        (0.5, float("nan"), "kg", "0.5 kg"),
        (0.02, 0.3, "kg", "0.0 ± 0.3 kg"),
    ],
)
def test_a_size_has_the_digits_that_its_error_leaves(
    value: float, std: float | None, unit: str, said: str
) -> None:
    assert size(Parameter(name="friction_force", value=value, std=std, unit=unit)) == said


CASE = Case(
    "pair",
    Path("pair"),
    (CaseFrame("15B", 15), CaseFrame("5<B", 5)),
    (),
    (Channel("a3", "absolute_acceleration", "m/s^2", frame="5<B", floor=3),),
    (Contact("15B", "5<B", 5, 0.008, "linear", 1e6),),
)


def marked(*effects: Claim) -> list[str]:
    """Return the tags of what is orange in the sketch."""
    drawing = ElementTree.fromstring(frame_sketch(CASE, effects, [("5<B", 3)]))
    tags = [one.tag.rpartition("}")[2] for one in drawing if ORANGE in one.attrib.values()]
    assert len([one for one in drawing if one.tag.endswith("circle")]) >= 1
    return tags


def test_what_was_found_is_marked_at_its_place() -> None:
    def at(effect: str, **place: object) -> Claim:
        return found(effect, "relative_change", 0.1, 0.01, "1", **place)

    assert marked() == []
    assert marked(at("stiffness_change", frame="15B", storey=4)) == ["line", "line", "text"]
    assert marked(at("added_mass", frame="5<B", floor=2)) == ["line", "text"]
    assert marked(at("sensor_gain", channel="a3")) == ["circle"]
    assert marked(at("table_gain")) == ["line"]
    assert marked(at("contact_law", contact=1)) == ["line"]
    assert marked(at("all_stiffness_change", frame="5<B")) == ["line"] * 10
    assert marked(at("joint_flexibility", frame="5<B")) == ["circle"] * 10
    assert marked(at("air_drag", frame="5<B")) == ["line"] * 5
