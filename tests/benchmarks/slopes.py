"""How far signatures are from slopes: as they are, without the laws' feedback, and with a gain that is one of modes.

For each law of `tests/diagnosis/model/test_signatures.py` and three storeys of a bench, the relative error of each nuisance
parameter's signature beside a small difference of the prediction; the noise of the table's delay, which no prediction
knows, is left out.

    python -m tests.benchmarks.slopes
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

import numpy as np
from rich.console import Console
from rich.table import Table

from pounding.diagnosis.inference import filtering
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.kalman import Gain
from tests.diagnosis.model.test_signatures import LAWS, errors
from tests.diagnosis.models import measured

LEVELS = (0.1, 0.003)
"""Latent forces, as a share of the storeys' shear: a filter that corrects much, and one that corrects little."""


@contextmanager
def without_feedback() -> Iterator[None]:
    """Take the laws' feedback out of the signatures."""
    with patch.object(filtering, "tangents_of", lambda *_: None):
        yield


@contextmanager
def gain_of_modes() -> Iterator[None]:
    """Let the likelihood's gain correct modes alike, whatever their shapes, instead of floors."""
    with patch.object(Gain, "at", lambda self, _: self.modal):
        yield


@contextmanager
def as_they_are() -> Iterator[None]:
    """Change nothing."""
    yield


WAYS = {"as they are": as_they_are, "no feedback": without_feedback, "gain of modes": gain_of_modes}


def main() -> None:
    """Print median and largest error of the signatures."""
    table = Table("law", "latent forces", *(f"{way}, median / largest [%]" for way in WAYS))
    for law, acting in LAWS.items():
        model = measured(acting)
        values = 0.5 * model.std * np.random.default_rng(5).standard_normal(len(model.std))
        for level in LEVELS:
            filtered = run_filter(model, values, starting_noise(model, (0,), level), (0,), acting)
            shown = []
            for way in WAYS.values():
                with way():
                    found = 100 * errors(model, filtered)
                shown.append(f"{np.median(found):.1f} / {found.max():.1f}")
            table.add_row(law, f"{level:g}", *shown)
    Console().print(table)


if __name__ == "__main__":
    main()
