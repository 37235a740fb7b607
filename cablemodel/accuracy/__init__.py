"""How accurate a run is, and what accuracy costs: one scene at several tolerances.

``study`` makes the runs, ``deviation`` holds how far they are from the finest one over time and
where that can be judged, ``verdict`` what to conclude, ``converge`` runs until they agree.
"""
