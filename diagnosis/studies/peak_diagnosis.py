"""Table 4.1 diagnosed: which effect of the catalogue, fitted to the peaks of two records, explains those of two others.

The truth is not known. For each of the six ways to split four records an effect's size is the likeliest on two of them,
one size for all frames or one a frame, and judged on the other two: by the mean of abs(model - measured) / measured, and by
the log density that the two foretell for the other two. Contested peaks are left out of both. Run it with
``pounding study peak-diagnosis``.
"""

from __future__ import annotations

import json as jsonlib
from collections.abc import Iterable, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rich.progress import Progress
from scipy.special import logsumexp

from pounding.diagnosis.case.case import Case, CaseFrame, Prior
from pounding.diagnosis.case.numbers import Peak
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.studies.thesis_modal import FRAMES
from pounding.diagnosis.studies.whole_frames import CATALOGUE, PeakModel, WholeFrame, evidence, log_likelihood
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.records import RECORDS, Record, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.studies.table_4_1 import KEPT_ARIAS, measured, trusted
from pounding.frames.files import replacing, write_whole
from pounding.scale import THESIS

STEP_S = 1e-3
"""Longest step at which the table's motion is sampled [s]; the frames take two substeps in it."""
STD_MM, STD_SHARE = 0.2, 0.03
"""Uncertainty of a peak: a fifth of a millimetre (printed to one tenth, laser), and three per cent of it."""
SPLITS = tuple(combinations(RECORDS, 2))


def shaking(name: str, folder: Path | None) -> tuple[Record, RunData]:
    """Return a record and the table's motion by it at model time."""
    record = find(name, folder)
    motion = record.scaled(THESIS.time_factor).trimmed(lower=0.0, upper=KEPT_ARIAS)
    motion = motion.resampled(motion.step_s / np.ceil(motion.step_s / STEP_S))
    samples = len(motion.acceleration_m_s2)
    nothing = np.zeros((samples, 0))
    time = np.arange(samples) * motion.step_s
    return record, RunData(name, motion.step_s, time, motion.acceleration_m_s2, nothing, nothing)


def thesis_peaks(frame: str) -> list[Peak]:
    """Return the peaks of a frame in Table 4.1 that no other number of the thesis contradicts."""
    printed, sure = measured(), trusted()
    found = []
    for place in np.flatnonzero(printed.frame.values == frame):
        for record in RECORDS:
            if not bool(sure.sel(record=record)[place]):
                continue
            for side in ("max", "min"):
                value = float(printed.sel(record=record, side=side)[place])
                std = float(np.hypot(STD_MM, STD_SHARE * value))
                floor = int(printed.floor[place])
                found.append(Peak(record, frame, floor, side, 1e-3 * value, 1e-3 * std))
    return found


def peak_model(name: str, runs: Sequence[RunData]) -> PeakModel:
    """Return the baseline model of a frame of the thesis, with its peaks."""
    case = Case(name, Path(), (CaseFrame(name, FRAMES[name]),), (), ())
    return PeakModel(baseline_frames(case)[0], runs, thesis_peaks(name), Prior())


def split_of(peaks: Sequence[Peak], records: Sequence[str]) -> np.ndarray:
    """Return which peaks belong to records, shape (peaks,)."""
    return np.array([peak.run in records for peak in peaks])


def judge(predicted: dict[str, np.ndarray], peaks: dict[str, tuple[Peak, ...]], each: bool) -> dict[str, Any]:
    """Return how near an effect comes on records it was not fitted to.

    Args:
        predicted: Peaks of each frame for all sizes (sizes, peaks), the first size being no effect.
        peaks: What was measured on each frame.
        each: One size a frame instead of one for all.
    """
    held, model, picked, foretold = [], [], [], []
    for train in SPLITS:
        groups = [[name] for name in peaks] if each else [list(peaks)]
        errors, neutral, sizes, gain = [], [], [], 0.0
        for group in groups:
            learnt = _likelihood(predicted, peaks, group, train)
            whole = _likelihood(predicted, peaks, group, RECORDS)
            gain += (evidence(whole) - evidence(learnt)) - (evidence(whole[:1]) - evidence(learnt[:1]))
            best = int(np.argmax(logsumexp(learnt, axis=1)))
            sizes += [best]
            for name in group:
                test = ~split_of(peaks[name], train)
                truth = np.array([peak.value for peak in peaks[name]])[test]
                errors.append(np.abs(predicted[name][best][test] / truth - 1))
                neutral.append(np.abs(predicted[name][0][test] / truth - 1))
        held.append(float(np.mean(np.concatenate(errors))))
        model.append(float(np.mean(np.concatenate(neutral))))
        picked.append(sizes)
        foretold.append(gain)
    return {
        "held_out": float(np.mean(held)),
        "baseline": float(np.mean(model)),
        "closed": float(1 - np.mean(held) / np.mean(model)),
        "worse_in": int(np.sum(np.array(held) > np.array(model))),
        "foretold_nats": float(np.mean(foretold)),
        "picked": picked,
        "by_split": held,
    }


def _likelihood(
    predicted: dict[str, np.ndarray],
    peaks: dict[str, tuple[Peak, ...]],
    group: Sequence[str],
    records: Sequence[str],
) -> np.ndarray:
    """Return the log likelihood of the peaks of frames in records, (sizes, scatters), one scatter for all of them."""
    total: Any = 0.0
    for name in group:
        chosen = split_of(peaks[name], records)
        kept = [peak for peak, one in zip(peaks[name], chosen, strict=True) if one]
        total = total + log_likelihood(predicted[name][:, chosen], kept)
    return np.asarray(total)


def row(
    effect: WholeFrame, predicted: dict[str, np.ndarray], peaks: dict[str, tuple[Peak, ...]]
) -> dict[str, Any]:
    """Return what the peaks say of an effect, with one size for all frames and with one a frame.

    Args:
        effect: The effect.
        predicted: Peaks of each frame [m], shape (sizes, peaks).
        peaks: Measured peaks of each frame.
    """
    common, each = judge(predicted, peaks, False), judge(predicted, peaks, True)
    everything = _likelihood(predicted, peaks, list(peaks), RECORDS)
    sizes = np.array(effect.sizes)
    best = {name: float(sizes[int(np.argmax(logsumexp(log_likelihood(predicted[name], peaks[name]), axis=1)))])
            for name in peaks}  # fmt: skip
    return {
        "effect": effect.name,
        "what": effect.what,
        "unit": effect.unit,
        "log_evidence": evidence(everything) - evidence(everything[:1]),
        "sizes": [float(sizes[one[0]]) for one in common["picked"]],
        "common": common,
        "each": each,
        "size_of_each": best,
    }


def main(
    *, records: options.Records = None, json: options.Json = False, out: options.Out = None
) -> dict[str, Any]:
    """Diagnose Table 4.1: which effect, fitted to two records, explains how much of the misfit on the other two."""
    found = [shaking(name, records) for name in RECORDS]
    runs = [run for _, run in found]
    with Progress(console=progress_console(), transient=True) as progress:
        task = progress.add_task("baseline frames", total=len(FRAMES) * len(CATALOGUE))
        models = {name: peak_model(name, runs) for name in FRAMES}
        peaks = {name: one.peaks for name, one in models.items()}
        rows = []
        for effect in CATALOGUE:
            predicted = {}
            for name, one in models.items():
                progress.update(task, description=f"{effect.name} in {name}", advance=1)
                predicted[name] = np.array([one.predict(effect, size) for size in effect.sizes])
            rows.append(row(effect, predicted, peaks))
    rows.sort(key=lambda one: one["common"]["held_out"])
    result = stamp({"std_mm": STD_MM, "std_share": STD_SHARE}, [record for record, _ in found])
    result |= {"peaks": sum(len(one) for one in peaks.values()), "effects": rows}
    if out is not None:
        write_whole(out / "peak_diagnosis.json", (jsonlib.dumps(plain(result), indent=2) + "\n").encode())
        picture(rows, out / "peak_diagnosis.png")
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the study as tables for a reader."""
    rows = result["effects"]
    unchanged = rows[0]["common"]["baseline"]
    lines = []
    for one in rows:
        common, each = one["common"], one["each"]
        low, high = min(one["sizes"]), max(one["sizes"])
        away = not np.isfinite(common["held_out"])
        lines.append(
            [
                one["effect"],
                "runs away" if away else f"{100 * common['held_out']:.1f}",
                "–" if away else f"{100 * common['closed']:.0f}",
                f"{common['worse_in']}",
                f"{common['foretold_nats']:+.1f}",
                f"{low:.3g} to {high:.3g} {one['unit']}",
                f"{100 * each['held_out']:.1f}" if np.isfinite(each["held_out"]) else "runs away",
                f"{each['foretold_nats']:+.1f}",
                f"{one['log_evidence']:.1f}",
            ]
        )
    yield table(
        f"{result['peaks']} uncontested peaks of Table 4.1; mean |model - measured| / measured on records not fitted [%], "
        f"baseline model {100 * unchanged:.1f}; one size for all frames, or one for each",
        [
            "effect",
            "all",
            "explained %",
            "worse in",
            "ln Bayes factor",
            "sizes in six splits",
            "each",
            "ln Bayes factor",
            "evidence, all four",
        ],
        lines,
    )
    yield table(
        "Size in each frame, fitted to all four records (not judged)",
        ["effect", "unit", *FRAMES],
        [
            [one["effect"], one["unit"], *(f"{one['size_of_each'][name]:.3g}" for name in FRAMES)]
            for one in rows
        ],
    )


def picture(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Draw the held-out error of every effect, with the six splits as dots."""
    figure = Figure(figsize=(8.0, 4.6), layout="constrained")
    axes = figure.subplots()
    y = np.arange(len(rows))[::-1]
    for shift, key, colour, label in (
        (0.18, "common", "#2e86c1", "one size for all frames"),
        (-0.18, "each", "#e59866", "one size a frame"),
    ):
        axes.barh(
            y + shift, [100 * one[key]["held_out"] for one in rows], height=0.34, color=colour, label=label
        )
        for place, one in zip(y, rows, strict=True):
            dots = 100 * np.array(one[key]["by_split"])
            axes.plot(dots, np.full(len(dots), place + shift), "k.", ms=3)
    axes.axvline(100 * rows[0]["common"]["baseline"], color="#c0392b", lw=1, label="baseline model")
    axes.set_yticks(y, [one["effect"].replace("_", " ") for one in rows])
    axes.set_xlim(0, 60)
    axes.set_xlabel(
        "mean |model − measured| / measured on the two records not fitted [%]; dots: the six splits"
    )
    axes.legend(fontsize=8, frameon=False, loc="lower right")
    axes.spines[["top", "right"]].set_visible(False)
    with replacing(path) as part:
        figure.savefig(part, format="png", dpi=90)


if __name__ == "__main__":
    run_script(main)
