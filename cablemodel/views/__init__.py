"""Pictures of runs: plots, animations, the report."""
