"""What the finite elements' status codes mean, and what to do about them."""

from __future__ import annotations

from cablemodel.solvers.shared import layout as at

_FOLDS = "slack cable with little bending stiffness, or none"

MEANING = {
    at.NOT_CONVERGED: (
        "no step was small enough for Newton's method to converge",
        f"look for a jump in the inputs, a stiffness far from the others, or {_FOLDS}, on the "
        "floor: give it more",
    ),
    at.TOO_MANY_STEPS: (
        "the step needs more internal steps than allowed",
        "ask for a shorter step or a looser tolerance",
    ),
    at.STALLED: (
        "the cable moves ever quicker: thousands of internal steps in a row were shorter than "
        "1e-5 sqrt(L/g)",
        f"{_FOLDS}, folds so: give it more",
    ),
    at.SINGULAR: ("the equations are singular", "give the cable bending stiffness"),
    at.NO_CAPACITY: (
        "more elements are needed than there is memory for",
        "ask for a looser tolerance",
    ),
    at.OVERSTRETCHED: (
        f"the cable would be stretched to more than {1.0 + at.LARGEST_STRAIN:g} times its length",
        "look for a jump in the inputs",
    ),
    at.NOT_FINITE: ("an input is not finite", "check the inputs"),
}
