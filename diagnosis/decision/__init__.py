"""From findings to a verdict: thresholds, checks of the model, and the confidence in it."""
