"""The sea floor: surface, contact, friction, what it remembers."""
