"""Statistics of runs, and sweeps over parameters."""
