"""What a report shows of a corrected model: loops beside the law's, answers to the table, the run on the frame."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from msgspec import structs

from pounding import frames
from pounding.diagnosis.case.case import Contact
from pounding.diagnosis.decision.claims import Parameter
from pounding.diagnosis.decision.conclusion import of_frames
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.design.detectability import Detectability, Sized
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Quantity
from pounding.diagnosis.inference.search import search
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.report.corrected_model import export_model
from pounding.diagnosis.report.details import detailed
from pounding.diagnosis.report.loops import bend, fullness, loops
from pounding.diagnosis.report.making import Made, report_on, shown_after
from pounding.diagnosis.report.on_the_frame import on_the_frame, write_frames
from pounding.diagnosis.report.report import Shape
from pounding.diagnosis.report.report_text import beside_the_verdict
from pounding.diagnosis.report.shape import departs, shape
from pounding.diagnosis.report.sheet import sheet
from pounding.diagnosis.report.transmissibility import answers
from pounding.diagnosis.report.writing import SOMETIMES, forget
from pounding.experiments.records import find
from pounding.experiments.rig.rig import Rig
from pounding.frames.storey_laws import Hysteresis
from tests.diagnosis.models import measured
from tests.diagnosis.report.bench import diagnosed
from tests.diagnosis.report.test_report import of_runs

ROUND = 1.5
"""Sharpness of the knee that is hidden; the catalogue's is 8."""
STOREY = 2


def drifts(model: Model) -> np.ndarray:
    """Return the largest drift of each storey [m] in the first run without any effect."""
    values = np.zeros(len(model.std))
    (states,) = model.predict(values, None, (), [0]).before
    floors = model.plain_modes(model.assemble(values)).floors
    return np.abs(states[:, : len(floors)] @ (model.structure.drift @ floors).T).max(axis=0)


def of(name: str) -> Diagnosis:
    """Return the diagnosis of runs in which storey 2 has an effect, which alone is looked for in all storeys."""
    plain = measured(samples=50, runs=1)
    (hidden,) = [one for one in candidates(plain) if one.name == name and one.storey == STOREY]
    drift = drifts(measured(runs=1))[STOREY - 1]
    stiffness = hidden.stiffness(plain)  # type: ignore[attr-defined]
    values = {
        "hysteresis": np.array([0.1 * stiffness * drift, 0.3 * stiffness, ROUND, 0.0]),
        "cubic_stiffness": np.array([0.5 * stiffness / drift**2]),
    }[name]
    model = measured([(hidden, values)], noise=0.005)
    effects = [one for one in candidates(model) if one.name == name]
    found = search(model, effects, [0], [1], lambda what, share: None)
    return diagnosed(found)


@cache
def rounded() -> Diagnosis:
    return of("hysteresis")


@cache
def made() -> Made:
    return report_on(rounded())


def test_a_rounder_loop_than_the_catalogues_is_called_so_with_its_figure() -> None:
    loop = loops(rounded())
    said = shape(rounded(), loop)
    assert said is not None
    assert (said.frame, said.storey) == ("bench", STOREY)
    assert said.statement.startswith(
        "hysteresis in storey 2 of bench; the loop is rounder than the catalogue's (sharpness"
    )
    # The law that was refined is that of the runs: the loops themselves are alike.
    assert said.statement.endswith(
        "area and bend of the measured loop are the law's within their uncertainty"
    )


def test_a_candidate_that_was_refined_has_the_size_that_is_claimed_of_it() -> None:
    said = rounded().conclusion
    assert said.candidates[0].place == said.effects[0].place
    assert said.candidates[0].parameters == said.effects[0].parameters


def test_loops_of_measurements_and_of_the_law_are_seen_through_one_smoother() -> None:
    loop = loops(rounded())
    assert loop is not None
    assert loop.storey == STOREY - 1
    for seen, law in zip(loop.measured, loop.law, strict=True):
        sizes = [np.sqrt(np.mean(one.force[:, loop.storey] ** 2)) for one in (seen, law)]
        assert sizes[1] == pytest.approx(sizes[0], rel=0.1)
        np.testing.assert_array_equal(seen.std, law.std)
        assert sizes[0] > 2 * seen.std[loop.storey]
    assert fullness(loop).measured > 0.2
    assert not fullness(loop).apart


def test_a_loop_that_is_not_the_laws_is_called_different() -> None:
    """The same storey's loops with those of a cubic spring in the place of the law's: thinner and bent otherwise."""
    loop, cubic = loops(rounded()), loops(of("cubic_stiffness"))
    assert loop is not None
    assert cubic is not None
    assert abs(fullness(cubic).measured) < 0.1
    assert bend(cubic).measured > 0.1
    other = type(loop)(loop.storey, loop.stiffness, loop.measured, cubic.law)
    assert fullness(other).apart
    assert bend(other).apart
    said = shape(rounded(), other)
    assert said is not None
    assert "the measured loop is fuller than the law's" in said.statement


@pytest.mark.parametrize(
    ("value", "std", "told"), [(3.0, 0.1, True), (3.0, 1.5, False), (7.0, 0.01, False), (40.0, 1.0, True)]
)
def test_a_shape_departs_by_its_error_and_by_its_prior(value: float, std: float, told: bool) -> None:
    assert departs(Quantity("sharpness", "1", reported=False, logarithmic=True), value, std, 8.0) is told


def test_the_answer_to_the_table_is_the_corrected_models_more_than_the_baselines() -> None:
    (one,) = answers(rounded(), made().outputs)
    assert (one.frame, one.channel, one.unit) == ("bench", "a3", "-")
    assert set(one.sizes) == {"measured", "baseline", "calibrated", "corrected"}
    off = {
        name: float(np.nanmean(np.abs(np.log(size / one.sizes["measured"]))))
        for name, size in one.sizes.items()
    }
    assert off["corrected"] < 0.5 * off["baseline"]
    assert off["corrected"] < off["calibrated"]
    (without,) = answers(rounded(), {})
    assert "corrected" not in without.sizes


def test_runs_of_another_rate_are_left_out_of_the_answers_to_the_table() -> None:
    whole = rounded()
    first, second = whole.found.model.observed.runs
    slower = replace(
        second,
        step_s=2 * second.step_s,
        time_s=second.time_s[::2],
        table=second.table[::2],
        measured=second.measured[::2],
        contact=second.contact[::2],
    )
    model = whole.found.model.seeing(replace(whole.found.model.observed, runs=(first, slower)))
    (one,) = answers(replace(whole, found=replace(whole.found, model=model)), {})
    assert one.runs == (first.name,)
    assert answers(whole, {})[0].runs == (first.name, second.name)
    # Measured and calibrated agree, which spectra of two rates added up would not.
    near = np.nanmedian(np.abs(np.log(one.sizes["calibrated"] / one.sizes["measured"])))
    assert near < 0.2


def test_the_run_on_the_frame_is_that_of_the_report() -> None:
    shown = on_the_frame(rounded(), made().motions)
    found = rounded().found
    (run,) = found.held_out
    assert shown.run == "run2"
    assert shown.after is not None
    data = found.model.observed.runs[run]
    roof = list(found.model.observed.names).index("d3")
    apart = []
    for motion in (shown.before, shown.after):
        (frame,) = motion.frames
        seen = np.interp(data.time_s, frame.time_s, frame.floor_displacement(3))
        apart.append(np.std(seen - data.measured[:, roof]) / np.std(data.measured[:, roof]))
    assert apart[1] < 0.05
    assert apart[0] > 2 * apart[1]


def test_both_series_have_the_same_stated_times_about_the_largest_difference(tmp_path: Path) -> None:
    shown = on_the_frame(rounded(), made().motions)
    write_frames(shown, tmp_path)
    times = []
    for name in ("before", "after"):
        sets = list(ElementTree.parse(tmp_path / f"{name}.pvd").getroot().iter("DataSet"))
        assert all((tmp_path / one.attrib["file"]).is_file() for one in sets)
        times.append([float(one.attrib["timestep"]) for one in sets])
    assert times[0] == times[1]
    np.testing.assert_allclose(np.diff(times[0]), 0.02)
    assert 20 <= len(times[0]) <= 51


def test_what_a_former_report_left_is_removed_and_nothing_else(tmp_path: Path) -> None:
    for name in (*SOMETIMES, "mine.txt"):
        (tmp_path / name).write_text("old")
    forget(tmp_path, ["on_the_frame.png"])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.txt", "on_the_frame.png"]


def test_without_evidence_there_is_no_after_and_no_loop() -> None:
    model = measured(noise=0.005)
    effects = [one for one in candidates(model) if one.name == "cubic_stiffness"]
    found = search(model, effects, [0], [1], lambda what, share: None)
    found.judged.clear()
    decision = decide(found)
    nothing = Diagnosis(rounded().case, found, decision, of_frames(rounded().case, found, decision))
    assert shown_after(nothing) is None
    assert loops(nothing) is None
    assert shape(nothing, None) is None
    assert on_the_frame(nothing, {}).after is None


def test_the_box_says_what_the_law_is_and_the_least_change_that_would_show() -> None:
    def sized(storey: int, value: float) -> Sized:
        size = Parameter(name="relative_change", value=value, unit="1")
        return Sized(effect="stiffness_change", frame="5B", storey=storey, parameters=(size,))

    least = Detectability(
        effect="stiffness_change", places=5, shown=5, best=sized(3, -0.04), worst=sized(1, 0.12)
    )
    report = structs.replace(
        of_runs(), shape=Shape(statement="friction; it is so"), smallest_detectable=(least,)
    )
    assert beside_the_verdict(report) == [
        "Friction; it is so.",
        "The smallest change of a storey's stiffness that this data could have shown is 4 % in storey 3 of 5B, and 12 % in "
        "storey 1 of 5B, where it shows least.",
    ]
    some = structs.replace(least, shown=3, worst=None)
    (said,) = beside_the_verdict(structs.replace(of_runs(), smallest_detectable=(some,)))
    assert said.endswith("4 % in storey 3 of 5B; at 2 of 5 storeys none would show.")
    none = structs.replace(least, shown=0, best=None, worst=None)
    (said,) = beside_the_verdict(structs.replace(of_runs(), smallest_detectable=(none,)))
    assert said.endswith("is larger than any.")


def test_the_exported_frame_shaken_by_the_exported_table_is_the_run_after(tmp_path: Path) -> None:
    model = export_model(rounded(), tmp_path / "bench.toml", "Found.")
    assert model.refused is None
    assert [Path(file).name for file in model.files] == [
        "bench.toml",
        "bench-table-run1.csv",
        "bench-table-run2.csv",
    ]
    frame = frames.load(model.files[0])
    (law,) = frame.storey_law
    assert isinstance(law, Hysteresis)
    assert law.storey == STOREY
    assert law.sharpness == pytest.approx(ROUND, rel=0.2)
    record = find(str(tmp_path / "bench-table-run2.csv"))
    (run,) = rounded().found.held_out
    own, shaken = made().motions[run], Rig([frames.build(frame)]).run(record).frames[0]
    times = np.linspace(0.0, 0.99 * record.duration_s, 2000)
    one, other = own.sampled(times)[0], shaken.sampled(times)[0]
    assert np.abs(one - other).max() < 2e-4 * np.abs(one).max()


def test_nothing_is_written_where_nothing_in_the_catalogue_fits(tmp_path: Path) -> None:
    diagnosis = rounded()
    unknown = replace(diagnosis, conclusion=replace(diagnosis.conclusion, verdict="unknown_effect"))
    model = export_model(unknown, tmp_path / "bench.toml", "Found.")
    assert model.refused == "nothing in the catalogue fits what is missing, so there is no corrected model"
    assert list(tmp_path.iterdir()) == []


def test_the_first_page_has_the_headline_the_place_and_the_frequencies() -> None:
    report = detailed(rounded(), made())
    page = sheet(rounded(), report)
    assert page.headline.startswith("A part of storey 2 of bench yields at")
    assert ">storey 2</text>" in page.sketch
    assert [row.mode for row in page.modes] == [1, 2, 3]
    # Hysteresis is a law: stiffness and mass of the frame are those of the calibration.
    assert all(row.frequency.corrected == row.frequency.calibrated for row in page.modes)
    assert any("To confirm it: The same shaking at a third" in step for step in page.steps)


def test_a_frequency_is_not_read_from_measurements_that_impacts_fill() -> None:
    diagnosis = rounded()
    report = detailed(diagnosis, made())
    contact = Contact("bench", "bench", 3, 0.01, "linear", 1e6)
    touching = replace(diagnosis, case=replace(diagnosis.case, contacts=(contact,)))
    assert sheet(diagnosis, report).modes[0].frequency.measured
    assert not sheet(touching, report).modes[0].frequency.measured
