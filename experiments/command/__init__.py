"""The `pounding` command: one verb a module, nothing computed here."""

from experiments.command.app import app, main

__all__ = ["app", "main"]
