"""A user's own measured histories."""
