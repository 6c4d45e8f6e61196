"""The folders that a shaking and a collision leave."""
