"""Shock problems of code_aster's validation manual, by the exact solver."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pounding.contact.laws import LinearSpring
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import run_exact
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.storeys import KnownForce
from tests.validation.oscillators import after_a_kick, oscillator, wall

PUBLISHED = tomllib.loads((Path(__file__).parent / "published" / "code_aster.toml").read_text("utf-8"))

RELEASE_STEP_S = 1e-5
SHAKEN_STEP_S = 2e-5


def _hz(case: dict[str, Any]) -> float:
    return float(np.sqrt(case["stiffness_n_per_m"] / case["mass_kg"]) / (2.0 * np.pi))


@pytest.fixture(scope="module")
def released() -> ContactHistory:
    case = PUBLISHED["sdnd101"]
    mass = case["mass_kg"]
    push = after_a_kick(case["velocity_m_s"], np.zeros(42_000), RELEASE_STEP_S)
    motion = run_exact(
        [oscillator("mass", mass, _hz(case), 0.0), wall()],
        # The mass has moved by a step of its velocity when the kick is over.
        [Contact(LinearSpring(case["contact_n_per_m"]), RELEASE_STEP_S * case["velocity_m_s"], 1)],
        np.zeros_like(push),
        RELEASE_STEP_S,
        storeys=[KnownForce(np.ones(1), mass * push)],
    )
    return motion.contacts[0]


def test_a_released_mass_hits_a_wall_as_published(released: ContactHistory) -> None:
    case = PUBLISHED["sdnd101"]
    peaks = case["first_peak_s"], case["second_peak_s"]
    for (begin, end), peak_s in zip(released.pulses, peaks, strict=True):
        times = np.linspace(begin, end, 2001)
        force = released.at(times)[2]
        assert force.max() == pytest.approx(case["peak_force_n"], rel=1e-3)
        assert np.trapezoid(force, times) == pytest.approx(case["impulse_n_s"], rel=1e-3)
        assert end - begin == pytest.approx(case["contact_time_s"], rel=1e-3)
        # The manual's times are steps of 0.5 ms.
        assert times[force.argmax()] - RELEASE_STEP_S == pytest.approx(peak_s, abs=2.5e-4)


@pytest.fixture(scope="module")
def shaken() -> tuple[Motion, float]:
    """Return two colliding oscillators whose anchors move against each other, and when that begins [s]."""
    case = PUBLISHED["sdnd102"]
    mass, ratio, omega = case["mass_kg"], case["damping_ratio"], 2.0 * np.pi * case["frequency_hz"]
    time_s = np.arange(0.0, 1.0 + 0.5 * SHAKEN_STEP_S, SHAKEN_STEP_S)
    # The anchor's displacement -sin(omega t) / omega^2 and its velocity pull at spring and dashpot. A mass that starts at
    # rest beside its anchor starts with the anchor's velocity.
    own = 2.0 * np.pi * _hz(case)
    pull = -((own / omega) ** 2) * np.sin(omega * time_s) - 2.0 * ratio * own / omega * np.cos(omega * time_s)
    push = mass * after_a_kick(-1.0 / omega, pull, SHAKEN_STEP_S)
    motion = run_exact(
        [oscillator(name, mass, _hz(case), ratio) for name in ("left", "right")],
        [Contact(LinearSpring(case["contact_n_per_m"]), case["gap_m"], 1)],
        np.zeros_like(push),
        SHAKEN_STEP_S,
        storeys=[KnownForce(np.ones(1), push), KnownForce(np.ones(1), -push, body=1)],
    )
    return motion, 2.0 * SHAKEN_STEP_S


def test_two_oscillators_collide_as_published(shaken: tuple[Motion, float]) -> None:
    case, (motion, begin_s) = PUBLISHED["sdnd102"], shaken
    frame, contact = motion.frames[0], motion.contacts[0]
    times = np.array(case["time_s"])
    found = np.interp(times + begin_s, contact.time_s, frame.displacement_m[:, 0])
    apart = np.abs(found - case["displacement_m"])
    assert len(contact.pulses) == 10
    # The manual allows itself 3e-5 m; its steps of 0.25 ms are an eighth of a touch.
    assert apart.max() < 3e-6 < case["tolerance_m"]


def test_the_published_force_is_a_sample_of_a_short_touch(shaken: tuple[Motion, float]) -> None:
    case, (motion, begin_s) = PUBLISHED["sdnd102"], shaken
    contact = motion.contacts[0]
    samples = 0.002 * np.arange(1, 251)
    force = contact.at(samples + begin_s)[2]
    assert samples[force.argmax()] == pytest.approx(case["sampled_force_s"])
    assert force.max() == pytest.approx(case["sampled_force_n"], rel=0.06)
    dense = contact.at(np.linspace(0.37, 0.38, 2001) + begin_s)[2]
    assert dense.max() > 1.5 * case["sampled_force_n"]
