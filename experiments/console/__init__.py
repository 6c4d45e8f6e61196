"""What all verbs of the command share: their common options, how they show results, and their exit status."""
