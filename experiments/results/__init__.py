"""A run as a labelled dataset with its provenance."""
