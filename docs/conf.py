"""Sphinx configuration."""

from importlib.metadata import version as installed_version

project = "pounding"
author = "the pounding developers"
copyright = "2026, the pounding developers"
release = installed_version("pounding")
version = release

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
autosummary_generate = True
autodoc_typehints = "description"
autodoc_member_order = "bysource"
napoleon_google_docstring = True
exclude_patterns = ["_build"]
html_theme = "alabaster"
html_static_path = ["_static"]
html_theme_options = {"page_width": "1080px", "description": "Adjacent frames on a shaking table"}
nitpicky = False
