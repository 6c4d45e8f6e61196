"""Find the missing effect: where measurements and a model disagree, what is missing, and how much that explains.

The short way is `diagnose(case_folder) -> Report`. Step by step: `read_case -> Case`, `Model`, `search -> Findings`,
`decide -> Decision`. The names are loaded when they are used, as what stands behind them takes a second to load.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pounding.diagnosis.case.case import Case
    from pounding.diagnosis.case.reading import read_case
    from pounding.diagnosis.decision.decision import Decision
    from pounding.diagnosis.decision.verdict import decide
    from pounding.diagnosis.errors import CaseError
    from pounding.diagnosis.inference.findings import Findings
    from pounding.diagnosis.inference.search import search
    from pounding.diagnosis.model.model import Model
    from pounding.diagnosis.report.reading import read_report
    from pounding.diagnosis.report.report import Report
    from pounding.diagnosis.workflow import diagnose

__all__ = [
    "Case",
    "CaseError",
    "Decision",
    "Findings",
    "Model",
    "Report",
    "decide",
    "diagnose",
    "read_case",
    "read_report",
    "search",
]

_MODULES = {
    "Case": "case.case",
    "CaseError": "errors",
    "Decision": "decision.decision",
    "Findings": "inference.findings",
    "Model": "model.model",
    "Report": "report.report",
    "decide": "decision.verdict",
    "diagnose": "workflow",
    "read_case": "case.reading",
    "read_report": "report.reading",
    "search": "inference.search",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
