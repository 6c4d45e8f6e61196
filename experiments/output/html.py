"""The HTML templates of this room."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, StrictUndefined

LOADER = PackageLoader("pounding.experiments.output", "templates")

TEMPLATES = Environment(
    loader=LOADER,
    autoescape=True,
    undefined=StrictUndefined,
)
"""Values are escaped, and one that is missing is an error."""
