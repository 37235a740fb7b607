"""Point bodies, rigid bodies, free bodies, vessels, and what clamps a line to them."""
