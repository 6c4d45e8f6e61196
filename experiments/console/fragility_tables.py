"""Tables of a fragility for a reader: the curves of each limit, and what a design spectrum asks for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from rich.console import RenderableType

from pounding.experiments.console.output import table
from pounding.experiments.fragility.lognormal import Lognormal
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.rig.table_scale import TableScale


def tables(result: dict[str, Any], scale: TableScale) -> Iterable[RenderableType | str]:
    """Return the result of a fragility for a reader: the curves, and what a design spectrum asks for.

    Args:
        result: The result.
        scale: The buildings' scale.
    """
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
