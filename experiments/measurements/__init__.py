"""A user's own measured histories: what a channel may measure, in which units, and reading them from CSV."""
