"""The tables of a benchmark for a reader."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from rich.table import Table

from pounding.diagnosis.benchmark.scoring import NOTHING, UNKNOWN
from pounding.diagnosis.benchmark.summary import AT_MOST, SHOWN, TARGETS


def tables(result: Mapping[str, Any]) -> Iterator[Table | str]:
    """Yield the tables of a benchmark, as `run_benchmark` returns it."""
    yield _figures(result)
    yield _detection(result)
    yield _confusion(result)
    yield _reliability(result)
    yield _misses(result)
    seconds, largest = result["seconds_median"], result["seconds_largest"]
    if seconds is not None:
        memory = result["memory_mb"]
        yield f"time a case: {seconds:.1f} s in the median, {largest:.1f} s at most; {memory:.0f} MB"
    for reason in result["failures"]:
        yield f"failed: {reason}"


def _percent(part: Mapping[str, Any]) -> str:
    if part["share"] is None:
        return "–"
    return f"{part['share']:.0%} ({part['hits']}/{part['cases']}; {part['low']:.0%} to {part['high']:.0%})"


def _figures(result: Mapping[str, Any]) -> Table:
    table = Table(
        "figure",
        "reached (95 % interval)",
        "asked for",
        title=f"{result['cases']} cases",
        title_justify="left",
    )
    for name, value in result.items():
        if isinstance(value, Mapping) and "share" in value:
            reached = _percent(value)
        elif name in TARGETS:
            reached = "–" if value is None else f"{value:.1%}"
        elif name == "parameter_deviation_median":
            reached = "–" if value is None else f"{value:.2f} standard errors"
        else:
            continue
        sign = "at most" if name in AT_MOST else "at least"
        asked = f"{sign} {TARGETS[name]:.0%}" if name in TARGETS else ""
        table.add_row(name.replace("_", " "), reached, asked)
    return table


def _detection(result: Mapping[str, Any]) -> Table:
    table = Table(
        "signal-to-noise", "detected", "exact", title="Single effects by size", title_justify="left"
    )
    for row in result["detection"]:
        low, high = row["signal_to_noise"]
        bounds = f"{low:g} to {high:g}" if high is not None else f"above {low:g}"
        table.add_row(bounds, _percent(row["detected"]), _percent(row["exact"]))
    return table


def _misses(result: Mapping[str, Any]) -> Table:
    """Return every verdict that is not right, by kind."""
    table = Table("miss", "frames", "hidden", "called", "signal-to-noise", title="Misses")
    table.title_justify = "left"
    for one in result["misses"]:
        hidden, size = ", ".join(one["effects"]) or "nothing", one["signal_to_noise"]
        strength = "" if not one["effects"] else f"{size:.2g}"
        table.add_row(one["miss"], "-".join(one["frames"]), hidden, one["called"], strength)
    return table


def _confusion(result: Mapping[str, Any]) -> Table:
    """Return what each hidden effect was called and how often, most often first."""
    names = {NOTHING: "nothing missing", UNKNOWN: "unknown effect"}
    table = Table("hidden", "called, how often", "exact if detected", title="Called what")
    table.title_justify = "left"
    for truth, row in result["confusion"].items():
        right = result["by_effect"].get(truth)
        called = sorted(row.items(), key=lambda one: -one[1])
        cells = ", ".join(f"{names.get(name, name)} {times}" for name, times in called)
        table.add_row(names.get(truth, truth), cells, _percent(right) if right else "")
    return table


def _reliability(result: Mapping[str, Any]) -> Table:
    table = Table("confidence", "stated", "right", "right as far as shown", title="Stated confidence")
    table.title_justify = "left"
    table.caption = f"as far as shown: 'nothing missing' is right below a signal-to-noise ratio of {SHOWN:g}"
    table.caption_justify = "left"
    for row in result["reliability"]:
        low, high = row["confidence"]
        stated = "–" if row["stated"] is None else f"{row['stated']:.0%}"
        table.add_row(f"{low:g} to {high:g}", stated, _percent(row["right"]), _percent(row["right_as_shown"]))
    return table
