"""Model reduction: from the thousands of coordinates of the finite elements to a few dozen (Craig-Bampton).

`reduced_frame` is the result, which everything else works with; `recovery` leads back to the plates' displacements and
stresses.
"""
