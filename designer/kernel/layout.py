"""How the arrays of a block are laid out: every row has one number for each lane."""

from __future__ import annotations

LANES = 128
"""Poses of a block. All of them go through each step together, so that the loops vectorise."""

# Rows of a cable: pull, length, squared horizontal distance, vector to the exit point, lever.
P, L, X2, EX, EY, D, RX, RY, RZ = range(9)
# Linear functions of the step in p: upward pull, top tension, change of length.
V, V_P, T, T_P, L_0, L_P = range(9, 15)
MASSLESS = 15
CABLE_ROWS = 16

# Rows of a pose: load (6), inverse weight and its goal, largest relative step.
LOAD, C, GOAL, STEP = 0, 6, 7, 8
# What is left of the balance (6), its scales of force and length, and the figures of merit.
REST, SCALE, REACH = 9, 15, 16
CLOSURE, RESIDUAL, OVERLOAD, LOWEST, HIGHEST, PULL = range(17, 23)
POSE_ROWS = 23

# Last axis of the results of a cable, and of a pose.
LENGTH, FORCE_X, FORCE_Z = range(3)
WEIGHT, CLOSURE_ERROR, BALANCE_ERROR, LOAD_FACTOR, MASSLESS_TENSION = range(5)
