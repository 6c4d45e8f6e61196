"""What a small force, input or sensor change does to the innovations: many at once through the steady filter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from typing import Any

import numpy as np
from numba import njit

from pounding.diagnosis.model.closed_loop import Jumps, Loop, own_motions, pushed, transition
from pounding.diagnosis.model.kalman import SteadyFilter
from pounding.diagnosis.model.law_feedback import Added, LawFeedback, filter_with_laws
from pounding.diagnosis.model.predictor import CONTRACT
from pounding.diagnosis.model.tangents import Tangents

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
        jumps: Series (samples, n), and what a unit of each adds to the states at once when a sample has corrected them,
            (states, n), or None.
        inertial: The force comes from the table's motion, which an absolute acceleration does not show at once.
        change: What it adds to the forces of the laws that act, at each sample and in the middle of each substep, shape
            (samples, 1 + substeps, laws), or None.
        between: What the mean over the step after each sample has beyond the mean of the step's ends, shape (samples,), or
            None: a force that is bent within a step pushes by more than the straight line from sample to sample.
    """

    series: np.ndarray
    force: np.ndarray | None = None
    output: np.ndarray | None = None
    end: np.ndarray | None = None
    inertial: bool = False
    table: float = 0.0
    jumps: tuple[np.ndarray, np.ndarray] | None = None
    change: np.ndarray | None = None
    between: np.ndarray | None = None

    def parts(self) -> list[Term]:
        """Return the term as forces that are straight lines from sample to sample."""
        if self.between is None:
            return [self]
        # It is held over the step, and no sample shows it by itself.
        until = np.append(0.0, self.between[:-1])
        return [replace(self, between=None), Term(self.between, self.force, end=until, inertial=True)]


def signatures(steady: SteadyFilter, groups: Sequence[Sequence[Term]], shown: np.ndarray) -> np.ndarray:
    """Return what the terms of each group add to the innovations, (samples, channels, groups), single precision.

    Args:
        steady: The filter.
        groups: Terms whose contributions are summed, group by group.
        shown: Matrix by which the innovations are multiplied, such as the one that whitens them, (channels, channels).

    This is the exact derivative of the one-step predictor for a force that is a series of its own states: the gain is
    fixed, and the state's change passes through the closed loop `step (1 - gain output)`, no law acting.
    """
    samples = next((len(term.series) for group in groups for term in group), 0)
    return next(signature_pieces(steady, groups, shown, max(samples, 1)))


def signature_pieces(
    steady: SteadyFilter,
    groups: Sequence[Sequence[Term]],
    shown: np.ndarray,
    piece: int,
    laws: Tangents | None = None,
) -> Iterator[np.ndarray]:
    """Yield `signatures` of some samples at a time, (samples, channels, groups): those of a long run fill the memory.

    Args:
        steady: The filter.
        groups: Terms whose contributions are summed, group by group.
        shown: Matrix by which the innovations are multiplied, (channels, channels).
        piece: Samples at a time.
        laws: Laws that act, about the motion: they answer what the terms do to it.
    """
    terms, turns, group = _in_turn([[part for term in group for part in term.parts()] for group in groups])
    if not terms:
        return
    modes, channels = steady.force_start.shape[1] - 1, len(steady.output)
    force = np.zeros((modes + 1, len(terms)))
    output = np.zeros((channels, len(terms)))
    for j, term in enumerate(terms):
        if term.force is not None:
            force[:modes, j] = term.force
        force[modes, j] = term.table
        if term.output is not None:
            output[:, j] = term.output
    seen = np.array([not term.inertial for term in terms], float)
    closed = transition(steady)
    inputs, direct = pushed(
        steady,
        closed,
        steady.force_start @ force,
        steady.force_end @ force,
        steady.direct @ force[:modes] * seen + output,
    )
    own = own_motions(closed)
    turn, shows, moved, onward = closed, shown @ steady.output, inputs, steady.step
    if own is not None:
        turn, shows, moved, onward = own.turn, shows @ own.back, own.forth @ inputs, own.forth @ steady.step
    precision = np.float64 if own is None else own.precision
    loop = Loop(turn, shows, moved[:2], shown @ direct, turns, group, turning=own is not None)
    feedback = (
        None if laws is None else LawFeedback.of(loop, steady, own, shown, laws, (force, direct, inputs[2]))
    )
    loop, feedback = loop.rounded(precision), feedback and feedback.rounded(precision)
    ends = [term.series if term.end is None else term.end for term in terms]
    state = _together(moved[2] * np.array([end[0] for end in ends]), turns).astype(precision)
    samples = len(ends[0])
    for first in range(0, samples, piece):
        rows = slice(first, first + piece)
        series = _rounded([term.series[rows] for term in terms], precision)
        at_end = _rounded([end[rows] for end in ends], precision)
        jumps = _jumps(terms, turns, rows, onward, precision)
        result = np.zeros((len(series), channels, len(groups)), np.float32)
        if feedback is None or laws is None:
            _filter(loop, series, at_end, jumps, state, result)
        else:
            jumped = _jumps(terms, turns, rows, feedback.seen, precision)
            added = _changes(terms, turns, rows, laws).rounded(precision)
            filter_with_laws(feedback, added, first, series, at_end, jumps, jumped, state, result)
        yield result


def _rounded(series: Sequence[np.ndarray], precision: type[np.floating[Any]]) -> np.ndarray:
    """Return the series of each term with numbers of a precision, shape (samples, terms)."""
    return np.ascontiguousarray(np.array(series, precision).T)


def _together(values: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Return the sums over the terms of each group, (..., columns), of what is given for each term, (..., terms)."""
    total = np.array(values[..., : turns[1]])
    for begin, end in pairwise(turns[1:]):
        total[..., : end - begin] += values[..., begin:end]
    return total


def _columns(turns: np.ndarray) -> list[int]:
    """Return the column of each term, that of its group."""
    return [column for begin, end in pairwise(turns) for column in range(end - begin)]


def _jumps(
    terms: Sequence[Term],
    turns: np.ndarray,
    rows: slice,
    onward: np.ndarray,
    precision: type[np.floating[Any]],
) -> Jumps:
    """Return what becomes of the jumps of groups at some samples, `added` having the rows of `onward`.

    Args:
        terms: The terms.
        turns: Those of `Loop`.
        rows: The samples.
        onward: What becomes of the filter's states: a step's end in whatever coordinates the loop's are, or what laws meet,
            shape (any, states).
        precision: Type of its numbers.
    """
    each: dict[int, tuple[np.ndarray, list[tuple[int, np.ndarray]]]] = {}
    for column, term in zip(_columns(turns), terms, strict=True):
        if term.jumps is not None and term.jumps[0][rows].any():
            series, ways = term.jumps
            each.setdefault(id(series), (series[rows].astype(precision), []))[1].append(
                (column, onward @ ways)
            )
    columns = np.unique([column for _, members in each.values() for column, _ in members]).astype(int)
    if not each:
        return Jumps(columns, np.zeros((0, 0, 0), precision))
    total = np.zeros((len(terms[0].series[rows]), len(onward), len(columns)), precision)
    for series, members in each.values():
        own = [int(np.searchsorted(columns, column)) for column, _ in members]
        if len(members) == 1:
            total[:, :, own[0]] += series @ members[0][1].astype(precision).T
            continue
        # Those that have their series in common are one product of large matrices.
        together = np.zeros((series.shape[1], len(onward), len(columns)), precision)
        for place, (_, ways) in zip(own, members, strict=True):
            together[:, :, place] += ways.T
        total += (series @ together.reshape(len(together), -1)).reshape(total.shape)
    return Jumps(columns, total)


def _changes(terms: Sequence[Term], turns: np.ndarray, rows: slice, laws: Tangents) -> Added:
    """Return the changes of laws at some samples."""
    each = zip(_columns(turns), terms, strict=True)
    changing = [(column, term.change) for column, term in each if term.change is not None]
    samples, substeps, count = laws.within.shape[:3]
    none = np.zeros((samples, 1 + substeps, 0))
    return Added(
        np.tile(np.arange(count), len(changing)),
        np.repeat(np.array([column for column, _ in changing], int), count),
        np.concatenate([none[rows], *(change[rows] for _, change in changing)], axis=2),
    )


def _in_turn(groups: Sequence[Sequence[Term]]) -> tuple[list[Term], np.ndarray, np.ndarray]:
    """Return all terms by turns, where each turn begins and the last ends, and the group of each column.

    The groups with the most terms are the first columns, and those without any are none: the terms of a turn, one of each
    group that has so many, are then those of the first columns.
    """
    order = sorted(
        (number for number, group in enumerate(groups) if group), key=lambda number: -len(groups[number])
    )
    longest = max((len(group) for group in groups), default=0)
    by_turn = [
        [groups[number][turn] for number in order if len(groups[number]) > turn] for turn in range(longest)
    ]
    turns = np.cumsum([0, *(len(terms) for terms in by_turn)])
    return list(chain.from_iterable(by_turn)), turns, np.array(order, int)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _filter(
    loop: Loop,
    series: np.ndarray,
    at_end: np.ndarray,
    jumps: Jumps,
    state: np.ndarray,
    result: np.ndarray,
) -> None:
    """Run the closed loop once for each group, pushed by all of its terms.

    Args:
        loop: The loop.
        series, at_end: Size of each term at the samples shown, shape (samples, terms).
        jumps: What else those of a group add to the states after each sample.
        state: States at the first sample less what the ends have just made, which become those after the last one shown,
            shape (states, columns).
        result: Filled with what is shown where a group has terms, shape (samples, channels, groups).
    """
    transition, output, _, direct, turns, group, turning = loop
    samples, columns = len(series), len(group)
    channels, states = output.shape
    pairs = states - transition.shape[1]
    # Some samples' states side by side: what they show is one product of large matrices, and all loops run over columns.
    x = np.zeros((states, TOGETHER + 1, columns), state.dtype)
    shown = np.zeros((channels, TOGETHER + 1, columns), state.dtype)
    all_x, all_shown = x.reshape(states, -1), shown.reshape(channels, -1)
    for i in range(states):
        for t in range(columns):
            x[i, 0, t] = state[i, t]
    for first in range(0, samples, TOGETHER):
        count = min(TOGETHER, samples - first)
        # One motion after the other, each over some samples: what it needs then stays in the processor's first cache.
        if turning:
            for i in range(pairs):
                real, imaginary, j = transition[0, i], transition[1, i], pairs + i
                _push(loop, i, series, at_end, jumps, first, count, x)
                _push(loop, j, series, at_end, jumps, first, count, x)
                for b in range(count):
                    # Two loops: each is done for several columns at the same time.
                    for t in range(columns):
                        x[i, b + 1, t] += real * x[i, b, t] - imaginary * x[j, b, t]
                    for t in range(columns):
                        x[j, b + 1, t] += imaginary * x[i, b, t] + real * x[j, b, t]
            for i in range(2 * pairs, states):
                real = transition[0, i - pairs]
                _push(loop, i, series, at_end, jumps, first, count, x)
                for b in range(count):
                    for t in range(columns):
                        x[i, b + 1, t] += real * x[i, b, t]
        else:
            for i in range(states):
                _push(loop, i, series, at_end, jumps, first, count, x)
            for b in range(count):
                for i in range(states):
                    for s in range(states):
                        real = transition[i, s]
                        for t in range(columns):
                            x[i, b + 1, t] += real * x[s, b, t]
        np.dot(output, all_x, all_shown)
        for b in range(count):
            k = first + b
            for c in range(channels):
                for r in range(len(turns) - 1):
                    begin = turns[r]
                    for t in range(turns[r + 1] - begin):
                        shown[c, b, t] += direct[c, begin + t] * at_end[k, begin + t]
                for t in range(columns):
                    result[k, c, group[t]] = shown[c, b, t]
        for i in range(states):
            for t in range(columns):
                x[i, 0, t] = x[i, count, t]
    for i in range(states):
        for t in range(columns):
            state[i, t] = x[i, 0, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _push(
    loop: Loop,
    i: int,
    series: np.ndarray,
    at_end: np.ndarray,
    jumps: Jumps,
    first: int,
    count: int,
    x: np.ndarray,
) -> None:
    """Fill state i after each of some samples, x of shape (states, 1 + samples, columns), with what pushes it there."""
    inputs, turns = loop.inputs, loop.turns
    columns = x.shape[2]
    for b in range(count):
        k = first + b
        for t in range(columns):
            x[i, b + 1, t] = inputs[0, i, t] * series[k, t] + inputs[1, i, t] * at_end[k, t]
        for r in range(1, len(turns) - 1):
            begin = turns[r]
            for t in range(turns[r + 1] - begin):
                x[i, b + 1, t] += (
                    inputs[0, i, begin + t] * series[k, begin + t]
                    + inputs[1, i, begin + t] * at_end[k, begin + t]
                )
        for n in range(len(jumps.columns)):
            x[i, b + 1, jumps.columns[n]] += jumps.added[k, i, n]
