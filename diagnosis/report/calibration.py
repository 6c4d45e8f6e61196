"""What became of the baseline model: its parameters and frequencies before and after calibration, and what then remains."""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import UNSET

from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.decision.claims import finite
from pounding.diagnosis.decision.false_alarms import p_value, remains
from pounding.diagnosis.decision.measures import model_error, remaining, within_model_error
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.misfit import allowed_error
from pounding.diagnosis.inference.refine import Fit
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.model.first_frequencies import measured_frequency
from pounding.diagnosis.model.nuisance import CHANNEL_DELAY, MODAL_DAMPING, MODAL_STIFFNESS, Parameter
from pounding.diagnosis.report.report import LOGARITHMS, CalibratedParameter, Remainder
from pounding.diagnosis.settings import SETTINGS

FROM_ZERO = ("table_delay", CHANNEL_DELAY, "damping_power")
"""Nuisance parameters that are zero in the baseline model: times [s] and a power [-]; others are logarithms of a factor, or
changes relative to one."""
FREQUENCIES = 3
"""How many frequencies of each frame are stated."""
SHOWN = 1e-4
"""Smallest share of the motion that is stated: no measurement is so exact."""


def calibration(
    found: Findings, judged: Judged, contact: Fitted | None = None
) -> tuple[CalibratedParameter, ...]:
    """Return the frames' frequencies and damping and every nuisance parameter that moved, before and after calibration.

    Args:
        found: What the search found.
        judged: What the verdict rests on.
        contact: The contact of the baseline model as its impacts have it; None where there is none, or it is another one.
    """
    return (*_modal(found, judged.fit), *_moved(found, judged.fit), *_moved_contact(contact))


def _modal(found: Findings, fit: Fit) -> list[CalibratedParameter]:
    model = found.model
    before = model.plain_modes(model.assemble(np.zeros(len(model.std))))
    after = model.plain_modes(model.assemble(fit.filtered.values))
    found_in = model.plain_modes(model.assemble(fit.filtered.values, fit.filtered.effects))
    shown = []
    for number, frame in enumerate(model.structure.frames):
        first = model.structure.first(number)
        peak = measured_frequency(model, number, float(before.omega[first]) / (2 * np.pi))
        for mode in range(min(FREQUENCIES, frame.floors)):
            hertz = [float(one.omega[first + mode]) / (2 * np.pi) for one in (before, after)]
            ratios = [float(one.ratio[first + mode]) for one in (before, after)]
            for name, (baseline, calibrated) in (("frequency_hz", hertz), ("damping_ratio", ratios)):
                read = peak if mode == 0 and name == "frequency_hz" else None
                shown.append(
                    CalibratedParameter(
                        parameter=name, frame=frame.name, mode=mode + 1, baseline=baseline, calibrated=calibrated,
                        std=None, prior_std=None,
                        measured=UNSET if read is None else read.hertz,
                        resolution=UNSET if read is None else read.resolution_hz,
                        corrected=UNSET if name != "frequency_hz" else float(found_in.omega[first + mode]) / (2 * np.pi),
                    )
                )  # fmt: skip
    return shown


def _moved(found: Findings, fit: Fit) -> list[CalibratedParameter]:
    model = found.model
    rows = zip(model.parameters, fit.filtered.values, fit.nuisance_std, strict=True)
    return [
        _entry(found, one, float(value), float(std))
        for one, value, std in rows
        if one.kind not in (MODAL_STIFFNESS, MODAL_DAMPING) and abs(value) > SETTINGS.report.moved * one.std
    ]


def _moved_contact(contact: Fitted | None) -> list[CalibratedParameter]:
    if contact is None:
        return []
    known, was, law = contact.hypothesis, contact.hypothesis.law, contact.law
    stiffer, lossier = law.stiffness / was.stiffness, law.damping / was.damping
    gap, stiffness, loss = contact.std
    rows = [
        ("contact_gap", was.gap_m, law.gap_m, gap, known.gap),
        ("contact_stiffness", 1.0, stiffer, stiffer * stiffness, known.stiffness),
        ("contact_damping", 1.0, lossier, lossier * loss, known.loss),
        ("contact_restitution", was.restitution, law.restitution, loss, known.loss),
    ]
    each = [
        CalibratedParameter(
            parameter=name, baseline=baseline, calibrated=calibrated, std=std, prior_std=prior, contact=1
        )
        for name, baseline, calibrated, std, prior in rows
        # A law without loss has neither of the last two, any other one of them.
        if prior > 0.0 and np.isfinite(calibrated)
    ]
    return [one for one in each if abs(one.moved() or 0.0) > SETTINGS.report.moved]


def _entry(found: Findings, one: Parameter, value: float, std: float) -> CalibratedParameter:
    if one.kind in FROM_ZERO:
        baseline, calibrated, factor = 0.0, value, 1.0
    elif one.kind in LOGARITHMS:
        baseline, calibrated, factor = 1.0, float(np.exp(value)), float(np.exp(value))
    else:
        baseline, calibrated, factor = 1.0, 1.0 + value, 1.0
    return CalibratedParameter(
        parameter=one.kind, baseline=baseline, calibrated=calibrated, std=factor * std, prior_std=one.std,
        **_place(found, one),
    )  # fmt: skip


def _place(found: Findings, one: Parameter) -> dict[str, Any]:
    """Return where a nuisance parameter is, as the report's keys."""
    structure = found.model.structure
    if one.kind.startswith("frame_") or one.kind in ("joint_stiffness", "damping_power"):
        return {"frame": structure.frames[one.place].name}
    if one.kind.startswith("channel_"):
        return {"channel": found.model.observed.names[one.place]}
    key = {
        "storey_stiffness": "storey",
        "base_stiffness": "storey",
        "floor_mass": "floor",
        "mode_damping": "mode",
    }
    if one.kind not in key:
        return {}
    frame, number = structure.place(one.place)
    return {"frame": frame, key[one.kind]: number}


def remainder(found: Findings, judged: Judged, sight: Sight) -> Remainder:
    """Return what remains with everything claimed in the model: the discrepancy, and whether more than noise is left.

    Args:
        found: What the search found.
        judged: What the verdict rests on.
        sight: What changes of its model do to the channels.
    """
    size, left = sight.discrepancy(), remaining(found, judged)
    share = "less than 0.01" if size < SHOWN else f"{100 * size:.2g}"
    model = (
        "the baseline model" if found.plain is None else "the baseline model with the frame's errors in it"
    )
    said = f"{model} and the frame differ by {share} % of the motion in ways that no single effect explains"
    chance = p_value(found, left)
    if not remains(found, left):
        return Remainder(
            p_value=chance, linear=True, size=finite(size), statement=f"{said}; what is left is noise"
        )
    linear = sight.linear_share() > SETTINGS.report.linear
    kind = (
        "most of that a frame of other stiffness, mass or damping would explain: the model is not quite this frame"
        if linear
        else "no frame of other stiffness, mass or damping would explain it: another law, or another effect"
    )
    within = judged is found.null and within_model_error(found)
    allowed = (
        f"; {100 * model_error(found):.2g} % of the motion are less than the "
        f"{100 * allowed_error(found.model):.2g} % that the model of a real frame may leave (model_error in case.toml)"
    )
    return Remainder(
        p_value=chance,
        linear=linear,
        size=finite(size),
        statement=f"{said}; {_floors(left)}, and {kind}{allowed if within else ''}",
        within=within,
    )


def _floors(left: float) -> str:
    if left < 1.05:
        return "a little more than noise is left"
    return f"{left:.2g} noise floors are left in the median channel"
