"""From a model and measurements to findings: likelihood, calibration, evidence and the search over effects."""
