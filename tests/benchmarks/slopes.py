"""How far signatures are from slopes: as they are, without the laws' feedback, and with a gain that is one of modes.

For each law of `tests/diagnosis/model/test_signatures.py` and three storeys of a bench, the relative error of each nuisance
parameter's signature beside a small difference of the prediction. Delays of channels are left out: they move the noise, too,
which no prediction knows.

    python -m tests.benchmarks.slopes
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
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


WAYS: dict[str, AbstractContextManager[object]] = {
    "as they are": nullcontext(),
    "no feedback": patch.object(filtering, "tangents_of", lambda *_: None),
    "gain of modes": patch.object(Gain, "at", lambda self, _: self.modal),
}
"""Signatures as they are, without the laws' feedback, and beside a gain that corrects modes alike instead of floors."""


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
                with way:
                    found = 100 * errors(model, filtered)
                shown.append(f"{np.median(found):.1f} / {found.max():.1f}")
            table.add_row(law, f"{level:g}", *shown)
    Console().print(table)


if __name__ == "__main__":
    main()
