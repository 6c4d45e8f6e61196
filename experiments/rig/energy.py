"""Energy of a run: what the table put in, and where it went."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.rig.motion import EnergyBalance

if TYPE_CHECKING:
    from pounding.experiments.rig.motion import ContactHistory, FrameMotion

Real = NDArray[np.floating]

# Gauss and Legendre's three points: exact to degree five in each step.
_PLACES = 0.5 + 0.5 * np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)])
_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
_CONTACT_CUTS = 6


def balance(frames: tuple[FrameMotion, ...], contacts: tuple[ContactHistory, ...]) -> EnergyBalance:
    """Return the balance of a run, each integral over the interpolated motion between the steps."""
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
    return EnergyBalance(time, work, kinetic, strain, damping, contact)


def _powers(frame: FrameMotion) -> tuple[Real, Real]:
    """Return the work of the table and the loss in the damping (m,) [J] of one frame."""
    time, v, a = frame.time_s, frame.velocity_m_s, frame.acceleration_m_s2
    step = np.diff(time)
    moved = frame.reduced.mass @ frame.reduced.influence
    put_in, lost = np.zeros(len(step)), np.zeros(len(step))
    for place, weight in zip(_PLACES, _WEIGHTS, strict=True):
        h00, h10, h01, h11 = _hermite(place)
        between = h00 * v[:-1] + h01 * v[1:] + step[:, None] * (h10 * a[:-1] + h11 * a[1:])
        shaking = (1.0 - place) * frame.table_m_s2[:-1] + place * frame.table_m_s2[1:]
        put_in -= weight * step * (between @ moved) * shaking
        lost += weight * step * np.einsum("ij,ij->i", between @ frame.reduced.damping, between)
    return _summed(put_in), _summed(lost)


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


def _hermite(place: float) -> tuple[float, float, float, float]:
    """Return cubic Hermite weights of both ends' values and slopes: (v0, s0, v1, s1)."""
    p2, p3 = place**2, place**3
    return 2 * p3 - 3 * p2 + 1, p3 - 2 * p2 + place, -2 * p3 + 3 * p2, p3 - p2


def _summed(parts: Real) -> Real:
    return np.concatenate([[0.0], np.cumsum(parts)])
