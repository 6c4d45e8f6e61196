"""Hidden cases: another, richer simulator of shaken frames, on which the diagnosis is judged.

Nothing here knows how the diagnosis describes an effect: the frames are beam-columns instead of shells,
the integration is an exponential one, and friction, hysteresis, damping and sensors have laws of their own.
"""
