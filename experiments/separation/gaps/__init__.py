"""Gaps that pairs of frames need, beside the thesis' chapter 4."""
