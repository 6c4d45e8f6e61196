"""A verdict in plain words: `storey 2 of 5A is 30 ± 2 % softer than the model`."""

from __future__ import annotations

import math

from pounding.diagnosis.decision.claims import Claim, Parameter
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.describing import Description
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.report.report_text import together, turned_round


def headline(report: Report) -> str:
    """Return the verdict in plain words, one sentence."""
    if report.verdict == "nothing_missing" and report.remainder and report.remainder.within:
        return "The model follows the measurements as well as models of real frames do; nothing else is missing in it."
    if report.verdict == "nothing_missing":
        return "The model follows the measurements: nothing is missing in it that this data could show."
    if report.verdict == "unknown_effect":
        return "The model lacks something that is not in the catalogue of effects."
    said = "; ".join(finding(one) for one in together(report.effects))
    others = len(report.effects[0].members) - 1
    if report.verdict == "effect_class" and others > 0:
        said += ", or something else that this data cannot tell from it"
    return f"{said[0].upper()}{said[1:]}."


def finding(effect: Claim) -> str:
    """Return an effect in plain words; what has none of its own is named with its parameters."""
    described = description(effect.effect)
    first = effect.parameters[0] if effect.parameters else None
    if described is None or not described.plain or first is None or not isinstance(first.value, float):
        return effect.sized()
    said = described.plain[-1] if first.value >= 0.0 else described.plain[0]
    where = effect.where()
    if turned_round(effect):
        return f"{where} reads minus the truth: its polarity is wrong"
    # Channels of one logger are said together.
    said = said.replace("{where} reads", "{where} read") if where.startswith("channels ") else said
    return said.format(where=where, size=size(first))


def description(name: str) -> Description | None:
    """Return what the catalogue says of the effect of that name; None for one that is not in it."""
    return next((kind.described for kind in kinds() if kind.name == name and kind.described), None)


def size(parameter: Parameter) -> str:
    """Return a parameter without its sign, as many digits as its standard error leaves: `0.53 ± 0.04 N`, `30 ± 2 %`."""
    assert isinstance(parameter.value, float)
    share = "relative_change" in parameter.name
    factor, unit = (100.0, "%") if share else (1.0, parameter.shown_unit)
    std = factor * parameter.std if isinstance(parameter.std, float) else 0.0
    return f"{_rounded(factor * abs(parameter.value), std)} {unit.translate(RAISED)}".replace(
        "^", ""
    ).rstrip()


RAISED = {ord("2"): "²", ord("3"): "³"}
"""Powers of units; no unit has another digit."""
POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
PLAIN = (-3, 4)
"""Powers of ten of the first digit between which a number is written without one."""


def _rounded(value: float, std: float) -> str:
    power = math.floor(math.log10(value)) if value > 0.0 else 0
    if not PLAIN[0] <= power <= PLAIN[1]:
        digits = _rounded(value / 10.0**power, std / 10.0**power)
        return f"{f'({digits})' if ' ' in digits else digits}·10{str(power).translate(POWERS)}"
    if not std > 0.0:
        return f"{value:.3g}"
    # One digit of the error, and the value down to the place of that digit.
    place = math.floor(math.log10(float(f"{std:.0e}")))
    decimals = max(0, -place)
    return f"{round(value, -place):.{decimals}f} ± {round(std, -place):.{decimals}f}"
