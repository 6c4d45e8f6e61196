"""Frames and contacts brought together: the shaking table, its records, the studies and the command."""
