"""All effects of the catalogue at every place that they can have."""

from __future__ import annotations

from pounding.diagnosis.effects import frame, storey, table_and_sensors  # noqa: F401  (they fill the catalogue)
from pounding.diagnosis.effects.catalogue import CATALOGUE, Effect, places
from pounding.diagnosis.model.model import Model


def candidates(model: Model) -> list[Effect]:
    """Return every effect of the catalogue at every place that it can have in this case, foils included."""
    found: list[Effect] = []
    for kind in CATALOGUE.kinds:
        found += places(kind, model)
    return found
