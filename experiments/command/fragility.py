"""`pounding fragility`: how likely the floors of a street touch, over many records."""

from __future__ import annotations

import json as json_text
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec
import numpy as np
from cyclopts import Parameter
from numpy.typing import NDArray
from rich.progress import Progress

from pounding import bounds
from pounding.experiments.console import options
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.console.street_input import LinearStreet, linear_street
from pounding.experiments.errors import ExperimentError
from pounding.experiments.fragility.capacity import Limit, closings, passing, touching_intensity
from pounding.experiments.fragility.intensity import Intensity
from pounding.experiments.fragility.lognormal import Lognormal, fit_capacities, fit_counts
from pounding.experiments.fragility.pictures import Curve, Sample, drawn, fragilities
from pounding.experiments.fragility.sweeping import Motions, passing_by_sweep, street_text
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.records.code_spectra import FORMS
from pounding.experiments.records.code_spectra import target as spectrum
from pounding.experiments.records.sets import FEMA_SETS
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.street_file import Street
from pounding.experiments.rig.table_scale import TableScale
from pounding.frames.files import replacing, write_whole
from pounding.units import LENGTH

if TYPE_CHECKING:
    from pounding.experiments.records import Record
    from pounding.experiments.rig.contacts import Contact

BEYOND = 4.0
"""Levels reach from the weakest intensity at which a record brings floors together to so many times the strongest [-]."""


def fragility(
    street: str,
    *,
    record: Annotated[
        list[options.RecordName] | None,
        Parameter(negative=(), show_choices=False, help="Ground motion by name or file, repeatable."),
    ] = None,
    set_: Annotated[
        str | None,
        Parameter(name="--set", help=f"Set of ground motions: a folder of files, or {', '.join(FEMA_SETS)}."),
    ] = None,
    period: Annotated[
        float | None,
        Parameter(
            help="Period of the spectral acceleration [s]; default: the longest first period of the buildings. 0: peak "
            "ground acceleration.",
            validator=options.bounded(bounds.PERIOD),
        ),
    ] = None,
    gap: Annotated[
        list[float] | None,
        Parameter(
            negative=(),
            help="Gap of all neighbours [mm], repeatable, a curve each; default: the street's own gaps.",
            validator=options.bounded(bounds.GAP, per=LENGTH["mm"], unit="mm"),
        ),
    ] = None,
    force: Annotated[
        float | None, Parameter(help="Also the probability of a contact force above this [kN].")
    ] = None,
    drift: Annotated[
        float | None, Parameter(help="Also the probability of a storey drift above this [% of the height].")
    ] = None,
    target: Annotated[
        str | None,
        Parameter(
            help="Design spectrum to which the records are brought, for the gap that they ask for: "
            f"{'; '.join(FORMS.values())}."
        ),
    ] = None,
    levels: Annotated[
        int,
        Parameter(
            help="Levels of the intensity for --force and --drift.",
            validator=options.bounded(bounds.LEVELS),
        ),
    ] = 12,
    seed: options.Seed = 0,
    workers: options.Workers = None,
    kept: Annotated[
        Path | None,
        Parameter(
            help="Folder for the finished runs of --force and --drift; an interrupted call goes on from it.",
            validator=options.writable_folder,
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        Parameter(
            help="Address of a dask.distributed scheduler, on which the runs of --force and --drift go."
        ),
    ] = None,
    time_factor: options.TimeFactor = None,
    damping: options.Damping = None,
    records: options.Records = None,
    record_unit: options.RecordUnit = None,
    out: options.Out = None,
    json: options.Json = False,
) -> None:
    """Compute how likely neighbours touch at an intensity of the shaking, as a lognormal fragility over many records.

    Until the first touch linear buildings move in proportion to the shaking, so that one run of a record says at which
    intensity it brings the floors together. Limits of force and drift take runs with contact at several levels.

    Args:
        street: Street file (`pounding new-street` writes one).
    """
    limits = _limits(force, drift)
    if (kept or scheduler) and not limits:
        raise ExperimentError(
            "--kept and --scheduler are for the runs of --force or --drift; touching takes one run a record, here"
        )
    aim = None if target is None else spectrum(target)
    row = linear_street(street, time_factor, damping)
    motions = Motions(
        tuple(map(_place, record or ())),
        set_ and _place(set_),
        None if records is None else str(records.resolve()),
        row.scale.time_factor,
        record_unit,
    )
    shakings = _several(motions.read())
    streets = [_with_gap(row.street, value) for value in gap] if gap else [row.street]
    contacts = [row.contacts(one)[0] for one in streets]
    if not all(contact.gap_m > 0.0 for places in contacts for contact in places):
        raise ExperimentError("floors that lie against each other touch at any intensity; give gaps above 0")
    if out is not None:
        keeping.prepare(out)
    firsts = [1.0 / float(frame.frequencies_hz[0]) for frame in row.frames]
    longest = max(firsts)
    factors = (
        None
        if aim is None
        else np.array([aim.factor(one, (min(firsts), longest), row.scale.time_factor) for one in shakings])
    )
    intensity = Intensity(longest if period is None else period or None)
    strengths = np.array([intensity.of(one) for one in shakings])
    with Progress(console=progress_console(), transient=True) as progress:
        bar = progress.add_task("records", total=len(shakings) * (1 + levels * bool(limits)))

        def told(done: int) -> None:
            progress.update(bar, completed=done)

        touching = _touching_g(row, contacts, shakings, strengths, told)
        shown_g = np.geomspace(touching.min(), BEYOND * touching.max(), levels)
        passed: Any = ()
        if limits and not (kept or scheduler):
            passed = passing(
                row.frames,
                contacts[0],
                shakings,
                shown_g / strengths[:, None],
                limits,
                workers=workers,
                progress=lambda count: told(len(shakings) + count),
            )
    if kept or scheduler:
        passed = passing_by_sweep(
            motions,
            shakings,
            strengths,
            shown_g,
            limits,
            street_text(streets[0], row.states, row.parameters),
            folder=kept,
            workers=workers,
            scheduler=scheduler,
        )
    labels = [_label(value) for value in gap] if gap else ["floors touch"]
    samples = [
        *(_touching(label, own) for label, own in zip(labels, touching, strict=True)),
        *(_counted(limit, one, shown_g) for limit, one in zip(limits, passed, strict=True)),
    ]
    axis_g, curves = drawn(samples, len(shakings), seed)
    asked = {
        **row.as_dict(),
        "set": set_,
        "record_unit": record_unit,
        "gap_mm": gap,
        "period_s": intensity.period_s,
        "target": aim and aim.words,
        "force_kn": force,
        "drift_percent": drift,
        "levels_g": shown_g if limits else None,
        "seed": seed,
    }
    result = stamp(asked, shakings) | {
        "intensity": intensity.words,
        "fragilities": [_as_dict(curve) for curve in curves],
        "per_record": [
            {"record": one.name, "intensity_g": strength, "touching_g": own}
            for one, strength, own in zip(shakings, strengths, touching.T, strict=True)
        ],
    }
    if factors is not None:
        gaps = [min(1e3 * contact.gap_m for contact in places) for places in contacts]
        result["at_target"] = _at_target(factors, strengths, touching, gaps)
    if out is not None:
        smallest = min(1e3 * contact.gap_m for contact in contacts[0])
        figure = fragilities(curves, axis_g, intensity.words, [(smallest, value) for value in touching[0]])
        with replacing(out / "fragility.png") as part:
            figure.savefig(part, dpi=100)
        write_whole(out / "fragility.json", (json_text.dumps(plain(result), indent=2) + "\n").encode())
        result["files"] = ["fragility.png", "fragility.json"]
    emit(result, as_json=json, show=lambda: _show(result, row.scale))


def _limits(force_kn: float | None, drift_percent: float | None) -> list[Limit]:
    found = []
    if force_kn is not None:
        bounds.CONTACT_FORCE.check(force_kn, "--force", per=1e3, unit="kN")
        found.append(Limit("force", 1e3 * force_kn))
    if drift_percent is not None:
        bounds.DRIFT.check(drift_percent, "--drift", per=0.01, unit="%")
        found.append(Limit("drift", 0.01 * drift_percent))
    return found


def _place(name: str) -> str:
    """Return a file or folder with its whole path: workers stand elsewhere. Other names stay."""
    path = Path(name)
    return str(path.resolve()) if path.exists() else name


def _several(found: list[Record]) -> list[Record]:
    if len(found) < 2:
        raise ExperimentError(
            f"{len(found)} record(s); a fragility needs several: give --set (a folder, or {', '.join(FEMA_SETS)}), or "
            "--record more than once"
        )
    return found


def _with_gap(street: Street, gap_mm: float) -> Street:
    gaps = tuple(msgspec.structs.replace(one, gap_mm=gap_mm) for one in street.gap)
    return msgspec.structs.replace(street, gap=gaps)


def _touching_g(
    row: LinearStreet,
    contacts: Sequence[Sequence[Contact]],
    shakings: Sequence[Record],
    strengths: NDArray[np.float64],
    told: Callable[[int], None],
) -> NDArray[np.float64]:
    """Return the intensity [g] at which each record brings floors together, for each set of gaps (sets, records)."""
    found = []
    for number, (one, strength) in enumerate(zip(shakings, strengths, strict=True), 1):
        closing = closings(row.frames, contacts[0], one)
        found.append([touching_intensity(closing, places, one.name, float(strength)) for places in contacts])
        told(number)
    return np.array(found).T


def _label(gap_mm: float) -> str:
    return f"floors touch, gap {gap_mm:g} mm"


def _touching(label: str, capacity_g: Any) -> Sample:
    shares = (np.arange(len(capacity_g)) + 0.5) / len(capacity_g)
    return Sample(label, lambda chosen: fit_capacities(capacity_g[chosen]), np.sort(capacity_g), shares)


def _counted(limit: Limit, passed: Any, levels_g: Any) -> Sample:
    label = (
        f"force above {limit.value / 1e3:g} kN"
        if limit.kind == "force"
        else f"drift above {100 * limit.value:g} %"
    )
    return Sample(label, lambda chosen: fit_counts(levels_g, passed[chosen]), levels_g, passed.mean(axis=0))


def _at_target(factors: Any, strengths: Any, touching: Any, gaps_mm: Sequence[float]) -> dict[str, Any]:
    """Return what the records brought to the target ask for: the gap at which the floors just touch is in proportion."""
    needed_mm = factors * strengths / touching[0] * gaps_mm[0]
    return {
        "factors": factors,
        "required_gap_mm": needed_mm,
        "median_mm": float(np.median(needed_mm)),
        "of_84_percent_mm": float(np.quantile(needed_mm, 0.84)),
        "largest_mm": float(needed_mm.max()),
        "touching": [
            {"gap_mm": gap, "records": int(np.sum(factors * strengths > own))}
            for gap, own in zip(gaps_mm, touching, strict=True)
        ],
    }


def _as_dict(curve: Curve) -> dict[str, Any]:
    return {
        "of": curve.label,
        "median_g": curve.fit.median_g,
        "beta": curve.fit.beta,
        "seen_g": curve.seen_g,
        "seen": curve.seen,
    }


def _show(result: dict[str, Any], scale: TableScale) -> Iterable[Any]:
    yield table(
        f"{result['parameters']['street']}, {len(result['records'])} records: {result['intensity']}",
        ["probability of", "median g", "beta", "5 % at g", "95 % at g"],
        [_row(one) for one in result["fragilities"]],
    )
    if "at_target" in result:
        found, count = result["at_target"], len(result["records"])
        yield (
            f"Brought to {result['parameters']['target']} by factors of {min(found['factors']):.2f} to "
            f"{max(found['factors']):.2f}, the records ask for a smallest gap of {found['median_mm']:.0f} mm in the median, "
            f"{found['of_84_percent_mm']:.0f} mm for 84 % of them and {found['largest_mm']:.0f} mm at most."
        )
        for one in found["touching"]:
            yield f"With {one['gap_mm']:g} mm the floors touch in {one['records']} of {count}."
    yield str(scale)
    yield from keeping.written(result)


def _row(one: dict[str, Any]) -> list[str]:
    curve = Lognormal(one["median_g"], one["beta"])
    low, high = (curve.median_g * float(np.exp(sign * 1.6449 * curve.beta)) for sign in (-1.0, 1.0))
    return [one["of"], f"{curve.median_g:.3f}", f"{curve.beta:.2f}", f"{low:.3f}", f"{high:.3f}"]
