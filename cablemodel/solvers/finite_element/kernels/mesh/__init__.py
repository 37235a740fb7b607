"""Meshes that change: touchdown, bending, sleep, pay-out, bodies that pass, cuts."""
