"""How large what effects do and leave is: over the noise, over the motion, and as a share of what can be explained."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.decision.false_alarms import alarms_of, remains
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.findings import Findings, Judged, fit_misfits
from pounding.diagnosis.inference.misfit import (
    allowed_error,
    beyond_noise,
    by_frame,
    channel_differences,
    floors,
    over_floor,
    simulate,
)
from pounding.diagnosis.settings import SETTINGS


def before(found: Findings, judged: Judged) -> float:
    """Return the misfit over the noise floor of the reference runs, as `remaining` does of the others; 1 without any."""
    if not found.reference:
        return 1.0
    filtered = judged.fit.filtered
    misfits = fit_misfits(found.model, filtered, found.reference)
    over = over_floor(found.model, misfits, floors(found.model, filtered, found.reference))
    return _of_frame(found, over[np.newaxis], 1.0)


def within_model_error(found: Findings, judged: Judged | None = None) -> bool:
    """Return whether effects, or the calibrated baseline model alone, leave no more than any real frame's model may leave.

    Where runs of the frame as it was before are there, the frame at hand is known, and nothing may be left. Nor may it where
    frames touch and no cell measured their forces: what such forces leave is no error of a frame.
    """
    if found.reference or forces_from_motion(found):
        return False
    return model_error(found, judged) <= allowed_error(found.model)


def model_error(found: Findings, judged: Judged | None = None, frame: str | None = None) -> float:
    """Return what effects, or the calibrated baseline model alone, leave beyond the noise over the motion.

    It is the median over a frame's channels, mean over the runs.

    Args:
        found: The findings.
        judged: The effects, or the null model.
        frame: Name of the frame; when None the one where it is most.
    """
    misfit, floor = np.asarray((judged or found.null).channel_misfit), np.asarray(found.floor)
    return _of_frame(found, beyond_noise(misfit, floor), 0.0, frame)


def hidden_error(found: Findings, frame: str | None = None) -> float:
    """Return how large an error of the model the noise may hide, over the motion, measured as `model_error` is.

    With it the misfit is as large as it may become by chance before something is said to remain.

    Args:
        found: The findings.
        frame: As in `model_error`.
    """
    beyond = found.model.observed.slower * max(alarms_of(found).most_by_chance ** 2 - 1.0, 0.0)
    return _of_frame(found, np.asarray(found.floor) * np.sqrt(beyond), 0.0, frame)


def forces_from_motion(found: Findings) -> bool:
    """Return whether two frames touch and no cell measured their forces, so that these are what the motion asks for."""
    return found.pair is not None and found.pair.blind


def remaining(found: Findings, judged: Judged) -> float:
    """Return the misfit over the noise floor of the frame that has most: median over its channels, mean over the runs.

    Training and held-out runs count alike.
    """
    return _of_frame(found, over_noise(found, judged)[_with_floors(found)], 1.0)


def _with_floors(found: Findings) -> slice:
    """Return which of the rows of training and held-out runs have a noise floor by which misfit is judged.

    Where a pair's forces are those that the motion asks for, only the held-out floor knows how uncertain they are.
    """
    held_out = forces_from_motion(found) and bool(np.isfinite(np.asarray(found.floor)[1]).any())
    return slice(1, 2) if held_out else slice(0, 2)


def _of_frame(found: Findings, measures: np.ndarray, unknown: float, frame: str | None = None) -> float:
    """Return a measure of channels (runs, channels) of one frame: median over its channels, mean over the runs.

    It is the named frame, else the one that has most. `unknown` is returned where no channel has it.
    """
    each = by_frame(found.model, measures)
    if frame is not None:
        each = each[:, [found.model.structure.index(frame)]]
    known = np.isfinite(each).any(axis=0)
    return float(np.nanmean(each[:, known], axis=0).max()) if known.any() else unknown


def over_noise(found: Findings, judged: Judged) -> np.ndarray:
    """Return misfits over the noise floor of each channel, training and held-out runs, (2, channels)."""
    return over_floor(found.model, judged.channel_misfit, found.floor)


def signal_to_noise(found: Findings, judged: Judged, without: Judged | None = None) -> float:
    """Return how much effects take out of the channel where they show most, in units of that channel's noise.

    Contact forces being known, what acts on one frame moves that one alone: what else takes out of the channels of the
    other, such as another optimum of its parameters, does not count.

    Args:
        found: The findings.
        judged: The effects.
        without: What they are compared with; when None what they are judged beside, or the null model.
    """
    before, after = over_noise(found, without or judged.beside or found.null), over_noise(found, judged)
    taken = np.sqrt(np.maximum(before**2 - after**2, 0.0))[:, moved_channels(found, judged)]
    known = taken[:, np.isfinite(taken).any(axis=0)]
    return float(np.nanmean(known, axis=0).max(initial=0.0))


def stands_out(found: Findings, judged: Judged) -> bool:
    """Return whether effects take more out of the channel where they show most than they leave there beyond the noise.

    What remains is an error of the model, and what is smaller than the errors that stand beside it is one of them. What most
    nulls leave is no error. Reference runs have the same errors, frames that touch have thresholds of their own, and what is
    wrong with a sensor is no error of a frame's model.

    Args:
        found: The findings.
        judged: The effects.
    """
    if of_sensors(judged) or found.reference or found.pair is not None:
        return True
    chance = alarms_of(found).left.exceeded_by(SETTINGS.decision.tail)
    before, after = (over_noise(found, one) ** 2 for one in (judged.beside or found.null, judged))
    beyond = ((before - after) - np.maximum(after - chance**2, 0.0))[:, moved_channels(found, judged)]
    known = beyond[:, np.isfinite(beyond).any(axis=0)]
    return bool(np.nanmean(known, axis=0).max(initial=-np.inf) > 0.0)


def told_from_none(found: Findings, judged: Judged, effects: Sequence[Effect]) -> bool:
    """Return whether the sizes of effects are further from none than chance takes any candidate's.

    A size that may have either sign may as well be none. Its standard error has what varies between windows, which the
    evidence has not: it believes that the law is the frame's, and takes what differs from window to window for a size.

    Args:
        found: The findings.
        judged: The fit in which the effects are.
        effects: The effects.
    """
    fit, needed = judged.fit, alarms_of(found).from_none
    return all(
        abs(values[effect.amplitude]) >= needed * std[effect.amplitude]
        for effect, values, std in zip(fit.effects, fit.values, fit.std, strict=True)
        if effect in effects and not effect.logarithmic()[effect.amplitude]
    )


def of_sensors(judged: Judged) -> bool:
    """Return whether effects are of sensors alone, whose faults are no errors of a frame's model."""
    return all(effect.channel is not None for effect in judged.effects)


def _acted_on(found: Findings, judged: Judged) -> np.ndarray:
    """Return which channels are of frames that effects move, or whose sensors they are, (channels,); all without any."""
    if not judged.effects:
        return np.ones(len(found.model.observed.names), bool)
    moved = moved_channels(found, judged)
    frames = [found.model.at_frame(frame) for frame in range(len(found.model.structure.frames))]
    return np.asarray(np.any([ours & np.any(ours & moved) for ours in frames], axis=0))


def moved_channels(found: Findings, judged: Judged) -> np.ndarray:
    """Return which channels effects can change, shape (channels,).

    Those of sensors change their own, a logger all of its own, others all of their frames, and what acts on no frame all.
    """
    model, frames = found.model, {effect.frame for effect in judged.effects}
    if of_sensors(judged):
        own = [entry["channel"] for effect in judged.effects for entry in effect.entries()]
        return np.isin(model.observed.names, own)
    if None in frames:
        return np.ones(len(model.observed.names), bool)
    return np.asarray(np.any([model.at_frame(model.structure.index(str(frame))) for frame in frames], axis=0))


def something_left(found: Findings, judged: Judged) -> bool:
    """Return whether something remains that was not there before: more misfit than in the reference runs.

    Args:
        found: The findings.
        judged: The effects, or the null model.
    """
    return remains(found, remaining(found, judged) / max(1.0, before(found, judged)))


def less_certain(found: Findings, judged: Judged) -> float:
    """Return by which factor the likelihood's standard errors are larger because the model leaves more than noise.

    The likelihood takes what remains for noise, which is new in every sample. What a model gets wrong stays as it is for
    about a radian of the first mode's swing, as a motion below that frequency does, and the samples of a radian say as
    little as one. Only what is more than most nulls leave counts; frames that touch have their own errors of forces.

    Args:
        found: The findings.
        judged: The effects.
    """
    if found.pair is not None:
        return 1.0
    chance = alarms_of(found).left.exceeded_by(SETTINGS.decision.tail)
    beyond = max(remaining(found, judged) ** 2 - chance**2, 0.0)
    radian = 1.0 / (2.0 * np.pi * found.model.structure.lowest_hz * found.model.observed.runs[0].step_s)
    return float(np.sqrt(1.0 + beyond * radian))


def explained(
    found: Findings,
    judged: Judged,
    nothing: float = SETTINGS.decision.confident_left,
    rival: Judged | None = None,
) -> float:
    """Return the share of the explainable misfit that effects explain, on the held-out runs if there are any.

    It is that of the frames on which they act: contact forces being known, effects move no other, and what that lacks, or
    gains by another optimum of its own parameters, says nothing of them.

    Args:
        found: The findings.
        judged: The effects.
        nothing: Misfit over noise floor of a channel that counts as wholly explained.
        rival: Other effects, whose frames count, too.
    """
    which = 1 if found.held_out else 0
    ours = _acted_on(found, judged)
    if rival is not None:
        ours = ours | _acted_on(found, rival)
    before, after = (over_noise(found, one)[which][ours] for one in (found.null, judged))
    # Over all channels together, by power: a channel that never saw the effect should not decide.
    explainable = np.nansum(np.maximum(before**2 - 1, 0.0))
    left = np.nansum(np.maximum(after**2 - nothing**2, 0.0))
    return float(1 - np.sqrt(left / explainable)) if explainable > 0 else 1.0


def explains(found: Findings, judged: Judged, part: float) -> bool:
    """Return whether effects explain a part of what can be explained where they act, in runs that were fitted or not.

    Each channel of the fitted runs and of the held-out ones counts by what the effects do there: a run that hardly reaches
    them, or a channel that they hardly move, says little of them, and what remains there is no answer to whether they are
    what is missing. Into the held-out runs they may bring no more misfit than the model of a real frame may leave.

    Args:
        found: The findings.
        judged: The effects.
        part: The share of the misfit.
    """
    before, after = (over_noise(found, one) ** 2 - 1.0 for one in (found.null, judged))
    brought = (after[1] - before[1]) * np.asarray(found.floor)[1] ** 2
    if np.isfinite(brought).any() and np.nanmean(brought) > allowed_error(found.model) ** 2:
        return False
    done, rows = what_is_done(found, judged), _with_floors(found)
    explainable, left = (float(np.nansum((done * np.maximum(each, 0.0))[rows])) for each in (before, after))
    return left < (1.0 - part) ** 2 * explainable


def what_is_done(found: Findings, judged: Judged) -> np.ndarray:
    """Return the power over its noise by which effects change each channel, training and held-out runs, (2, channels).

    It is what parts the simulation with them from that of the null model.

    Args:
        found: The findings.
        judged: The effects.
    """
    model, change = found.model, np.full(np.shape(found.floor), np.nan)
    for which, runs in enumerate((found.training, found.held_out)):
        if runs:
            with_them, without = (
                simulate(model, fit.filtered.values, fit.filtered.effects, runs)
                for fit in (judged.fit, found.null.fit)
            )
            change[which] = channel_differences(model, with_them, without, runs)
    return np.asarray((change / np.asarray(found.floor)) ** 2)
