"""Structural pounding: frames, impact laws, experiments on a shaking table, and the diagnosis of missing effects.

The packages are `pounding.frames`, `pounding.contact`, `pounding.experiments` and `pounding.diagnosis`. In a clone their
sources are the folders of these names beside this one, to which the links here lead.
"""
