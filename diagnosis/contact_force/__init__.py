"""Pairs of frames: the force cell, contact forces found from the motion, and what single impacts say."""
