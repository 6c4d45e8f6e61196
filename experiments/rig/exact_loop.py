"""The compiled loop of the exact solver: modes without integration error, contacts found, stepped and left.

Everything is in flat arrays (`exact_arrays`), so that a run needs no Python and no copy; `exact` fills and reads them.

While all contacts are open every pole follows ``z' = rate z + load a(t)`` by its closed formula, whatever the step. How
long no contact can touch follows from a bound on the speed with which the gap closes: the sum of the modes' largest speeds
and of what the table can add. Only when that time is shorter than the finest step are the gap's ends looked at, and a
touch between them is located by Newton's method on the closed formula itself.

While a contact is closed its force is a parabola over the step, through the force of the law at both ends and in the
middle; again every pole follows by a closed formula, and the three forces by fixed-point iteration (order four). The
difference between parabola and straight line measures the step's error.

A law in a storey is stepped in the same way from the start to the end of the run. Its memory goes through the middle of a
step to its end, and through the drift's turns on the way. Steps grow up to the longest as the error control allows; one
that is longer than the finest in flight must end before any contact can touch, whatever the laws push.

The loop is one file because numba's cache looks whether the file of a compiled function has changed, not the files of what
that function calls.
"""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
from numba import njit

from pounding.calling import called_at
from pounding.contact.evaluation import force_of
from pounding.experiments.rig.exact_arrays import Room

DONE, FULL, STUCK = 0, 1, 2
"""How a call of `advance` ends: at the end of the run, with its rows used up, or without getting on."""

ITERATIONS = 30
"""Fixed-point iterations after which a step is halved; a step as short as the error control takes needs three or four."""

CONVERGED = 1e-10
"""Change of a force in an iteration, as a share of the largest of the step, at which it ends."""

LOCATED_S = 1e-15
"""Newton's step [s] at which a touch or a parting is located."""

FASTER = 32.0
"""A step may be twice as long when the error, of third order in it, is below its limit by so much: eight, with room."""

LOCATED_M = 1e-17
"""Deformation [m] at which it is located, too: round-off."""

FIRST_STEP = 4
"""A step after an event is a sixteenth of the finest in flight; the error control does the rest."""

ON_GRID = 1e-6
"""Share of a step by which its start may lie off the grid of such steps: round-off."""

TURN, TRIAL = 3, 4
"""Places in the laws' memory for what is remembered at a turn on the way, and for what is tried and not kept."""

STRIDES = 4
"""Strides in half a step by which the error of what a law remembers is measured."""

_BYTES = 8


_FAST: Any = {"reassoc", "contract", "nsz", "arcp"}


@njit(cache=True, nogil=True, error_model="numpy")
def integrals(x: complex, out: Any, pole: int) -> None:
    """Write growth over a step and the integrals of 1, s and s^2 / 2 against it, as ``phi_1`` to ``phi_3``.

    Args:
        x: Pole times step [-].
        out: Where to write (8, p): real and imaginary part of each.
        pole: Column.
    """
    if abs(x) < 0.5:
        # The recurrences below would lose digits; the series has them all after 13 terms.
        third = 0.0j
        for k in range(13, 0, -1):
            third = (third + 1.0) * x / (k + 3)
        third = (third + 1.0) / 6.0
        second = x * third + 0.5
        first = x * second + 1.0
        growth = x * first + 1.0
    else:
        growth = cmath.exp(x)
        first = (growth - 1.0) / x
        second = (first - 1.0) / x
        third = (second - 0.5) / x
    out[0, pole], out[1, pole] = growth.real, growth.imag
    out[2, pole], out[3, pole] = first.real, first.imag
    out[4, pole], out[5, pole] = second.real, second.imag
    out[6, pole], out[7, pole] = third.real, third.imag


@njit(cache=True, nogil=True, error_model="numpy")
def fill(rates: Any, step_s: float, out: Any) -> None:
    """Write the integrals of all poles for one step.

    Args:
        rates: Poles (p,) [1/s].
        step_s: The step [s].
        out: Where to write (8, p).
    """
    for pole in range(len(rates)):
        integrals(rates[pole] * step_s, out, pole)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _fly(z: Any, to: Any, table: Any, pushed: Any, start: float, rise: float) -> None:
    """Carry the poles over a step without contact under an acceleration that rises from `start` by `rise`."""
    for p in range(z.shape[1]):
        re, im = z[0, p], z[1, p]
        to[0, p] = table[0, p] * re - table[1, p] * im + pushed[0, p] * start + pushed[2, p] * rise
        to[1, p] = table[0, p] * im + table[1, p] * re + pushed[1, p] * start + pushed[3, p] * rise


@njit(cache=True, nogil=True, error_model="numpy")
def push(table: Any, load: Any, step_s: float, out: Any) -> None:
    """Write what a unit acceleration, and a unit rise of it over the step, add to the poles.

    Args:
        table: Integrals of the step (8, p).
        load: Load of a unit acceleration on each pole (2, p).
        step_s: The step [s].
        out: Where to write (4, p).
    """
    for p in range(load.shape[1]):
        for k in range(2):
            re, im = table[2 + 2 * k, p], table[3 + 2 * k, p]
            out[2 * k, p] = step_s * (re * load[0, p] - im * load[1, p])
            out[2 * k + 1, p] = step_s * (re * load[1, p] + im * load[0, p])


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _product(row: Any, z: Any, first: int, last: int) -> float:
    """Return ``Re(row z)`` over the poles from first to last; row and z (2, p)."""
    total = 0.0
    for p in range(first, last):
        total += row[0, p] * z[0, p] - row[1, p] * z[1, p]
    return total


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _fastest(weight: Any, z: Any, first: int, last: int) -> float:
    """Return a bound of ``sum(weight |z|)``: the larger part and half the smaller are never less than |z|."""
    total = 0.0
    for p in range(first, last):
        re, im = abs(z[0, p]), abs(z[1, p])
        total += weight[p] * (max(re, im) + 0.5 * min(re, im))
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def _cubic(s: float, d0: float, v0: float, d1: float, v1: float) -> float:
    """Return Hermite's cubic at s from 0 to 1; slopes over the whole step."""
    return d0 + s * (v0 + s * (3.0 * (d1 - d0) - 2.0 * v0 - v1 + s * (2.0 * (d0 - d1) + v0 + v1)))


@njit(cache=True, nogil=True, error_model="numpy")
def crossing(d0: float, v0: float, d1: float, v1: float) -> float:
    """Return where in a step a cubic first rises above zero, from 0 to 1; 2.0 if nowhere.

    Args:
        d0, d1: Values at the step's ends; d0 at most 0.
        v0, v1: Slopes there, over the whole step.
    """
    if d0 >= 0.0:
        d0 = 0.0
        if v0 > 0.0 or (v0 == 0.0 and d1 > 0.0):
            return 0.0
    # Where the slope is zero the cubic has its highest and lowest points; between them it only rises or falls.
    a, b, c = 3.0 * (2.0 * (d0 - d1) + v0 + v1), 2.0 * (3.0 * (d1 - d0) - 2.0 * v0 - v1), v0
    inner = b * b - 4.0 * a * c
    first, second = 1.0, 1.0
    if inner >= 0.0:
        half = -0.5 * (b + math.copysign(math.sqrt(inner), b))
        one = half / a if a != 0.0 else 2.0
        two = c / half if half != 0.0 else 2.0
        first, second = min(one, two), max(one, two)
    low = 0.0
    for place in (first, second, 1.0):
        if not low < place <= 1.0:
            continue
        if _cubic(place, d0, v0, d1, v1) > 0.0:
            high = place
            for _ in range(60):
                middle = 0.5 * (low + high)
                if _cubic(middle, d0, v0, d1, v1) > 0.0:
                    high = middle
                else:
                    low = middle
            return high
        low = place
    return 2.0


@njit(cache=True, nogil=True, error_model="numpy")
def _deformation(contacts: Any, c: int, z: Any) -> float:
    return float(_product(contacts.row[c], z, contacts.span[c, 0], contacts.span[c, 1]) - contacts.gap[c])


@njit(cache=True, nogil=True, error_model="numpy")
def _rate(contacts: Any, c: int, z: Any) -> float:
    return float(_product(contacts.rate[c], z, contacts.span[c, 0], contacts.span[c, 1]))


@njit(cache=True, nogil=True, error_model="numpy")
def _force(contacts: Any, c: int, deformation: float, rate: float, approach: float) -> float:
    code, first = contacts.code, contacts.first
    return float(
        force_of(
            code,
            first[c],
            first[c + 1],
            contacts.registers[c],
            contacts.result[c],
            deformation,
            rate,
            approach,
        )
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _respond(contacts: Any, c: int, other: int, table: Any, half: Any, step_s: float, out: Any) -> None:
    """Write what a contact sees in a step of unit forces of another at start, middle and end into (4, 3)."""
    out[:, :] = 0.0
    row, rate, gain = contacts.row[c], contacts.rate[c], contacts.gain[other]
    first = max(contacts.span[c, 0], contacts.span[other, 0])
    last = min(contacts.span[c, 1], contacts.span[other, 1])
    for place in range(2):
        at, length = (half, 0.5 * step_s) if place == 0 else (table, step_s)
        # The parabola's first and second derivative over its first half are a half and a quarter of the whole's.
        share = 0.5 if place == 0 else 1.0
        for p in range(first, last):
            push_p = length * complex(gain[0, p], gain[1, p])
            one = push_p * complex(at[2, p], at[3, p])
            two = push_p * complex(at[4, p], at[5, p]) * share
            three = push_p * complex(at[6, p], at[7, p]) * (2.0 * share * share)
            see, see_rate = complex(row[0, p], row[1, p]), complex(rate[0, p], rate[1, p])
            for k in range(3):
                if k == 0:
                    moved = one - 3.0 * two + 2.0 * three
                elif k == 1:
                    moved = 4.0 * (two - three)
                else:
                    moved = 2.0 * three - two
                out[2 * place, k] += (see * moved).real
                out[2 * place + 1, k] += (see_rate * moved).real


@njit(cache=True, nogil=True, error_model="numpy", fastmath=_FAST)
def _add_force(end: Any, table: Any, gain: Any, first: int, last: int, step_s: float, force: Any) -> None:
    """Add what a contact's force did to the poles over a step."""
    slope = step_s * (-3.0 * force[0] + 4.0 * force[1] - force[2])
    bend = step_s * 4.0 * (force[0] - 2.0 * force[1] + force[2])
    whole = step_s * force[0]
    for p in range(first, last):
        re = whole * table[2, p] + slope * table[4, p] + bend * table[6, p]
        im = whole * table[3, p] + slope * table[5, p] + bend * table[7, p]
        end[0, p] += re * gain[0, p] - im * gain[1, p]
        end[1, p] += re * gain[1, p] + im * gain[0, p]


@njit(cache=True, nogil=True, error_model="numpy")
def _slope(s: float, d0: float, v0: float, d1: float, v1: float) -> float:
    """Return the slope of Hermite's cubic at s from 0 to 1, over the whole step as those at its ends."""
    return v0 + s * (6.0 * (d1 - d0) - 4.0 * v0 - 2.0 * v1 + 3.0 * s * (2.0 * (d0 - d1) + v0 + v1))


@njit(cache=True, nogil=True, error_model="numpy")
def turn(d0: float, v0: float, d1: float, v1: float) -> Any:
    """Return where a cubic turns between slopes of opposite sign, from 0 to 1, and its value there.

    Args:
        d0, d1: Values at the step's ends.
        v0, v1: Slopes there, over the whole step.
    """
    a, b = 3.0 * (2.0 * (d0 - d1) + v0 + v1), 2.0 * (3.0 * (d1 - d0) - 2.0 * v0 - v1)
    half = -0.5 * (b + math.copysign(math.sqrt(max(b * b - 4.0 * a * v0, 0.0)), b))
    place = half / a if a != 0.0 else 2.0
    if not 0.0 <= place <= 1.0:
        place = v0 / half if half != 0.0 else 0.5
    return place, _cubic(place, d0, v0, d1, v1)


@njit(cache=True, nogil=True, error_model="numpy")
def _called(storeys: Any, law: int, at_s: float, before: int, d: float, v: float, after: int) -> float:
    """Return the force of a law in a storey at a time from the step's start; memories by their places in `memory`."""
    size = _BYTES * storeys.memory.shape[2]
    memories, each = storeys.memory.ctypes.data + law * size, size * storeys.memory.shape[1]
    numbers = storeys.parameters.ctypes.data + law * _BYTES * storeys.parameters.shape[1]
    moment = storeys.moment
    share = storeys.in_room[law]
    if share != 0.0:
        v += share * (moment[1] + at_s * (moment[2] + at_s * moment[3]))
    return float(
        called_at(
            storeys.address[law],
            numbers,
            memories + before * each,
            d,
            v,
            moment[0] + at_s,
            memories + after * each,
        )
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _storey_force(storeys: Any, law: int, half: int, half_s: float) -> float:
    """Return the force of a law in a storey at the end of a half of a step, and remember what it then remembers.

    Args:
        storeys: The laws.
        law: Which of them; beyond the last it is a known force, which pushes where a law opposes.
        half: Which half of the step: 0 or 1.
        half_s: Its length [s].
    """
    if law >= len(storeys.address):
        at, slope = storeys.known[law - len(storeys.address)]
        return float(-at - (half + 1) * half_s * slope)
    seen, before = storeys.seen[law], half
    d0, v0, d, v = seen[2 * half], seen[2 * half + 1], seen[2 * half + 2], seen[2 * half + 3]
    if storeys.remembers[law] and v0 * v < 0.0:
        # A memory depends on how far the drift went, which neither end shows.
        where, turned = turn(d0, half_s * v0, d, half_s * v)
        _called(storeys, law, (half + where) * half_s, before, turned, 0.0, TURN)
        before = TURN
    return float(_called(storeys, law, (half + 1) * half_s, before, d, v, half + 1))


@njit(cache=True, nogil=True, error_model="numpy")
def _memory_error(contacts: Any, state: Any, storeys: Any, half_s: float) -> float:
    """Return the velocity [m/s] by which what is remembered may be wrong: halves of a step in one stride against several."""
    error = 0.0
    for law in range(len(storeys.address)):
        if not storeys.remembers[law]:
            continue
        c, before, after, seen = storeys.first + law, 0, TRIAL, storeys.seen[law]
        for half in range(2):
            d0, v0, d, v = (
                seen[2 * half],
                half_s * seen[2 * half + 1],
                seen[2 * half + 2],
                half_s * seen[2 * half + 3],
            )
            apart, force = 1.0, 0.0
            if v0 * v < 0.0:
                apart, _ = turn(d0, v0, d, v)
            for k in range(2 * STRIDES if apart < 1.0 else STRIDES):
                share = (k % STRIDES + 1) / STRIDES
                place = apart * share if k < STRIDES else apart + (1.0 - apart) * share
                rate = _slope(place, d0, v0, d, v) / half_s
                force = _called(
                    storeys, law, (half + place) * half_s, before, _cubic(place, d0, v0, d, v), rate, after
                )
                before, after = after, (TURN if after == TRIAL else TRIAL)
            wrong = abs(force - state.force[c, half + 1])
            error = max(error, contacts.mobility[c] * storeys.lasting_s * wrong)
    return error


@njit(cache=True, nogil=True, error_model="numpy")
def _iterated(contacts: Any, state: Any, room: Any, response: Any, storeys: Any, step_s: float) -> bool:
    """Find the closed contacts' forces in the middle and at the end of a step; return whether that converged."""
    count, force, free = len(contacts.gap), state.force, room.free
    for c in range(count):
        if state.closed[c]:
            force[c, 1] = force[c, 2] = force[c, 0]
    for _ in range(ITERATIONS):
        change, scale = 0.0, 0.0
        for c in range(count):
            if state.closed[c]:
                for place in range(2):
                    d, v = free[c, 2 * place], free[c, 2 * place + 1]
                    for other in range(count):
                        if state.closed[other]:
                            for k in range(3):
                                d += response[c, other, 2 * place, k] * force[other, k]
                                v += response[c, other, 2 * place + 1, k] * force[other, k]
                    new = 0.0
                    if storeys is None:
                        new = _force(contacts, c, d, v, state.approach[c])
                    else:
                        if c < storeys.first:
                            new = _force(contacts, c, d, v, state.approach[c])
                        else:
                            seen = storeys.seen[c - storeys.first]
                            seen[2 * place + 2], seen[2 * place + 3] = d, v
                            new = _storey_force(storeys, c - storeys.first, place, 0.5 * step_s)
                    change = max(change, abs(new - force[c, place + 1]))
                    scale = max(scale, abs(new))
                    force[c, place + 1] = new
        if not change < math.inf:
            return False
        if change <= CONVERGED * scale:
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def _pressed(
    contacts: Any, storeys: Any, state: Any, room: Any, response: Any, z: Any, end: Any, table: Any, pushed: Any,
    half: Any, half_push: Any, step_s: float, start: float, rise: float,
) -> float:  # fmt: skip
    """Carry the poles over a step with closed contacts from `z` to `end`; return its error [m/s], or -1 if it diverges.

    The error is the velocity by which a straight line of the force would have differed from the parabola.
    """
    _fly(z, end, table, pushed, start, rise)
    _fly(z, room.middle, half, half_push, start, 0.5 * rise)
    for c in range(len(contacts.gap)):
        if state.closed[c]:
            room.free[c, 0], room.free[c, 1] = (
                _deformation(contacts, c, room.middle),
                _rate(contacts, c, room.middle),
            )
            room.free[c, 2], room.free[c, 3] = _deformation(contacts, c, end), _rate(contacts, c, end)
    if storeys is not None:
        for law in range(len(storeys.address)):
            c, seen = storeys.first + law, storeys.seen[law]
            if storeys.remembers[law]:
                seen[0], seen[1] = _deformation(contacts, c, z), _rate(contacts, c, z)
    if not _iterated(contacts, state, room, response, storeys, step_s):
        return -1.0
    error = 0.0
    if storeys is not None:
        error = _memory_error(contacts, state, storeys, 0.5 * step_s)
    for c in range(len(contacts.gap)):
        if state.closed[c]:
            force = state.force[c]
            _add_force(end, table, contacts.gain[c], contacts.span[c, 0], contacts.span[c, 1], step_s, force)
            error = max(
                error, contacts.mobility[c] * step_s * abs(force[0] - 2.0 * force[1] + force[2]) / 6.0
            )
    return error


@njit(cache=True, nogil=True, error_model="numpy")
def _respond_all(contacts: Any, state: Any, response: Any, table: Any, half: Any, step_s: float) -> None:
    for c in range(len(contacts.gap)):
        if state.closed[c]:
            for other in range(len(contacts.gap)):
                if state.closed[other]:
                    _respond(contacts, c, other, table, half, step_s, response[c, other])


@njit(cache=True, nogil=True, error_model="numpy")
def _free_step(modes: Any, room: Any, z: Any, end: Any, step_s: float, start: float, rise: float) -> None:
    """Carry the poles over a step in flight of any length."""
    fill(modes.rates, step_s, room.own)
    push(room.own, modes.load, step_s, room.own_push)
    _fly(z, end, room.own, room.own_push, start, rise)


@njit(cache=True, nogil=True, error_model="numpy")
def _any_step(
    modes: Any, contacts: Any, storeys: Any, state: Any, room: Any, z: Any, end: Any, step_s: float, start: float,
    rise: float,
) -> float:  # fmt: skip
    """Carry the poles over a step of any length with what pushes on its way; return what `_pressed` does."""
    fill(modes.rates, step_s, room.own)
    push(room.own, modes.load, step_s, room.own_push)
    fill(modes.rates, 0.5 * step_s, room.half)
    push(room.half, modes.load, 0.5 * step_s, room.half_push)
    _respond_all(contacts, state, room.response[-1], room.own, room.half, step_s)
    return float(
        _pressed(
            contacts,
            storeys,
            state,
            room,
            room.response[-1],
            z,
            end,
            room.own,
            room.own_push,
            room.half,
            room.half_push,
            step_s,
            start,
            rise,
        )
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _level_step(
    modes: Any, contacts: Any, storeys: Any, state: Any, room: Any, z: Any, end: Any, level: int, step_s: float,
    start: float, rise: float,
) -> float:  # fmt: skip
    """Carry the poles over a step in contact that is the longest over 2^level; return what `_pressed` does."""
    response = room.response[level]
    if not room.known[level]:
        _respond_all(contacts, state, response, modes.tables[level], modes.tables[level + 1], step_s)
        room.known[level] = True
    return float(
        _pressed(
            contacts, storeys, state, room, response, z, end, modes.tables[level], modes.pushed[level],
            modes.tables[level + 1], modes.pushed[level + 1], step_s, start, rise,
        )
    )  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy")
def _wait(contacts: Any, state: Any, z: Any, now: float, tick_s: float, strongest: float) -> float:
    """Return for how long no contact can touch [s]; where that was nearly over it is found anew."""
    wait = math.inf
    for c in range(len(contacts.gap)):
        if state.horizon[c] - now < tick_s:
            apart = max(-_deformation(contacts, c, z), 0.0)
            speed = _fastest(contacts.weight[c], z, contacts.span[c, 0], contacts.span[c, 1])
            # The gap closes by at most speed t + pushing strongest t^2 / 2.
            under = speed + math.sqrt(speed * speed + 2.0 * contacts.pushing[c] * strongest * apart)
            if apart == 0.0:
                state.horizon[c] = now
            else:
                state.horizon[c] = now + (2.0 * apart / under if under > 0.0 else math.inf)
        wait = min(wait, state.horizon[c] - now)
    return wait


@njit(cache=True, nogil=True, error_model="numpy")
def _longest_level(tick: int, fine: int, tick_s: float, wait: float) -> int:
    """Return the level of the longest step that begins on its own grid and ends before anything can touch."""
    level = fine
    while level > 0:
        longer = 1 << (fine - level + 1)
        if tick % longer != 0 or longer * tick_s > wait:
            break
        level -= 1
    return level


@njit(cache=True, nogil=True, error_model="numpy")
def _first_event(
    contacts: Any, count: int, state: Any, z: Any, end: Any, touching: bool, until: float, step_s: float
) -> Any:
    """Return which of so many contacts first touches or parts in a step, and where from 0 to 1; (-1, 2) if none."""
    event, at = -1, 2.0
    for c in range(count):
        if not touching and state.horizon[c] >= until:
            continue
        sign = -1.0 if state.closed[c] else 1.0
        where = crossing(
            sign * _deformation(contacts, c, z),
            sign * _rate(contacts, c, z) * step_s,
            sign * _deformation(contacts, c, end),
            sign * _rate(contacts, c, end) * step_s,
        )
        if where < at:
            event, at = c, where
    return event, at


@njit(cache=True, nogil=True, error_model="numpy")
def _locate(
    modes: Any, contacts: Any, storeys: Any, state: Any, room: Any, z: Any, end: Any, touching: bool, event: int,
    guess_s: float, whole_s: float, start: float, per_s: float,
) -> Any:  # fmt: skip
    """Return when in a step a contact touches or parts [s], the state then in `end`, and whether it does.

    Newton's method on the step's length, each trial a step by the closed formulas, kept inside what brackets the event.
    """
    sign = -1.0 if state.closed[event] else 1.0
    low, high, length = 0.0, whole_s, guess_s
    for _ in range(60):
        if touching:
            _any_step(modes, contacts, storeys, state, room, z, end, length, start, per_s * length)
        else:
            _free_step(modes, room, z, end, length, start, per_s * length)
        d, v = sign * _deformation(contacts, event, end), sign * _rate(contacts, event, end)
        if d > 0.0:
            high = length
        else:
            low = length
        new = length - d / v if v > 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - length) <= LOCATED_S or abs(d) <= LOCATED_M:
            return length, True
        length = new
    # The cubic saw an event that is none.
    return length, False


@njit(cache=True, nogil=True, error_model="numpy")
def _flip(contacts: Any, state: Any, room: Any, z: Any, shaking: Any, deepest: int, event: int) -> None:
    """Close a contact that is open, open one that is closed."""
    state.closed[event] = not state.closed[event]
    state.force[event, :] = 0.0
    if state.closed[event]:
        speed = max(_rate(contacts, event, z), 0.0)
        state.approach[event] = state.fastest[event] = speed
        state.force[event, 0] = _force(contacts, event, 0.0, speed, speed)
    level = shaking.forced_level if shaking.forced_level >= 0 else min(shaking.fine + FIRST_STEP, deepest)
    state.clock[1], state.clock[2] = -1, level
    state.horizon[:] = -1.0
    room.known[:] = False


@njit(cache=True, nogil=True, error_model="numpy")
def _limit(contacts: Any, state: Any, z: Any, tolerance: float) -> float:
    """Return the velocity [m/s] by which a step in contact may be wrong."""
    fastest = 0.0
    for c in range(len(contacts.gap)):
        if state.closed[c]:
            state.fastest[c] = max(state.fastest[c], abs(_rate(contacts, c, z)))
            fastest = max(fastest, state.fastest[c])
    return tolerance * fastest


@njit(cache=True, nogil=True, error_model="numpy")
def _controlled(
    modes: Any, contacts: Any, state: Any, room: Any, shaking: Any, z: Any, end: Any, left_s: float, start: float,
    per_s: float,
) -> float:  # fmt: skip
    """Carry the poles over a step in contact whose error is within its limit; return its length, -1 if there is none.

    The step is the longest over a power of two, or what is left to the next sample if that is less.
    """
    longest, level = shaking.dt_s / shaking.parts, state.clock[2]
    deepest = len(modes.tables) - 2
    limit = _limit(contacts, state, z, shaking.tolerance)
    while True:
        step_s = longest / (1 << level)
        if step_s < left_s * (1.0 - 1e-9):
            error = _level_step(
                modes, contacts, None, state, room, z, end, level, step_s, start, per_s * step_s
            )  # fmt: skip
        else:
            step_s = left_s
            error = _any_step(modes, contacts, None, state, room, z, end, step_s, start, per_s * step_s)
        if error >= 0.0 and (error <= limit or shaking.forced_level >= 0 or level == deepest):
            break
        if level == deepest:
            return -1.0
        level += 1
        while level < deepest and longest / (1 << level) >= step_s:
            level += 1
    if shaking.forced_level < 0 and error * FASTER < limit and level > shaking.fine:
        level -= 1
    state.clock[2] = level
    return float(step_s)


@njit(cache=True, nogil=True, error_model="numpy")
def _may_touch(contacts: Any, storeys: Any, state: Any, z: Any, step_s: float, strongest: float) -> bool:
    """Return whether an open contact may touch within a step, whose forces of laws in storeys are in `state`."""
    for c in range(storeys.first):
        if state.closed[c]:
            continue
        pushing = contacts.pushing[c] * strongest
        for place in range(storeys.jolt.shape[1]):
            first, middle, last = state.force[storeys.first + place]
            # A parabola is at most a quarter higher than the largest of its ends and its middle.
            pushing += 1.25 * storeys.jolt[c, place] * max(abs(first), abs(middle), abs(last))
        speed = _fastest(contacts.weight[c], z, contacts.span[c, 0], contacts.span[c, 1])
        if step_s * (speed + 0.5 * step_s * pushing) >= -_deformation(contacts, c, z):
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def _followed(
    modes: Any, contacts: Any, storeys: Any, state: Any, room: Any, shaking: Any, z: Any, end: Any, left_s: float,
    start: float, per_s: float,
) -> Any:  # fmt: skip
    """Carry the poles over a step with laws in storeys whose error is within its limit.

    The step ends on the grid of its level. One longer than the finest in flight ends before a contact can touch.

    Returns:
        Its length [s], -1 if there is none, and whether a contact may touch or part in it.
    """
    longest, level, since = shaking.dt_s / shaking.parts, state.clock[2], state.since[0]
    deepest, fine, forced = len(modes.tables) - 2, shaking.fine, shaking.forced_level >= 0
    least = fine if _any_closed(state.closed[: storeys.first]) else 0
    # At the start nothing moves: the velocity that the table gains in the longest step is as small as counts.
    limit = max(
        _limit(contacts, state, z, shaking.tolerance), shaking.tolerance * shaking.strongest * longest
    )
    if not forced:
        level = max(level, least)
        while level < fine and _may_touch(
            contacts, storeys, state, z, longest / (1 << level), shaking.strongest
        ):
            level += 1
    while True:
        grid_s = longest / (1 << level)
        step_s = min((math.floor(since / grid_s + ON_GRID) + 1.0) * grid_s - since, left_s)
        if abs(step_s - grid_s) <= ON_GRID * grid_s:
            step_s = grid_s
            error = _level_step(
                modes, contacts, storeys, state, room, z, end, level, step_s, start, per_s * step_s
            )  # fmt: skip
        else:
            error = _any_step(modes, contacts, storeys, state, room, z, end, step_s, start, per_s * step_s)
        if error >= 0.0 and (error <= limit or forced or level == deepest):
            looked = level >= fine or forced
            if looked or not _may_touch(contacts, storeys, state, z, step_s, shaking.strongest):
                break
        elif level == deepest:
            return -1.0, True
        level += 1
        while level < deepest and longest / (1 << level) >= step_s:
            level += 1
    if not forced and error * FASTER < limit and level > least:
        doubled = (since + step_s) / (2.0 * grid_s)
        if abs(doubled - round(doubled)) <= ON_GRID:
            level -= 1
    if not forced:
        state.clock[2] = level
    return step_s, looked


@njit(cache=True, nogil=True, error_model="numpy")
def _note(storeys: Any, shaking: Any, interval: int, since: float, now: float) -> None:
    """Write the time of a step's start, and the table's velocity and known forces from there on, where they are read."""
    rates, dt_s = storeys.table_rate, shaking.dt_s
    bend = 0.5 * (shaking.ends[interval] - shaking.starts[interval]) / dt_s
    slope = (rates[interval + 1] - rates[interval]) / dt_s - bend * dt_s
    storeys.moment[0] = now
    storeys.moment[1] = rates[interval] + since * (slope + since * bend)
    storeys.moment[2], storeys.moment[3] = slope + 2.0 * since * bend, bend
    for force in range(len(storeys.known)):
        at = storeys.before[interval, force]
        slope = (storeys.after[interval, force] - at) / dt_s
        storeys.known[force, 0], storeys.known[force, 1] = at + since * slope, slope


@njit(cache=True, nogil=True, error_model="numpy")
def _flown(
    modes: Any, contacts: Any, state: Any, room: Any, shaking: Any, z: Any, end: Any, now: float, left_s: float,
    start: float, per_s: float,
) -> Any:  # fmt: skip
    """Carry the poles over a step in flight; return its length [s], the tick at its end and whether one may touch."""
    tick_s = shaking.dt_s / shaking.parts / (1 << shaking.fine)
    tick = state.clock[1]
    wait = _wait(contacts, state, z, now, tick_s, shaking.strongest)
    if tick < 0:
        # Off the ticks after an event: a step of its own length, back to the next tick.
        since = state.since[0]
        tick = math.floor(since / tick_s + 1e-6) + 1
        step_s = min(tick * tick_s - since, left_s)
        _free_step(modes, room, z, end, step_s, start, per_s * step_s)
    else:
        level = _longest_level(tick, shaking.fine, tick_s, wait)
        tick += 1 << (shaking.fine - level)
        step_s = tick_s * (1 << (shaking.fine - level))
        if step_s < left_s * (1.0 + 1e-9):
            _fly(z, end, modes.tables[level], modes.pushed[level], start, per_s * step_s)
        else:
            step_s = left_s
            _free_step(modes, room, z, end, step_s, start, per_s * step_s)
    return step_s, tick, step_s > wait


@njit(cache=True, nogil=True, error_model="numpy")
def _cruise(shaking: Any, modes: Any, state: Any, times: Any, states: Any, row: int, until: float) -> int:
    """Take longest steps as long as nothing can touch before their end; return the row that is next to fill.

    It does what `advance` would, without what each step there costs.
    """
    clock, starts, ends = state.clock, shaking.starts, shaking.ends
    longest, ticks = shaking.dt_s / shaking.parts, 1 << shaking.fine
    part = clock[1] // ticks
    while row < len(times) and clock[0] < len(starts) - 1:
        begun = clock[0] * shaking.dt_s
        if begun + (part + 1) * longest > until:
            break
        rise = (ends[clock[0]] - starts[clock[0]]) / shaking.parts
        _fly(
            states[row - 1], states[row], modes.tables[0], modes.pushed[0], starts[clock[0]] + part * rise, rise
        )  # fmt: skip
        part += 1
        times[row] = begun + part * longest
        if part == shaking.parts:
            part = 0
            clock[0] += 1
            times[row] = clock[0] * shaking.dt_s
        row += 1
    clock[1] = part * ticks
    state.since[0] = part * longest
    return row


@njit(cache=True, nogil=True, error_model="numpy")
def _any_closed(closed: Any) -> bool:
    return bool(closed.sum() > 0)


@njit(cache=True, nogil=True, error_model="numpy")
def advance(
    shaking: Any, modes: Any, contacts: Any, storeys: Any, state: Any, times: Any, states: Any, forces: Any
) -> Any:
    """Go on with a run until it ends or the rows are full; return how it ended and how many rows are filled.

    Args:
        shaking, modes, contacts: The run (`Shaking`, `Modes`, `Contacts`).
        storeys: Its laws in storeys (`Storeys`; changed), or None. Without them the loop is compiled without what they need.
        state: Where it is (`State`); changed.
        times, states, forces: Rows to fill: time (k,) [s], poles (k, 2, p), forces of all connections and of the laws in
            storeys in the middle of the step before (k, c + laws) [N]. The first one is given.
    """
    poles, count, deepest = states.shape[2], len(contacts.gap), len(modes.tables) - 2
    room = Room(
        np.empty((8, poles)), np.empty((4, poles)), np.empty((8, poles)), np.empty((4, poles)),
        np.empty((2, poles)), np.empty((count, 4)), np.empty((deepest + 2, count, count, 4, 3)),
        np.zeros(deepest + 2, np.bool_),
    )  # fmt: skip
    opening = count
    if storeys is not None:
        opening = storeys.first
    clock = state.clock
    tick_s = shaking.dt_s / shaking.parts / (1 << shaking.fine)
    flips, row = 0, 1
    while clock[0] < len(shaking.starts) and row < len(times):
        z, end = states[row - 1], states[row]
        interval, since = clock[0], state.since[0]
        length_s = shaking.last_s if interval == len(shaking.starts) - 1 else shaking.dt_s
        now, left_s = interval * shaking.dt_s + since, length_s - since
        per_s = (shaking.ends[interval] - shaking.starts[interval]) / shaking.dt_s
        start = shaking.starts[interval] + per_s * since
        touching, tick = _any_closed(state.closed), -1
        if not touching and clock[1] >= 0 and clock[1] % (1 << shaking.fine) == 0:
            wait = _wait(contacts, state, z, now, tick_s, shaking.strongest)
            gone = _cruise(shaking, modes, state, times, states, row, now + wait)
            if gone > row:
                forces[row:gone] = 0.0
                row = gone
                continue
        step_s, looked = 0.0, True
        if storeys is not None:
            _note(storeys, shaking, interval, since, now)
            step_s, looked = _followed(
                modes, contacts, storeys, state, room, shaking, z, end, left_s, start, per_s
            )  # fmt: skip
        else:
            if touching:
                step_s = _controlled(modes, contacts, state, room, shaking, z, end, left_s, start, per_s)
            else:
                step_s, tick, looked = _flown(
                    modes, contacts, state, room, shaking, z, end, now, left_s, start, per_s
                )  # fmt: skip
        if step_s < 0.0:
            return STUCK, row
        event = -1
        if looked and flips <= 2 * opening:
            event, at = _first_event(contacts, opening, state, z, end, touching, now + step_s, step_s)
            if event >= 0:
                tick, found = -1, True
                if at == 0.0:
                    step_s = 0.0
                else:
                    step_s, found = _locate(
                        modes, contacts, storeys, state, room, z, end, touching, event, at * step_s, step_s, start, per_s
                    )  # fmt: skip
                event = event if found else -1
        if step_s > 0.0:
            flips = 0
            for c in range(count):
                state.force[c, 0] = state.force[c, 2]
            if storeys is not None:
                for law in range(storeys.memory.shape[1]):
                    for i in range(storeys.memory.shape[2]):
                        storeys.memory[0, law, i] = storeys.memory[2, law, i]
                for law in range(count - opening):
                    forces[row, count + law] = state.force[opening + law, 1]
            if step_s >= left_s * (1.0 - 1e-9):
                clock[0], clock[1], state.since[0] = interval + 1, 0, 0.0
                now = interval * shaking.dt_s + length_s
            else:
                clock[1] = tick
                state.since[0] = tick * tick_s if tick >= 0 else since + step_s
                now = interval * shaking.dt_s + state.since[0]
            row += 1
        if event >= 0:
            flips += 1
            _flip(contacts, state, room, states[row - 1], shaking, deepest, event)
        # An event at the very time of the last row changes that row's forces: those after it count.
        times[row - 1] = now
        for c in range(count):
            forces[row - 1, c] = state.force[c, 0]
    return (FULL if clock[0] < len(shaking.starts) else DONE), row
