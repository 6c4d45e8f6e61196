"""Axes to draw into, the caller's or those of a new figure, and the file that is written only when one is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from pounding.experiments.errors import ExperimentError
from pounding.frames.files import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def panels(
    axes: Axes | Sequence[Axes] | None,
    rows: int,
    size: tuple[float, float],
    *,
    columns: int = 1,
    title: str = "",
    **grid: Any,
) -> list[Axes]:
    """Return the axes that were given or, without, those of a new figure.

    Args:
        axes: Axes to draw into; a new figure when None.
        rows: Rows of panels.
        size: Width and height of a new figure [inches].
        columns: Columns of panels.
        title: Above a new figure.
        grid: Arguments of matplotlib's `Figure.subplots`.

    Raises:
        ExperimentError: Not as many axes were given as there are panels.
    """
    if axes is None:
        # A figure without pyplot: nothing global is touched, and no display is needed.
        figure = Figure(figsize=size, layout="constrained")
        if title:
            figure.suptitle(title, x=0.01, ha="left")
        return list(figure.subplots(rows, columns, squeeze=False, **grid).flat)
    given = list(np.ravel(np.asarray(axes, dtype=object)))
    if len(given) != rows * columns:
        raise ExperimentError(f"this plot has {rows * columns} panels, but {len(given)} axes were given")
    return given


def figure_of(axes: Axes) -> Figure:
    """Return the figure in which axes are."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def keep(axes: Axes, path: str | Path | None, *, dpi: int = 110) -> None:
    """Write the figure in which axes are, if a file is asked for.

    Args:
        axes: One of the figure's axes.
        path: File to write, its suffix says the format; none when None.
        dpi: Dots in an inch.

    Raises:
        FrameError: The file cannot be written.
    """
    if path is not None:
        with replacing(path) as part:
            figure_of(axes).savefig(part, dpi=dpi)
