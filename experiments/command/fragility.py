"""`pounding fragility`: how likely the floors of a street touch, over many records."""

from __future__ import annotations

import json as json_text
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec
import numpy as np
from cyclopts import Parameter
from rich.progress import Progress

from pounding import bounds
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.errors import ExperimentError
from pounding.experiments.fragility.capacity import Limit, passing, touching_intensity
from pounding.experiments.fragility.intensity import Intensity
from pounding.experiments.fragility.lognormal import Lognormal, fit_capacities, fit_counts
from pounding.experiments.fragility.pictures import Curve, Sample, drawn, fragilities
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.records import find
from pounding.experiments.records.code_spectra import FORMS
from pounding.experiments.records.code_spectra import target as spectrum
from pounding.experiments.records.sets import FEMA_SETS, record_set
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.frame_laws import refuse_laws
from pounding.experiments.rig.states import states_of
from pounding.experiments.rig.street import built_row, chosen_sets, named, street_contacts
from pounding.experiments.rig.street_file import Street, is_street_file, load_street, refuse_columns
from pounding.experiments.rig.table_scale import TableScale, table_scale
from pounding.frames import load
from pounding.frames.files import replacing, write_whole
from pounding.units import LENGTH

if TYPE_CHECKING:
    from pounding.experiments.records import Record

BEYOND = 4.0
"""Levels reach from the weakest intensity at which a record brings floors together to so many times the strongest [-]."""


def fragility(
    street: str,
    *,
    record: Annotated[
        list[str] | None, Parameter(negative=(), help="Ground motion by name or file, repeatable.")
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
    time_factor: options.TimeFactor = None,
    damping: options.Damping = None,
    records: options.Records = None,
    out: options.Out = None,
    json: options.Json = False,
) -> None:
    """Compute how likely neighbours touch at an intensity of the shaking, as a lognormal fragility over many records.

    Until the first touch linear buildings move in proportion to the shaking, so that one run of a record says at which
    intensity it brings the floors together. Limits of force and drift take runs with contact at several levels.

    Args:
        street: Street file (`pounding new-street` writes one).
    """
    if not is_street_file(street):
        raise ExperimentError(
            f"{street} is no street file; pounding new-street writes one from two frames or more"
        )
    limits = _limits(force, drift)
    aim = None if target is None else spectrum(target)
    read = load_street(street)
    refuse_columns(read)
    names = [building.frame for building in read.building]
    definitions = [load(name) for name in names]
    scale = table_scale(definitions, time_factor)
    sets = chosen_sets(read, definitions, scale)
    shakings = _shakings(record, set_, records, scale)
    states = states_of(names, damping=damping)
    estimates.announce(*map(estimates.of_frame, definitions))
    row = named(read, built_row(read, states))
    refuse_laws(row)
    streets = [_with_gap(read, value) for value in gap] if gap else [read]
    contacts = [street_contacts(one, row, sets)[0] for one in streets]
    if not all(contact.gap_m > 0.0 for places in contacts for contact in places):
        raise ExperimentError("floors that lie against each other touch at any intensity; give gaps above 0")
    if out is not None:
        keeping.prepare(out)
    firsts = [1.0 / float(frame.frequencies_hz[0]) for frame in row]
    longest = max(firsts)
    factors = (
        None
        if aim is None
        else np.array([aim.factor(one, (min(firsts), longest), scale.time_factor) for one in shakings])
    )
    intensity = Intensity(longest if period is None else period or None)
    strengths = np.array([intensity.of(one) for one in shakings])
    runs = len(shakings) * levels * bool(limits)
    with Progress(console=progress_console(), transient=True) as progress:
        bar = progress.add_task("records", total=len(shakings) * len(contacts) + runs)
        touching = np.array(
            [
                [_told(progress, bar, touching_intensity(row, places, one, strength)) for places in contacts]
                for one, strength in zip(shakings, strengths, strict=True)
            ]
        ).T
        shown_g = np.geomspace(touching.min(), BEYOND * touching.max(), levels)
        passed = (
            passing(
                row,
                contacts[0],
                shakings,
                shown_g / strengths[:, None],
                limits,
                workers=workers,
                progress=lambda count: progress.update(bar, completed=touching.size + count),
            )
            if limits
            else np.zeros((0, 0, 0), bool)
        )
    labels = [_label(value) for value in gap] if gap else ["floors touch"]
    samples = [
        *(_touching(label, own) for label, own in zip(labels, touching, strict=True)),
        *(_counted(limit, one, shown_g) for limit, one in zip(limits, passed, strict=True)),
    ]
    axis_g, curves = drawn(samples, len(shakings), seed)
    asked = {
        "street": street,
        **msgspec.to_builtins(read),
        "set": set_,
        "gap_mm": gap,
        "period_s": intensity.period_s,
        "target": aim and aim.words,
        "force_kn": force,
        "drift_percent": drift,
        "levels_g": shown_g if limits else None,
        "seed": seed,
        "states": [one.as_dict() for one in states],
        **scale.as_dict(),
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
    emit(result, as_json=json, show=lambda: _show(result, scale))


def _limits(force_kn: float | None, drift_percent: float | None) -> list[Limit]:
    found = []
    if force_kn is not None:
        bounds.CONTACT_FORCE.check(force_kn, "--force", per=1e3, unit="kN")
        found.append(Limit("force", 1e3 * force_kn))
    if drift_percent is not None:
        bounds.DRIFT.check(drift_percent, "--drift", per=0.01, unit="%")
        found.append(Limit("drift", 0.01 * drift_percent))
    return found


def _shakings(
    names: Sequence[str] | None, set_: str | None, folder: Path | None, scale: TableScale
) -> list[Record]:
    found = [find(name, folder) for name in names or ()] + (record_set(set_) if set_ else [])
    if len(found) < 2:
        raise ExperimentError(
            f"{len(found)} record(s); a fragility needs several: give --set (a folder, or {', '.join(FEMA_SETS)}), or "
            "--record more than once"
        )
    return [one.scaled(scale.time_factor) for one in found]


def _with_gap(street: Street, gap_mm: float) -> Street:
    gaps = tuple(msgspec.structs.replace(one, gap_mm=gap_mm) for one in street.gap)
    return msgspec.structs.replace(street, gap=gaps)


def _told(progress: Progress, bar: Any, value: float) -> float:
    progress.advance(bar)
    return value


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
