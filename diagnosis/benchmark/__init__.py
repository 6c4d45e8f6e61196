"""What the diagnosis is worth: a drawn set of hidden cases, judged by their truth, and rivals on the same."""
