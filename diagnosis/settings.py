"""Every threshold of the diagnosis: what is searched, refined, accepted, claimed, doubted and advised.

Modules read `SETTINGS`, which cannot be changed. A test or a study that wants other values replaces `SETTINGS` in the module
that reads it by a copy (`dataclasses.replace`). The line under each field says its unit, its meaning and its origin, where
*chosen* stands for: chosen when it was written; not measured. ``python -m pounding.diagnosis.settings`` prints the tables of
docs/diagnosis/settings.md. Priors, steps of numerical methods and formats are no thresholds and stay where they are used.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from pounding.constants import STANDARD_GRAVITY


@dataclass(frozen=True)
class Screening:
    """Faults that are told before any effect is looked for (`model.sensors`, `model.first_frequencies`)."""

    dead_s: float = 0.05
    """[s] A channel that repeats one value for longer in the middle of a shaking has dropped out. Origin: chosen."""
    dead_samples: int = 8
    """[samples] The least number of equal samples for a channel to have dropped out. Origin: chosen."""
    clipped_samples: int = 6
    """[samples] A channel is clipped only if at least so many samples are exactly at its largest value. Origin:
    chosen."""
    clipped_from: float = 0.9
    """[share of the largest value] Samples above this count as near the largest value. Origin: chosen."""
    clipped_share: float = 0.3
    """[share of the samples near the largest value] A channel is clipped only if more than this share of them is
    exactly at the largest value. Origin: chosen."""
    still: float = 0.003
    """[rms of the largest floor acceleration] A table whose acceleration reads less is at rest, or its sensor is dead.
    Origin: theory: in resonance a frame of half a per cent damping amplifies a hundredfold, 0.01."""
    woken: float = 0.1
    """[rms of the table] A channel that repeats one value at an end of a run is dead if the table moves more. Origin:
    chosen."""
    hum: float = 4.0
    """[amplitude beside it] A line at a mains frequency with a larger mean amplitude is hum. Origin: chosen."""
    hum_steady: float = 0.5
    """[amplitude] Hum differs less than this from its mean in every part of a run. Origin: chosen; what shaking excites
    comes and goes."""
    hum_of_table: float = 0.7
    """[rms of the table] A table with a larger line at a mains frequency is shaken so: it is no hum. Origin: theory: the
    line is then half of what the table does, and no shaking that begins at rest is as steady."""
    noise_alone: float = 0.5
    """[rms of the channel] Noise, by what the channel shows above the modes, that leaves no room for a motion. Origin:
    chosen."""
    moving: float = 0.3
    """[rms of the channel] A floor's acceleration that is further from its mean in the first samples is no frame at rest.
    Origin: chosen."""
    moving_noise: float = 8.0
    """[noise of the channel] And further than this. Origin: chosen."""
    answers: float = 0.5
    """[table acceleration] A channel shows a first frequency only if a floor answers with more acceleration there.
    Origin: theory: a mode answers with the inverse of twice its damping ratio, a dead sensor with nothing."""
    long_samples: int = 1_000_000
    """[samples of all channels and runs] Runs of frames that stand alone and have more are sampled less often. Origin:
    chosen for the memory: the 200 cases of the benchmark have half as many at most."""
    long_rate_hz: float = 250.0
    """[Hz] Long runs keep at least this sampling rate. Origin: chosen, that of pairs."""
    long_rate_modes: float = 3.0
    """[highest natural frequency] Long runs keep at least this sampling rate. Origin: chosen; the low-pass is flat to
    0.4 of the rate."""
    frequency_range: tuple[float, float] = (0.4, 2.0)
    """[first frequency of the baseline] Where the measured first frequency is looked for. Origin: chosen."""
    frequency_unlikely: float = 3.0
    """[prior standard deviations] A warning says that a measured first frequency is further off. Origin: chosen."""


@dataclass(frozen=True)
class Start:
    """Latent forces and noise from which calibrations start (`inference.starting`)."""

    first_level: float = 0.3
    """[storey shear] Latent force at the start of the first calibration. Origin: chosen."""
    last_level: float = 1e-5
    """[storey shear] Latent force at which the first calibration ends. Origin: chosen."""
    reduction: float = 0.3
    """[-] Calibration and refinement reduce the latent forces by this factor as long as the data like it. Origin:
    chosen."""
    rescue_level: float = 0.01
    """[storey shear] Latent force of a start from the baseline parameters where nothing fits yet. Origin: chosen."""
    quick_level: float = 0.03
    """[storey shear] Latent force while pushes are looked for in frames that are not calibrated. Origin: chosen."""
    impact_level: float = 0.01
    """[storey shear] Latent force while impacts are looked at in calibrated frames. Origin: chosen."""
    table_noise: float = 0.005
    """[rms of the table] Noise of the table's channel. Origin: chosen."""
    least_noise: float = 0.003
    """[rms of the channel] The least noise that is believed of a channel. Origin: chosen."""
    least_table: float = 1e-6
    """[m/s^2] The table's channel never has less noise. Origin: chosen."""


@dataclass(frozen=True)
class Search:
    """Which effects are refined, and from where (`inference.search`, `inference.null_model`, `inference.swapped`)."""

    worth: float = 2.0
    """[ln Bayes factor] A scored effect with less is not refined. Origin: chosen."""
    side_by_side: int = 10_000_000
    """[numbers] Two pieces of work, as effects to refine, are done at the same time only if the nuisance parameters'
    signatures of all their runs have fewer: those of both are in memory. Origin: chosen for the memory."""
    refined: int = 8
    """[effects] At most so many effects are refined. Origin: chosen."""
    thorough: int = 3
    """[effects] So many of these are refined to the end, and one of the frames if all of these are of sensors.
    Origin: chosen."""
    rivals: int = 2
    """[effects] At most so many of the refined are rivals outside the catalogue, which act alike on neighbouring
    floors. Origin: chosen."""
    start_factors: tuple[float, ...] = (0.5, 2.0)
    """[scored size] Sizes tried beside the scored one before a refinement. Origin: chosen."""
    start_shapes: int = 2
    """[shapes] Neighbours of the scored shape tried before a refinement. Origin: chosen."""
    softer: float = 0.4
    """[stiffness found] A base that turns is refined again from here: a soft one has several maxima. Origin: chosen."""
    faded: tuple[float, ...] = (0.3, 1.0)
    """[usual drift rate] Rates at which a friction that fades starts with half of itself lost. Origin: chosen."""
    creeps: float = 0.05
    """[usual drift rate] Rate at which friction that creeps starts to slide. Origin: chosen."""
    slides: float = 0.3
    """[usual drift or rate] What creeps is friction only if it slides from there on. Origin: chosen."""
    restarts: int = 2
    """[times] At most so often the null model is calibrated again from where the likeliest effect led. Origin:
    chosen."""
    restart_gain: float = 5.0
    """[ln likelihood] The search starts anew if the null model gains this by it. Origin: chosen."""
    restart_share: float = 0.05
    """[ln Bayes factor of the best] The null model must also gain this share. What leads is refined from other starts once
    more where these gain as much. Origin: chosen."""
    unexplained: float = 1.5
    """[noise floors] A frame with more misfit is searched further, with larger effects. Origin: chosen."""
    rescued: float = 50.0
    """[ln likelihood] An effect is refined from the baseline parameters if it gains this there. Origin: chosen."""
    clock: float = 0.03
    """[-] Clocks are tried up to so much slower and faster. Origin: chosen, several times what a failing logger shows."""
    rescues: int = 4
    """[effects] At most so many effects are refined from the baseline parameters. Origin: chosen."""
    rescued_storeys: int = 6
    """[storeys] Larger effects are tried in so many storeys, those that score best. Origin: chosen."""
    rescued_scores: int = 4
    """[effects] So many effects, those that score best, are tried from the baseline parameters. Origin: chosen."""
    rescued_factors: tuple[float, ...] = (1.0, 2.0)
    """[scored size] Sizes at which the best-scoring effects are tried from there. Origin: chosen."""
    rescue_shapes: int = 4
    """[shapes] About so many of an effect's shapes are tried where nothing fits. Origin: chosen."""
    rescue_factors: tuple[float, ...] = (0.5, 1.5, 4.0, 12.0)
    """[typical size] Sizes at which all effects are tried where nothing fits. Origin: chosen."""
    gains: tuple[float, ...] = (
        -2.0, STANDARD_GRAVITY - 1, 1 / STANDARD_GRAVITY - 1, 9.0, -0.9, 99.0, -0.99, 999.0, -0.999,
    )  # fmt: skip
    """[relative change] Gains of a sensor that are tried. Origin: theory: wrong polarity, g for m/s^2, powers of
    ten."""
    second: float = 12.0
    """[ln Bayes factor] A scored second effect with less is not refined. Origin: chosen."""
    seconds: int = 2
    """[effects] So many second effects are refined at a time. Origin: chosen."""
    refined_beside: int = 4
    """[effects] So many are refined at a time beside an error of the frame. Origin: chosen."""
    rounds: int = 3
    """[times] At most so often the next ones are refined, while their scores promise more than was gained. Origin:
    chosen."""
    errors: int = 2
    """[errors] At most so many errors of a frame become part of the null model. Origin: chosen."""
    swapped: float = 1000.0
    """[ln likelihood] The exchange of two channels is tried, and later believed, if it gains this. Origin: chosen."""
    swapped_misfit: float = 0.6
    """[misfit before] An exchange is believed if the larger misfit of the two channels falls to this. Origin:
    chosen."""


@dataclass(frozen=True)
class Refinement:
    """When a refinement goes on, ends and steps back (`inference.refine`, `inference.posterior`, `inference.histories`)."""

    outside: float = 0.05
    """[probability] Nuisance parameters stay so near to the baseline that, of all in a model whose priors are right, one
    lies further away with this probability: some 3.3 prior standard deviations of a frame with five storeys, 3.6 of a
    pair. What lies beyond is no nuisance. Origin: theory: the usual rate of false alarms, shared by all parameters."""
    calming_steps: int = 3
    """[-] A descent has so many steps at each size of the latent forces. Origin: chosen."""
    steps: int = 18
    """[-] It has so many at most where these stay as they are. Origin: chosen."""
    by_motion: int = 24
    """[-] The calibration of the null model by its motion alone has so many steps. Origin: chosen."""
    law_error: float = 0.02
    """[share of the size] The law of an effect on a frame, of a table that pitches as well, its place and the frame's mass
    are known no better: standard errors contain it. Origin: fitted; twelve sizes, nine of own cases and those of column E of
    the benchmark, were 0.3 to 4 % off whatever the data said."""
    law_error_everywhere: float = 0.11
    """[share of the size] The same of a law in all storeys of a frame and of a storey that loosens, which are stated over a
    stiffness that a storey has not alone, and of how joints, base and weight soften a frame, which is in every model and
    never quite right. Origin: fitted; four sizes of columns G, I and J of the benchmark, stated by either stiffness, were
    4 to 14 % off, with standard errors of 2 to 10 % without it; in plane frames joints 3 to 25 % with 2 to 15 %, three bases
    that turn 8 to 11 % with 3 to 8 %, seven storeys that loosen 2 to 10 % with 2 to 7 %; judged on joints and bases since
    their tenth set, and on one storey that loosens in their twelfth."""
    law_error_of_yielding: float = 0.4
    """[share of the size] The same of what yields: a rounder or a sharper knee means another force and another stiffness
    with nearly the same loop. Origin: fitted; eight sizes of columns F, G and J were 16 to 54 % off; too
    small in plane frames, see the next."""
    law_error_of_knee: float = 1.2
    """[share of the size times ductility] And the less it yields, ductility being the largest drift over the yield drift
    that was found. Origin: fitted; to the force of Menegotto and Pinto with R0 = 20 up to a ductility of 2.2 (`python -m
    tests.benchmarks.yield_forces`); not judged on others."""
    least_latent_n: float = 1e-4
    """[N] A smaller latent force is none. Origin: chosen."""
    likelier: float = 1.0
    """[ln likelihood] Gain from which on smaller latent forces are kept, and a refinement goes on. Origin: chosen."""
    catches_up: float = 3.0
    """[gain so far] A refinement goes on only if so many times what it has gained would take it past the fit that is ahead:
    beyond what it is refined about, while latent forces become smaller, and then in its last round, as if each gained three
    quarters of the one before; where it lacks more than a third of what it has gained, also beyond the last size of the
    latent forces. Origin: chosen."""
    noise_likelier: float = 0.5
    """[ln likelihood] Gain from which on another noise of channels or table is kept. Origin: chosen."""
    noise_steps: int = 10
    """[steps] Fisher's scoring of the noise. Origin: chosen."""
    least_channel: float = 1e-4
    """[rms of the channel] No refinement gives a channel less noise. Origin: chosen."""
    worse: float = 5.0
    """[ln likelihood] Loss at which a step is taken back. Origin: chosen."""
    enough: float = 0.2
    """[ln posterior] Gain below which a descent ends. Origin: chosen."""


@dataclass(frozen=True)
class MisfitMap:
    """Which windows and bands are listed as places of the misfit (`inference.misfit_map`)."""

    windows: int = 6
    """[windows] A run is divided into so many windows. Origin: chosen."""
    bands: int = 6
    """[bands] The frequencies up to beyond the fifth mode are divided into so many bands. Origin: chosen."""
    above: float = 1.5
    """[noise] A window and band with less misfit is not listed. Origin: chosen."""
    listed: int = 8
    """[entries] At most so many entries are listed. Origin: chosen."""


@dataclass(frozen=True)
class Checks:
    """What speaks against a model however well it fits (`inference.model_checks`)."""

    bent: float = 1e-4
    """[probability by the priors] Frames with a lower probability are calibrated again: the calibration may be stuck.
    Origin: chosen."""
    strained: float = 1e-8
    """[probability by the priors] Frames with a lower probability are other frames: the verdict is unknown effect, unless
    one effect makes them likely. Damping with a lower one is beyond calibration. Origin: chosen."""
    tone: float = 200.0
    """[power over the median beside it] A line of the spectrum with more power is a tone. Origin: chosen; noise alone
    reaches some 40."""
    tone_quiet: float = 0.1
    """[power of whitened noise] Where the spectrum is lower than this, a tone is told from this: what stands out of a
    band that is far quieter than the sensor's noise moves no verdict. Origin: chosen; lines of 1e-4 of the motion in a
    recording of twelve digits were tones without it."""
    table_line: float = 0.01
    """[largest power] A line of the table's own spectrum with more of it may have harmonics in the answer of a frame
    that is not linear. Origin: chosen."""
    beside: int = 41
    """[bins] The median is taken over so many bins to each side of a line. Origin: chosen."""
    own: float = 0.02
    """[natural frequency] A line that is so near to a mode is that mode. Origin: lowered from 0.03 after commit
    b0092bb; not measured."""
    as_stiff: float = 0.1
    """[share of a run] A mode swings as fast as a law that is as stiff for so long makes it. Origin: chosen."""
    same_tone_hz: float = 0.5
    """[Hz] Lines nearer to each other are one tone. Origin: chosen."""
    hum_hz: float = 0.3
    """[Hz] A line so near to a multiple of a mains frequency is hum of the cables. Origin: chosen."""


@dataclass(frozen=True)
class Pushes:
    """Short pushes on a floor that nothing in the model makes (`decision.impulses`)."""

    plain: float = 10.0
    """[usual standard deviations] A push with a larger answer of the matched filter is plain. Origin: chosen; noise
    alone reaches five."""
    usual_share: float = 0.97
    """[share of the time] This share of a run's answers is usual: a wrong law answers in every cycle, a knock seldom.
    Origin: chosen."""
    usual_deviations: float = 2.17
    """[standard deviations] This share of Gaussian noise stays below so many. Origin: theory: the normal quantile of
    `usual_share` (2.1701), rounded."""
    least: int = 2
    """[pushes] Fewer pushes are taken for an accident. Origin: chosen."""
    alone: float = 10.0
    """[ln likelihood] A push on one floor must be more likely by this than a push on both floors of a contact. Origin:
    chosen."""
    apart_s: float = 0.1
    """[s] Answers nearer than this are one push; nearer to an end of a run none is looked for. Origin: chosen."""
    beside_contact_s: float = 0.05
    """[s] Nearer to a contact event no push is looked for. Origin: chosen."""
    listed: int = 6
    """[pushes] The warning lists so many times at most. Origin: chosen."""


@dataclass(frozen=True)
class Decision:
    """From evidence to the verdict on frames (`inference.findings`, `decision.verdict`)."""

    false_alarms: float = 0.05
    """[share of the cases without an effect] In half so many an effect is named on a single frame, in half so many
    something is said to remain, unless the user asks for another rate. Origin: theory: the usual level of a test."""
    tail: float = 0.25
    """[share of the nulls] The largest of what nulls show follow an exponential law. Origin: chosen."""
    tail_sure: float = 0.9
    """[probability] The mean of this law is less than what is taken for it. Origin: chosen."""
    beyond_calibration: float = 3.0
    """[prior standard deviations] What moves further is no longer calibrated but changed. Origin: theory: one in 370 by
    the prior."""
    size: float = 0.2
    """[noise of a channel] An effect of a single frame also needs this signal-to-noise ratio in some channel. Origin:
    chosen; a lower one raised false alarms on development cases."""
    absorbing_size: float = 0.4
    """[noise of a channel] An effect that absorbs errors of every model needs this instead. Origin: twice as much, as in a
    pair; with nothing hidden up to 0.27 in the stored nulls, of a table that tilts.
    """
    second_evidence: float = 60.0
    """[ln Bayes factor] An effect of a single frame beside another one needs this, whatever force acts instead of the first
    one's law. Origin: chosen; lower thresholds named second effects that were not there on development cases."""
    second_size: float = 0.1
    """[noise of a channel] A second effect needs this signal-to-noise ratio in some channel. Origin: chosen."""
    second_share: float = 0.1
    """[share] A second effect needs `second_evidence` whatever force acts in the storeys of the first one, this being its
    square as a share of that of the first one's law; beside what is no force of storeys it also adds this share of the
    first one's evidence. Origin: chosen; lower thresholds of evidence named second effects that were not there on
    development cases."""
    same_storey: float = 0.8
    """[share] A second effect in the same storey must explain this share of what the first one leaves. Origin:
    chosen."""
    alike: float = 12.0
    """[ln Bayes factor] Candidates so near to the best are in its class. Origin: raised from 5 after commit b0092bb: a
    late table and a late sensor, which are one to a single channel, ended ten apart."""
    rival: float = 5.0
    """[ln Bayes factor] A rival outside the catalogue must be better by this than the best effect of the catalogue.
    Origin: chosen."""
    rival_left: float = 0.5
    """[share of what the best effect of the catalogue leaves] A rival that is better must leave less. Origin: chosen."""
    larger_part: float = 0.5
    """[share of the explainable misfit] If the effects explain less where they act, they are not what is missing.
    Origin: theory: the larger part."""
    explained: float = 0.8
    """[share of the explainable misfit] The share that effects must explain if something else is known to act, such as
    blows or a machine. Origin: chosen."""
    errors_alike: float = 5.0
    """[the model's other errors] What every real frame has a little of is an error of the model, too, while it takes no more
    than this out of the motion. Origin: chosen on development cases: flaws of frames took 0.7 to 4.3 times the others, laws
    of all storeys that were hidden at 0.5 and more of the noise 7 times and more. What the noise may hide of the others
    counts as there since a blind set called two flaws effects whose others were below the noise."""
    least_error: float = 0.005
    """[of the motion] No model of a frame has other errors that are smaller, as it seems where one error dominates. Origin:
    models of real frames leave 0.5 to 5 % of the motion; chosen after flaws of the second world whose others were below the
    noise had been named (commits J and Y)."""
    confident_left: float = 1.6
    """[noise floors] A channel with less misfit counts as wholly explained in the features of the confidence. Origin:
    chosen."""


@dataclass(frozen=True)
class PairDecision:
    """The same for two frames that collide, and for their contact (`inference.findings`, `decision.pair_decision`)."""

    local_evidence: float = 100.0
    """[ln Bayes factor] An effect of a frame needs this. Origin: with nothing hidden 21 at most in 16 pairs of seed
    20261206, and 88 in 16 of seed 20261210."""
    local_size: float = 0.1
    """[noise of a channel] It also needs this signal-to-noise ratio in a channel of its frame. Origin: chosen."""
    absorbing_evidence: float = 200.0
    """[ln Bayes factor] An effect that absorbs errors of every model needs this instead. Origin: with nothing hidden
    192 at most in 16 pairs of seed 20261206; in 16 of seed 20261210 658 and 242 once each, else 109."""
    absorbing_size: float = 0.2
    """[noise of a channel] It also needs this signal-to-noise ratio. Origin: with nothing hidden up to 0.16 in
    development pairs."""
    certain_evidence: float = 1000.0
    """[ln Bayes factor] With a force cell this evidence makes up for size. Origin: chosen."""
    certain_size: float = 0.1
    """[noise of a channel] The signal-to-noise ratio that is then enough. Origin: chosen."""
    beside_contact_factor: float = 1.5
    """[-] Absorbing effects need so many times as much beside an effect of the contact. Origin: lowered from 2 in
    287634a, when forces were first corrected; not measured."""
    unmeasured_factor: float = 2.0
    """[-] So many times the evidence is needed without a force cell; a contact's effect needs it once more without
    held-out impacts. Origin: chosen on development pairs (eecf4f4, 35bffd9): less was what models of impacts leave."""
    second_factor: float = 2.0
    """[evidence of a first one] An effect beside another one needs so many times the evidence of a first one. Origin:
    chosen; lower thresholds named second effects that were not there on development cases."""
    model_error_factor: float = 2.0
    """[-] The models of frames that touch may leave so many times `model_error`: blows excite modes of which a calibration
    by shaking says less. Origin: three pairs of the second world without an effect of a frame (977230b) leave 6.7, 5.6 and
    7.2 % of the motion, the same frames alone 4.2, 4.2 and 3.1 %; not judged on others."""
    unexplained: float = 1.15
    """[noise floors] If a frame's remaining misfit is smaller, nothing is left to explain. Origin: chosen."""
    blind_unexplained: float = 1.3
    """[noise floors] Replaces `unexplained` where the forces are found from the motion. Origin: chosen."""
    filtered_s: float = 2.5e-4
    """[s] A shorter delay of a sensor is its filter and no effect. Origin: chosen."""
    contact_evidence: float = 8.0
    """[ln Bayes factor] An effect of the contact, or a fault of the force cell, needs this; beside another effect the
    contact's needs `second_factor` times as much. Origin: lowered on development pairs from 15 over 10
    (35bffd9: 13 for a restitution off by 0.14) to 8 (287634a)."""
    parameter_cost: float = 3.0
    """[ln Bayes factor] A gap, gain or delay that one number tells pays this for being free. Origin: chosen."""
    held_out_spread: float = 1.96
    """[standard deviations] Held-out impacts may gain so much less than they would if an effect of the contact had made
    them. Origin: 2.5 % of the effects that are there lack more by chance."""
    held_out_most: float = 10.0
    """[ln likelihood] They need not gain more than this. Origin: a development pair whose effect was vetoed although they
    agreed (950931f)."""


@dataclass(frozen=True)
class Modal:
    """Modal data without runs (`inference.modal`, `inference.modal_evidence`)."""

    evidence: float = 3.0
    """[ln Bayes factor] An effect needs this, a second one adds it, and candidates nearer to the best are its class.
    Origin: theory: odds of 20 to 1."""
    unlikely: float = 0.001
    """[probability] If the misfit has a lower probability, the verdict is unknown effect. Origin: chosen."""
    starts: tuple[float, ...] = (0.3, 1.0, 2.5)
    """[prior standard deviations] Sizes from which a descent starts, of each sign that a size may have. Origin:
    chosen."""


@dataclass(frozen=True)
class Confidence:
    """The regression of the confidence (`decision.confidence`)."""

    intercept: float = 1.0
    """[log odds] Prior standard deviation of the intercept of a kind of verdict. Origin: chosen."""
    slope: float = 0.3
    """[log odds] Prior standard deviation of the other coefficients: few wrong verdicts make no steep rule. Origin:
    chosen."""
    rig: float = 2.0
    """[log odds] Prior standard deviation of the intercept of one rig about that of the shipped calibration. Origin:
    chosen."""
    limits: tuple[float, float] = (0.01, 0.99)
    """[probability] The stated confidence lies within these. Origin: chosen: no calibration rests on enough cases for
    a figure beyond them."""


@dataclass(frozen=True)
class Calibration:
    """The cases of `--calibrate` (`decision.rig_calibration`, `decision.pair_calibration`)."""

    cases: int = 36
    """[cases] So many cases are simulated. Origin: chosen."""
    minutes: float = 15.0
    """[min] The calibration ends after so long with the cases finished by then. Origin: chosen."""
    rivals: int = 4
    """[effects] So many effects take turns at being the truth; in every third case nothing is missing. Origin:
    chosen."""
    least_nulls: int = 8
    """[nulls] Fewer nulls of a rig do not say what an effect on it needs; those of the package do. Origin: chosen."""
    pair_rivals: int = 2
    """[effects] Of a pair so many effects of the frames, and as many of the contact, take turns. Origin: chosen."""
    within: float = 2.5
    """[prior standard deviations] Nuisance parameters are drawn within this. Origin: chosen."""
    size_scatter: float = 0.5
    """[-] Standard deviation of the logarithm of an effect's size over its fitted one. Origin: chosen."""


@dataclass(frozen=True)
class Forces:
    """Contact forces from the motion, and their correction (`contact_force.pairs`, `.pair`, `.force_errors`)."""

    rate_hz: float = 250.0
    """[Hz] Least sampling rate on which the frames of a pair are judged. Origin: chosen."""
    plain: float = 8.0
    """[standard deviations] A force is looked for where the answer of the matched filter is larger. Origin: chosen."""
    rounds: int = 8
    """[times] At most so often forces are looked for in what remains. Origin: chosen."""
    pushing: float = 4.0
    """[standard deviations] The sum of a contact event's force must exceed this: a contact does not pull. Origin:
    chosen."""
    cost: float = 4.0
    """[ln likelihood] The evidence of found forces is reduced by this for each sample that is free. Origin: chosen."""
    shares: tuple[float, ...] = (0.003, 0.01, 0.03, 0.1)
    """[force] These errors of the samples are tried, and the likeliest is taken. Origin: chosen."""
    near_samples: int = 2
    """[samples] The size of the force at a sample is the largest within so many samples of it. Origin: chosen."""
    least_share: float = 1e-3
    """[largest force] A smaller force is no contact event, and is not corrected. Origin: chosen."""
    correction_rounds: int = 3
    """[times] So often errors of the force, frames and noise are found in turn. Origin: chosen."""
    settling_rounds: int = 5
    """[times] So often at most forces and the sizes of what is found in a pair are found in turn. Origin: chosen; a frame
    that reads 3 ms late was found 1.3 ms late by forces without it, and 2.3 ms in five rounds."""
    settled: float = 0.5
    """[standard error] Sizes that move by less in a round stand still. Origin: chosen."""
    cell_size: float = 0.03
    """[force] Prior standard deviation of the size of a contact event from a cell. Origin: chosen."""
    found_size: float = 0.1
    """[force] Prior standard deviation of the size of a contact event found from the motion. Origin: chosen."""
    around_s: float = 0.01
    """[s] How far a contact event reaches beyond its samples at the lower rate. Origin: chosen."""
    free_events: int = 60
    """[events] The sizes of so many contact events, the largest, are free. Origin: chosen."""


@dataclass(frozen=True)
class SecondContact:
    """A contact that the case does not state (`contact_force.second_contact`)."""

    evidence: float = 300.0
    """[ln Bayes factor] A second contact needs this. Origin: chosen."""
    pushes: int = 4
    """[pushes] A second contact needs so many contact events. Origin: chosen."""
    share: float = 0.5
    """[share of the approaches beyond its gap] A second contact must push in this share. Origin: chosen."""
    least_share: float = 0.15
    """[share of the approaches beyond its gap] This share is enough if both frames are pushed, because a rocking base
    makes distances wrong. Origin: chosen."""
    both: float = 15.0
    """[ln likelihood] Both frames are pushed if that is more likely by this than pushes on either alone. Origin:
    chosen."""
    before_s: float = 2e-3
    """[s] No second contact is looked for so long before an impact of the stated contact. Origin: chosen."""
    after_s: float = 8e-3
    """[s] No second contact is looked for so long after such an impact. Origin: chosen."""
    near_s: float = 0.01
    """[s] A push so near in time to an approach belongs to it. Origin: chosen."""


@dataclass(frozen=True)
class ForceCell:
    """Faults of a force cell (`contact_force.force_cell`); their evidence is `pair_decision.contact_evidence`."""

    clipped_samples: int = 3
    """[samples] A cell is clipped by the rule for channels (`screening`), but with so many samples at its largest force,
    because impacts have few. Origin: chosen."""
    quiet: float = 5.0
    """[standard deviations] Readings within this of the median are those without contact. Origin: chosen."""
    turned: float = 2.0
    """[largest push] A cell whose largest pull is larger has the wrong polarity. Origin: chosen."""
    turned_evidence: float = 1000.0
    """[ln Bayes factor] Stated for a wrong polarity, whose evidence is not computed. Origin: chosen."""
    offset_error: float = 0.01
    """[noise of the force] The offset of a cell is not known better. Origin: chosen."""
    gain_error: float = 0.02
    """[-] The relative gain of a cell is not known better from the motion. Origin: chosen."""
    delay_error_s: float = 1.5e-4
    """[s] The delay of a cell is not known better from the motion. Origin: chosen."""
    least: int = 4
    """[impacts] Fewer impacts do not determine gain and delay. Origin: chosen."""
    shown: float = 0.3
    """[impulse by the cell] An impact counts only if the motion shows more of its impulse. Origin: chosen."""
    before_s: float = 0.006
    """[s] Impulses are compared from so long before the first plain sample. Origin: chosen."""
    after_s: float = 0.007
    """[s] Impulses are compared until so long after the last plain sample. Origin: chosen."""


@dataclass(frozen=True)
class Impacts:
    """Single impacts and the contacts fitted to them (`contact_force.impacts`, `.contacts`, `.pair`)."""

    plain: float = 6.0
    """[standard deviations of the force's noise] A larger force is a contact event. Origin: chosen."""
    plain_share: float = 0.03
    """[largest force of the run] An impact has a larger force. Origin: chosen."""
    lead_s: float = 1e-3
    """[s] An impact, or a push found from the motion, begins so long before its first plain sample. Origin: chosen."""
    tail_s: float = 3e-3
    """[s] An impact, or a push found from the motion, ends so long after its last plain sample. Origin: chosen."""
    apart_s: float = 3.5e-3
    """[s] Plain samples further apart are two impacts. Origin: chosen."""
    longest_s: float = 0.03
    """[s] A longer contact event is no impact. Origin: chosen."""
    used: int = 40
    """[impacts] A contact is fitted to so many impacts, the strongest. Origin: chosen."""
    least: int = 2
    """[impacts] Fewer impacts do not judge a contact. Origin: chosen."""
    frequencies: tuple[float, ...] = (0.0, 0.1, 0.2, 0.3)
    """[sampling rate] Pulses are compared at these frequencies. Origin: chosen."""
    highest_hz: float = 450.0
    """[Hz] The highest of these frequencies is at most this. Origin: chosen."""
    faint: float = 0.25
    """[impulse] A pulse is not compared where its magnitude is smaller. Origin: chosen."""
    model_error: tuple[float, ...] = (0.01, 0.01, 0.015, 0.02, 0.01, 0.02, 0.03)
    """[-, rad] What frames and filter leave uncertain of logarithmic magnitudes, then of phases. Origin: chosen."""
    inflated: float = 2.0
    """[-] The filter's uncertainty of the state before an impact is taken so many times as large. Origin: chosen."""
    least_state: tuple[float, float] = (5e-6, 0.01)
    """[m, relative velocity] The uncertainty of displacement and velocity before an impact is at least this. Origin:
    chosen."""
    off: float = 4.0
    """[standard deviations] An impact further off counts less (Huber), and is looked for again as lost. Origin:
    chosen."""
    searches: int = 4
    """[times] Lost impacts are looked for so often. Origin: chosen."""
    most: float = 12.0
    """[ln likelihood] One impact says this at most: floors that press on each other bounce by chance. Origin: a
    development pair in which one such impact decided where forty plain ones did not (eecf4f4)."""
    steps: int = 25
    """[steps] A descent has at most so many steps. Origin: chosen."""
    enough: float = 0.02
    """[ln posterior] Gain below which a descent ends. Origin: chosen."""
    warmed: float = 300.0
    """[ln Bayes factor] Fits so near to the best are fitted again from its impacts. Origin: chosen."""
    plausible: float = 2.0
    """[prior standard deviations] They are also fitted again from its contact, as far as so many reach. Origin:
    chosen."""
    sharpest: float = 0.5
    """[expected error] Errors of impacts are reduced to this at most, however well they fit. Origin: chosen."""


@dataclass(frozen=True)
class Design:
    """Which further measurements are advised (`design`)."""

    weak: float = 20.0
    """[ln Bayes factor] An explanation with a smaller lead is weakly told from the next. Origin: chosen."""
    enough: float = 5.0
    """[ln Bayes factor] A further measurement that is expected to bring less is not advised. Origin: chosen; decisive
    on the scale of Kass and Raftery (1995)."""
    listed: int = 4
    """[measurements] At most so many further measurements are advised. Origin: chosen."""
    impacts: int = 12
    """[impacts] So many impacts, the strongest, are simulated. Origin: chosen."""
    longest_s: float = 8.0
    """[s] A simulated run is not longer. Origin: chosen."""
    seconds: float = 20.0
    """[s] After these no further measurement is tried. Origin: chosen."""
    noise: float = 0.02
    """[rms of the channel] Noise of an added channel where the case has none of its kind. Origin: chosen."""
    weight: float = 0.1
    """[mass of the frame] A weight of this mass is put on the roof. Origin: chosen."""


@dataclass(frozen=True)
class Report:
    """What a report says beside the verdict (`report`)."""

    explainable: float = 1.1
    """[noise floors] If the misfit before is smaller, no explained share is stated. Origin: chosen."""
    poor_forces: float = 2.0
    """[noise floors] If more misfit remains, forces found from the motion are called poor. Origin: chosen."""
    worst_channel: float = 3.0
    """[median misfit] The misfit of the worst channel is stated too if it is larger. Origin: chosen."""
    moved: float = 1.0
    """[prior standard deviations] A nuisance parameter that the calibration moved further is listed. Origin: chosen."""
    in_step: float = 0.005
    """[-] Frequencies of a frame that are all off alike by more are said to be so, as a wrong clock does that. Origin:
    chosen."""
    in_step_spread: float = 0.2
    """[mean difference] Frequencies are off alike if their relative differences vary by less. Origin: chosen."""
    linear: float = 0.5
    """[share of the power above the noise] What remains is called linear if other stiffness, mass and damping would take
    away more of it. Origin: theory: the larger part."""
    shape_apart: float = 3.0
    """[standard errors] A parameter of a law's shape that is nearer to the catalogue's value is not told apart from it.
    Origin: chosen."""
    shape_size: float = 0.3
    """[prior standard deviations] A parameter of a law's shape that is nearer to the catalogue's value is called like it.
    Origin: chosen."""
    loop_apart: float = 3.0
    """[standard errors] Measures of a measured loop and of the law's that differ less are called alike. Origin: chosen."""
    loop_size: float = 0.03
    """[-] Measures of the two loops, correlations, that differ less are called alike. Origin: chosen: less is not seen in a
    picture."""
    like: float = 0.03
    """[-] A sensor's gain so near to that of another unit or polarity is called that. Origin: chosen."""


@dataclass(frozen=True)
class Settings:
    """All thresholds, a group for each part of the diagnosis."""

    screening: Screening = Screening()
    start: Start = Start()
    search: Search = Search()
    refinement: Refinement = Refinement()
    misfit_map: MisfitMap = MisfitMap()
    checks: Checks = Checks()
    pushes: Pushes = Pushes()
    decision: Decision = Decision()
    pair_decision: PairDecision = PairDecision()
    modal: Modal = Modal()
    confidence: Confidence = Confidence()
    calibration: Calibration = Calibration()
    forces: Forces = Forces()
    second_contact: SecondContact = SecondContact()
    force_cell: ForceCell = ForceCell()
    impacts: Impacts = Impacts()
    design: Design = Design()
    report: Report = Report()


SETTINGS = Settings()
"""The values by which the program decides."""


class Row(NamedTuple):
    """A threshold as the documentation shows it."""

    group: str
    name: str
    value: str
    unit: str
    meaning: str
    origin: str


_SAID = re.compile(r"\[(?P<unit>[^]]+)] (?P<meaning>.+?) Origin: (?P<origin>.+)")


def rows(settings: Settings = SETTINGS) -> Iterator[Row]:
    """Yield every threshold with what stands under it in this module.

    Raises:
        ValueError: The line under a field is missing, or lacks unit, meaning or origin.
    """
    said = _said()
    for group in fields(settings):
        values = getattr(settings, group.name)
        for one in fields(values):
            found = _SAID.fullmatch(said.get((type(values).__name__, one.name), ""))
            if found is None:
                raise ValueError(
                    f"{group.name}.{one.name}: say '[unit] Meaning. Origin: ...' under the field"
                )
            unit, meaning, origin = found.groups()
            shown = _shown(getattr(values, one.name))
            yield Row(group.name, one.name, shown, unit, meaning, origin.removesuffix("."))


def tables(settings: Settings = SETTINGS) -> str:
    """Return all thresholds in Markdown, a table for each group."""
    lines = []
    every = list(rows(settings))
    for group in fields(settings):
        about = (type(getattr(settings, group.name)).__doc__ or "").strip()
        lines += ["", f"### {group.name}", "", about, "", "| setting | value | unit | meaning | origin |"]
        lines += ["|---|---|---|---|---|"]
        lines += [f"| `{one.name}` | {' | '.join(one[2:])} |" for one in every if one.group == group.name]
    return "\n".join(lines[1:]) + "\n"


def _said() -> dict[tuple[str, str], str]:
    """Return the docstring under each field of each class of this module."""
    found = {}
    for node in ast.parse(Path(__file__).read_text(encoding="utf-8")).body:
        body = node.body if isinstance(node, ast.ClassDef) else []
        for one, under in pairwise(body):
            if not isinstance(one, ast.AnnAssign) or not isinstance(under, ast.Expr):
                continue
            if isinstance(node, ast.ClassDef) and isinstance(one.target, ast.Name):
                found[node.name, one.target.id] = " ".join(str(ast.literal_eval(under.value)).split())
    return found


def _shown(value: Any) -> str:
    return ", ".join(_shown(one) for one in value) if isinstance(value, tuple) else f"{value:g}"


if __name__ == "__main__":
    sys.stdout.write(tables())
