"""The picture of the study `sap2000-input`: computed over printed gaps in both directions."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pounding.experiments.pictures.palette import BLUE, GREEN, PURPLE, VERMILION
from pounding.experiments.studies.sap2000_model import Real
from pounding.frames.files import replacing

COLOURS = {"elcentro": BLUE, "hachinohe": GREEN, "northridge": VERMILION, "kobe": PURPLE}
NAMES = {"elcentro": "El Centro", "hachinohe": "Hachinohe", "northridge": "Northridge", "kobe": "Kobe"}


def picture(rows: pd.DataFrame, gaps: Mapping[str, Real], gains: pd.DataFrame, path: Path) -> None:
    """Draw computed over printed gaps, row by row, as closing gaps and by equation 4.1.

    Args:
        rows: The printed rows.
        gaps: Computed gaps by direction [mm].
        gains: One gain for each record, as fitted to the closing gaps.
        path: The file.

    Raises:
        FrameError: The file cannot be written.
    """
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    printed, label = rows["gap_mm"].to_numpy(float), rows["label"].to_numpy()
    titles = {"closing": "closing gap", "equation_4_1": "equation 4.1"}
    for axes, (direction, title) in zip(panels, titles.items(), strict=True):
        for name, colour in COLOURS.items():
            here = np.flatnonzero(label == name)
            ratio = gaps[direction][here] / printed[here]
            axes.plot(here, ratio, "o", ms=4, color=colour, label=NAMES[name])
            if direction == "closing":
                level = 1.0 / gains.loc[name, "gain"]
                axes.hlines(level, here.min(), here.max(), color=colour, lw=1.2)
        axes.axhline(1.0, color="#7f8c8d", lw=0.8, ls="--")
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("printed row of Tables 7.2 to 7.4, in order")
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("computed / printed gap [-]")
    panels[0].legend(fontsize=8, frameon=False, loc="upper left")
    with replacing(path) as part_file:
        figure.savefig(part_file, format="png", dpi=90)
