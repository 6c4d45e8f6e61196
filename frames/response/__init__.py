"""How a reduced frame moves: exact linear response, modes, laboratory tests and stresses.

`body` puts a reduced frame into exudyn, for runs that are not linear.
"""
