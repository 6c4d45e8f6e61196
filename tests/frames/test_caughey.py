"""Damping of the modes above those with a stated ratio: Rayleigh's matrix, the series, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pounding import frames
from pounding.frames import FrameError
from pounding.frames.stick import caughey


def stick(**fields: Any) -> frames.StickFrame:
    usual = {
        "name": "tower",
        "storeys": 5,
        "storey_height_m": 3.2,
        "floor_mass_kg": [3e5] * 5,
        "frequency_hz": [1.1],
        "damping_ratio": [0.03, 0.04],
        "damping_beyond": "caughey",
    }
    return frames.StickFrame(**(usual | fields))


def test_two_ratios_are_rayleighs_damping() -> None:
    built = frames.build(stick())
    first, second = 2 * np.pi * built.frequencies_hz[:2]
    factors = np.linalg.solve([[1 / first, first], [1 / second, second]], [0.06, 0.08])
    expected = factors[0] * built.mass + factors[1] * built.stiffness
    np.testing.assert_allclose(built.damping, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())


def test_the_stated_ratios_are_kept_and_all_are_none_other() -> None:
    hertz = np.array([1.0, 2.9, 4.6, 5.9])
    for count in (1, 2, 3, 4):
        given = np.array([0.03, 0.035, 0.04, 0.05])[:count]
        np.testing.assert_allclose(caughey(hertz, given)[:count], given, rtol=1e-12)
    np.testing.assert_allclose(caughey(hertz, np.array([0.03])), 0.03 / hertz)  # in proportion to the mass


def test_without_the_key_the_last_ratio_goes_on() -> None:
    built = frames.build(stick(damping_beyond="last"))
    np.testing.assert_allclose(built.damping_ratios, [0.03, 0.04, 0.04, 0.04, 0.04])


def test_a_series_that_makes_a_mode_grow_is_refused() -> None:
    with pytest.raises(FrameError, match=r"gives mode \d the ratio -.*, below 0"):
        frames.build(stick(damping_ratio=[0.03, 0.06, 0.05]))


def test_a_ratio_asked_for_goes_before() -> None:
    np.testing.assert_allclose(frames.build(stick(), damping=0.02).damping_ratios, 0.02)
