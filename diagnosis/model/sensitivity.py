"""What a small force, input or sensor change does to the innovations: many at once through the steady filter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from pounding.diagnosis.model.kalman import SteadyFilter

ALIKE = 1e6
"""Condition of the own motions' shapes from which on the loop is run without them: sums would lose six digits."""
TOGETHER = 8
"""Samples whose outputs are worked out together."""


@dataclass(frozen=True)
class Term:
    """One series acting along one direction.

    Attributes:
        series: Size at each sample, shape (samples,).
        force: Modal forces that a unit of it makes, shape (modes,), or None.
        output: What a unit of it adds to the channels by itself, shape (channels,), or None.
        end: Size at the end of the step before each sample, where it differs from `series` (a force that jumps when
            the state is corrected), shape (samples,), or None.
        table: What a unit of it adds to the table's own acceleration.
        inertial: The force comes from the table's motion, which an absolute acceleration does not show at once.
    """

    series: np.ndarray
    force: np.ndarray | None = None
    output: np.ndarray | None = None
    end: np.ndarray | None = None
    inertial: bool = False
    table: float = 0.0


def signatures(steady: SteadyFilter, groups: Sequence[Sequence[Term]], shown: np.ndarray) -> np.ndarray:
    """Return what the terms of each group add to the innovations, (samples, channels, groups), single precision.

    Args:
        steady: The filter.
        groups: Terms whose contributions are summed, group by group.
        shown: Matrix by which the innovations are multiplied, such as the one that whitens them, (channels, channels).

    This is the exact derivative of the one-step predictor for a force that is a series of its own states: the gain is
    fixed, and the state's change passes through the closed loop `step (1 - gain output)`.
    """
    samples = next((len(term.series) for group in groups for term in group), 0)
    return next(signature_pieces(steady, groups, shown, max(samples, 1)))


def signature_pieces(
    steady: SteadyFilter, groups: Sequence[Sequence[Term]], shown: np.ndarray, piece: int
) -> Iterator[np.ndarray]:
    """Yield `signatures` of some samples at a time, (samples, channels, groups): those of a long run fill the memory.

    Args:
        steady: The filter.
        groups: Terms whose contributions are summed, group by group.
        shown: Matrix by which the innovations are multiplied, (channels, channels).
        piece: Samples at a time.
    """
    terms, column = _in_turn(groups)
    modes, channels = steady.force_start.shape[1] - 1, len(steady.output)
    force = np.zeros((modes + 1, len(terms)))
    output = np.zeros((channels, len(terms)))
    for j, term in enumerate(terms):
        if term.force is not None:
            force[:modes, j] = term.force
        force[modes, j] = term.table
        if term.output is not None:
            output[:, j] = term.output
    ends = [term.series if term.end is None else term.end for term in terms]
    seen = np.array([not term.inertial for term in terms], float)
    direct = steady.direct @ force[:modes] * seen + output
    closed = steady.step @ (np.eye(len(steady.step)) - steady.gain @ steady.output)
    start = steady.force_start @ force
    back = -steady.step @ steady.gain @ direct
    end = steady.force_end @ force
    inputs = np.stack([start, back, end])
    own = _own_motions(closed)
    if own is None:
        transition, seen, pushed = closed, shown @ steady.output, inputs
    else:
        transition, seen = own.turn, shown @ steady.output @ own.back
        pushed = own.forth @ inputs
    transition, seen, pushed, past = (
        np.ascontiguousarray(one) for one in (transition, seen, pushed, shown @ direct)
    )
    state = np.zeros((len(closed), len(groups)))
    samples = len(ends[0])
    for first in range(0, samples, piece):
        # The sample after the last one shown says what the step to it ends with.
        rows = slice(first, first + piece + 1)
        series = np.stack([term.series[rows] for term in terms], axis=1)
        at_end = np.stack([end[rows] for end in ends], axis=1)
        result = np.zeros((min(piece, samples - first), channels, len(groups)), np.float32)
        _filter(transition, seen, pushed, past, series, at_end, column, state, result, own is not None)
        yield result


def _in_turn(groups: Sequence[Sequence[Term]]) -> tuple[list[Term], np.ndarray]:
    """Return all terms and the group of each, shape (terms,): the first term of each group, the second ones, and so on.

    Neighbours so add to different sums, which a processor does at the same time.
    """
    length = next((len(group[0].series) for group in groups if group), 0)
    still = Term(np.zeros(length))
    terms = [group[0] if group else still for group in groups]
    further = [(turn, number) for number, group in enumerate(groups) for turn in range(1, len(group))]
    further.sort()
    column = [*range(len(groups)), *(number for _, number in further)]
    return terms + [groups[number][turn] for turn, number in further], np.array(column)


@dataclass(frozen=True)
class _OwnMotions:
    """Coordinates in which each of a closed loop's own motions goes its own way.

    Attributes:
        turn: Real and imaginary part of each one's factor in a step, those that turn first, shape (2, motions).
        forth: From the states to the real parts of those that turn, their imaginary parts, and the others, shape
            (states, states).
        back: The way back, shape (states, states).
    """

    turn: np.ndarray
    forth: np.ndarray
    back: np.ndarray


def _own_motions(closed: np.ndarray) -> _OwnMotions | None:
    """Return the own motions of a closed loop, (states, states), None where they are too alike to be told apart."""
    factors, vectors = np.linalg.eig(closed)
    size = np.abs(vectors).max(axis=1)
    if not np.all(size > 0.0) or np.linalg.cond(vectors / size[:, None]) > ALIKE:
        return None
    # Of a conjugate pair one is enough: the real part of twice its contribution is that of both.
    turns, stays = factors.imag > 0.0, factors.imag == 0.0
    inverse = np.linalg.inv(vectors)
    return _OwnMotions(
        np.hstack([[one.real, one.imag] for one in (factors[turns], factors[stays])]),
        np.concatenate([inverse[turns].real, inverse[turns].imag, inverse[stays].real]),
        np.hstack([2 * vectors[:, turns].real, -2 * vectors[:, turns].imag, vectors[:, stays].real]),
    )


@njit(cache=True, nogil=True)
def _filter(
    transition: np.ndarray,
    output: np.ndarray,
    inputs: np.ndarray,
    direct: np.ndarray,
    series: np.ndarray,
    at_end: np.ndarray,
    column: np.ndarray,
    state: np.ndarray,
    result: np.ndarray,
    turning: bool,
) -> None:
    """Run the closed loop once for each group: what its terms do to the states adds up.

    Args:
        transition: Transition of the closed loop, shape (states, states); where the states are `turning`,
            `_OwnMotions.turn`, shape (2, motions).
        output: What the states show, shape (channels, states).
        inputs: What a unit of each term adds to the states by its start, by its end before the step and by that after it,
            shape (3, states, terms).
        direct: What it adds to what is shown, shape (channels, terms).
        series, at_end: Size of each term, shape (samples, terms), at those shown and, where there is one, at the next.
        column: Group of each term, shape (terms,); the first terms are those of one group after the other.
        state: States at the first sample, which become those after the last one shown, shape (states, groups).
        result: Filled with what is shown, shape (samples shown, channels, groups).
        turning: Whether the states are those of `_OwnMotions`.
    """
    samples, terms = series.shape
    channels, states = output.shape
    groups, motions = result.shape[2], transition.shape[1]
    pairs = states - motions
    # Some samples' states side by side: what they show is one product of large matrices, and all loops run over groups.
    x = np.zeros((states, (TOGETHER + 1) * groups))
    shown = np.zeros((channels, (TOGETHER + 1) * groups))
    x[:, :groups] = state
    pushed = np.zeros(terms)
    stop = len(result)
    for first in range(0, stop, TOGETHER):
        count = min(TOGETHER, stop - first)
        for b in range(count):
            k, here, there = first + b, b * groups, (b + 1) * groups
            if k + 1 == samples:
                break
            if turning:
                for i in range(pairs):
                    real, imaginary = transition[0, i], transition[1, i]
                    one, other = x[i, here:there], x[pairs + i, here:there]
                    one_then, other_then = x[i, there : there + groups], x[pairs + i, there : there + groups]
                    for g in range(groups):
                        one_then[g] = real * one[g] - imaginary * other[g]
                        other_then[g] = imaginary * one[g] + real * other[g]
                for i in range(pairs, motions):
                    for g in range(groups):
                        x[pairs + i, there + g] = transition[0, i] * x[pairs + i, here + g]
            else:
                for i in range(states):
                    x[i, there : there + groups] = 0.0
                    for s in range(states):
                        for g in range(groups):
                            x[i, there + g] += transition[i, s] * x[s, here + g]
            size, end, next_end = series[k], at_end[k], at_end[k + 1]
            for i in range(states):
                start, back, forth = inputs[0, i], inputs[1, i], inputs[2, i]
                # All terms first, side by side in the processor: those that share a sum go into it one by one.
                for j in range(terms):
                    pushed[j] = start[j] * size[j] + back[j] * end[j] + forth[j] * next_end[j]
                then = x[i, there : there + groups]
                for g in range(groups):
                    then[g] += pushed[g]
                for j in range(groups, terms):
                    then[column[j]] += pushed[j]
        np.dot(output, x, shown)
        for b in range(count):
            k, here = first + b, b * groups
            end = at_end[k]
            for c in range(channels):
                seen, shows, kept = shown[c, here : here + groups], direct[c], result[k, c]
                for j in range(groups, terms):
                    seen[column[j]] += shows[j] * end[j]
                for g in range(groups):
                    kept[g] = seen[g] + shows[g] * end[g]
        x[:, :groups] = x[:, count * groups : (count + 1) * groups]
    state[:] = x[:, :groups]
