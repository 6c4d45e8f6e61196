"""The gap that two frames need so that they do not touch, computed, and beside chapter 4 of the thesis."""
