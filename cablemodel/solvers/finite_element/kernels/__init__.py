"""Numerical kernels: one source, compiled just in time for Python, ahead of time for the FMU."""
