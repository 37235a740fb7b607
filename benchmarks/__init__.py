"""Run time against error: cablemodel, its peers, and what each scene asks for.

``python -m benchmarks`` measures and writes ``docs/benchmarks.md``;
``python -m benchmarks.robustness`` runs the stress matrix and writes ``docs/stress.md``.
"""
