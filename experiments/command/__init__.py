"""The `pounding` command: one module for each verb; nothing is computed here."""

import os
from collections.abc import Sequence

# Thousands of small matrices: threads inside the BLAS only get in the way of our own processes.
# Read when numpy is first imported, so this stands before every other import.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

from pounding.experiments.console.interruption import heeding  # noqa: E402


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command as `pounding.experiments.command.app.main`, and heed Ctrl-C while it is still being imported.

    Args:
        arguments: The words after ``pounding``; those of the command line when None.

    Raises:
        SystemExit: 2 with one sentence on standard error for invalid input, 130 for Ctrl-C.
    """
    with heeding():
        from pounding.experiments.command.app import main as run_command
    run_command(arguments)
