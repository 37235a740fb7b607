"""The line as a system of equations, and how it is solved."""
