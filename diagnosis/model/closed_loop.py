"""The closed loop of frames and filter: what pushes do to its states, and the motions of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pounding.diagnosis.model.kalman import SteadyFilter

TOLERANCE = 1e-4
"""Error to which sums over own motions may add up: their condition times the rounding of the numbers. What is shown is kept
in single precision anyhow, in which the loop is run where that is enough."""


def transition(steady: SteadyFilter) -> np.ndarray:
    """Return what a step and the filter's correction before it make of the states, shape (states, states).

    Args:
        steady: The filter.
    """
    return np.asarray(steady.step @ (np.eye(len(steady.step)) - steady.gain @ steady.output))


def pushed(
    steady: SteadyFilter, closed: np.ndarray, start: np.ndarray, end: np.ndarray, direct: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return what forces add to the states, (3, states, forces), and their ends to the channels, (channels, forces).

    The first is of a step's start, the second of the end of the step before; the third is what that end has just made of
    the states, which are less that: a force so pushes once a step instead of twice.

    Args:
        steady: The filter.
        closed: Its `transition`, shape (states, states).
        start, end: What a force at the start and at the end of a step makes of the states in it, each (states, forces).
        direct: What it adds to the channels at once, shape (channels, forces).
    """
    back = -steady.step @ steady.gain @ direct
    return np.stack([start, back + closed @ end, -end]), direct + steady.output @ end


@dataclass(frozen=True)
class OwnMotions:
    """Coordinates in which each of a closed loop's own motions goes its own way.

    Attributes:
        turn: Real and imaginary part of each one's factor in a step, those that turn first, shape (2, motions).
        forth: From the states to the real parts of those that turn, their imaginary parts, and the others, shape
            (states, states).
        back: The way back, shape (states, states).
        precision: Type of numbers in which the loop may be run by them: the more they are alike, the more digits it needs.
    """

    turn: np.ndarray
    forth: np.ndarray
    back: np.ndarray
    precision: type[np.floating[Any]]


def own_motions(closed: np.ndarray) -> OwnMotions | None:
    """Return the own motions of a closed loop, (states, states), None where they are too alike to be told apart."""
    factors, vectors = np.linalg.eig(closed)
    size = np.abs(vectors).max(axis=1)
    alike = np.linalg.cond(vectors / size[:, None]) if np.all(size > 0.0) else np.inf
    precision = next((one for one in (np.float32, np.float64) if alike * np.finfo(one).eps < TOLERANCE), None)
    if precision is None:
        return None
    # Of a conjugate pair one is enough: the real part of twice its contribution is that of both.
    turns, stays = factors.imag > 0.0, factors.imag == 0.0
    inverse = np.linalg.inv(vectors)
    return OwnMotions(
        np.hstack([[one.real, one.imag] for one in (factors[turns], factors[stays])]),
        np.concatenate([inverse[turns].real, inverse[turns].imag, inverse[stays].real]),
        np.hstack([2 * vectors[:, turns].real, -2 * vectors[:, turns].imag, vectors[:, stays].real]),
        precision,
    )


class Jumps(NamedTuple):
    """What else is added to the states after each sample, in the few columns where anything is.

    Attributes:
        columns: Numbers of these columns of the states, shape (n,).
        added: What is added, or what becomes of it elsewhere, shape (samples, states, n); without any (0, 0, 0).
    """

    columns: np.ndarray
    added: np.ndarray


class Loop(NamedTuple):
    """The closed loop with terms that push it, in whatever coordinates its states are, as compiled functions take it.

    Attributes:
        transition: Transition, shape (states, states); where the states are `turning`, `OwnMotions.turn`, (2, motions).
        output: What the states show, shape (channels, states).
        inputs: What a unit of each term's series, and of its end, adds to the states in a step, shape (2, states, terms).
        direct: What its end adds to what is shown, shape (channels, terms).
        turns: First term of each turn, and how many terms there are, shape (turns + 1,): those of a turn push the first
            columns of the states, one each.
        group: Number of the group of each column, shape (columns,): what its terms push, and show, is added up.
        turning: Whether the states are those of `OwnMotions`.
    """

    transition: np.ndarray
    output: np.ndarray
    inputs: np.ndarray
    direct: np.ndarray
    turns: np.ndarray
    group: np.ndarray
    turning: bool

    def rounded(self, precision: type[np.floating[Any]]) -> Loop:
        """Return the loop with numbers of a precision."""
        transition, output, inputs, direct = (one.astype(precision, order="C") for one in self[:4])
        return Loop(transition, output, inputs, direct, self.turns, self.group, self.turning)
