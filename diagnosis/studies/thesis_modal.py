"""Table 3.1 as modal data with the uncertainty that such numbers have."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pounding.diagnosis.case.case import Case, CaseFrame, Prior
from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.inference.modal_model import Joints, alone, joints
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.experiments import published

FRAMES = {"5A": 5, "5B": 5, "10": 10, "15A": 15, "15B": 15}
TWINS = (("5A", "5B"), ("15A", "15B"))
FREE_STD = 0.005
"""Free vibration, a fraction: printed to three or four digits, a decay of some ten cycles at 0.5 % damping."""
ROOF_STD = 0.03
"""Roof stiffness, a fraction: two or three printed digits of a force over a displacement."""
MASS_STD_KG = 6.28 / np.sqrt(3)
"""Stated mass [kg]: with or without a base plate of 6.28 kg, evenly distributed about half of it."""


def twin_scatter() -> float:
    """Return how far a swept frequency is off a frame of its drawing, a fraction, from the frames built twice.

    Ratios of two frequencies do not depend on how stiff or heavy a frame is as a whole, so twins should share them.
    They do not: each difference of two ratios holds four frequencies.
    """
    rows = published.table("3.1")["experiment"]
    differences = []
    for one, other in TWINS:
        for mode in (2, 3):
            ratios = [
                np.log(rows.loc[name, f"mode{mode}_hz"] / rows.loc[name, "mode1_hz"]) for name in (one, other)
            ]
            differences.append(ratios[0] - ratios[1])
    return float(np.sqrt(np.mean(np.square(differences))) / 2)


def thesis_data(name: str) -> list[ModalDatum]:
    """Return the numbers of a frame: free vibration, sweep, push and stated mass."""
    table = published.table("3.1")
    row, mass = table["experiment"].loc[name], float(table["numerical"].loc[name, "mass_kg"])
    swept = twin_scatter()

    def frequency(mode: int, test: str, hertz: float, share: float) -> ModalDatum:
        return ModalDatum(name, "frequency", mode, test, float(hertz), share * float(hertz))

    roof = 1e6 * float(row["stiffness_kn_per_mm"])
    return [
        frequency(1, "free_vibration", row["free_vibration_hz"], FREE_STD),
        *(frequency(mode, "sweep", row[f"mode{mode}_hz"], swept) for mode in (1, 2, 3)),
        ModalDatum(name, "roof_stiffness", None, "push", roof, ROOF_STD * roof),
        ModalDatum(name, "mass", None, "statement", mass - 3.14, MASS_STD_KG),
    ]


def thesis_belief(name: str, *, p_delta: bool) -> tuple[Model, Joints]:
    """Return the baseline model of a frame of the thesis with rigid joints, and its joints as an effect."""
    frame = CaseFrame(name, FRAMES[name], joints="rigid", p_delta=p_delta)
    case = Case(name, Path(), (frame,), (), ())
    flexible = joints(frame)
    assert flexible is not None
    return alone(baseline_frames(case)[0], Prior()), flexible
