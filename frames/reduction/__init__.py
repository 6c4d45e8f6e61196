"""From thousands of coordinates to a few dozen, and back to the plates."""
