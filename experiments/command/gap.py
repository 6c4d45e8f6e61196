"""`pounding gap`: the clearance that two frames, or the neighbours of a street, need under a record."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise, product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import msgspec
from cyclopts import Parameter
from rich.console import RenderableType

from pounding import frames
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, table, warn, written
from pounding.experiments.errors import ExperimentError
from pounding.experiments.output.building_sketch import Marked, Outline, building_sketch
from pounding.experiments.output.report import write_report
from pounding.experiments.records import Record, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.required_gap import fine_step, is_left_lower
from pounding.experiments.rig.states import FrameState, states_of
from pounding.experiments.rig.street import built_row, named
from pounding.experiments.rig.street_file import (
    Building,
    Gap,
    Street,
    is_street_file,
    load_street,
)
from pounding.experiments.rig.table_scale import TableScale, table_scale
from pounding.experiments.separation.gaps.gap import Where, gap_answer, history
from pounding.experiments.separation.pictures import gap_history

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floor = Annotated[int | None, Parameter(help="Floor of the lower frame; default: its roof.")]
Report = Annotated[
    Path | None,
    Parameter(
        help="HTML file to write: the answer with its picture, self-contained.",
        validator=options.report_file,
    ),
]


def gap(
    left: options.FrameName,
    right: options.FrameName | None = None,
    *,
    record: options.RecordName,
    pga: options.Pga = None,
    floor: Floor = None,
    state: options.State = None,
    time_factor: options.TimeFactor = None,
    joints: options.Joints = "calibrated",
    p_delta: options.PDelta = True,
    damping: options.Damping = None,
    records: options.Records = None,
    record_unit: options.RecordUnit = None,
    report: Report = None,
    json: options.Json = False,
) -> None:
    """Compute the gap that keeps two frames apart under a record, beside the gaps by the codes' rules.

    The required gap is the largest closing motion of an exact run without contact. All lengths are those of
    the frames, whose scale their files state. Of a street each pair of neighbours is answered, beside the gap that it has.

    Args:
        left: Frame on the left, a name or a frame file; it moves in +x towards the right one. Or, alone, a street file.
        right: Frame on the right.
        record: Name or file of the ground motion.
    """
    street = _street(left, right, floor)
    names = [building.frame for building in street.building]
    definitions = [frames.load(name) for name in names]
    scale = table_scale(definitions, time_factor)
    motion = find(record, records, unit=record_unit).scaled(scale.time_factor, pga)
    states = states_of(names, state, motion.name, joints=joints, damping=damping)
    estimates.announce(*map(estimates.of_frame, definitions))
    row = named(street, built_row(street, states, joints, p_delta))
    step_s = motion.step_s / fine_step(motion.step_s)
    estimates.announce(*(estimates.of_gap(pair, motion.duration_s, step_s) for pair in pairwise(row)))
    places = _places(street, row)
    own_peak = pga is None and scale.is_laboratory
    length = scale.scale.buildings_length
    answers = [place.answer(motion, own_peak=own_peak, length_scale=length) for place in places]
    asked = {
        **(
            {"left": left, "right": right, "floor": floor}
            if right is not None
            else {"street": left, **msgspec.to_builtins(street)}
        ),
        "record": record,
        "record_unit": record_unit,
        "pga_g": pga,
        "joints": joints,
        "p_delta": p_delta,
        "damping_ratio": [frame.damping_ratio for frame in row],
        "states": [one.as_dict() for one in states],
        **scale.as_dict(),
    }
    result = stamp(asked, [motion]) | (_of_street(answers) if right is None else answers[0])
    if report is not None:
        pictures = [place.picture(motion, answer) for place, answer in zip(places, answers, strict=True)]
        _write(report, result, answers, pictures, row, scale)
    show = _tables if right is not None else _street_tables
    emit(result, as_json=json, show=lambda: [*show(result, states, scale), *written(report)])
    for sentence in map(str, result["warnings"]):
        warn(sentence)


def _street(left: str, right: str | None, floor: int | None) -> Street:
    """Return the street of a file, or a pair as a street without a gap of its own."""
    if is_street_file(left):
        if right is not None or floor is not None:
            raise ExperimentError(
                f"{left} is a street file, which has its own buildings and floors; give it alone, without a second frame "
                "and --floor"
            )
        return load_street(left)
    if right is None:
        frames.load(left)  # whose sentence on what is no frame is the better one
        raise ExperimentError(
            f"{left} is one frame; give a second one beside it, or a street file (pounding new-street writes one)"
        )
    return Street((Building(left), Building(right)), (Gap((), () if floor is None else (floor,)),))


def _places(street: Street, row: Sequence[frames.ReducedFrame]) -> list[_Place]:
    return [
        _Place(
            one,
            other,
            None if present is None else between.free_mm(present),
            Where(number, y_m, between.columns is not None),
        )
        for (one, other), between in zip(pairwise(row), street.gap, strict=True)
        for (number, present), y_m in product(between.by_floor(), between.places_m)
    ]


class _Place(NamedTuple):
    """A place where two neighbours may meet, and the gap [mm] that is there; None where none is stated."""

    left: frames.ReducedFrame
    right: frames.ReducedFrame
    gap_mm: float | None
    where: Where

    def answer(self, motion: Record, **options: Any) -> dict[str, Any]:
        found = gap_answer(self.left, self.right, motion, self.where, **options).as_dict()
        return found if self.gap_mm is None else found | {"gap_mm": self.gap_mm}

    def picture(self, motion: Record, answer: dict[str, Any]) -> Figure:
        return gap_history(*history(self.left, self.right, motion, self.where), answer)


def _of_street(answers: list[dict[str, Any]]) -> dict[str, Any]:
    short = [_sentence(answer) for answer in answers if _is_short(answer)]
    other = [
        f"{answer['left']} and {answer['right']}: {sentence}"
        for answer in answers
        for sentence in answer["warnings"]
    ]
    # Several places of one pair say the same of its ends.
    return {"pairs": answers, "warnings": [*short, *dict.fromkeys(other)]}


def _write(
    path: Path,
    result: dict[str, Any],
    answers: Sequence[dict[str, Any]],
    pictures: Sequence[Figure],
    row: Sequence[frames.ReducedFrame],
    scale: TableScale,
) -> None:
    write_report(
        "street" if "pairs" in result else "gap",
        result,
        path,
        pictures,
        _sketch(row, answers),
        lengths=f"The {scale}.",
        short=[_sentence(answer) for answer in answers if _is_short(answer)],
    )


def _sketch(row: Sequence[frames.ReducedFrame], answers: Sequence[dict[str, Any]]) -> str:
    """Return the buildings, and between each pair what it has and needs where it lacks most."""
    marks = []
    for pair, (left, right) in enumerate(pairwise(row)):
        own = [answer for answer in answers if (answer["left"], answer["right"]) == (left.name, right.name)]
        answer = max(own, key=lambda one: one["required_gap_mm"] - one.get("gap_mm", 0.0))
        lower = left if is_left_lower(left, right) else right
        needs = f"{answer['required_gap_mm']:.4g}"
        words = f"{answer['gap_mm']:.4g} / {needs}" if "gap_mm" in answer else f"{needs} mm"
        height_m = float(lower.heights_m[answer["floor"] - 1])
        marks.append(Marked(pair, height_m, words, _is_short(answer)))
    return building_sketch([Outline(one.name, one.heights_m.tolist()) for one in row], marks)


def _is_short(answer: dict[str, Any]) -> bool:
    return bool(answer.get("gap_mm", math.inf) < answer["required_gap_mm"])


def _sentence(answer: dict[str, Any]) -> str:
    return (
        f"{answer['left']} and {answer['right']} meet at floor {_floor(answer)}: their gap is {answer['gap_mm']:g} mm, and "
        f"{answer['record']} asks for {answer['required_gap_mm']:.2f} mm"
    )


def _floor(answer: dict[str, Any]) -> str:
    return f"{answer['floor']}" + (f" at y = {answer['y_m']:g} m" if answer["y_m"] else "")


def _street_tables(
    result: dict[str, Any], states: Iterable[FrameState], scale: TableScale
) -> Iterable[RenderableType | str]:
    first = result["pairs"][0]
    yield table(
        f"{result['parameters']['street']}, {first['record']} ({first['pga_g']:.3f} g): gaps in mm",
        ["neighbours", "floor", "gap", "required", "if 5 % off", "sides swapped", "enough"],
        [_street_row(answer) for answer in result["pairs"]],
    )
    yield from map(str, states)
    yield str(scale)


def _street_row(answer: dict[str, Any]) -> list[str]:
    spread = answer["spread"]
    return [
        f"{answer['left']} and {answer['right']}",
        _floor(answer),
        f"{answer['gap_mm']:g}",
        f"{answer['required_gap_mm']:.2f}",
        f"{spread['low_mm']:.2f} to {spread['high_mm']:.2f}",
        f"{answer['reversed_mm']:.2f}",
        "no" if _is_short(answer) else "yes",
    ]


def _tables(
    result: dict[str, Any], states: Iterable[FrameState], scale: TableScale
) -> Iterable[RenderableType | str]:
    spread, published = result["spread"], result["published"]
    rows = [
        ["required gap (closing motion)", f"{result['required_gap_mm']:.2f}", f"at {result['time_s']:.3f} s"],
        ["... least and largest", f"{spread['low_mm']:.2f} to {spread['high_mm']:.2f}", spread["basis"]],
        ["... frames on swapped sides", f"{result['reversed_mm']:.2f}", "or the record with the other sign"],
        ["equation 4.1 (either way)", f"{result['equation_4_1_mm']:.2f}", "counts opening like closing"],
    ]
    if published:
        rows.append(["measured", f"{published['experiment_mm']:g}", published["source"]])
        rows.append(["SAP2000 model of the thesis", f"{published['numerical_mm']:g}", published["source"]])
    title = (
        f"{result['left']} beside {result['right']}, floor {result['floor']}, {result['record']} "
        f"({result['pga_g']:.3f} g)"
    )
    yield table(title, ["", "mm", ""], rows)
    yield from dict.fromkeys(map(str, states))  # one building may stand twice
    yield str(scale)
    yield table(
        "Rules, from the peaks of this run",
        ["rule", "gap mm", "applies", "mind"],
        [
            [r["name"], _mm(r["gap_mm"]), "yes" if r["in_range"] else "no", r["reason"]]
            for r in result["rules"]
        ],
    )


def _mm(value: float | None) -> str | None:
    return None if value is None else f"{value:.2f}"
