"""How the command shows results and leaves with an exit status."""
