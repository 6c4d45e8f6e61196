"""What a reduced frame does: exact response, laboratory tests, stresses, and its body in exudyn."""
