"""Evidence: results of the simulator beside measurements, other programs and closed forms.

`python -m validation` writes docs/validation/ (rows and pictures) and the tables of
docs/validation.md. Nothing here is fitted to what it is compared with.
"""
