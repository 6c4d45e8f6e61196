"""The `pounding` command: one module for each verb; nothing is computed here."""

import os

# Thousands of small matrices: threads inside the BLAS only get in the way of our own processes.
# Read when numpy is first imported, so this stands before every other import.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

from pounding.experiments.command.app import app, main  # noqa: E402

__all__ = ["app", "main"]
