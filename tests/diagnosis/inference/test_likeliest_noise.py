"""The likeliest noise by what it must be: a maximum that does not depend on its start, near the noise that was put in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.effects.storey import CubicStiffness
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.likeliest_noise import _louder, _scored, likeliest_noise
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS
from tests.diagnosis.models import in_the_room, measured

SHARE = 0.02


def started(model: Model, noise: Noise) -> Filtered:
    return run_filter(model, np.zeros(len(model.std)), [noise], (0,))


def likely(model: Model) -> Noise:
    return starting_noise(model, (0,), 0.001)[0]


def test_the_noise_that_was_put_in_is_found_from_any_start() -> None:
    model = measured(noise=SHARE)
    noise = likely(model)
    starts = [
        noise,
        replace(noise, channel=3.0 * noise.channel),
        replace(noise, channel=noise.channel * np.array([0.2, 1.0, 5.0, 0.5, 2.0])),
        replace(noise, latent=10.0 * noise.latent),
    ]
    found = [likeliest_noise(model, started(model, start)) for start in starts]
    true = SHARE * model.observed.rms(model.observed.runs[0])
    for one in found:
        assert one.noise[0].channel == pytest.approx(true, rel=0.08)
        assert one.log_likelihood == pytest.approx(found[0].log_likelihood, abs=2.0)


def test_at_the_maximum_nothing_changes_and_none_is_ever_less_likely() -> None:
    model = measured(noise=SHARE)
    start = started(model, likely(model))
    found = likeliest_noise(model, start)
    assert found.log_likelihood > start.log_likelihood + SETTINGS.refinement.noise_likelier
    assert likeliest_noise(model, found) is found
    for factor in (0.9, 1.1):
        for name in ("channel", "latent", "table"):
            beside = replace(found.noise[0], **{name: factor * getattr(found.noise[0], name)})
            assert started(model, beside).log_likelihood < found.log_likelihood + 1.0


def test_latent_forces_stay_where_they_are_to_stay() -> None:
    model = measured(noise=SHARE)
    loud = replace(likely(model), latent=30.0 * likely(model).latent)
    found = likeliest_noise(model, started(model, loud), latent=False)
    np.testing.assert_array_equal(found.noise[0].latent, loud.latent)
    assert likeliest_noise(model, started(model, loud)).noise[0].latent.max() < loud.latent.max()


def test_a_channel_that_was_not_measured_keeps_no_noise_and_gaps_do_no_harm() -> None:
    model = measured(noise=SHARE)
    run = model.observed.runs[0]
    holed = run.measured.copy()
    holed[:, 1] = np.nan
    holed[500:700, 0] = np.nan
    gappy = model.seeing(
        replace(model.observed, runs=(replace(run, measured=holed), *model.observed.runs[1:]))
    )
    found = likeliest_noise(gappy, started(gappy, likely(gappy)))
    (noise,) = found.noise
    assert np.isinf(noise.channel[1])
    true = SHARE * model.observed.rms(run)
    assert np.delete(noise.channel, 1) == pytest.approx(np.delete(true, 1), rel=0.1)


def test_a_model_that_blew_up_is_returned_as_it_is() -> None:
    model = measured(noise=SHARE)
    blown = replace(started(model, likely(model)), log_likelihood=-np.inf)
    assert likeliest_noise(model, blown) is blown


@pytest.mark.parametrize(
    "effects", [(), ((CubicStiffness(index=1, frame="bench", storey=2), np.array([2e10])),)]
)
@pytest.mark.parametrize("seen", [lambda model: model, in_the_room], ids=["from the table", "in the room"])
def test_slopes_by_the_noise_are_those_of_differences_whatever_acts(
    effects: Any, seen: Callable[[Model], Model]
) -> None:
    model = seen(measured(effects, noise=SHARE))
    noise = replace(likely(model), channel=1.2 * likely(model).channel, table=0.05)

    def at(by: np.ndarray) -> Filtered:
        rms = model.observed.rms(model.observed.runs[0])
        return run_filter(model, np.zeros(len(model.std)), [_louder(noise, by, rms)], (0,), effects)

    rows = 1e-3 * np.eye(2 + len(noise.channel))
    wanted = [(at(row).log_likelihood - at(-row).log_likelihood) / 2e-3 for row in rows]
    information, slope = _scored(model, at(0.0 * rows[0]))
    assert slope == pytest.approx(wanted, rel=0.01, abs=0.02 * np.abs(wanted).max())
    assert np.linalg.eigvalsh(information).min() > 0.0
