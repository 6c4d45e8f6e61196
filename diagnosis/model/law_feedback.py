"""The feedback of laws: what a small force does to a frame changes the forces of the laws in it, and so what it does."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from pounding.diagnosis.model.closed_loop import Loop, OwnMotions, pushed
from pounding.diagnosis.model.kalman import SteadyFilter
from pounding.diagnosis.model.predictor import CONTRACT
from pounding.diagnosis.model.tangents import Tangents


class LawFeedback(NamedTuple):
    """The feedback of laws about a motion to each term: tangent stiffness, damping and memory in the closed loop.

    Attributes:
        loop: The loop without it, whose `output` and `direct` have the laws' drifts, then their rates, below the channels.
        slopes: Of `Tangents`.
        own_ends: What the end of a law adds to drifts and rates, shape (2 laws, laws).
        settled: What the ends of laws become of those that answer the terms alone, because each answers what all of them do
            to the motion at once, shape (samples, laws, laws).
        corrected: How far what is shown corrects these, shape (2 laws, channels).
        pushed: What start and end of each law, all starts first, add to the states in a step, shape (states, 2 laws).
        direct: What the end of each law adds to what is shown, shape (channels, laws).
        memory: Change of what each law remembers, for each term, shape (laws, remembered, terms).
    """

    loop: Loop
    slopes: np.ndarray
    own_ends: np.ndarray
    settled: np.ndarray
    corrected: np.ndarray
    pushed: np.ndarray
    direct: np.ndarray
    memory: np.ndarray

    @classmethod
    def of(
        cls,
        loop: Loop,
        steady: SteadyFilter,
        closed: np.ndarray,
        own: OwnMotions | None,
        shown: np.ndarray,
        laws: Tangents,
        lacking: np.ndarray,
    ) -> LawFeedback:
        """Return the feedback to terms.

        Args:
            loop: The loop without laws.
            steady: The filter.
            closed: Transition of its closed loop, shape (states, states).
            own: The motions that are the loop's states; None where these are the filter's own.
            shown: Matrix by which the innovations are multiplied, shape (channels, channels).
            laws: The laws.
            lacking: What the ends of the terms have made of the filter's states, which are less that (`pushed`), taken
                negative, shape (states, terms).
        """
        count, modes = laws.rows.shape
        states = len(steady.step)
        seen = np.zeros((2 * count, states))
        seen[:count, :modes] = laws.rows
        seen[count:, modes : 2 * modes] = laws.rows
        seen[count:, -1] = laws.room
        # With the mean of start and end over the step, as in Newmark's rule of constant acceleration, no joint is too stiff.
        mean = 0.5 * (steady.force_start + steady.force_end)[:, :modes] @ laws.rows.T
        inputs, direct = pushed(steady, closed, mean, mean, steady.direct @ laws.rows.T)
        moved = inputs if own is None else own.forth @ inputs
        shows = seen if own is None else seen @ own.back
        own_ends = -seen @ inputs[2]
        # The force at the end of a step is a part of the motion that it answers.
        before = laws.slopes[::2, :, 0, :2]
        answers = (
            before[..., 0, np.newaxis] * own_ends[:count] + before[..., 1, np.newaxis] * own_ends[count:]
        )
        alone = np.eye(count) + answers
        # The library's inverse of each sample's matrix is slow, and most often it is that of a number.
        settled = np.linalg.inv(alone) if count > 1 else 1.0 / alone
        whole = (
            laws.slopes,
            own_ends,
            settled,
            seen @ steady.gain @ np.linalg.inv(shown),
            np.hstack([moved[0], moved[1]]),
            shown @ direct,
            np.zeros((count, laws.slopes.shape[2] - 1, lacking.shape[1])),
        )
        below = loop._replace(
            output=np.vstack([loop.output, shows]), direct=np.vstack([loop.direct, -seen @ lacking])
        )
        return cls(below, *whole)

    def rounded(self, precision: type[np.floating[Any]]) -> LawFeedback:
        """Return the feedback with numbers of a precision."""
        return LawFeedback(
            self.loop.rounded(precision), *(one.astype(precision, order="C") for one in self[1:])
        )


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def filter_with_laws(
    feedback: LawFeedback,
    first: int,
    series: np.ndarray,
    at_end: np.ndarray,
    jumps: np.ndarray,
    state: np.ndarray,
    result: np.ndarray,
) -> None:
    """Run the closed loop once for each term, with the laws' feedback, and add up what those of a group show.

    Args:
        feedback: The loop with it.
        first: Number of the first sample.
        series, at_end: Size of each term at the samples, shape (samples, terms).
        jumps: What else each adds to the states after each sample, shape (samples, states, terms), or none.
        state: States before the first sample, which become those after the last one, shape (states, terms).
        result: Filled with what is shown, shape (samples, channels, groups).
    """
    transition, output, inputs, direct, column, turning = feedback.loop
    _, slopes, own_ends, settled, corrected, own_pushed, own_direct, memory = feedback
    samples, terms = series.shape
    channels, laws = own_direct.shape
    groups = result.shape[2]
    jumping = jumps.size > 0
    shown = np.zeros((channels + 2 * laws, terms), state.dtype)
    motion = np.zeros((2 * laws, terms), state.dtype)
    forces = np.zeros((2 * laws, terms), state.dtype)
    starts, ends = forces[:laws], forces[laws:]
    push = np.zeros_like(state)
    moved = np.zeros_like(state)
    new = np.zeros_like(memory)
    for k in range(samples):
        np.dot(output, state, shown)
        for c in range(channels + 2 * laws):
            for t in range(terms):
                shown[c, t] += direct[c, t] * at_end[k, t]
        before, after = slopes[2 * (first + k)], slopes[2 * (first + k) + 1]
        for i in range(2 * laws):
            for t in range(terms):
                motion[i, t] = shown[channels + i, t]
        _answer(before, motion, memory, starts)
        _weighed(settled[first + k], starts, ends)
        for i in range(2 * laws):
            for j in range(laws):
                for t in range(terms):
                    motion[i, t] += own_ends[i, j] * ends[j, t]
        _remember(before, motion, memory, new)
        for c in range(channels):
            for j in range(laws):
                for t in range(terms):
                    shown[c, t] += own_direct[c, j] * ends[j, t]
            for i in range(2 * laws):
                for t in range(terms):
                    motion[i, t] -= corrected[i, c] * shown[c, t]
        _answer(after, motion, memory, starts)
        _remember(after, motion, memory, new)
        for c in range(channels):
            for t in range(groups, terms):
                shown[c, column[t]] += shown[c, t]
            for g in range(groups):
                result[k, c, g] = shown[c, g]
        _weighed(own_pushed, forces, push)
        for i in range(len(state)):
            for t in range(terms):
                push[i, t] += inputs[0, i, t] * series[k, t] + inputs[1, i, t] * at_end[k, t]
                if jumping:
                    push[i, t] += jumps[k, i, t]
        if turning:
            _turn(transition, push, state)
        else:
            np.dot(transition, state, moved)
            for i in range(len(state)):
                for t in range(terms):
                    state[i, t] = moved[i, t] + push[i, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _turn(turn: np.ndarray, push: np.ndarray, state: np.ndarray) -> None:
    """Take a step of own motions (`OwnMotions.turn`) with a push, states and push of shape (states, terms)."""
    states, terms = state.shape
    pairs = states - turn.shape[1]
    for i in range(pairs):
        real, imaginary, j = turn[0, i], turn[1, i], pairs + i
        for t in range(terms):
            one, other = state[i, t], state[j, t]
            state[i, t] = real * one - imaginary * other + push[i, t]
            state[j, t] = imaginary * one + real * other + push[j, t]
    for i in range(2 * pairs, states):
        for t in range(terms):
            state[i, t] = turn[0, i - pairs] * state[i, t] + push[i, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _weighed(weights: np.ndarray, rows: np.ndarray, found: np.ndarray) -> None:
    """Fill in the product of weights, (n, m), and rows, (m, terms): for few of them no library is called."""
    terms = rows.shape[1]
    for i in range(weights.shape[0]):
        weight = weights[i, 0]
        for t in range(terms):
            found[i, t] = weight * rows[0, t]
        for j in range(1, weights.shape[1]):
            weight = weights[i, j]
            for t in range(terms):
                found[i, t] += weight * rows[j, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _answer(slopes: np.ndarray, motion: np.ndarray, memory: np.ndarray, forces: np.ndarray) -> None:
    """Fill in the forces, (laws, terms), that answer changes of drifts and rates, (2 laws, terms), and of memories."""
    laws, terms = forces.shape
    for i in range(laws):
        for t in range(terms):
            forces[i, t] = -(slopes[i, 0, 0] * motion[i, t] + slopes[i, 0, 1] * motion[laws + i, t])
        for r in range(memory.shape[1]):
            for t in range(terms):
                forces[i, t] -= slopes[i, 0, 2 + r] * memory[i, r, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _remember(slopes: np.ndarray, motion: np.ndarray, memory: np.ndarray, new: np.ndarray) -> None:
    """Change what laws remember, (laws, remembered, terms), by changes of drifts and rates, (2 laws, terms)."""
    laws, remembered, terms = memory.shape
    if remembered == 0:
        return
    for i in range(laws):
        for r in range(remembered):
            by_drift, by_rate = slopes[i, 1 + r, 0], slopes[i, 1 + r, 1]
            for t in range(terms):
                new[i, r, t] = by_drift * motion[i, t] + by_rate * motion[laws + i, t]
            for q in range(remembered):
                kept = slopes[i, 1 + r, 2 + q]
                if kept != 0.0:
                    for t in range(terms):
                        new[i, r, t] += kept * memory[i, q, t]
    for i in range(laws):
        for r in range(remembered):
            for t in range(terms):
                memory[i, r, t] = new[i, r, t]
