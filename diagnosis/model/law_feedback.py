"""The feedback of laws: what a small force does to a frame changes the forces of the laws in it, and so what it does."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from pounding.diagnosis.model.closed_loop import Loop, OwnMotions
from pounding.diagnosis.model.kalman import SteadyFilter
from pounding.diagnosis.model.predictor import CONTRACT
from pounding.diagnosis.model.tangents import Tangents

MANY = 64
"""Weights from which on a product by the library is faster."""


class Added(NamedTuple):
    """What terms add to the forces of laws by themselves, at the samples at hand.

    Attributes:
        law, term: Number of the law and of the term, shape (additions,).
        forces: The forces [N] at each sample and in the middle of each substep, shape (samples, 1 + substeps, additions).
    """

    law: np.ndarray
    term: np.ndarray
    forces: np.ndarray

    def rounded(self, precision: type[np.floating[Any]]) -> Added:
        """Return the same with numbers of a precision."""
        return Added(self.law, self.term, self.forces.astype(precision, order="C"))


class _Step(NamedTuple):
    """What a step makes of the drifts and rates that laws answer, in the middle of each substep.

    Attributes:
        middles: Of a unit of each state after the filter's correction, shape (answered substeps, states).
        held: Of a unit of each modal force, and of the table's acceleration, that is held from then on, shape (answered
            substeps, modes + 1).
        onwards: Of the force of each law in the last substep of the step before, and in each substep, shape (substeps,
            answered, (1 + substeps) laws).
        pushed: What the same forces add to the states at the end of the step, shape (states, (1 + substeps) laws).
    """

    middles: np.ndarray
    held: np.ndarray
    onwards: np.ndarray
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
        none, onwards = np.zeros_like(until_half), []
        for j in range(substeps):
            earlier = [none, *(half @ one for one in pushes[:j][::-1]), *[none] * (substeps - j)]
            # Until the middle of a substep the predictor takes the force that the law had in the substep before.
            earlier[j] = earlier[j] + until_half
            onwards.append(np.hstack([seen @ one for one in earlier]))
        # The last force of the step before has pushed already.
        return cls(
            np.vstack(middles),
            np.vstack(held),
            np.array(onwards),
            np.hstack([none, *pushes[:substeps][::-1]]),
        )


class LawFeedback(NamedTuple):
    """The feedback of laws about a motion to each term: tangent stiffness, damping and memory in the closed loop.

    As the predictor does, it asks each law at the samples, which accelerations show at once, and in the middle of each
    substep, over which its force is held there. Of drifts and rates only those count that some law answers: a damper
    answers no drift.

    Attributes:
        loop: The loop without it. Below the channels, its `output` and `direct` have the drifts and rates that laws answer
            at a sample as predicted, and then in the middle of each substep.
        place: Number of each law's drift and rate among those that are answered, -1 where it answers none, shape (laws, 2).
        at_sample, within: Slopes, of `Tangents`.
        held: What each term's series adds to the latter until the middle of each substep, shape (answered substeps, terms).
        onwards: What forces before it add to drifts and rates in the middle of each substep, shape (substeps, answered, (2
            + substeps) laws): those of each law at the sample, by what the filter makes of them, in the last substep of
            the step before, and in each substep.
        pushed: What the same forces add to the states in a step, shape (states, (2 + substeps) laws).
        direct: What the force of each law at a sample adds to what is shown, shape (channels, laws).
        seen: Drifts and rates in the middle of each substep for each of the filter's states, (answered substeps, states).
        memory: Change of what each law remembers, for each term, shape (laws, remembered, terms).
        last: Change of the force of each law in the last substep before, for each term, shape (laws, terms).
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
        inputs = np.hstack([-steady.step @ steady.gain @ at_once, step.pushed])
        terms, remembered = lacking.shape[1], laws.within.shape[3] - 1
        return cls(
            loop=below,
            place=np.ascontiguousarray(place),
            at_sample=laws.at_sample,
            within=laws.within,
            held=step.held @ force,
            onwards=np.concatenate([by_sample, step.onwards], axis=2),
            pushed=inputs if own is None else own.forth @ inputs,
            direct=shown @ at_once,
            seen=step.middles,
            memory=np.zeros((count, remembered, terms)),
            last=np.zeros((count, terms)),
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
    jumps: np.ndarray,
    jumped: np.ndarray,
    state: np.ndarray,
    result: np.ndarray,
) -> None:
    """Run the closed loop once for each term, with the laws' feedback, and add up what those of a group show.

    Args:
        feedback: The loop with it.
        added: What terms add to the forces of laws by themselves.
        first: Number of the first sample.
        series, at_end: Size of each term at the samples, shape (samples, terms).
        jumps: What else each adds to the states after each sample, shape (samples, states, terms), or none.
        jumped: What that adds to drifts and rates in the middle of each substep, shape (samples, answered substeps, terms).
        state: States before the first sample, which become those after the last one, shape (states, terms).
        result: Filled with what is shown, shape (samples, channels, groups).
    """
    transition, output, inputs, direct, column, turning = feedback.loop
    _, place, at_sample, within, held, onwards, own_pushed, own_direct, _, memory, last = feedback
    samples, terms = series.shape
    channels, laws = own_direct.shape
    substeps, answered, groups = within.shape[1], onwards.shape[1], result.shape[2]
    middles = channels + answered
    jumping = jumps.size > 0
    shown = np.zeros((middles + answered * substeps, terms), state.dtype)
    motion = np.zeros((answered, terms), state.dtype)
    # Those at the sample, of the last substep before, and of each substep.
    forces = np.zeros(((2 + substeps) * laws, terms), state.dtype)
    here = forces[:laws]
    for i in range(laws):
        for t in range(terms):
            forces[laws + i, t] = last[i, t]
    push = np.zeros_like(state)
    moved = np.zeros_like(state)
    new = np.zeros_like(memory)
    for k in range(samples):
        np.dot(output, state, shown)
        for c in range(len(shown)):
            for t in range(terms):
                shown[c, t] += direct[c, t] * at_end[k, t]
        for i in range(answered):
            for t in range(terms):
                motion[i, t] = shown[channels + i, t]
        _answer(place, at_sample[first + k], motion, memory, here)
        for a in range(added.law.size):
            here[added.law[a], added.term[a]] += added.forces[k, 0, a]
        for c in range(channels):
            for j in range(laws):
                for t in range(terms):
                    shown[c, t] += own_direct[c, j] * here[j, t]
        for j in range(substeps):
            _weighed(onwards[j], forces, motion)
            for i in range(answered):
                row = answered * j + i
                for t in range(terms):
                    motion[i, t] += shown[middles + row, t] + held[row, t] * series[k, t]
                if jumping:
                    for t in range(terms):
                        motion[i, t] += jumped[k, row, t]
            there = forces[(2 + j) * laws : (3 + j) * laws]
            _answer(place, within[first + k, j, :, 0], motion, memory, there)
            for a in range(added.law.size):
                there[added.law[a], added.term[a]] += added.forces[k, 1 + j, a]
            _remember(place, within[first + k, j], motion, memory, new)
        for c in range(channels):
            for t in range(groups, terms):
                shown[c, column[t]] += shown[c, t]
            for g in range(groups):
                result[k, c, g] = shown[c, g]
        _weighed(own_pushed, forces, push)
        for i in range(laws):
            for t in range(terms):
                forces[laws + i, t] = forces[(1 + substeps) * laws + i, t]
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
    for i in range(laws):
        for t in range(terms):
            last[i, t] = forces[laws + i, t]


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
    if weights.size > MANY:
        np.dot(weights, rows, found)
        return
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
def _answer(
    place: np.ndarray, slopes: np.ndarray, motion: np.ndarray, memory: np.ndarray, forces: np.ndarray
) -> None:
    """Fill in the forces, (laws, terms), that answer changes of drifts and rates, (answered, terms), and of memories.

    `place` is that of `LawFeedback`; `slopes` are those of the forces, shape (laws, 2 + remembered).
    """
    laws, terms = forces.shape
    for i in range(laws):
        for t in range(terms):
            forces[i, t] = 0.0
        for n in range(2):
            row, slope = place[i, n], slopes[i, n]
            if row >= 0:
                for t in range(terms):
                    forces[i, t] -= slope * motion[row, t]
        for r in range(memory.shape[1]):
            kept = slopes[i, 2 + r]
            for t in range(terms):
                forces[i, t] -= kept * memory[i, r, t]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _remember(
    place: np.ndarray, slopes: np.ndarray, motion: np.ndarray, memory: np.ndarray, new: np.ndarray
) -> None:
    """Change what laws remember, (laws, remembered, terms), by changes of drifts and rates, (answered, terms).

    `place` is that of `LawFeedback`; `slopes` are those of `Tangents.within` of one substep, shape (laws, 1 + remembered,
    2 + remembered).
    """
    laws, remembered, terms = memory.shape
    if remembered == 0:
        return
    for i in range(laws):
        for r in range(remembered):
            for t in range(terms):
                new[i, r, t] = 0.0
            for n in range(2):
                row, slope = place[i, n], slopes[i, 1 + r, n]
                if row >= 0:
                    for t in range(terms):
                        new[i, r, t] += slope * motion[row, t]
            for q in range(remembered):
                kept = slopes[i, 1 + r, 2 + q]
                if kept != 0.0:
                    for t in range(terms):
                        new[i, r, t] += kept * memory[i, q, t]
    for i in range(laws):
        for r in range(remembered):
            for t in range(terms):
                memory[i, r, t] = new[i, r, t]
