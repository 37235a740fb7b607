"""Numba kernels of the direct solver: the rules are those of the finite elements."""
