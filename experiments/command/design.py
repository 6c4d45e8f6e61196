"""`pounding design`: the gap between two buildings at full scale by every rule that applies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Annotated, Any

from cyclopts import Parameter
from rich.console import RenderableType

from pounding.experiments.command.gap import Report
from pounding.experiments.console import options
from pounding.experiments.console.output import emit, table, written
from pounding.experiments.output.building_sketch import Marked, Outline, building_sketch
from pounding.experiments.output.report import write_report
from pounding.experiments.results.provenance import stamp
from pounding.experiments.separation import pictures
from pounding.experiments.separation.rules.design import DEFAULT_DAMPING_PERCENT, Site
from pounding.experiments.separation.rules.design import design as answer

Hertz = Annotated[
    float | None, Parameter(help="First frequency [Hz]; default: from the height by AS 1170.4, eq 7.19.")
]
Peak = Annotated[
    float | None, Parameter(help="Peak displacement at the lower roof [mm], for rules that need peaks.")
]


def _fraction(_type: object, value: float) -> None:
    """Refuse a damping in percent, as which a code states it."""
    if not 0.0 < value < 1.0:
        raise ValueError(f"{value:g} is not a fraction from above 0 to below 1 (5 % is 0.05)")


def design(
    *,
    tall: Annotated[float, Parameter(help="Height of the taller building [m].")],
    short: Annotated[float, Parameter(help="Height of the lower building [m].")],
    pga: Annotated[float, Parameter(help="Peak ground acceleration [g].")],
    tall_frequency: Hertz = None,
    short_frequency: Hertz = None,
    damping: Annotated[
        float,
        Parameter(help="Damping ratio of both buildings, a fraction (0.05 is 5 %).", validator=_fraction),
    ] = DEFAULT_DAMPING_PERCENT / 100.0,
    tall_mm: Peak = None,
    short_mm: Peak = None,
    report: Report = None,
    json: options.Json = False,
) -> None:
    """Print the full-scale gap that two buildings need by codes' rules and the thesis' equations."""
    site = Site(
        tall_m=tall,
        short_m=short,
        pga_g=pga,
        tall_frequency_hz=tall_frequency,
        short_frequency_hz=short_frequency,
        damping_percent=100.0 * damping,
        tall_mm=tall_mm,
        short_mm=short_mm,
    )
    result = stamp(asdict(site)) | answer(site)
    if report is not None:
        in_range = result["in_range"]
        words = f"{in_range['low_mm']:.0f}–{in_range['high_mm']:.0f} mm" if in_range["count"] else "no rule"
        sketch = building_sketch(
            [Outline("tall", [tall]), Outline("short", [short])], [Marked(0, short, words)]
        )
        write_report("design", result, report, [pictures.design_bars(result)], sketch)
    emit(result, as_json=json, show=lambda: [*_tables(result), *written(report)])


def _tables(result: dict[str, Any]) -> Iterable[RenderableType | str]:
    yield table(
        f"{result['tall']['height_m']:g} m beside {result['short']['height_m']:g} m at {result['pga_g']:g} g "
        f"(class: {result['pga_class'] or 'none'}), full scale",
        ["rule", "gap mm", "applies", "basis", "mind"],
        [
            [r["name"], _mm(r["gap_mm"]), "yes" if r["in_range"] else "no", r["basis"], r["reason"]]
            for r in result["rules"]
        ],
    )
    edges = ", ".join(
        f"{level} {edge['lower_g']} to {edge['upper_g']} g" for level, edge in result["pga_classes"].items()
    )
    yield f"Classes of peak acceleration: {edges}; an edge belongs to the class above."
    yield "Below 0.2 g the thesis' equations are asked at 0.2 g."
    yield from result["limits"]


def _mm(value: float | None) -> str | None:
    return None if value is None else f"{value:.1f}"
