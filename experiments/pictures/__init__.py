"""Plots, scenes, films and VTK series of runs."""
