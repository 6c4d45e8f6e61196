"""Find the missing effect: where measurements and a model disagree, what is missing, and that it closes the gap."""
