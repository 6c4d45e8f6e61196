"""Code rules for the separation of adjacent buildings."""
