"""Reference solutions that share no code with cablemodel: closed forms, ODEs, a lumped mass chain.

SI units; z up; `s` is unstretched arc length. Each module's numbers are checked against the
published or independently computed ones in `test_references.py`.
"""
