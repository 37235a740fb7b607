"""Random search: a thousand short scenes drawn over all that a scene can ask, each judged."""
