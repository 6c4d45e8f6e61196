"""The pounding tests of the thesis (chapters 5 and 6): its pairs, gaps and laws as cases of a sweep, and their tables."""
