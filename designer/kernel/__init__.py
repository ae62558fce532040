"""Compiled, batched Newton solver for robots with as many cables as degrees of freedom.

Importing this package imports Numba: do it inside the function that needs it.
"""
