"""Worked studies: what the diagnosis says of the thesis' own measurements, whose truth nobody knows."""
