"""The catalogue of effects that may be missing, rivals outside it, and the user's own."""
