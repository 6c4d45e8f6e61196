"""A verdict in plain words: `storey 2 of 5A is 30 ± 2 % softer than the model`."""

from __future__ import annotations

from pounding.diagnosis.decision.claims import Claim, Parameter
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.describing import Description
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.report.report_text import together


def headline(report: Report) -> str:
    """Return the verdict in plain words, one sentence."""
    if report.verdict == "nothing_missing":
        return "The model follows the measurements: nothing is missing in it that this data could show."
    if report.verdict == "unknown_effect":
        return "The model lacks something that is not in the catalogue of effects."
    said = "; ".join(finding(one) for one in together(report.effects))
    others = len(report.effects[0].members) - 1
    if report.verdict == "effect_class" and others > 0:
        said += ", or what this data cannot tell from it"
    return f"{said[0].upper()}{said[1:]}."


def finding(effect: Claim) -> str:
    """Return an effect in plain words; what has none of its own is named with its parameters."""
    described = description(effect.effect)
    first = effect.parameters[0] if effect.parameters else None
    if described is None or not described.plain or first is None or not isinstance(first.value, float):
        return effect.sized()
    said = described.plain[-1] if first.value >= 0.0 else described.plain[0]
    where = effect.where()
    # Channels of one logger are said together.
    said = said.replace("{where} reads", "{where} read") if where.startswith("channels ") else said
    return said.format(where=where, size=size(first))


def description(name: str) -> Description | None:
    """Return what the catalogue says of the effect of that name; None for one that is not in it."""
    return next((kind.described for kind in kinds() if kind.name == name and kind.described), None)


def size(parameter: Parameter) -> str:
    """Return a parameter without its sign: `0.53 ± 0.04 N`, and `30 ± 2 %` for a relative change."""
    assert isinstance(parameter.value, float)
    share = "relative_change" in parameter.name
    factor, unit = (100.0, "%") if share else (1.0, "" if parameter.unit == "1" else parameter.unit)
    value = f"{factor * abs(parameter.value):.3g}"
    if isinstance(parameter.std, float):
        value += f" ± {factor * parameter.std:.1g}"
    return f"{value} {unit}".rstrip()
