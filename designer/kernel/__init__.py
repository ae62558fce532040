"""Compiled, batched solvers for robots with at least as many cables as degrees of freedom.

Importing this package imports Numba: do it inside the function that needs it.
"""
