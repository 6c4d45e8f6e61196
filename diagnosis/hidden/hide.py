"""Making a hidden case: draw the rig, put the effects in with the wanted visibility, let the runs happen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pounding.diagnosis.case.case import REFERENCE, Case, CaseFrame, Contact
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden import motions
from pounding.diagnosis.hidden.contact_effects import CONTACT
from pounding.diagnosis.hidden.contacts import Touch
from pounding.diagnosis.hidden.instruments import recorded
from pounding.diagnosis.hidden.places import Place, Wanted, locate, wanted
from pounding.diagnosis.hidden.reference import typical
from pounding.diagnosis.hidden.rigging import RUNS, Rig, approach, draw_rig
from pounding.diagnosis.hidden.scenario import Scenario
from pounding.diagnosis.hidden.setting import Parameters, Setting
from pounding.diagnosis.hidden.visibility import LEAST, Eye
from pounding.diagnosis.hidden.worlds import world_of

VISIBILITY = (0.1, 10.0)
"""Range from which the visibility of an effect is drawn, log-uniform: barely visible to plain."""

SHORTEST_S, LONGEST_S = 0.5, 60.0
"""Lengths of a run that are made [s]."""
NARROWING = 0.2
"""Least share of what lies between two sizes (logarithms) that a trial takes away."""

TRIALS = 7
SMALLEST_CONTACT = 0.05
"""Least size of a contact's effect over its largest; drawn log-uniform from there."""


@dataclass(frozen=True)
class Hidden:
    """A case and the truth about it."""

    case: Case
    truth: dict[str, Any]


def hide(
    effects: Sequence[str],
    frames: Sequence[str] = ("5A",),
    *,
    seed: int = 0,
    visibility: float | None = None,
    source: str = "mixed",
    duration_s: float | None = None,
    title: str | None = None,
    engine: str = "own",
    noise: float | None = None,
    model_error: float | None = None,
    reference: int = 0,
) -> Hidden:
    """Make a case with hidden effects.

    Args:
        effects: Names, each with ``:place`` if wanted; empty or ``nothing`` for a case without any.
        frames: Frames of the thesis that stand on the table.
        seed: Seed of everything that is drawn.
        visibility: How far each effect stands above the noise (see `visibility.Eye`); drawn from
            `VISIBILITY` when None.
        source: Of the motions: ``records``, ``artificial`` or ``mixed``.
        duration_s: Length of each run [s]; drawn when None.
        title: Title of the case; says nothing of the truth by default.
        engine: The world: ``own``, or ``opensees`` where that is installed.
        noise: Noise of every response channel over its root mean square [-]; drawn when None.
        model_error: Misfit that the second world's model error leaves after calibration, over the motion [-];
            drawn when None.
        reference: How many runs there are of the frames before an effect was put in, under the same motions.

    Raises:
        CaseError: An effect, place, frame or option is not known, or the engine is not installed.
    """
    world = world_of(engine)
    here = world.effects
    wants = [want for word in effects if (want := wanted(word, here, engine))]
    if source not in motions.SOURCES:
        raise CaseError(f"motions {source!r} are not known; use one of {', '.join(motions.SOURCES)}")
    if visibility is not None and not 0 < visibility < 1e3:
        raise CaseError(
            f"visibility is {visibility:g}; give a number above 0 and below 1000; 1 is as strong as the noise"
        )
    if duration_s is not None and not SHORTEST_S <= duration_s <= LONGEST_S:
        raise CaseError(f"duration is {duration_s:g} s; give {SHORTEST_S:g} to {LONGEST_S:g}")
    for name, share in (("noise", noise), ("model error", model_error)):
        if share is not None and not 1e-4 <= share <= 0.5:
            raise CaseError(f"{name} is {100 * share:g} %; give 0.01 to 50")
    if not 0 <= reference <= RUNS or (reference and len(frames) > 1):
        raise CaseError(
            f"{reference} reference runs are not made; give 0 to {RUNS}, and none for frames that touch"
        )
    rng = np.random.default_rng(seed)
    damped = any(want.name == "contact_damping" for want in wants)
    rig = draw_rig(
        rng, frames, source, duration_s, world=world, damped=damped, noise=noise, model_error=model_error
    )
    scenario, stated = rig.bare, []
    eye = _eye(rig) if wants else None
    for want in wants:
        assert eye is not None
        target = visibility or float(np.exp(rng.uniform(*np.log(VISIBILITY))))
        scenario, truth = _put(rng, rig, eye, scenario, want, target)
        stated.append(truth)
    runs = tuple(
        recorded(rng, rig.behind_sensors(scenario, run), rig.channels, rig.log, f"run{run + 1}.csv")
        for run in range(RUNS)
    )
    runs += tuple(
        replace(
            recorded(rng, rig.behind_sensors(rig.bare, run), rig.channels, rig.log, f"before{run + 1}.csv"),
            role=REFERENCE,
        )
        for run in range(reference)
    )
    known = tuple(CaseFrame(name, beams.storeys) for name, beams in rig.bare.frames.items())
    contacts = tuple(Contact(**vars(touch)) for touch in rig.baseline)
    case = Case(title or f"hidden {seed}", Path(), known, runs, rig.channels, contacts)
    return Hidden(case, _truth(rig, seed, source, stated, scenario.touches))


def _put(
    rng: np.random.Generator, rig: Rig, eye: Eye, scenario: Scenario, want: Wanted, target: float
) -> tuple[Scenario, dict[str, Any]]:
    """Put one effect into the scenario, as strong as wanted as far as that makes sense."""
    here = rig.world.effects
    effect = here[want.name]
    where = locate(rng, want, dict(rig.bare.frames), rig.channels, here)
    setting = _setting(rig, where)
    sign = _sign(rng, effect.largest, effect.smallest)
    limit = effect.largest if sign > 0 else -effect.smallest
    quantities = {channel.name: channel.quantity for channel in rig.channels}
    on_a_force_cell = quantities.get(where.channel or "") == "contact_force"
    # The same chance at every trial, so that only the size changes.
    chance = int(rng.integers(2**32))

    def put(size: float, into: Setting = setting) -> tuple[Scenario, Parameters]:
        return effect.put(into, sign * size, np.random.default_rng(chance))

    made: dict[float, tuple[Scenario, Parameters]] = {}

    def sees(size: float) -> tuple[float, float]:
        alone, _ = made[size] = put(size)
        with np.errstate(over="ignore", invalid="ignore"):
            if want.name in CONTACT or on_a_force_cell:
                return _raw(rig, alone)
            return eye.sees(rig.clean(replace(alone, touches=()) if alone.touches else alone, 0))

    if want.name in CONTACT:
        # Impacts are chaotic: what is seen does not follow from what is changed, so the change is drawn.
        size = limit * float(np.exp(rng.uniform(np.log(SMALLEST_CONTACT), 0.0)))
        raw, left = sees(size)
    else:
        size, (raw, left) = _sized(sees, limit, target)
    first = scenario is rig.bare
    whole, parameters = made[size] if first else put(size, replace(setting, scenario=scenario))
    return whole, {
        "effect": want.name,
        **vars(where),
        "parameters": _stated(parameters, rig, where),
        "visibility": left,
        "visibility_raw": raw,
        "visibility_wanted": target,
    }


def _eye(rig: Rig) -> Eye:
    """Return what looks at the strongest run; frames that can touch are looked at apart."""
    noise = rig.errors(rig.clean(rig.apart, 0))
    noise[noise == 0] = np.inf
    return Eye(lambda scenario, coarsely: rig.clean(scenario, 0, coarsely=coarsely), rig.apart, noise)


def _raw(rig: Rig, scenario: Scenario) -> tuple[float, float]:
    """Return how far a contact's effect stands above noise and model error, twice: no nuisance parameter is refitted."""
    bare, seen = rig.clean(rig.bare, 0), rig.clean(scenario, 0)
    noise = rig.errors(bare)
    largest = float(np.sqrt(np.mean(((seen - bare) / np.where(noise > 0, noise, np.inf)) ** 2, axis=0)).max())
    return largest, max(largest, LEAST)


def _sized(sees: Any, limit: float, target: float) -> tuple[float, tuple[float, float]]:
    """Return the size whose calibrated visibility comes nearest to `target`, and both visibilities."""
    size, low, high = min(0.05, 0.5 * limit), 0.0, limit
    tried: dict[float, tuple[float, float]] = {}
    for _ in range(TRIALS):
        seen = sees(size)
        if np.isfinite(seen).all():
            tried[size] = seen
            if abs(np.log(seen[1] / target)) < 0.25:
                break
        # What runs away is too strong.
        weak = size in tried and seen[1] < target
        low, high = (max(low, size), high) if weak else (low, min(high, size))
        size = _next_size(tried, size, (low, high), limit, target)
        if weak and low == limit:
            break
    if not tried:
        raise CaseError(
            "the hidden effect makes the frame run away at any size that was tried; use another seed"
        )
    best = min(tried, key=lambda known: abs(np.log(tried[known][1] / target)))
    return best, tried[best]


def _next_size(
    tried: dict[float, tuple[float, float]],
    size: float,
    known: tuple[float, float],
    limit: float,
    target: float,
) -> float:
    """Return the size to try after one, between those that are known to be too weak and too strong."""
    low, high = known
    if low in tried and high in tried:
        weak, strong = np.log(tried[low][1] / target), np.log(tried[high][1] / target)
        # What is seen of a size follows a power of it, until the nuisance parameters can imitate no more.
        share = float(np.clip(-weak / (strong - weak), NARROWING, 1 - NARROWING)) if strong > weak else 0.5
        return float(low ** (1 - share) * high**share)
    step = size * float(np.clip(target / tried[size][1], 0.03, 30.0)) if size in tried else 0.5 * size
    # A proportional step, unless it leaves what is known to be too weak and too strong.
    if step >= high == limit and limit not in tried:
        return limit
    if low < step < high:
        return step
    return float(np.sqrt(low * high)) if low else 0.3 * high


def _sign(rng: np.random.Generator, largest: float, smallest: float) -> float:
    if not (largest and smallest):
        return 1.0 if largest else -1.0
    return float(rng.choice([-1.0, 1.0]))


def _setting(rig: Rig, where: Place) -> Setting:
    frame = where.frame or next(iter(rig.bare.frames))
    free, motion = rig.free, rig.shakings[0]
    setting = Setting(
        rig.bare, typical(rig.apart, frame, free, motion.velocity), frame, where.storey or 0, where.floor or 0
    )
    if where.left and where.right and where.floor:
        near, listed = (
            approach(rig.bare, free, where.left, where.right, floor)
            for floor in (where.floor, rig.baseline[0].floor)
        )
        setting = replace(setting, nearness=near / listed)
    if rig.baseline:
        setting = replace(setting, stated_contact=rig.baseline[0])
    if where.channel is None:
        return setting
    column = [channel.name for channel in rig.channels].index(where.channel)
    rms = float(rig.clean(rig.bare, 0)[:, column].std())
    to_si = rig.channels[column].to_si
    return replace(setting, channel=where.channel, channel_rms=rms, channel_to_si=to_si)


def _stated(parameters: Parameters, rig: Rig, where: Place) -> list[dict[str, Any]]:
    unit = next((channel.unit for channel in rig.channels if channel.name == where.channel), "")
    return [
        {"name": name, "value": value, "unit": unit if given == "channel" else given, "also": also}
        for name, (value, given, *also) in parameters.items()
    ]


def _truth(
    rig: Rig, seed: int, source: str, stated: list[dict[str, Any]], touches: Sequence[Touch]
) -> dict[str, Any]:
    """Return all that is true of a case, for whoever judges a diagnosis of it."""
    outside = any(effect["effect"] in rig.world.outside for effect in stated)
    kinds = {0: "nothing", 1: "single", 2: "double"}
    truth = {
        "schema": 2,
        "seed": seed,
        "frames": list(rig.bare.frames),
        "kind": "outside" if outside else kinds.get(len(stated), "several"),
        "effects": stated,
        "motions": [
            {"source": motion.source, "peak_m_s2": float(np.abs(motion.acceleration).max())}
            for motion in rig.shakings
        ],
        "asked_motions": source,
        "rate_hz": rig.log.rate_hz,
        "noise": {
            channel.name: float(level) for channel, level in zip(rig.channels, rig.log.noise, strict=True)
        },
        "table_noise": rig.log.table_noise,
        "table_gain": rig.bare.table_gain,
        "table_delay_ms": 1e3 * rig.bare.table_delay_s,
        "touches": [vars(touch) for touch in touches],
        "engine": rig.world.name,
    }
    return truth if rig.model_error is None else truth | {"model_error": rig.model_error}
