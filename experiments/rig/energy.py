"""Energy of a run: what the table put in, and where it went."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.rig.motion import EnergyBalance

if TYPE_CHECKING:
    from pounding.experiments.rig.contact_history import ContactHistory
    from pounding.experiments.rig.motion import FrameMotion, StoreyHistory

Real = NDArray[np.floating]

# Gauss and Legendre's three points: exact to degree five in each step.
_PLACES = 0.5 + 0.5 * np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)])
_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
_CONTACT_CUTS = 6


def balance(
    frames: tuple[FrameMotion, ...],
    contacts: tuple[ContactHistory, ...],
    storeys: tuple[StoreyHistory, ...] = (),
) -> EnergyBalance:
    """Return the balance of a run, each integral over the interpolated motion between the steps.

    Args:
        frames: Motion of each frame.
        contacts: History of each contact.
        storeys: History of each law in a storey.
    """
    time = frames[0].time_s
    kinetic, strain, damping, work = (np.zeros(len(time)) for _ in range(4))
    for frame in frames:
        reduced, q, v = frame.reduced, frame.displacement_m, frame.velocity_m_s
        kinetic += 0.5 * np.einsum("ij,ij->i", v @ reduced.mass, v)
        strain += 0.5 * np.einsum("ij,ij->i", q @ reduced.stiffness, q)
        put_in, lost = _powers(frame)
        work += put_in
        damping += lost
    contact = np.zeros(len(time))
    for history in contacts:
        contact += _contact_work(history)
    in_storeys = sum((one.work_j for one in storeys), np.zeros(len(time)))
    return EnergyBalance(time, work, kinetic, strain, damping, contact, in_storeys)


def _powers(frame: FrameMotion) -> tuple[Real, Real]:
    """Return the work of the table and the loss in the damping (m,) [J] of one frame."""
    v, a, table = frame.velocity_m_s, frame.acceleration_m_s2, frame.table_m_s2
    step = np.diff(frame.time_s)
    moved = frame.reduced.mass @ frame.reduced.influence
    pushed, quicker = -(v @ moved), -(a @ moved)
    bend = np.diff(table) / step
    put_in = _integrated(
        step,
        pushed * table,
        quicker[:-1] * table[:-1] + pushed[:-1] * bend,
        quicker[1:] * table[1:] + pushed[1:] * bend,
    )
    resisting = v @ frame.reduced.damping
    change = 2.0 * np.einsum("ij,ij->i", a, resisting)
    lost = _integrated(step, np.einsum("ij,ij->i", v, resisting), change[:-1], change[1:])
    return put_in, lost


def _integrated(step: Real, power: Real, change_after: Real, change_before: Real) -> Real:
    """Return the integral of a power (m,) from its values and its slopes at both ends of each step (order four)."""
    parts = 0.5 * step * (power[:-1] + power[1:]) + step**2 / 12.0 * (change_after - change_before)
    return _summed(parts)


def _contact_work(history: ContactHistory) -> Real:
    """Return the work done on a contact (m,) [J]; steps in touch are cut, for the force bends in them."""
    time = history.time_s
    closed = history.deformation_m > 0.0
    steps = np.flatnonzero(closed[:-1] | closed[1:])
    work = np.zeros(len(time) - 1)
    length = np.diff(time)[steps]
    for cut in range(_CONTACT_CUTS):
        for place, weight in zip(_PLACES, _WEIGHTS, strict=True):
            _, rate, force = history.at(time[steps] + length * (cut + place) / _CONTACT_CUTS)
            work[steps] += weight / _CONTACT_CUTS * length * force * rate
    return _summed(work)


def _summed(parts: Real) -> Real:
    return np.concatenate([[0.0], np.cumsum(parts)])
