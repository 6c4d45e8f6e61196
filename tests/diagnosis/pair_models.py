"""Two small frames that collide, made by a general-purpose integrator, for the tests of pairs."""

from __future__ import annotations

from functools import cache, lru_cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from scipy.integrate import odeint
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Contact, Run
from pounding.diagnosis.contact_force.pair import ContactFindings, contact_findings, prepare
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.confidence import Features, basis
from pounding.diagnosis.decision.pair_decision import joined
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.model.storeys import StoreyFrame, Structure

STEP_S = 0.001
SAMPLES = 2500
FLOORS = 3
MASS = 6.5
STIFFNESS = {"tall": 2.4e4, "stiff": 9e4}
DRIFT = np.eye(FLOORS) - np.eye(FLOORS, k=-1)
GAP_M = 0.004
CONTACT = Contact("tall", "stiff", FLOORS, GAP_M, "linear_viscoelastic", 2e7, None, 0.7)

CHANNELS = (
    Channel("table", "table_acceleration", "m/s^2"),
    *(
        Channel(f"{name}_{kind}{floor}", quantity, "m/s^2" if kind == "a" else "m", frame=name, floor=floor)
        for name in STIFFNESS
        for kind, quantity in (("a", "absolute_acceleration"), ("d", "relative_displacement"))
        for floor in (1, 2, 3)
    ),
    Channel("force_1", "contact_force", "N", contact=1),
)


def structure() -> Structure:
    """Return the two frames as believed, which is as they are."""
    return Structure(
        tuple(
            StoreyFrame(
                name, MASS * np.eye(FLOORS), k * DRIFT.T @ DRIFT, np.full(FLOORS, 0.01), 0.2 * np.arange(1, 4)
            )
            for name, k in STIFFNESS.items()
        )
    )


def damping(stiffness: np.ndarray) -> np.ndarray:
    """Return the damping matrix of one per cent in every mode."""
    squares, shapes = np.linalg.eigh(stiffness / MASS)
    return MASS * shapes @ np.diag(0.02 * np.sqrt(squares)) @ shapes.T


def force(contact: Contact, depth: float, rate: float) -> float:
    """Return what a contact pushes with; written out for the two laws of the tests."""
    if depth <= 0:
        return 0.0
    if contact.law == "hertz":
        return contact.stiffness * depth**1.5
    loss = np.log(contact.restitution)
    ratio = -loss / np.hypot(np.pi, loss)
    return max(contact.stiffness * depth + 2 * ratio * np.sqrt(contact.stiffness * MASS / 2) * rate, 0.0)


@lru_cache(maxsize=32)
def shaken(contact_events: tuple[Contact, ...], seed: int, peak: float = 5.0) -> np.ndarray:
    """Return the columns of `CHANNELS` (samples, channels) before noise; the force is that of the first contact."""
    finer = 5
    at = np.arange(SAMPLES) * STEP_S
    rng = np.random.default_rng(seed)
    white = np.fft.rfft(rng.standard_normal(SAMPLES))
    smooth = np.fft.irfft(white * np.exp(-((np.fft.rfftfreq(SAMPLES, STEP_S) / 12.0) ** 2)), SAMPLES)
    table = peak * smooth / np.abs(smooth).max() * np.sin(np.linspace(0, np.pi, SAMPLES)) ** 0.5
    spline = CubicSpline(at, table)
    # Forty thousand times called: one product for both frames, and numbers that are no arrays where there are few.
    still, ones = np.zeros((FLOORS, FLOORS)), np.eye(FLOORS)
    stiff, loose = (k * DRIFT.T @ DRIFT for k in STIFFNESS.values())
    squares = np.block([[stiff, still], [still, loose]]) / MASS
    losses = np.block([[damping(stiff), still], [still, damping(loose)]]) / MASS
    free = np.block([[np.zeros_like(squares), np.kron(np.eye(2), ones)], [-squares, -losses]])
    pieces = [tuple(piece) for piece in spline.c.T.tolist()]

    def ground(t: float) -> float:
        number = min(int(t / STEP_S), SAMPLES - 2)
        past = t - number * STEP_S
        a, b, c, d = pieces[number]
        return float(((a * past + b) * past + c) * past + d)

    def pushes(y: np.ndarray) -> list[float]:
        at = y.tolist()
        return [
            force(
                one,
                at[one.floor - 1] - at[FLOORS + one.floor - 1] - one.gap_m,
                at[2 * FLOORS + one.floor - 1] - at[3 * FLOORS + one.floor - 1],
            )
            for one in contact_events
        ]

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        change = free @ y
        change[2 * FLOORS :] -= ground(t)
        for one, push in zip(contact_events, pushes(y), strict=True):
            change[2 * FLOORS + one.floor - 1] -= push / MASS
            change[3 * FLOORS + one.floor - 1] += push / MASS
        return change

    fine = np.arange(finer * (SAMPLES - 1) + 1) * STEP_S / finer
    # So fine that another processor's rounding does not show: at 1e-6 it moves the forces of the touches by a sixth.
    found = odeint(
        rates, np.zeros(4 * FLOORS), fine, rtol=1e-11, atol=1e-14, hmax=1e-4, mxstep=10_000, tfirst=True
    )
    u = found[:, : 2 * FLOORS].T
    acceleration = np.array([rates(t, y)[2 * FLOORS :] + spline(t) for t, y in zip(fine, found, strict=True)])
    cell = np.array([pushes(y)[0] for y in found]) if contact_events else np.zeros(len(fine))
    columns = [spline(fine)]
    for frame in (0, 1):
        span = range(3 * frame, 3 * frame + 3)
        columns += [acceleration[:, i] for i in span] + [u[i] for i in span]
    # A logger's low-pass, here without delay.
    sections = butter(4, 0.4 / STEP_S, fs=finer / STEP_S, output="sos")
    return np.asarray(sosfiltfilt(sections, np.column_stack([*columns, cell]), axis=0)[::finer])


def colliding(
    *contact_events: Contact,
    model: Contact = CONTACT,
    measured: bool = True,
    runs: int = 2,
    peak: float = 5.0,
) -> Case:
    """Return a case in which the frames have the contacts `contact_events`, with noise of one per cent."""
    made = []
    for run in range(runs):
        values = shaken(contact_events, run, peak).copy()
        rng = np.random.default_rng(100 + run)
        noise = 0.01 * values.std(axis=0)
        noise[0], noise[-1] = 0.5 * noise[0], max(noise[-1], 0.5)
        values += noise * rng.standard_normal(values.shape)
        kept = values if measured else values[:, :-1]
        made.append(Run(f"run{run + 1}.csv", None, STEP_S * np.arange(SAMPLES), STEP_S, kept))
    frames = tuple(
        CaseFrame(
            name, FLOORS, storey_height_m=0.2, floor_mass_kg=(MASS,) * FLOORS,
            frequency_hz=(float(np.sqrt(np.linalg.eigvalsh(k * DRIFT.T @ DRIFT / MASS)[0]) / (2 * np.pi)),),
            damping_ratio=(0.01,),
        )
        for name, k in STIFFNESS.items()
    )  # fmt: skip
    channels = CHANNELS if measured else CHANNELS[:-1]
    return Case("two sticks", Path("two-sticks"), frames, tuple(made), channels, (model,))


def model_of(case: Case) -> Model:
    """Return the baseline model of a case."""
    return Model(structure(), observe(case, structure()), case.prior)


NOTHING = Conclusion(
    "nothing_missing", 0.9, basis(Features("pair_nothing_missing", 0.0, 0.0, 0.0, 0.0, 0)), (), ()
)


def judged(case: Case) -> tuple[Pair, ContactFindings, Conclusion]:
    """Return a pair, what its impacts say, and what is concluded, its frames being as believed."""
    model = model_of(case)
    pair = prepare(case, model)
    found = contact_findings(case, pair, np.zeros(len(model.std)), (), (0, 1), np.zeros(2))
    return pair, found, joined(case, pair, found, NOTHING)


@cache
def found_of(*contacts: Contact) -> tuple[Pair, ContactFindings, Conclusion]:
    """Return `judged` of two runs with a force cell, once for all tests; they change nothing of it."""
    return judged(colliding(*contacts))


def claimed(conclusion: Conclusion) -> list[str]:
    return [effect.effect for effect in conclusion.effects]


def value(conclusion: Conclusion, name: str) -> Any:
    return next(one.value for one in conclusion.effects[0].parameters if one.name == name)


def still_frames(pair: Pair) -> tuple[Findings, Filtered]:
    """Return findings on a pair and its frames as believed, the third run being held out."""
    filtered = SimpleNamespace(values=np.zeros(len(pair.slow.std)), effects=())
    return cast(Findings, SimpleNamespace(pair=pair, held_out=(2,))), cast(Filtered, filtered)
