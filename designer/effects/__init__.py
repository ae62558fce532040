"""Physical effects that a model may lack, a file for each family.

An effect changes the machine (exit points moved, a softer cable) or a reading (a scale, a bias).
"""
