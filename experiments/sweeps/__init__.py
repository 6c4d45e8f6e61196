"""Many cases: a labelled grid goes in, a labelled dataset comes out."""
