"""What an effect needs to be named, and when something remains: by the rate of false alarms, over simulated nulls.

The nulls that come with the package are in `nulls.csv`; its first lines say which command made it, at which commit.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.tails import FalseAlarms, Tail
from pounding.diagnosis.settings import SETTINGS

FILE = Path(__file__).with_name("nulls.csv")


@cache
def stored(rate: float = SETTINGS.decision.false_alarms, candidates: int = 1) -> FalseAlarms:
    """Return false alarms by the nulls that come with the package.

    Args:
        rate: Share of nulls that may raise one.
        candidates: How many effects are tried.
    """
    rows, said = read_nulls(FILE)
    return replace(of_rows(rate, rows, f"{len(rows)} simulated nulls; {said}"), candidates=candidates)


def read_nulls(path: Path) -> tuple[list[dict[str, str]], str]:
    """Return the nulls of a file, a mapping each, and what its first lines say of them.

    Args:
        path: The file.
    """
    lines = path.read_text(encoding="utf-8").splitlines()
    said = [line.removeprefix("#").strip() for line in lines if line.startswith("#")]
    return list(csv.DictReader(line for line in lines if not line.startswith("#"))), " ".join(said)


def of_rows(rate: float, rows: Sequence[Mapping[str, str]], source: str) -> FalseAlarms:
    """Return false alarms by nulls of a file.

    Args:
        rate: Share of nulls that may raise one.
        rows: The nulls.
        source: Where they come from.
    """
    evidence = [max(float(row["ordinary"]), float(row["absorbing"])) for row in rows]
    return of_nulls(rate, evidence, [float(row["left"]) for row in rows], source)


def of_nulls(rate: float, evidence: Sequence[float], left: Sequence[float], source: str) -> FalseAlarms:
    """Return false alarms by nulls.

    Args:
        rate: Share of nulls that may raise one.
        evidence: Largest ln Bayes factor of a single effect in each null.
        left: Misfit over the noise floor of each null.
        source: Where the nulls come from.
    """
    return FalseAlarms(rate, Tail(tuple(sorted(evidence))), Tail(tuple(sorted(left))), source)


def alarms_of(found: Findings) -> FalseAlarms:
    """Return the false alarms by which findings are judged: those of the package where they have none of their own."""
    return found.false_alarms or stored()


def thresholds(found: Findings, absorbing: bool = False) -> tuple[float, float]:
    """Return the ln Bayes factor and the size, in units of a channel's noise, that an effect needs to be named.

    Args:
        found: The findings.
        absorbing: Whether a little of it mends what every baseline frame has wrong (see `Effect.absorbing`); it needs more.
    """
    pair = found.pair
    if pair is None:
        return alarms_of(found).needed, least_size(absorbing)
    needs = SETTINGS.pair_decision
    known = needs.unmeasured_factor if pair.blind else 1.0
    if absorbing:
        return _beside(found) * known * needs.absorbing_evidence, _beside(found) * needs.absorbing_size
    return known * needs.local_evidence, needs.local_size


def least_size(absorbing: bool) -> float:
    """Return the size that an effect of a single frame needs to be named, in units of a channel's noise.

    Args:
        absorbing: As in `thresholds`.
    """
    return SETTINGS.decision.absorbing_size if absorbing else SETTINGS.decision.size


def _beside(found: Findings) -> float:
    claimed = found.pair is not None and found.pair.contact_claimed
    return SETTINGS.pair_decision.beside_contact_factor if claimed else 1.0


def plain(found: Findings, judged: Judged, size: float) -> bool:
    """Return whether effects are detected that have so much evidence and this size.

    Args:
        found: The findings.
        judged: The effects.
        size: What they take out of a channel, over its noise.
    """
    needed, least = thresholds(found, any(effect.absorbing for effect in judged.effects))
    certain = found.pair is not None and not found.pair.blind
    if judged.ln_bayes >= needed and size >= least:
        return True
    sure = _beside(found) * SETTINGS.pair_decision.certain_evidence
    return certain and judged.ln_bayes >= sure and size >= SETTINGS.pair_decision.certain_size


def p_value(found: Findings, left: float) -> float | None:
    """Return the share of nulls that leave as much; None for a pair, of which no nulls are kept.

    Args:
        found: The findings.
        left: Misfit over the noise floor.
    """
    return None if found.pair is not None else alarms_of(found).left.probability(left)


def remains(found: Findings, left: float) -> bool:
    """Return whether a misfit is more than nulls leave.

    Args:
        found: The findings.
        left: Misfit over the noise floor.
    """
    pair = found.pair
    if pair is None:
        return alarms_of(found).too_much(left)
    needs = SETTINGS.pair_decision
    return left >= (needs.blind_unexplained if pair.blind else needs.unexplained)
