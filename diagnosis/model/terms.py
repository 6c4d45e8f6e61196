"""What a unit of each nuisance parameter, and of anything like it, adds to a predicted motion: terms of its signature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import (
    MODAL_DAMPING,
    MODAL_STIFFNESS,
    floor_mass,
    log_frequency,
    storey_pattern,
)
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes

LEAST_SHARE = 0.02
"""Part of a mode below which its damping is not followed."""


@dataclass(frozen=True)
class Motion:
    """Motion of one run, from which regressors are made; columns are floors, storeys or modes.

    `start` holds it as the filter leaves it at each sample, the rest as predicted before the sample. `table_read` is the
    table's acceleration at the delay and clock that act, without its gain [m/s^2], and `table_slope` by how much it grows
    with its own clock's time, with the gain [m/s^3]. `outputs` are what faultless sensors would read, and `reads` how much
    of it each channel reads, shape (channels,). `between` holds what the mean over the step after each sample has beyond the
    mean of the step's ends.
    """

    run: RunData
    eta: np.ndarray
    eta_rate: np.ndarray
    floor: np.ndarray
    floor_rate: np.ndarray
    drift: np.ndarray
    drift_rate: np.ndarray
    acceleration: np.ndarray
    table_rate: np.ndarray
    table_read: np.ndarray
    table_slope: np.ndarray
    outputs: np.ndarray
    output_rate: np.ndarray
    reads: np.ndarray
    start: Motion | None = None
    between: Motion | None = None


def force_term(
    motion: Motion, series: Callable[[Motion], np.ndarray], force: np.ndarray, linear: bool = True
) -> Term:
    """Return the term of a force that is a function of the motion.

    Args:
        motion: Motion of a run.
        series: Gives the force of a unit amplitude [N] from a motion, shape (samples,).
        force: Modal force of a unit of it, shape (modes,).
        linear: Whether it is linear in the motion at the same instant; else it goes straight from sample to sample.
    """
    between = series(motion.between) if linear and motion.between is not None else None
    return Term(series(motion.start or motion), force, end=series(motion), between=between)


def nuisance_terms(model: Model, modes: Modes, motion: Motion) -> list[list[Term]]:
    """Return for each nuisance parameter the terms that a unit of it adds.

    Args:
        model: The baseline model.
        modes: Modes of the filtered model.
        motion: Motion of a run.
    """
    return [parameter_terms(model, modes, motion, one.kind, one.place) for one in model.parameters]


def parameter_terms(model: Model, modes: Modes, motion: Motion, kind: str, place: int) -> list[Term]:
    """Return the terms that a unit of a nuisance parameter adds, or of an effect that is one beyond its prior.

    Args:
        model: The baseline model.
        modes: Modes of the filtered model.
        motion: Motion of a run.
        kind, place: Kind of the parameter, and the index of its place.
    """
    shapes = modes.floors
    structure = model.structure
    if kind in ("storey_stiffness", "base_stiffness"):
        return pattern_terms(motion, storey_pattern(structure, place), shapes)
    if kind == MODAL_STIFFNESS:
        return _modal_terms(model, motion, shapes, place)
    if kind == MODAL_DAMPING:
        return _coupling_terms(model, modes, motion, place)
    if kind == "frame_stiffness":
        span = structure.span(place)
        return matrix_terms(motion, structure.frames[place].stiffness, shapes, span)
    if kind == "joint_stiffness":
        return matrix_terms(
            motion, np.asarray(structure.frames[place].joint_derivative), shapes, structure.span(place)
        )
    if kind == "floor_mass":
        mass = floor_mass(structure, place)
        return [force_term(motion, lambda m: -mass * m.acceleration[:, place], shapes[place])]
    if kind == "mode_damping":
        return _damping_terms(model, modes, motion, slice(place, place + 1), np.ones(1))
    if kind == "frame_damping":
        return _damping_terms(
            model, modes, motion, structure.span(place), np.ones(len(structure.frames[place].mass))
        )
    if kind == "damping_power":
        return _damping_terms(model, modes, motion, structure.span(place), log_frequency(structure, place))
    if kind == "table_gain":
        return [table_term(modes, motion.table_read)]
    if kind == "table_delay":
        return [table_term(modes, -motion.table_slope)]
    if kind == "event_gain":
        return _event_terms(model, modes, motion, place)
    if kind == "channel_gain":
        return [channel_term(model, place, motion.outputs[:, place] / motion.reads[place])]
    if kind == "channel_offset":
        return [channel_term(model, place, np.full(len(motion.outputs), 1.0 / motion.reads[place]))]
    return [channel_term(model, place, -motion.output_rate[:, place])]


def _modal_terms(model: Model, motion: Motion, shapes: np.ndarray, place: int) -> list[Term]:
    """Return the terms of a unit stiffness between two modes of the baseline frame."""
    number, one, other = model.structure.discrepancies[place]
    span, rows = model.structure.span(number), model.structure.frames[number].modal_rows
    each = [(one, other)] if one == other else [(one, other), (other, one)]
    return [
        force_term(motion, lambda m, j=j: -(m.floor[:, span] @ rows[j]), rows[i] @ shapes[span])  # type: ignore[misc]
        for i, j in each
    ]


def _coupling_terms(model: Model, modes: Modes, motion: Motion, place: int) -> list[Term]:
    """Return the terms of a damping between two of a frame's own modes as large as the geometric mean of their own."""
    plain = len(modes.omega) == model.structure.floors
    own = np.eye(len(modes.omega)) if plain else model.own_motion @ modes.floors
    (one, other), size = model.structure.couplings[place], float(model.structure.coupling_size[place])
    return [
        # The predictor, too, takes it for a straight line.
        force_term(motion, lambda m, b=b: -size * (m.eta_rate @ own[b]), own[a], linear=False)  # type: ignore[misc]
        for a, b in ((one, other), (other, one))
    ]


def law_term(motion: Motion, modes: Modes, placed: PlacedLaw) -> Term:
    """Return the term of a law at its place.

    Args:
        motion: Motion of a run.
        modes: Modes of the filtered model.
        placed: The law.
    """

    def pull(m: Motion) -> np.ndarray:
        rate = m.floor_rate @ placed.row + placed.in_room * m.table_rate
        time = np.arange(len(rate)) * motion.run.step_s
        return -placed.law.along(placed.parameters, m.floor @ placed.row, rate, time)

    return force_term(motion, pull, placed.row @ modes.floors, linear=False)


def _event_terms(model: Model, modes: Modes, motion: Motion, place: int) -> list[Term]:
    """Return the contact force in one contact event, nothing in other runs."""
    event, run = model.observed.contact_events[place], motion.run
    if model.observed.runs[event.run] is not run:
        return []
    left, right = model.observed.contact_floors[event.column]
    direction = modes.floors[right] - modes.floors[left]
    at, middle = run.instants
    shown, held = (
        np.where(event.within(times), run.contact_at(times, event.column), 0.0) for times in (at, middle)
    )
    direct = model.linear_system(modes).direct @ direction
    return [Term(shown, output=direct, jumps=(held, _within_step(model, modes, run, direction)))]


def _within_step(model: Model, modes: Modes, run: RunData, direction: np.ndarray) -> np.ndarray:
    """Return states at a step's start from which modes swing as after a unit force in each substep, (states, substeps).

    As the predictor does, it holds the force over the substep; an impact is shorter than a step.

    Args:
        model: The baseline model.
        modes: Modes of the filtered model.
        run: The run.
        direction: Modal force of a unit of it, shape (modes,).
    """
    substep, n = run.step_s / run.substeps, len(modes.omega)
    moved, rate = modes.step(substep)[4:] * direction
    back = modes.swing(-substep * np.arange(1, run.substeps + 1))
    ways = np.zeros((2 * n + model.structure.floors + 3, run.substeps))
    ways[:n] = (back[0] * moved + back[1] * rate).T
    ways[n : 2 * n] = (back[2] * moved + back[3] * rate).T
    return ways


def matrix_terms(motion: Motion, stiffness: np.ndarray, shapes: np.ndarray, span: slice) -> list[Term]:
    """Return the terms of a stiffness matrix added to the floors in `span`.

    Args:
        motion: Motion of a run.
        stiffness: The added stiffness [N/m], shape (floors in span, floors in span).
        shapes: Displacement of each floor for a unit of each mode, shape (floors, modes).
        span: The floors among all.
    """
    return [
        force_term(motion, lambda m, row=row: -(m.floor[:, span] @ row), shapes[span.start + floor])  # type: ignore[misc]
        for floor, row in enumerate(stiffness)
    ]


def pattern_terms(motion: Motion, pattern: np.ndarray, shapes: np.ndarray) -> list[Term]:
    """Return the terms of a symmetric stiffness of low rank: one for each of its eigenvectors that matters.

    Args:
        motion: Motion of a run.
        pattern: The added stiffness of all floors [N/m], shape (floors, floors).
        shapes: Displacement of each floor for a unit of each mode, shape (floors, modes).
    """
    values, vectors = np.linalg.eigh(pattern)
    large = np.flatnonzero(np.abs(values) > 1e-3 * np.abs(values).max())
    return [
        force_term(motion, lambda m, j=j: -values[j] * (m.floor @ vectors[:, j]), vectors[:, j] @ shapes)  # type: ignore[misc]
        for j in large
    ]


def _damping_terms(
    model: Model, modes: Modes, motion: Motion, places: slice, changes: np.ndarray
) -> list[Term]:
    """Return the terms of relative changes of the damping of the frames' own modes `places`, shape (places,).

    With coordinates that the floors do not have there are more modes, each made of several of the frames' own.
    """
    plain = len(modes.omega) == model.structure.floors
    own = np.eye(len(modes.omega)) if plain else model.overlap(modes)
    share = changes @ own[places]
    return [
        force_term(motion, _damper(modes, int(mode), float(share[mode])), np.eye(len(modes.omega))[mode])
        for mode in np.flatnonzero(np.abs(share) > LEAST_SHARE)
    ]


def _damper(modes: Modes, mode: int, share: float) -> Callable[[Motion], np.ndarray]:
    factor = -2 * share * modes.ratio[mode] * modes.omega[mode]
    return lambda m: factor * m.eta_rate[:, mode]


def table_term(modes: Modes, series: np.ndarray) -> Term:
    """Return what a change of the table's acceleration by `series` adds.

    Args:
        modes: Modes of the filtered model.
        series: Change of the table's acceleration [m/s^2], shape (samples,).
    """
    return Term(series, -modes.participation, inertial=True, table=1.0)


def channel_term(model: Model, channel: int, series: np.ndarray) -> Term:
    """Return what a change of a channel by `series` adds.

    Args:
        model: The baseline model.
        channel: Number of the channel.
        series: Change of what it shows in SI, shape (samples,).
    """
    return Term(series, output=np.eye(len(model.observed.names))[channel])
