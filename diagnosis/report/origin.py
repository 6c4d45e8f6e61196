"""Where a report comes from: the software, what it was asked, and the files that it read."""

from __future__ import annotations

import hashlib
import platform
from importlib.metadata import version

import msgspec

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.report.report import File, Origin
from pounding.experiments.results.provenance import stamp

LIBRARIES = ("exudyn", "numpy", "scipy", "numba")


def origin(case: Case) -> Origin:
    """Return where the report on a case comes from."""
    stamped = stamp({})
    frames = [frame.file for frame in case.frames if frame.file is not None]
    paths = [case.folder / "case.toml", *(case.folder / run.file for run in case.runs), *frames]
    return Origin(
        software=stamped["software"],
        version=stamped["version"],
        libraries={name: version(name) for name in LIBRARIES},
        python=platform.python_version(),
        command=f"pounding diagnose {case.folder} --out DIR",
        prior=msgspec.to_builtins(case.prior),
        files=tuple(
            File(name=path.name, sha256=hashlib.sha256(path.read_bytes()).hexdigest())
            for path in paths
            if path.is_file()
        ),
        reference=tuple(run.file for run in case.runs if run.reference),
    )
