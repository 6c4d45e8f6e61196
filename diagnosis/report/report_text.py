"""A report in sentences: the verdict, what the evidence means, what would tell more, and what was assumed."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
from msgspec import UNSET, UnsetType

from pounding.diagnosis.case.case import Case, Channel
from pounding.diagnosis.case.quantities import UNITS
from pounding.diagnosis.decision.claims import Claim, Place
from pounding.diagnosis.design.contenders import DECISIVE, STRONG, strength
from pounding.diagnosis.design.detectability import Detectability, Sized
from pounding.diagnosis.inference.coordinates import box_of
from pounding.diagnosis.model.nuisance import (
    CHANNEL_DELAY_S,
    CHANNEL_GAIN,
    DAMPING_POWER,
    STRUCK_DAMPING,
)
from pounding.diagnosis.report.report import CalibratedParameter, ChannelMisfit, Report
from pounding.diagnosis.settings import SETTINGS

_STRUCK = (
    f"Frames that collide show their higher modes, whose damping is known {STRUCK_DAMPING:g} times less well."
)
LN_BAYES = (
    "The ln Bayes factor of an effect is the natural logarithm of how many times likelier the measurements are with the "
    "effect in the model than with nothing missing, its size and the nuisance parameters averaged over their priors: "
    f"below {STRONG:g} is weak, above {STRONG:g} strong, above {DECISIVE:g} decisive (bounds of Kass and Raftery 1995)."
)


def sentence(report: Report) -> str:
    """Return the verdict in one sentence."""
    return _of_modal_data(report) if report.modal else _of_runs(report)


def _of_runs(report: Report) -> str:
    held_out = report.misfit.held_out
    run = f"on {held_out.run}, which was not used," if held_out else "on the runs used"
    misfit, sure = report.misfit.judged, _sure(report)
    before, after, noise = (percent(getattr(misfit, key, None)) for key in ("before", "after", "noise_floor"))
    if report.verdict == "nothing_missing":
        moved = storeys_that_moved(report)
        within = report.remainder is not None and report.remainder.within
        besides = " beside the errors that every model has" if within else ""
        beyond = f" beyond calibration. In calibration {moved}. The" if moved else ": the"
        judged = f"misfit {run} is {before}, the noise floor {noise}{sure}."
        return f"Nothing is missing that this data could show{besides}{beyond} {judged}"
    if report.verdict == "unknown_effect":
        return (
            f"Something is missing, and nothing in the catalogue fits it: the misfit {run} is {before}, "
            f"{after} with the nearest of the catalogue, the noise floor {noise}{sure}."
        )
    names = " and ".join(effect.sized() for effect in together(report.effects))
    # A contact moves no frame whose forces are known.
    errors = " by the frames' own errors in the model" if all(map(_of_a_contact, report.effects)) else ""
    moves = _moves(before, after) + (errors if before != after else "")
    change = f"the misfit {run} {moves}, where noise alone leaves {noise}{_worst(report)}"
    if report.verdict == "effect_class":
        return f"Missing is {names}, or {_others(report)}; {change}{sure}."
    return f"Missing is {names}; {change}{sure}."


def before_the_change(report: Report) -> str | None:
    """Return which runs are of the frame as it was before; None without any, or in a report without its origin."""
    names = report.origin.reference if report.origin else ()
    if not names:
        return None
    several = len(names) > 1
    return (
        f"Run{'s' * several} {listed(names)} {'are' if several else 'is'} of the frame before the change; the baseline was "
        f"calibrated on {'them' if several else 'it'} too, and the question is what changed since."
    )


def listed(names: Sequence[str]) -> str:
    """Return names in words: `a`, `a and b`, `a, b and c`."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def storeys_that_moved(report: Report) -> str:
    """Return in words which storeys the calibration took far from the baseline model, empty where it took none."""
    return listed(
        [
            _storey_that_moved(one, one.prior_std)
            for one in report.calibration or ()
            if one.parameter == "storey_stiffness" and one.prior_std
        ]
    )


def _storey_that_moved(one: CalibratedParameter, prior_std: float) -> str:
    change, std = 100 * (one.calibrated - 1), 100 * (one.std or 0.0)
    far = abs(one.calibrated - 1) / prior_std
    return f"storey {one.storey} of {one.frame} moved by {change:+.1f} ± {std:.1f} % ({far:.1f} prior standard deviations)"


def beside_the_verdict(report: Report) -> list[str]:
    """Return what stands under the verdict in its box: the law's shape, what remains, the least change that would show."""
    said = [report.shape.statement] if report.shape else []
    said += [f"what remains: {report.remainder.statement}"] if report.remainder else []
    said += nearest(report)
    said += frequencies_in_step(report)
    said += least_change(report)
    return [f"{one[0].upper()}{one[1:]}." for one in said]


def nearest(report: Report) -> list[str]:
    """Return what comes nearest to being named where nothing is, if the measurements speak strongly for it."""
    if report.verdict != "nothing_missing" or not report.candidates or not report.thresholds:
        return []
    likeliest, needs = report.candidates[0], report.thresholds
    if likeliest.parameters is UNSET or likeliest.log_evidence < STRONG or _of_a_contact(likeliest):
        return []
    size = f"{percent(needs.share_of_noise)} of some channel's noise"
    lacks = f"and a name needs {number(needs.log_evidence)} and {size}, or more"
    if likeliest.log_evidence >= needs.log_evidence:
        errors = f"{needs.standard_errors:.2g} standard errors" if needs.standard_errors else "far enough"
        lacks = (
            "enough for a name, but it takes too little out of the motion, or its size may as well be none: a name needs "
            f"{size}, more where the model's own errors are as large, and a size {errors} from none"
        )
    return [
        f"nearest to a verdict is {likeliest.sized()}: its ln Bayes factor is {likeliest.log_evidence:.3g}, {lacks}"
    ]


def frequencies_in_step(report: Report) -> list[str]:
    """Return a sentence for each frame whose frequencies are all off alike, as they are when seconds are no seconds."""
    ratios: dict[str | None, list[float]] = {}
    for one in report.calibration or ():
        if one.parameter == "frequency_hz":
            ratios.setdefault(one.frame, []).append(one.calibrated / one.baseline)
    ours, said = SETTINGS.report, []
    for frame, each in ratios.items():
        off = sum(each) / len(each) - 1.0
        alike = max(each) - min(each) < ours.in_step_spread * abs(off)
        if len(each) > 1 and alike and abs(off) > ours.in_step:
            seconds = "long" if off < 0.0 else "short"
            said.append(
                f"all frequencies of {frame} are {100 * abs(off):.1f} % {'lower' if off < 0.0 else 'higher'} than in the "
                f"baseline model; if the logger's clock may be off, seconds that are {100 * abs(off):.1f} % too {seconds} "
                "would look the same"
            )
    return said


def least_change(report: Report) -> list[str]:
    """Return the smallest change of a storey's stiffness that this data could have shown; nothing where it is not known."""
    known = [one for one in report.smallest_detectable or () if one.effect == "stiffness_change"]
    return [
        f"the smallest change of a storey's stiffness that this data could have shown is {_least(one)}"
        for one in known
    ]


def _least(one: Detectability) -> str:
    if one.best is None:
        return "larger than any"
    best = f"{_change(one.best)} in {one.best.where()}"
    if one.places == 1:
        return best
    if one.worst is None:
        return f"{best}; at {one.places - one.shown} of {one.places} storeys none would show"
    return f"{best}, and {_change(one.worst)} in {one.worst.where()}, where it shows least"


def _change(one: Sized) -> str:
    value = one.parameters[0].value
    return f"{100 * abs(value):.2g} %" if isinstance(value, float) else one.size()


def _of_modal_data(report: Report) -> str:
    misfit, sure = report.misfit.held_out, _sure(report)
    before, after = (percent(getattr(misfit, key, None)) for key in ("before", "after"))
    change = f"a number predicted from the others is off by {after} in the median instead of {before}{sure}"
    names = " and ".join(effect.sized() for effect in report.effects)
    unknown = f"Something is missing that nothing tried explains; nearest is {names}; {change}."
    if not names:
        unknown = (
            f"These numbers contradict the model or each other, and nothing tried brings them nearer{sure}."
        )
    return {
        "nothing_missing": f"Nothing is missing that these numbers could show{sure}.",
        "unknown_effect": unknown,
        "effect_class": f"Missing is {names}, or another that these numbers cannot tell from it; {change}.",
        "effect_named": f"Missing is {names}; {change}.",
    }[report.verdict]


def _sure(report: Report) -> str:
    confidence = report.confidence
    if confidence is None:
        return ""
    return " (more than 99 % sure)" if confidence > 0.99 else f" ({100 * confidence:.0f} % sure)"


def _others(report: Report) -> str:
    """Return what else it may be, with the size that it would have: not that of the effect that is named."""
    alike = report.effects[0].members[1:]
    if len(alike) == 1:
        name = alike[0].words()
        sized = (one.sized() for one in report.candidates if one.words() == name)
        return f"{next(sized, name)}, which this data cannot tell from it"
    return f"one of {len(alike)} others that this data cannot tell from it"


def _moves(before: str, after: str) -> str:
    return f"stays at {before}" if before == after else f"goes from {before} to {after}"


def _worst(report: Report) -> str:
    """Return what became of the worst channel where the median of all channels does not show it."""
    known: list[tuple[float, ChannelMisfit]] = [
        (one.before, one) for one in report.channels or () if one.before is not None
    ]
    misfit = report.misfit.judged
    if not known or misfit is None or misfit.before is None:
        return ""
    before, worst = max(known, key=lambda one: one[0])
    if before < SETTINGS.report.worst_channel * misfit.before:
        return ""
    return f", and that of channel {worst.channel} from {percent(before)} to {percent(worst.after)}"


def percent(share: float | UnsetType | None) -> str:
    """Return a share in per cent with three significant digits, a dash where it is not known."""
    return f"{100 * share:.3g} %" if isinstance(share, float | int) else "–"


def number(value: float | str | UnsetType | None) -> str:
    """Return a number with four significant digits, a dash where it is not known."""
    if isinstance(value, str):
        return value
    return f"{value:.4g}" if isinstance(value, float | int) else "–"


def against_the_next(report: Report) -> str | None:
    """Return how strongly a single named effect is told from what comes next; None where that was not compared.

    Effects of a contact are weighed by the impacts and those of frames by their motion: no Bayes factor compares them.
    """
    if report.verdict == "unknown_effect" or len(report.effects) != 1:
        return None
    (effect,) = report.effects
    tried = [one for one in report.candidates if one.place not in effect.members]
    if not tried or any(map(_of_a_contact, report.candidates)):
        return None
    ln_bayes = effect.log_evidence - tried[0].log_evidence
    name = "The class" if report.verdict == "effect_class" else effect.words()[0].upper() + effect.words()[1:]
    if ln_bayes < 0.0:
        other = tried[0].words()
        return (
            f"{other[0].upper()}{other[1:]} has more evidence (an ln Bayes factor of {-ln_bayes:.3g} against what is named) "
            "and is not named: it takes too little out of the measurements, or was only scored and not refined."
        )
    return (
        f"{name} against the next candidate, {tried[0].words()}: the evidence is {strength(ln_bayes)} "
        f"(ln Bayes factor {ln_bayes:.3g})."
    )


def _of_a_contact(place: Place) -> bool:
    """Return whether an effect is of a contact, which is judged by its impacts and not by how frames move."""
    return place.contact is not None or place.left is not None


def together(effects: Sequence[Claim]) -> list[Claim]:
    """Return effects with those of one size on several channels as one, as when a logger is late."""
    found: dict[str, Claim] = {}
    for effect in effects:
        key = f"{effect.effect} {effect.parameters}" if effect.channel is not None else f"{len(found)}"
        if key in found:
            effect = msgspec.structs.replace(effect, channel=f"{found[key].channel}, {effect.channel}")
        found[key] = effect
    return list(found.values())


def next_steps(report: Report, *, figures: bool = False) -> list[str]:
    """Return what would tell more, beside the tests that part what looks alike.

    Args:
        report: The report with its details.
        figures: Whether each further measurement comes with the ln Bayes factor that it is expected to bring.
    """
    said = [
        f"{sentence[:-1]} (ln Bayes factor {ln_bayes:.3g})." if figures else sentence
        for sentence, ln_bayes in zip(report.advice or (), report.advice_evidence or (), strict=True)
    ]
    if report.misfit.held_out is None:
        said.append(
            "A second run would allow a judgement on data that was not used; there is no held-out run here."
        )
    if report.verdict == "unknown_effect":
        said += [
            "Look at the residual force: which storey it is in, and whether it follows drift, drift rate or time.",
            "Shake again at half the amplitude: what keeps its share is linear (a mass or a spring that nobody listed), "
            "what does not is a contact, friction or yielding.",
            "Listen and look while it is shaken: loose parts, cables, tools left on a floor, a fan.",
            "Is this the frame that case.toml names? Compare its first frequencies with a hammer test.",
        ]
    return said


def turned_round(effect: Claim) -> bool:
    """Return whether a sensor's gain looks like the wrong polarity."""
    change = effect.parameters[0].value if effect.effect == "sensor_gain" else None
    return isinstance(change, float) and abs(change + 2) < SETTINGS.report.like


def misread(case: Case, effect: Claim) -> str | None:
    """Return what a gain of a sensor or of the table looks like: another unit than the case says, or the wrong polarity.

    Args:
        case: The case.
        effect: An effect; None is returned for any other.
    """
    read = _reads(case, effect)
    if read is None:
        return None
    channel, reads = read
    if turned_round(effect):
        return f"channel {channel.name} reads minus the truth: its polarity is wrong"
    for unit, factor in UNITS[channel.quantity].items():
        if unit != channel.unit and abs(reads * factor / channel.to_si - 1) < SETTINGS.report.like:
            return f"channel {channel.name} reads as if it were in {unit}; case.toml says {channel.unit}"
    return None


def _reads(case: Case, effect: Claim) -> tuple[Channel, float] | None:
    """Return the channel that a gain is of, and how many times the truth it reads; None for any other effect."""
    change = effect.parameters[0].value
    if not isinstance(change, float):
        return None
    if effect.effect == "sensor_gain" and effect.channel is not None:
        return case.channels[case.channel_index(effect.channel)], 1 + change
    if effect.effect == "table_gain" and change > -1:
        # What shook the frame is so many times the channel.
        return next(channel for channel in case.channels if channel.is_table), 1 / (1 + change)
    return None


def assumptions(case: Case, report: Report, parameters: int) -> list[str]:
    """Return what the verdict rests on.

    Args:
        case: The case.
        report: The report.
        parameters: How many nuisance parameters the model has.
    """
    prior, ours = case.prior, SETTINGS.refinement
    channels = len(report.channels or ())
    return [
        f"Nuisance parameters are free inside their priors (standard deviations: storey stiffness "
        f"{prior.storey_stiffness:.1%}, frame stiffness {prior.frame_stiffness:.1%}, floor mass {prior.floor_mass:.1%}, "
        f"each mode's damping {prior.damping_ratio:.0%} and the power of its frequency with which it grows "
        f"{DAMPING_POWER * prior.damping_ratio:.2g}, table gain {prior.table_gain:.1%}, table delay "
        f"{prior.table_delay_ms:g} ms), none beyond {box_of(parameters):.1f} of them.",
        f"A sensor's gain is known to {CHANNEL_GAIN:.1%}, its delay against the others to {CHANNEL_DELAY_S * 1e3:g} ms; "
        f"how rigid a plate frame's base is to {prior.base_stiffness:.0%} of its first storey's stiffness, its joints to "
        f"{prior.joint_stiffness:.0%}.",
        *([_STRUCK] if case.contacts else []),
        "Standard errors contain the noise, the nuisance parameters, what is refined of a law's shape, and, for what the "
        f"law gets wrong besides, {ours.law_error:.0%} of an effect on a frame or of the table's pitch, "
        f"{ours.law_error_everywhere:.0%} of a law in all storeys, of joints, base or weight and of what loosens, "
        f"{ours.law_error_of_yielding:.0%} of what yields and {ours.law_error_of_knee:.0%} divided by its ductility, the "
        "largest drift over the yield drift.",
        "Noise is estimated from the data: its spectrum where no frame answers, then the innovations.",
        "The frames are at rest before the first sample of each run.",
        f"Misfits are medians over {channels} channel{'s' * (channels != 1)}; evidence is against the calibrated model.",
    ]
