"""What `truth.json` says of a case: what is hidden, and how much of it can be seen."""

from __future__ import annotations

import numpy as np

from tests.planar_world.baseline import baseline_of, modes
from tests.planar_world.making import STEPS, STEPS_WITHOUT_BOUND, WITHIN, Made, Rig, calibrated
from tests.planar_world.measuring import TABLE_NOISE
from tests.planar_world.refits import fit_own, over_channels, sizes
from tests.planar_world.structure import drift

Truth = dict[str, object]
"""An object of JSON, by the names in `truth.json`."""

SIZE_NOTE = (
    "size_raw: rms over channels of rms(with-without)/rms(with), runs pooled; above 0.4 where a frequency shifts (damping "
    "0.5 %). size_after_frame_stiffness_and_damping_refit: own model without effect, one stiffness and one damping factor "
    "fitted. refit_within_2_prior_sd: baseline model, storeys 3 %, floors 1 %, modal damping 20 % each held within 2 sd, "
    "frame factor free to 0.4; [motion without effect = model error, with effect = roughly what is visible]."
)
STOREY_NOTE = (
    "relative_change of a storey is by projection on the baseline pattern; "
    "columns_factor is what was done to its columns"
)


def truth(made: Made) -> Truth:
    """Return the truth of a case that was made."""
    plan, setting, frame = made.plan, made.rig.setting, made.rig.frame
    kind = "half of the variance white, half AR(1) with pole 0.95" if plan.coloured else "white"
    peaks = [np.abs(one(np.arange(0, 8, 0.001))).max() for one in setting.shaken]
    drifts = [made.taken.largest(drift(plan.storeys, storey)) for storey in range(1, plan.storeys + 1)]
    return {
        "case": plan.name,
        "frame": plan.frame,
        "noise": plan.noise,
        "noise_kind": kind,
        "table_noise": TABLE_NOISE,
        "records": list(setting.sources),
        "output": "anti-aliased 200 Hz zero phase" if setting.sensing.filtered else "sampled",
        "channels": [channel.name for channel in setting.channels],
        **(_of_effects(made.rig) if plan.kinds else _of_null(made.rig)),
        "convergence": made.convergence,
        "max_drift_mm": max(drifts) * 1e3,
        "f1_hz": float(modes(*frame.matrices())[0][0]),
        "f1_baseline": float(baseline_of(plan.frame).frequencies()[0]),
        "stiffness_scatter": frame.scatter.tolist(),
        "peaks_m_s2": [float(peak) for peak in peaks],
        "size_note": SIZE_NOTE,
        "storey_note": STOREY_NOTE,
    }


def _of_null(rig: Rig) -> Truth:
    """Return how strange the construction is, and what calibrations of the baseline frame leave."""
    style, within = rig.frame.style, rig.left
    assert within is not None
    said = {"pd": style.weight, "base": style.foot, "jtop": style.roof, "ke": style.fitting}
    difference = {
        "strength": rig.strength,
        "damping": style.damping,
        "kw": {name: value for name, value in said.items() if value is not None},
        "left_after_refit_within_2_prior_sd": within.rms,
        "left_after_unbounded_refit": calibrated(rig.setting, rig.taken, STEPS_WITHOUT_BOUND).rms,
        "median": within.median,
    }
    return {"effects": [], "outside": False, "model_difference": difference, "size_raw": 0.0}


def _of_effects(rig: Rig) -> Truth:
    """Return the effects, and what of them is seen before and after fits of a linear frame."""
    setting, bare, read = rig.setting, rig.bare, rig.taken
    size = sizes(read.responses, bare.responses)
    own = fit_own(setting.scene, rig.frame, read.responses)
    within = [calibrated(setting, one, STEPS, WITHIN).rms for one in (bare, read)]
    without, with_it = (calibrated(setting, one, STEPS_WITHOUT_BOUND) for one in (bare, read))
    return {
        "refit_within_2_prior_sd_without_and_with_effect": within,
        "effects": [told.entry() for told in rig.effects],
        "outside": any("outside" in told.effect for told in rig.effects),
        "size_raw": over_channels(size),
        "size_raw_largest_channel": float(size.max()),
        "size_raw_each": _each(rig),
        "size_after_frame_stiffness_and_damping_refit": own.left,
        "refit_factors": [float(own.stiffness), float(own.damping)],
        "baseline_refit_left_without_effect": without.rms,
        "baseline_refit_left_with_effect": with_it.rms,
        "baseline_refit_left_with_effect_median": with_it.median,
        "damping": rig.frame.style.damping,
    }


def _each(rig: Rig) -> list[float]:
    """Return what each of two effects changes alone [-]; nothing for one."""
    if len(rig.placed) < 2:
        return []
    alone = [one.put(rig.frame, rig.frame.structure())[0] for one in rig.placed]
    reads = [rig.setting.taken(structure).responses for structure in alone]
    return [over_channels(sizes(read, rig.bare.responses)) for read in reads]
