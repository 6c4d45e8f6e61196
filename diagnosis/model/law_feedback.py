"""The feedback of laws: what a small force does to a frame changes the forces of the laws in it, and so what it does."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from pounding.diagnosis.model.closed_loop import Jumps, Loop, OwnMotions
from pounding.diagnosis.model.kalman import SteadyFilter
from pounding.diagnosis.model.predictor import CONTRACT
from pounding.diagnosis.model.tangents import Tangents

MANY = 64
"""Weights from which on a product by the library is faster."""


class Added(NamedTuple):
    """What terms add to the forces of laws by themselves, at the samples at hand.

    Attributes:
        law, column: Number of the law, and the column of the term's group, shape (additions,).
        forces: The forces [N] at each sample and in the middle of each substep, shape (samples, 1 + substeps, additions).
    """

    law: np.ndarray
    column: np.ndarray
    forces: np.ndarray

    def rounded(self, precision: type[np.floating[Any]]) -> Added:
        """Return the same with numbers of a precision."""
        return Added(self.law, self.column, self.forces.astype(precision, order="C"))


class _Step(NamedTuple):
    """What a step makes of the drifts and rates that laws answer, in the middle of each substep.

    Attributes:
        middles: Of a unit of each state after the filter's correction, shape (answered substeps, states).
        held: Of a unit of each modal force, and of the table's acceleration, that is held from then on, shape (answered
            substeps, modes + 1).
        onwards: Of the force of each law in the last substep of the step before, and in each earlier substep, for each
            substep, shape (answered, (1 + substeps before) laws).
        pushed: What the force of each law in each substep adds to the states at the end of the step, shape (states,
            substeps laws). The last one of the step before has pushed already.
    """

    middles: np.ndarray
    held: np.ndarray
    onwards: list[np.ndarray]
    pushed: np.ndarray

    @classmethod
    def of(cls, laws: Tangents, seen: np.ndarray) -> _Step:
        """Return it from the drifts and rates of a unit of each state, shape (answered, states)."""
        (half, pushed), (count, _), substeps = laws.half, laws.rows.shape, laws.within.shape[1]
        whole, by_law = half @ half, np.vstack([laws.rows.T, np.zeros(count)])
        # What a force that is held makes of the states until the middle of the substep in which it begins, and its end.
        until_half, until_end = pushed @ by_law, (pushed + half @ pushed) @ by_law
        middles, held, onward, so_far, pushes = [], [], half, pushed, [until_end]
        for _ in range(substeps):
            middles.append(seen @ onward)
            held.append(seen @ so_far)
            onward, so_far = onward @ whole, so_far + onward @ (pushed + half @ pushed)
            pushes.append(whole @ pushes[-1])
        onwards = []
        for j in range(substeps):
            earlier = [np.zeros_like(until_half), *(half @ one for one in pushes[:j][::-1])]
            # Until the middle of a substep the predictor takes the force that the law had in the substep before.
            earlier[j] = earlier[j] + until_half
            onwards.append(np.hstack([seen @ one for one in earlier]))
        return cls(np.vstack(middles), np.vstack(held), onwards, np.hstack(pushes[:substeps][::-1]))


class LawFeedback(NamedTuple):
    """The feedback of laws about a motion to each group of terms: tangent stiffness, damping and memory in the closed loop.

    As the predictor does, it asks each law at the samples, which accelerations show at once, and in the middle of each
    substep, over which its force is held there. Of drifts and rates only those count that some law answers: a damper
    answers no drift.

    Attributes:
        loop: The loop without it. Below the channels, its `output` and `direct` have the drifts and rates that laws answer
            at a sample as predicted, and then in the middle of each substep.
        place: Number of each law's drift and rate among those that are answered, -1 where it answers none, shape (laws, 2).
        at_sample, within: Slopes, of `Tangents`.
        held: What each term's series adds to the latter until the middle of each substep, shape (answered substeps, terms).
        onwards: What forces before it add to drifts and rates in the middle of each substep, one substep after the other,
            each of shape (answered, (2 + substeps before) laws), all in one row: forces of each law in the last substep of
            the step before, at the sample, by what the filter makes of them, and in each earlier substep.
        pushed: What the forces at the sample and in each substep add to the states in a step, shape (states, (1 + substeps)
            laws).
        direct: What the force of each law at a sample adds to what is shown, shape (channels, laws).
        seen: Drifts and rates in the middle of each substep for each of the filter's states, (answered substeps, states).
        memory: Change of what each law remembers, for each group, shape (laws, remembered, columns).
        last: Change of the force of each law in the last substep before, for each group, shape (laws, columns).
    """

    loop: Loop
    place: np.ndarray
    at_sample: np.ndarray
    within: np.ndarray
    held: np.ndarray
    onwards: np.ndarray
    pushed: np.ndarray
    direct: np.ndarray
    seen: np.ndarray
    memory: np.ndarray
    last: np.ndarray

    @classmethod
    def of(
        cls,
        loop: Loop,
        steady: SteadyFilter,
        own: OwnMotions | None,
        shown: np.ndarray,
        laws: Tangents,
        pushes: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> LawFeedback:
        """Return the feedback to terms.

        Args:
            loop: The loop without laws.
            steady: The filter.
            own: The motions that are the loop's states; None where these are the filter's own.
            shown: Matrix by which the innovations are multiplied, shape (channels, channels).
            laws: The laws.
            pushes: Modal forces, and acceleration of the table, that a unit of each term makes, shape (modes + 1, terms);
                what its end adds to the channels, shape (channels, terms); and what this end has made of the filter's
                states, which are less that (`pushed`), taken negative, shape (states, terms).
        """
        count, modes = laws.rows.shape
        states, substeps = len(steady.step), laws.within.shape[1]
        seen = np.zeros((2, count, states))
        seen[0, :, :modes] = laws.rows
        seen[1, :, modes : 2 * modes] = laws.rows
        seen[1, :, -1] = laws.room
        answers = laws.answers
        place = np.where(answers, np.cumsum(answers).reshape(answers.shape) - 1, -1).T
        seen = seen[answers]
        force, direct, lacking = pushes
        at_once = steady.direct @ laws.rows.T
        step = _Step.of(laws, seen)
        # In the middle of a substep the filter has corrected the states by what is shown.
        corrected = step.middles - step.middles @ steady.gain @ steady.output
        answered = -(step.middles @ steady.gain)
        back = np.eye(states) if own is None else own.back
        below = loop._replace(
            output=np.vstack([loop.output, seen @ back, corrected @ back]),
            direct=np.vstack([loop.direct, -seen @ lacking, -step.middles @ lacking + answered @ direct]),
        )
        by_sample = (answered @ at_once).reshape(substeps, len(seen), count)
        onwards = [
            np.hstack([one[:, :count], sample, one[:, count:]])
            for sample, one in zip(by_sample, step.onwards, strict=True)
        ]
        inputs = np.hstack([-steady.step @ steady.gain @ at_once, step.pushed])
        columns, remembered = len(loop.group), laws.within.shape[3] - 1
        return cls(
            loop=below,
            place=np.ascontiguousarray(place),
            at_sample=laws.at_sample,
            within=laws.within,
            held=step.held @ force,
            onwards=np.concatenate([one.ravel() for one in onwards]),
            pushed=inputs if own is None else own.forth @ inputs,
            direct=shown @ at_once,
            seen=step.middles,
            memory=np.zeros((count, remembered, columns)),
            last=np.zeros((count, columns)),
        )

    def rounded(self, precision: type[np.floating[Any]]) -> LawFeedback:
        """Return the feedback with numbers of a precision."""
        loop, place, *numbers = self
        return LawFeedback(
            loop.rounded(precision), place, *(one.astype(precision, order="C") for one in numbers)
        )


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def filter_with_laws(
    feedback: LawFeedback,
    added: Added,
    first: int,
    series: np.ndarray,
    at_end: np.ndarray,
    jumps: Jumps,
    jumped: Jumps,
    state: np.ndarray,
    result: np.ndarray,
) -> None:
    """Run the closed loop once for each group, pushed by all of its terms, with the laws' feedback.

    Args:
        feedback: The loop with it.
        added: What terms add to the forces of laws by themselves.
        first: Number of the first sample.
        series, at_end: Size of each term at the samples, shape (samples, terms).
        jumps: What else those of a group add to the states after each sample.
        jumped: What that adds to drifts and rates in the middle of each substep, which are its rows instead of states.
        state: States before the first sample, which become those after the last one, shape (states, columns).
        result: Filled with what is shown where a group has terms, shape (samples, channels, groups).
    """
    transition, output, inputs, direct, turns, group, turning = feedback.loop
    _, place, at_sample, within, held, onwards, own_pushed, own_direct, seen, memory, last = feedback
    samples, columns = len(series), len(group)
    channels, laws = own_direct.shape
    substeps = within.shape[1]
    answered = len(seen) // substeps
    middles = channels + answered
    shown = np.zeros((middles + answered * substeps, columns), state.dtype)
    motion = np.zeros((answered, columns), state.dtype)
    # Those of the last substep before, at the sample, and of each substep.
    forces = np.zeros(((2 + substeps) * laws, columns), state.dtype)
    here = forces[laws : 2 * laws]
    for i in range(laws):
        for t in range(columns):
            forces[i, t] = last[i, t]
    push = np.zeros_like(state)
    moved = np.zeros_like(state)
    new = np.zeros_like(memory)
    for k in range(samples):
        np.dot(output, state, shown)
        for r in range(len(turns) - 1):
            begin = turns[r]
            for c in range(len(shown)):
                for t in range(turns[r + 1] - begin):
                    shown[c, t] += direct[c, begin + t] * at_end[k, begin + t]
            for c in range(len(held)):
                for t in range(turns[r + 1] - begin):
                    shown[middles + c, t] += held[c, begin + t] * series[k, begin + t]
        for c in range(len(held)):
            for n in range(len(jumped.columns)):
                shown[middles + c, jumped.columns[n]] += jumped.added[k, c, n]
        for i in range(answered):
            for t in range(columns):
                motion[i, t] = shown[channels + i, t]
        _answer(place, at_sample[first + k], motion, memory, here)
        for a in range(added.law.size):
            here[added.law[a], added.column[a]] += added.forces[k, 0, a]
        for c in range(channels):
            for j in range(laws):
                for t in range(columns):
                    shown[c, t] += own_direct[c, j] * here[j, t]
            for t in range(columns):
                result[k, c, group[t]] = shown[c, t]
        begin = 0
        for j in range(substeps):
            before = (2 + j) * laws
            weights = onwards[begin : begin + answered * before].reshape(answered, before)
            begin += answered * before
            _weighed(weights, forces[:before], motion)
            for i in range(answered):
                for t in range(columns):
                    motion[i, t] += shown[middles + answered * j + i, t]
            there = forces[before : before + laws]
            _answer(place, within[first + k, j, :, 0], motion, memory, there)
            for a in range(added.law.size):
                there[added.law[a], added.column[a]] += added.forces[k, 1 + j, a]
            _remember(place, within[first + k, j], motion, memory, new)
        _weighed(own_pushed, forces[laws:], push)
        for i in range(laws):
            for t in range(columns):
                forces[i, t] = forces[(1 + substeps) * laws + i, t]
        for r in range(len(turns) - 1):
            begin = turns[r]
            for i in range(len(state)):
                for t in range(turns[r + 1] - begin):
                    push[i, t] += (
                        inputs[0, i, begin + t] * series[k, begin + t]
                        + inputs[1, i, begin + t] * at_end[k, begin + t]
                    )
        for i in range(len(state)):
            for n in range(len(jumps.columns)):
                push[i, jumps.columns[n]] += jumps.added[k, i, n]
        if turning:
            _turn(transition, push, state)
        else:
            np.dot(transition, state, moved)
            for i in range(len(state)):
                for t in range(columns):
                    state[i, t] = moved[i, t] + push[i, t]
    for i in range(laws):
        for t in range(columns):
            last[i, t] = forces[i, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _turn(turn: np.ndarray, push: np.ndarray, state: np.ndarray) -> None:
    """Take a step of own motions (`OwnMotions.turn`) with a push, states and push of shape (states, columns)."""
    states, columns = state.shape
    pairs = states - turn.shape[1]
    for i in range(pairs):
        real, imaginary, j = turn[0, i], turn[1, i], pairs + i
        for t in range(columns):
            one, other = state[i, t], state[j, t]
            state[i, t] = real * one - imaginary * other + push[i, t]
            state[j, t] = imaginary * one + real * other + push[j, t]
    for i in range(2 * pairs, states):
        for t in range(columns):
            state[i, t] = turn[0, i - pairs] * state[i, t] + push[i, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _weighed(weights: np.ndarray, rows: np.ndarray, found: np.ndarray) -> None:
    """Fill in the product of weights, (n, m), and rows, (m, columns): for few of them no library is called."""
    if weights.size > MANY:
        np.dot(weights, rows, found)
        return
    columns = rows.shape[1]
    for i in range(weights.shape[0]):
        weight = weights[i, 0]
        for t in range(columns):
            found[i, t] = weight * rows[0, t]
        for j in range(1, weights.shape[1]):
            weight = weights[i, j]
            for t in range(columns):
                found[i, t] += weight * rows[j, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _answer(
    place: np.ndarray, slopes: np.ndarray, motion: np.ndarray, memory: np.ndarray, forces: np.ndarray
) -> None:
    """Fill in the forces, (laws, columns), that answer changes of drifts and rates, (answered, columns), and of memories.

    `place` is that of `LawFeedback`; `slopes` are those of the forces, shape (laws, 2 + remembered).
    """
    laws, columns = forces.shape
    for i in range(laws):
        for t in range(columns):
            forces[i, t] = 0.0
        for n in range(2):
            row, slope = place[i, n], slopes[i, n]
            if row >= 0:
                for t in range(columns):
                    forces[i, t] -= slope * motion[row, t]
        for r in range(memory.shape[1]):
            kept = slopes[i, 2 + r]
            for t in range(columns):
                forces[i, t] -= kept * memory[i, r, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _remember(
    place: np.ndarray, slopes: np.ndarray, motion: np.ndarray, memory: np.ndarray, new: np.ndarray
) -> None:
    """Change what laws remember, (laws, remembered, columns), by changes of drifts and rates, (answered, columns).

    `place` is that of `LawFeedback`; `slopes` are those of `Tangents.within` of one substep, shape (laws, 1 + remembered,
    2 + remembered).
    """
    laws, remembered, columns = memory.shape
    if remembered == 0:
        return
    for i in range(laws):
        for r in range(remembered):
            for t in range(columns):
                new[i, r, t] = 0.0
            for n in range(2):
                row, slope = place[i, n], slopes[i, 1 + r, n]
                if row >= 0:
                    for t in range(columns):
                        new[i, r, t] += slope * motion[row, t]
            for q in range(remembered):
                kept = slopes[i, 1 + r, 2 + q]
                if kept != 0.0:
                    for t in range(columns):
                        new[i, r, t] += kept * memory[i, q, t]
    for i in range(laws):
        for r in range(remembered):
            for t in range(columns):
                memory[i, r, t] = new[i, r, t]
