"""Table 3.1 diagnosed: what the rigid-joint frames lack, what P-Delta adds, and why the sweep's f1 disagrees.

The truth is not known. Evidence is that of `inference.modal_evidence`; a size is never judged by the number it was fitted
to: the error beside the evidence is that of second and third frequency and roof stiffness foretold from the first frequency
of free vibration alone. Run it with ``pounding study modal-diagnosis``.
"""

from __future__ import annotations

import json as jsonlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rich.progress import track
from scipy.special import logsumexp

from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.effects.frame import AddedMass, BaseRocking, PDelta
from pounding.diagnosis.effects.storey import StiffnessChange
from pounding.diagnosis.inference.modal_evidence import Softening, Weighed, foretell, weigh
from pounding.diagnosis.inference.modal_model import Joints
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.studies.thesis_modal import (
    FRAMES,
    FREE_STD,
    MASS_STD_KG,
    ROOF_STD,
    thesis_belief,
    thesis_data,
    twin_scatter,
)
from pounding.experiments import published
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.results.provenance import stamp
from pounding.frames.files import replacing, write_whole

SWEEP = "sweep"
POWERS = (0, 1, 2)
LAW_SIZE = 0.1
"""Prior standard deviation of the relative fall of the sweep's f1 of the frame that moves most."""


def without_swept_first(data: Sequence[ModalDatum]) -> list[ModalDatum]:
    """Return the data but for the sweep's first frequency."""
    return [datum for datum in data if not (datum.test == SWEEP and datum.mode == 1)]


def single(model: Model, flexible: Joints) -> dict[str, list[Effect]]:
    """Return the single effects by type, at each of their places."""
    name = model.structure.frames[0].name
    return {
        "joint_flexibility": [flexible],
        "base_rocking": [BaseRocking(frame=name)],
        "p_delta": [PDelta(frame=name)],
        "stiffness_change (one storey)": list(places(StiffnessChange, model)),
        "added_mass (one floor)": list(places(AddedMass, model)),
    }


def best_single(name: str) -> list[dict[str, Any]]:
    """Return for each type of effect its evidence in a frame without the sweep's f1, and what it foretells."""
    model, flexible = thesis_belief(name, p_delta=False)
    data = without_swept_first(thesis_data(name))
    null = weigh(model, data)
    rows = [_single_row(name, "nothing", model, data, null, [null])]
    for kind, acting in single(model, flexible).items():
        found = [weigh(model, data, [one]) for one in acting]
        rows.append(_single_row(name, kind, model, data, null, found))
    return rows


def _single_row(
    name: str,
    kind: str,
    model: Model,
    data: Sequence[ModalDatum],
    null: Weighed,
    found: Sequence[Weighed],
) -> dict[str, Any]:
    """Return a row; a type with many places has the mean of their evidences."""
    best = max(found, key=lambda one: one.log_evidence)
    evidence = logsumexp([one.log_evidence for one in found]) - np.log(len(found))
    told, _ = foretell(model, data, best.acting, [0])
    judged = [i for i, datum in enumerate(data) if i and datum.quantity != "mass"]
    error = [told[i] / data[i].value - 1 for i in judged]
    return {
        "frame": name,
        "effect": kind,
        "log_evidence": float(evidence - null.log_evidence),
        "place": best.acting[0].storey or best.acting[0].floor if best.acting else None,
        "value": float(best.value[0]) if best.acting else None,
        "std": float(best.std[0]) if best.acting else None,
        "misfit": best.misfit,
        "foretold_error": [float(e) for e in error],
    }


def with_gravity(name: str) -> dict[str, Any]:
    """Return what P-Delta adds to flexible joints: gravity as it is, and a free multiple of the weight."""
    data = without_swept_first(thesis_data(name))
    plain_belief, plain_joints = thesis_belief(name, p_delta=False)
    heavy_belief, heavy_joints = thesis_belief(name, p_delta=True)
    bare = weigh(plain_belief, data, [plain_joints])
    gravity = weigh(heavy_belief, data, [heavy_joints])
    free = weigh(plain_belief, data, [plain_joints, PDelta(frame=name)])
    return {
        "frame": name,
        "joints": float(bare.value[0]),
        "joints_with_gravity": float(gravity.value[0]),
        "gravity_nats": gravity.log_evidence - bare.log_evidence,
        "free_factor_nats": free.log_evidence - bare.log_evidence,
        "weight_factor": float(free.value[1]),
        "weight_factor_std": float(free.std[1]),
    }


def why_the_sweep(name: str) -> list[dict[str, Any]]:
    """Return the evidence for what acts in the sweep only, beside joints and gravity, with the sweep's f1."""
    model, flexible = thesis_belief(name, p_delta=True)
    data, first = thesis_data(name), flexible
    roof = model.structure.floors
    seconds: dict[str, Effect] = {
        "softer first mode (amplitude)": Softening(frame=name),
        "base_rocking": BaseRocking(frame=name),
        "p_delta": PDelta(frame=name),
        "joint_flexibility": flexible,
        "added_mass on the roof": AddedMass(index=roof - 1, frame=name, floor=roof),
    }
    bare = weigh(model, data, [first])
    rows = [
        {
            "frame": name,
            "effect": "nothing",
            "log_evidence": 0.0,
            "value": None,
            "std": None,
            "misfit": bare.misfit,
        }
    ]
    for kind, effect in seconds.items():
        found = weigh(model, data, [first, replace(effect, test=SWEEP)])
        rows.append(
            {
                "frame": name,
                "effect": kind,
                "log_evidence": found.log_evidence - bare.log_evidence,
                "value": float(found.value[1]),
                "std": float(found.std[1]),
                "misfit": found.misfit,
            }
        )
    return rows


def amplitude_law() -> dict[str, Any]:
    """Return whether one law for all frames explains how far the sweep's f1 lies below that of free vibration.

    A sweep of one table acceleration drives a storey at resonance in proportion to 1 / (damping ratio, f1 squared, storeys).
    The fall of f1 is a power of that: 0 is the same share everywhere, 1 a joint that slips, 2 a cubic spring.
    """
    rows = published.table("3.1")["experiment"]
    names = list(FRAMES)
    free = np.array([rows.loc[name, "free_vibration_hz"] for name in names])
    swept = np.array([rows.loc[name, "mode1_hz"] for name in names])
    damping = np.array([rows.loc[name, "damping_percent"] for name in names])
    drift = 1 / (damping * free**2 * np.array([FRAMES[name] for name in names]))
    drift /= drift.max()
    fall, std = np.log(swept / free), float(np.hypot(twin_scatter(), FREE_STD))
    beta = np.linspace(0.0, 4 * LAW_SIZE, 400)
    prior = -0.5 * (beta / LAW_SIZE) ** 2
    prior -= logsumexp(prior)

    def density(expected: np.ndarray) -> np.ndarray:
        return np.asarray(-0.5 * np.sum(((fall - expected) / std) ** 2, axis=-1))

    nothing = float(density(np.zeros(len(fall))))
    laws = []
    for power in POWERS:
        each = prior + density(-beta[:, None] * drift**power)
        best = float(beta[int(np.argmax(each))])
        left = [_left_out_fall(fall, drift**power, beta, prior, std, i) for i in range(len(fall))]
        laws.append(
            {
                "power": power,
                "log_evidence": float(logsumexp(each)) - nothing,
                "fall_of_the_most_moved": best,
                "foretold": left,
            }
        )
    return {"frames": names, "drift": drift, "fall": fall, "std": std, "laws": laws}


def _left_out_fall(
    fall: np.ndarray, shape: np.ndarray, beta: np.ndarray, prior: np.ndarray, std: float, i: int
) -> float:
    """Return the fall of a frame as the law foretells it from the other frames."""
    rest = np.arange(len(fall)) != i
    each = prior - 0.5 * np.sum(((fall[rest] + beta[:, None] * shape[rest]) / std) ** 2, axis=1)
    weight = np.exp(each - logsumexp(each))
    return float(-(weight @ beta) * shape[i])


def pooled(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the sum of the evidences over the frames for each effect, each frame with its own size, best first."""
    kinds = list(dict.fromkeys(row["effect"] for row in rows))
    found = []
    for kind in kinds:
        mine = [row for row in rows if row["effect"] == kind]
        errors = [abs(e) for row in mine for e in row.get("foretold_error", [])]
        found.append(
            {
                "effect": kind,
                "log_evidence": float(sum(row["log_evidence"] for row in mine)),
                "each": {row["frame"]: row["log_evidence"] for row in mine},
                "values": {row["frame"]: row["value"] for row in mine},
                "misfit": float(sum(row["misfit"] for row in mine)),
                "mean_foretold_error": float(np.mean(errors)) if errors else None,
            }
        )
    return sorted(found, key=lambda one: -one["log_evidence"])


def main(*, json: options.Json = False, out: options.Out = None) -> dict[str, Any]:
    """Diagnose Table 3.1: what rigid joints lack, what P-Delta adds, why the sweep's first frequency disagrees."""
    console = progress_console()
    names = list(FRAMES)
    singles = [row for name in track(names, "single effects", console=console) for row in best_single(name)]
    gravity = [with_gravity(name) for name in track(names, "gravity", console=console)]
    sweeps = [row for name in track(names, "the sweep", console=console) for row in why_the_sweep(name)]
    uncertainty = {
        "free_vibration": FREE_STD,
        "sweep": twin_scatter(),
        "roof": ROOF_STD,
        "mass_kg": MASS_STD_KG,
    }
    result = stamp({"relative_std": uncertainty}) | {
        "single": singles,
        "single_pooled": pooled(singles),
        "gravity": gravity,
        "sweep": sweeps,
        "sweep_pooled": pooled(sweeps),
        "amplitude_law": amplitude_law(),
    }
    if out is not None:
        write_whole(out / "modal_diagnosis.json", (jsonlib.dumps(plain(result), indent=2) + "\n").encode())
        picture(result, out / "modal_diagnosis.png")
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the study as tables for a reader."""
    std = result["parameters"]["relative_std"]
    yield (
        f"standard deviations: free vibration {std['free_vibration']:.1%}, sweep {std['sweep']:.1%} (twins), "
        f"roof stiffness {std['roof']:.0%}, mass {std['mass_kg']:.1f} kg; nuisance parameters inside their priors"
    )
    yield _pooled_table("1. Rigid joints, no P-Delta; the sweep's f1 left out", result["single_pooled"], True)
    yield _gravity_table(result["gravity"])
    yield _pooled_table(
        "3. What acts in the sweep only, beside joints and gravity", result["sweep_pooled"], False
    )
    yield table(
        "   Size in the sweep: relative change, N m/rad, times the weight, N m/rad, kg",
        ["effect", *FRAMES],
        [
            [
                row["effect"],
                *("–" if row["values"][name] is None else f"{row['values'][name]:.3g}" for name in FRAMES),
            ]
            for row in result["sweep_pooled"]
        ],
    )
    yield _law_table(result["amplitude_law"])


def _pooled_table(title: str, rows: Sequence[dict[str, Any]], judged: bool) -> Any:
    heads = ["effect", "ln Bayes factor, all", *FRAMES, "chi-square"] + (
        ["predicted from f1, mean error"] if judged else []
    )
    lines = []
    for row in rows:
        line = [row["effect"], f"{row['log_evidence']:.1f}", *(f"{row['each'][name]:.1f}" for name in FRAMES)]
        line.append(f"{row['misfit']:.0f}")
        lines.append(line + ([f"{row['mean_foretold_error']:.1%}"] if judged else []))
    return table(title, heads, lines)


def _gravity_table(rows: Sequence[dict[str, Any]]) -> Any:
    return table(
        "2. P-Delta beside flexible joints",
        [
            "frame",
            "joints [N m/rad]",
            "with gravity",
            "gravity, ln Bayes factor",
            "free factor, ln Bayes factor",
            "factor",
        ],
        [
            [
                row["frame"],
                f"{row['joints']:.0f}",
                f"{row['joints_with_gravity']:.0f}",
                f"{row['gravity_nats']:+.1f}",
                f"{row['free_factor_nats']:+.1f}",
                f"{row['weight_factor']:.1f} ± {row['weight_factor_std']:.1f}",
            ]
            for row in rows
        ],
    )


def _law_table(law: dict[str, Any]) -> Any:
    return table(
        "4. One law for all frames: fall of f1 [%] as a power of the storey drift at the sweep's resonance",
        ["law", "ln Bayes factor", *law["frames"]],
        [
            ["measured", "", *(f"{100 * f:.1f}" for f in law["fall"])],
            ["relative drift", "", *(f"{d:.2f}" for d in law["drift"])],
            *(
                [f"power {one['power']}, predicted from the others", f"{one['log_evidence']:.1f}"]
                + [f"{100 * f:.1f}" for f in one["foretold"]]
                for one in law["laws"]
            ),
        ],
    )


def picture(result: dict[str, Any], path: Path) -> None:
    """Draw the evidence of single effects and of what acts in the sweep, and the fall of f1 against drift."""
    figure = Figure(figsize=(9.0, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 2, width_ratios=(1.7, 1))
    for axes, key, title in (
        (upper[0], "single_pooled", "rigid joints lack ..."),
        (lower[0], "sweep_pooled", "in the sweep only ..."),
    ):
        _bars(axes, result[key], title)
    _errors(upper[1], result["single_pooled"])
    _law(lower[1], result["amplitude_law"])
    with replacing(path) as part:
        figure.savefig(part, format="png", dpi=90)


def _bars(axes: Any, rows: Sequence[dict[str, Any]], title: str) -> None:
    shown = [row for row in rows if row["effect"] != "nothing"][::-1]
    left = np.zeros(len(shown))
    for number, name in enumerate(FRAMES):
        width = np.array([max(row["each"][name], 0.0) for row in shown])
        axes.barh([row["effect"] for row in shown], width, left=left, label=name, color=f"C{number}")
        left += width
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlabel("ln Bayes factor", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=8, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)


def _errors(axes: Any, rows: Sequence[dict[str, Any]]) -> None:
    shown = rows[::-1]
    axes.barh(
        [row["effect"] for row in shown], [100 * row["mean_foretold_error"] for row in shown], color="#888888"
    )
    axes.set_title("f2, f3, roof from free f1", loc="left", fontsize=10)
    axes.set_xlabel("mean error [%]", fontsize=9)
    axes.tick_params(labelsize=7)
    axes.spines[["top", "right"]].set_visible(False)


def _law(axes: Any, law: dict[str, Any]) -> None:
    axes.errorbar(law["drift"], 100 * law["fall"], 100 * law["std"], fmt="ko", ms=4, label="measured")
    for x, y, name in zip(law["drift"], 100 * law["fall"], law["frames"], strict=True):
        axes.annotate(name, (x, y), textcoords="offset points", xytext=(4, 4), fontsize=8)
    at = np.linspace(0, 1, 50)
    for one in law["laws"]:
        axes.plot(
            at, -100 * one["fall_of_the_most_moved"] * at ** one["power"], lw=1, label=f"power {one['power']}"
        )
    axes.set_xlabel("storey drift at resonance, relative", fontsize=9)
    axes.set_ylabel("fall of f1 [%]", fontsize=9)
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=7, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)


if __name__ == "__main__":
    run_script(main)
