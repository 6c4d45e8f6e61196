"""The arrays of the exact solver's compiled loop: what shakes, what moves, what touches, and where a run is.

A law in a storey is a connection as a contact is, but one that never opens; connections are the contacts, then the laws.

Poles are kept as real and imaginary parts in two rows, which the compiler turns into vector instructions.
"""

from __future__ import annotations

from typing import Any, NamedTuple


class Shaking(NamedTuple):
    """How the table moves and how closely it is followed.

    Attributes:
        starts, ends: Acceleration at the start and the end of each interval (m,) [m/s^2].
        dt_s: Length of an interval [s].
        last_s: Length of the last one [s], where the run may end before the sample.
        strongest: Largest acceleration [m/s^2].
        parts: The longest step is an interval over `parts`.
        fine: The finest step in flight is the longest over 2^fine; steps in contact are as long or shorter.
        tolerance: Limit of the velocity's error in a step in contact, as a share of the contact's largest velocity [-].
        forced_level: All steps in contact are the longest over 2^forced_level, for studies of convergence; -1 leaves
            them to the error control.
    """

    starts: Any
    ends: Any
    dt_s: float
    last_s: float
    strongest: float
    parts: int
    fine: int
    tolerance: float
    forced_level: int


class Modes(NamedTuple):
    """The frames' poles, one frame after the other.

    Attributes:
        rates: Poles (p,) [1/s].
        load: Load of a unit acceleration of the table on each (2, p).
        tables, pushed: `exact_loop.integrals` (levels, 8, p) and `push` (levels, 4, p) of the longest step over 2^level.
    """

    rates: Any
    load: Any
    tables: Any
    pushed: Any


class Contacts(NamedTuple):
    """The connections (c of them) and the programs of those that are contacts.

    Attributes:
        span: First pole and one past the last of each connection's frames (c, 2).
        row, rate: Deformation or drift [m] and its rate [m/s] for a unit state (c, 2, p).
        gain: Load of a unit force on each pole (c, 2, p).
        gap: Gaps at rest (c,) [m]; zero for a law in a storey.
        weight, pushing: Bound of each pole's part in the rate (c, p), and of that of a unit acceleration of the table
            (c,), for the time before which nothing can touch.
        mobility: Relative acceleration that a unit force gives (c,) [1/kg].
        code, first, result: The contacts' programs, one after the other (see `contact.evaluation`).
        registers: Their registers (contacts, r).
    """

    span: Any
    row: Any
    rate: Any
    gain: Any
    gap: Any
    weight: Any
    pushing: Any
    mobility: Any
    code: Any
    first: Any
    result: Any
    registers: Any


class Storeys(NamedTuple):
    """The laws in storeys (l of them), then known forces (f), and room to work in; runs without them have none of it.

    Attributes:
        first: The first connection that is a law in a storey: how many contacts there are.
        address: Where the laws' compiled functions are (l,).
        parameters: Their parameters in SI (l, NUMBERS).
        in_room: Share of the table's velocity in the rate that a law sees (l,).
        remembers: Which of them have a memory (l,).
        jolt: Bound of what a unit force of each adds to each connection's relative acceleration (c, l + f) [1/kg].
        table_rate: Velocity of the table at the intervals' ends (m + 1,) [m/s].
        before, after: Known forces at the start and the end of each interval (m, f) [N].
        memory: What they remember at the start of a step, in its middle, at its end, at a turn on the way, and in trials
            (5, l, MEMORY).
        seen: Drift and rate at the start, in the middle and at the end of a step (l + f, 6).
        moment: Time at a step's start [s], the table's velocity there [m/s], its slope and half its bend (4,).
        known: Known forces at a step's start [N] and their slopes [N/s] (f, 2).
        lasting_s: Time for which an error of a memory counts [s].
    """

    first: int
    address: Any
    parameters: Any
    in_room: Any
    remembers: Any
    jolt: Any
    table_rate: Any
    before: Any
    after: Any
    memory: Any
    seen: Any
    moment: Any
    known: Any
    lasting_s: float


class State(NamedTuple):
    """All that a run remembers from step to step; `advance` changes it.

    Attributes:
        clock: Interval, tick of the finest step in it (-1 off the ticks), level of the steps in contact (3,).
        since: Time since the interval's start (1,) [s].
        closed: Which contacts touch (c,); laws in storeys always do.
        approach, fastest: Velocity at first touch, largest velocity since (c,) [m/s].
        horizon: Time before which a contact cannot touch (c,) [s].
        force: Forces at start, middle and end of a step (c, 3) [N].
    """

    clock: Any
    since: Any
    closed: Any
    approach: Any
    fastest: Any
    horizon: Any
    force: Any


class Room(NamedTuple):
    """Room to work in.

    Attributes:
        own, own_push, half, half_push: `integrals` (8, p) and `push` (4, p) of a step of any length and of its half.
        middle: State in the middle of a step (2, p).
        free: Deformation and rate in the middle and at the end of a step without the forces of what is closed (c, 4).
        response: The same for unit forces at start, middle and end: of a connection, for another's force
            (levels + 1, c, c, 4, 3); the last is for a step of any length.
        known: For which levels `response` is known (levels + 1,).
    """

    own: Any
    own_push: Any
    half: Any
    half_push: Any
    middle: Any
    free: Any
    response: Any
    known: Any
