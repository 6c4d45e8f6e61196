"""The model of the measured frames: storeys, observations, nuisance parameters, prediction, and its exudyn twin."""
