"""Many records: how likely two floors touch, or a limit is passed, at an intensity of the shaking."""
