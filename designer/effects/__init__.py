"""Physical effects that a model may lack: one file each, two small functions each.

An effect changes the machine (exit points moved, a softer cable) or a reading (a scale, a bias).
"""
