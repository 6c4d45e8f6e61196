"""The command's verbs and studies."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from pathlib import Path

from cyclopts import App, Group

from pounding.experiments.console.exit_status import command, run

app = command(
    name="pounding",
    help="Shake frames and buildings, let neighbours collide, find the gap that they need, and name what a model lacks "
    "beside measurements.\n\nFor example: pounding gap 15B 5B --record elcentro-chopra",
)

VERBS_BY_PURPOSE = {
    "To begin with": {
        "demo": "pounding.experiments.command.demo:demo",
        "list": "pounding.experiments.command.listing:listing",
    },
    "Frames on the shaking table": {
        "new-frame": "pounding.experiments.command.new_frame:new_frame",
        "modal": "pounding.experiments.command.modal:modal",
        "shake": "pounding.experiments.command.shake:shake",
        "pound": "pounding.experiments.command.pound:pound",
        "gap": "pounding.experiments.command.gap:gap",
        "opensees": "pounding.experiments.command.opensees:opensees",
    },
    "Buildings": {
        "new-street": "pounding.experiments.command.new_street:new_street",
        "design": "pounding.experiments.command.design:design",
        "mitigate": "pounding.experiments.command.mitigate:mitigate",
        "fragility": "pounding.experiments.command.fragility:fragility",
    },
    "Measurements": {
        "new-case": "pounding.experiments.command.new_case:new_case",
        "check-case": "pounding.experiments.command.check_case:check_case",
        "diagnose": "pounding.experiments.command.diagnose:diagnose",
        "hide": "pounding.experiments.command.hide:hide",
    },
    "The thesis": {
        "experiment": "pounding.experiments.command.experiment:experiment",
    },
}
"""The verbs as the help shows them; they are imported only when they are called, so that it loads no finite-element code."""

VERBS = {verb: function for verbs in VERBS_BY_PURPOSE.values() for verb, function in verbs.items()}

EXAMPLES = {
    "demo": "pounding demo --out results/demo",
    "list": "pounding list",
    "new-frame": "pounding new-frame office.toml",
    "modal": "pounding modal 15B",
    "shake": "pounding shake 15B --record elcentro-chopra --out results/shake",
    "pound": "pounding pound 15B 5B --gap 8 --record elcentro-chopra --out results/pair",
    "gap": "pounding gap 15B 5B --record elcentro-chopra --report gap.html",
    "opensees": "pounding opensees office.toml office.py",
    "new-street": "pounding new-street street.toml office.toml flats.toml --gap 60",
    "design": "pounding design --tall 39 --short 21 --pga 0.2",
    "mitigate": "pounding mitigate street.toml --record elcentro-chopra --out results/measures",
    "fragility": "pounding fragility street.toml --set fema-p695-farfield",
    "new-case": "pounding new-case run1.csv run2.csv --frame 5A --out case",
    "check-case": "pounding check-case case",
    "diagnose": "pounding diagnose case --out report",
    "hide": "pounding hide coulomb_friction:3 --frame 5A --out case --truth truth.json",
    "experiment": "pounding experiment alone-15B-elcentro --out results",
    "study": "pounding study table-3-1",
}
"""A line to try, by verb; its help ends with it."""


def described(function: str) -> str:
    """Return what the docstring of ``module:function`` says before its arguments, read without importing the module."""
    module, name = function.split(":")
    source = Path(__file__).parents[3].joinpath(*module.split(".")).with_suffix(".py").read_text("utf-8")
    body = ast.parse(source).body
    found = next(node for node in body if isinstance(node, ast.FunctionDef) and node.name == name)
    return (ast.get_docstring(found) or "").split("\n\nArgs:")[0]


def _with_example(verb: str, said: str) -> str:
    return f"{said}\n\nFor example: {EXAMPLES[verb]}"


_groups = {
    purpose: Group(purpose, sort_key=place)
    for place, purpose in enumerate([*VERBS_BY_PURPOSE, "The command"])
}
for _purpose, _verbs in VERBS_BY_PURPOSE.items():
    for _place, (_verb, _function) in enumerate(_verbs.items()):
        _help = _with_example(_verb, described(_function))
        app.command(_function, name=_verb, help=_help, group=_groups[_purpose], sort_key=_place)

study = App(
    name="study",
    help=_with_example("study", "Run a study: a chapter or table of the thesis, or a question of its own."),
    group=_groups["The thesis"],
)
app.command(study)

STUDIES = {
    "frame-mesh": "pounding.experiments.studies.frame_mesh:main",
    "table-3-1": "pounding.experiments.studies.table_3_1:main",
    "laboratory": "pounding.experiments.studies.laboratory:main",
    "engine-accuracy": "pounding.experiments.studies.engine_accuracy:main",
    "engine-body": "pounding.experiments.studies.engine_body:main",
    "figure-4-11": "pounding.experiments.studies.figure_4_11:main",
    "thesis-figures": "pounding.experiments.studies.thesis_figures:main",
    "table-4-1": "pounding.experiments.studies.table_4_1:main",
    "table-4-1-missing": "pounding.experiments.studies.table_4_1_missing:main",
    "missing-in-the-thesis": "pounding.experiments.studies.missing_in_the_thesis:main",
    "strong-motion": "pounding.experiments.studies.strong_motion:main",
    "chapter-4": "pounding.experiments.studies.chapter_4:main",
    "chapter-5": "pounding.experiments.studies.chapter_5:main",
    "chapter-6": "pounding.experiments.studies.chapter_6:main",
    "chapter-7": "pounding.experiments.studies.chapter_7:main",
    "chapter-8": "pounding.experiments.studies.chapter_8:main",
    "sap2000-input": "pounding.experiments.studies.sap2000_input:main",
    "contact-laws": "pounding.experiments.studies.contact_laws:main",
    "contact-accuracy": "pounding.experiments.studies.contact_accuracy:main",
    "campaign-speed": "pounding.experiments.studies.campaign_speed:main",
    "end-and-inner": "pounding.experiments.studies.end_and_inner:main",
    "exact-convergence": "pounding.experiments.studies.exact_convergence:main",
    "modal-diagnosis": "pounding.diagnosis.studies.modal_diagnosis:main",
    "peak-diagnosis": "pounding.diagnosis.studies.peak_diagnosis:main",
    "real-oscillator": "pounding.diagnosis.studies.real_oscillator:main",
}
"""The studies by name; `python -m` and the tests call the same functions."""

for _name, _function in STUDIES.items():
    study.command(_function, name=_name, help=described(_function))

# What the Tab key then runs is the shell alone: it completes without starting Python.
app.register_install_completion_command(
    help="Let the Tab key complete verbs, options and names in this shell.", group=_groups["The command"]
)
for _flag in ("--help", "--version"):
    app[_flag].group = _groups["The command"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command and leave with its exit status.

    Args:
        arguments: The words after ``pounding``; those of the command line when None.

    Raises:
        SystemExit: 2 with one sentence on standard error for invalid input, 130 for Ctrl-C.
    """
    run(app, arguments)
