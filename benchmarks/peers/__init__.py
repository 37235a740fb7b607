"""Other simulators, each driven as its own documentation recommends."""
