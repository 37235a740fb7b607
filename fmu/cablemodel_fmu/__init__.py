"""The cable as a Functional Mock-up Unit (FMI 2.0 co-simulation) that needs no Python.

`build` compiles the kernels ahead of time into one shared library a platform; `export` packs a
scene with these libraries into an FMU.
"""
