"""The thesis' pounding tests as cases for sweeps, and their tables."""
