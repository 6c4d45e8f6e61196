"""A second world in which effects are hidden: plane frames of beam-columns in OpenSees, with the laws of its materials.

OpenSees is for development only and no dependency: `domain.py` alone touches it, and refuses in one sentence
where it is not installed.
"""
