"""The method of Sun & Leonard 1998: implicit steps in time, initial value problems along the cable.

An independent second solver of the same scenes, see docs/theory.md.
"""
