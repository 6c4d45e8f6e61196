"""`pounding mitigate`: what can be done about pounding in a street, measure beside measure."""

from __future__ import annotations

import json as json_text
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from cyclopts import Parameter
from rich.progress import Progress

from pounding import bounds
from pounding.contact.rubber import FLAT
from pounding.experiments.console import options
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.console.street_input import linear_street
from pounding.experiments.errors import ExperimentError
from pounding.experiments.mitigation.measures import NAMES, described
from pounding.experiments.mitigation.pictures import trade_offs
from pounding.experiments.mitigation.search import Answer, Objective, compare, cost
from pounding.experiments.mitigation.standing import Hit, Standing
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.output.building_sketch import Marked, Outline, building_sketch
from pounding.experiments.output.html import three_digits
from pounding.experiments.output.report import write_report
from pounding.experiments.records import find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.table_scale import TableScale
from pounding.frames import ReducedFrame
from pounding.frames.files import replacing, write_whole

LIMITS = (
    "Buildings are linear, and measures are without mass; walls and links also need foundations and floors that bear "
    "their forces.",
    "The best setting is the best of those tried under these records; judge it under others before it is built.",
    "A force of contact is known within a factor of about three (docs/full-scale.md); a link's force does not depend on "
    "the contact.",
)

OBJECTIVES = {
    "acceleration": ("acceleration of a floor", 1.0, "g"),
    "drift": ("storey drift", 100.0, "%"),
    "force": ("force of a contact or link", 1e-3, "kN"),
}
"""What is made small: in words, and the unit in which it is shown."""


def mitigate(
    street: str,
    *,
    record: Annotated[
        list[options.RecordName],
        Parameter(
            negative=(),
            show_choices=False,
            help="Ground motion by name or file, repeatable; of each response the worst counts.",
        ),
    ],
    measure: Annotated[
        list[str] | None,
        Parameter(negative=(), help=f"Measure, repeatable; default: all of {', '.join(NAMES)}."),
    ] = None,
    objective: Annotated[
        Objective,
        Parameter(
            help="What the search makes small: the floors' acceleration, the storeys' drift, or the force of contacts "
            "and links."
        ),
    ] = "acceleration",
    evaluations: Annotated[
        int,
        Parameter(
            help="About how many settings of each measure are tried.",
            validator=options.bounded(bounds.EVALUATIONS),
        ),
    ] = 25,
    pga: options.Pga = None,
    time_factor: options.TimeFactor = None,
    damping: options.Damping = None,
    records: options.Records = None,
    record_unit: options.RecordUnit = None,
    out: options.Out = None,
    json: options.Json = False,
) -> None:
    """Compare what can be done about pounding in a street, each measure with its best setting.

    The measures: wider gaps, rubber bumpers, hard links, links of spring and dashpot, viscous dampers between the floors,
    more damping in the buildings, walls in them, and walls in the place of columns that a floor hits. All runs are exact,
    so the buildings must be linear.

    Args:
        street: Street file (`pounding new-street` writes one).
    """
    for name in measure or ():
        if name not in NAMES:
            raise ExperimentError(f"measure {name!r} is not known; known are {', '.join(NAMES)}")
    row = linear_street(street, time_factor, damping)
    shakings = [find(name, records, unit=record_unit).scaled(row.scale.time_factor, pga) for name in record]
    contacts, bases = row.contacts()
    hits = tuple(Hit(number, *basis.hit) for number, basis in enumerate(bases) if basis.hit is not None)
    if out is not None:
        keeping.prepare(out)
    with Progress(console=progress_console(), transient=True) as progress:
        bar = progress.add_task("none", total=evaluations)
        answers = compare(
            Standing(row.frames, tuple(contacts), hits=hits),
            shakings,
            names=measure or (),
            objective=objective,
            evaluations=evaluations,
            progress=lambda name, count: progress.update(bar, description=name, completed=count),
        )
    asked = {
        **row.as_dict(),
        "objective": objective,
        "evaluations": evaluations,
        "pga_g": pga,
        "record_unit": record_unit,
        "contact_basis": [basis.sentence for basis in bases],
    }
    result = stamp(asked, shakings) | {
        "sentence": _sentence(answers, objective),
        "measures": [_as_dict(answer) for answer in answers],
        "limits": list(LIMITS),
    }
    if out is not None:
        result["files"] = _keep(result, answers, row.frames, contacts, out)
    emit(result, as_json=json, show=lambda: _show(result, row.scale))


def _as_dict(answer: Answer) -> dict[str, Any]:
    return {
        "name": answer.measure.name,
        "words": answer.measure.words,
        "settings": described(answer.measure, answer.best.values),
        "remark": _remark(answer),
        "response": answer.best.response.as_dict(),
        "tried": [
            {"settings": described(answer.measure, one.values), "response": one.response.as_dict()}
            for one in answer.tried
        ],
    }


def _remark(answer: Answer) -> str:
    """Return what must be known of a best setting beside its numbers; empty if nothing."""
    if answer.best.response.compression > FLAT:
        return "every block tried is pressed flat, this one the least"
    bound = [name for name in answer.at_bound if answer.measure.name != "wider-gap"]
    return f"best at the bound of the search ({' and '.join(bound)})" if bound else ""


def _sentence(answers: Sequence[Answer], objective: Objective) -> str:
    """Return what comes out, in a sentence."""
    as_it_is, *others = answers
    if as_it_is.best.response.touches == 0:
        return "The floors do not touch under these records: nothing needs to be done about pounding."
    best = min(others, key=lambda answer: cost(answer.best.response, objective))
    what, factor, unit = OBJECTIVES[objective]
    before, after = (factor * cost(one.best.response, objective) for one in (as_it_is, best))
    said = f"{best.measure.name} ({best.measure.words}): {after:.3g} {unit} instead of {before:.3g} {unit}."
    if after >= before:
        return f"No measure tried lowers the largest {what}; the least is left by {said}"
    return f"The smallest {what} is left by {said}"


def _keep(
    result: dict[str, Any],
    answers: Sequence[Answer],
    row: Sequence[ReducedFrame],
    contacts: Sequence[Contact],
    out: Path,
) -> list[str]:
    figure = trade_offs(answers)
    with replacing(out / "trade-offs.png") as part:
        figure.savefig(part, dpi=100)
    places = _narrowest(contacts, answers[0].best.response.required_gap_mm)
    sketch = building_sketch(
        [Outline(one.name, one.heights_m.tolist()) for one in row], [place.marked(row) for place in places]
    )
    needed_mm = [place.needed_mm for place in places]
    page = out / "mitigate.html"
    write_report("mitigate", plain(result), page, [figure], sketch, needed_mm=needed_mm)
    write_whole(out / "mitigate.json", (json_text.dumps(plain(result), indent=2) + "\n").encode())
    return ["trade-offs.png", "mitigate.html", "mitigate.json"]


class _Place(NamedTuple):
    """A contact and the gap [mm] that would have kept its floors apart."""

    contact: Contact
    needed_mm: float

    def marked(self, row: Sequence[ReducedFrame]) -> Marked:
        there_mm = 1e3 * self.contact.gap_m
        levels_m = [0.0, *row[self.contact.pair].heights_m]
        # Between two floors where it is on columns.
        height_m = float(np.interp(self.contact.floors[0], range(len(levels_m)), levels_m))
        words = f"{there_mm:.4g} / {three_digits(self.needed_mm)}"
        return Marked(self.contact.pair, height_m, words, there_mm < self.needed_mm)


def _narrowest(contacts: Sequence[Contact], needed_mm: Sequence[float]) -> list[_Place]:
    """Return of each pair of neighbours the place that lacks most."""
    places = list(map(_Place, contacts, needed_mm))
    return [
        max(
            (place for place in places if place.contact.pair == pair),
            key=lambda place: place.needed_mm - 1e3 * place.contact.gap_m,
        )
        for pair in sorted({contact.pair for contact in contacts})
    ]


def _records(result: dict[str, Any]) -> str:
    count = len(result["records"])
    return f"{count} records" if count > 1 else "1 record"


def _show(result: dict[str, Any], scale: TableScale) -> Iterable[Any]:
    hit = result["measures"][0]["response"]["column_shear_kn"] > 0.0
    # No link stands where floors hit columns.
    heads = ["contact kN", "link kN", "touches", "drift %", "accel. g", "gap needed mm"]
    hit_heads = ["force kN", "column kN", "kN m", "hits", "drift %", "acc. g", "gap mm"]
    yield table(
        f"{result['parameters']['street']}, the worst of {_records(result)}, each measure at its best",
        ["measure", *(hit_heads if hit else heads)],
        [_row(one, hit) for one in result["measures"]],
    )
    for one in result["measures"]:
        stated = [f"{name} {value:.3g}" for name, value in one["settings"].items()]
        if stated:
            remark = [one["remark"]] if one["remark"] else []
            yield f"{one['name']}: {one['words']}; {'; '.join([*stated, *remark])}"
    yield result["sentence"]
    yield str(scale)
    yield from keeping.written(result)


def _row(one: dict[str, Any], hit: bool) -> list[str]:
    found = one["response"]
    own = ["column_shear_kn", "column_moment_kn_m"] if hit else ["link_force_n"]
    return [
        one["name"],
        three_digits(found["peak_force_n"] / 1e3),
        *(three_digits(found[key] / (1e3 if key.endswith("_n") else 1.0)) for key in own),
        f"{found['touches']}",
        f"{100 * found['drift']:.2f}",
        f"{found['acceleration_g']:.2f}",
        three_digits(max(found["required_gap_mm"])),
    ]
