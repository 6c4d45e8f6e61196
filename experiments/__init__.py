"""Frames and contacts brought together: the shaking table, its records, the studies and the command.

`records` reads ground motions, `rig` shakes frames and lets them collide, `results` labels what a run gave, `sweeps` runs
many cases, `studies` repeats the thesis', and `command` is what a user types.
"""
