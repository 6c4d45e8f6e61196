"""All effects of the catalogue at every place that they can have."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from pounding.diagnosis import effects
from pounding.diagnosis.effects.catalogue import CATALOGUE, Effect, places
from pounding.diagnosis.model.model import Model

OWN = ("candidate_file", "candidate_trial", "user")
"""Modules that hold no effect but read the user's own, with libraries that only they need."""


@cache
def kinds() -> tuple[type[Effect], ...]:
    """Return every kind of effect that a module of this folder adds to the catalogue, rivals and optional ones included."""
    for module in iter_modules(effects.__path__):
        if module.name not in OWN:
            import_module(f"{effects.__name__}.{module.name}")
    return tuple(CATALOGUE.ordered())


def candidates(model: Model) -> list[Effect]:
    """Return every effect that is always tried, rivals included, at every place that it can have in this case."""
    return [effect for kind in kinds() if kind.default for effect in places(kind, model)]
