"""Small motions with names, inputs and outputs; exact derivatives of a step."""
