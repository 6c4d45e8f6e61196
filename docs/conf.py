"""Sphinx configuration."""

import re
import sys
from importlib.metadata import version as installed_version
from pathlib import Path

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.ext.napoleon import GoogleDocstring

sys.path.insert(0, str(Path(__file__).parent))

project = "pounding"
author = "the pounding developers"
copyright = "2026, the pounding developers"
release = installed_version("pounding")
version = release

extensions = [
    "myst_parser",
    "notebook_pages",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
autodoc_typehints = "description"
autodoc_member_order = "bysource"
napoleon_google_docstring = True
# The gallery offers each script as a notebook too; its page is made of the script.
exclude_patterns = ["_build", "gallery", "examples/**.ipynb"]

# The scripts of the gallery run when the documentation is built, those that changed since it was built last.
sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "subsection_order": ["gallery/frames", "gallery/contact", "gallery/experiments", "gallery/diagnosis"],
    "within_subsection_order": "FileNameSortKey",
    "parallel": 2,
    "abort_on_example_error": True,
    "only_warn_on_example_error": False,
    "reset_modules": ("matplotlib",),
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "thumbnail_size": (400, 280),
    "image_srcset": ["2x"],
    "capture_repr": (),
}
html_theme = "furo"
html_math_renderer = "mathml"
html_title = "pounding"
html_static_path = ["_static"]
html_css_files = ["custom.css"]
html_theme_options = {"top_of_page_buttons": []}

# In a docstring a name between single backticks is a link where the reference has it, and code elsewhere.
default_role = "py:obj"
nitpicky = True
# Other libraries, without an inventory: the build downloads nothing.
nitpick_ignore_regex = [
    ("py:.*", r"(numpy|np|xarray|xr|pandas|pd|matplotlib|rich|msgspec)\..*"),
    ("py:.*", r"(collections\.abc|pathlib|typing)\..*|Path"),
    ("py:.*", r"Real|ArrayLike|Index|Axes"),
]
# What stands behind the names of the reference, and is not for scripts: rooms, and names that annotations give without one.
nitpick_ignore_regex += [
    (
        "py:.*",
        r"pounding\.diagnosis\.(case\.case\.Contact$|(decision|design|effects|inference|model|report)\.).*",
    ),
    ("py:.*", r"pounding\.frames\.(fe|reduction|response)\..*"),
    (
        "py:.*",
        r"Acting|BesideLatentForce|FalseAlarms|Filtered|Fit|Largest|Observations|Pair|Scales|Scores|Structure",
    ),
]

DOCUMENTED = re.compile(r"^\.\. (?:currentmodule:: (\S+)|auto\w+:: (\S+))", re.MULTILINE)


def documented():
    """Return the full names that the reference has."""
    found = []
    for page in sorted((Path(__file__).parent / "api").glob("*.md")):
        module = ""
        for current, name in DOCUMENTED.findall(page.read_text(encoding="utf-8")):
            module = current or module
            if name:
                found.append(name if name.startswith("pounding.") else f"{module}.{name}")
    return found


NAMES = documented()


def link(app, env, node, contnode):
    """Find a name that an annotation or a docstring gives without its module, or with the one that defines it."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"]
    near = target if "." in target else node.get("py:module") or ""
    alike = [name for name in NAMES if name.rpartition(".")[2] == target.rpartition(".")[2]]
    if alike:
        package = near.split(".")[:2]
        full = next((name for name in alike if name.split(".")[:2] == package), alike[0])
        domain = env.get_domain("py")
        found = domain.resolve_xref(env, node["refdoc"], app.builder, "obj", full, node, contnode)
        if found is not None:
            return found
    return contnode if node["reftype"] == "obj" else None


def whole_sentence(app, what, name, obj, options, lines):
    """Keep napoleon from taking what stands before a colon in a property's docstring for its type."""
    if what in ("attribute", "data", "property"):
        lines[:] = [
            "..",
            "",
            *str(GoogleDocstring(list(lines), app.config, app, "function", name)).splitlines(),
        ]


def inline_formula(writer, node):
    """Write a formula as MathML, which browsers show by themselves: no script is loaded from anywhere."""
    writer.body.append(convert(node.astext()))
    raise nodes.SkipNode


def displayed_formula(writer, node):
    """Write a formula on a line of its own."""
    writer.body.append(f'<div class="formula">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", (inline_formula, None), (displayed_formula, None))
    app.connect("missing-reference", link)
    app.connect("autodoc-process-docstring", whole_sentence, priority=400)  # before napoleon
