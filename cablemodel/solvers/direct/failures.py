"""What the direct solver's status codes mean, and what to do about them."""

from __future__ import annotations

from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.shared import layout as at

MEANING = {
    at.NOT_CONVERGED: (
        "Newton's method does not converge, however short the step",
        "look for a jump in the inputs, give a shorter time_step or node_spacing, "
        "or use method: finite_element",
    ),
    at.SINGULAR: (
        "the equations are singular",
        "give the cable bending stiffness and model: elastica",
    ),
    at.STATICS_FAILED: (
        "the implicit steps towards it do not converge",
        "check weights and current, or start from initial: {straight: ...}",
    ),
    at.NO_CAPACITY: (
        "more nodes are needed than were set aside",
        "give a larger node_spacing",
    ),
    at.NOT_FINITE: ("an input is not finite", "check the inputs"),
    own.SLACK: (
        "a perfectly flexible cable has lost its tension, where its equations are singular",
        "model: elastica, or a longer solver.bending_length for a hybrid",
    ),
    own.SINGULAR_ANGLE: (
        "the cable lies along the axis of its Euler angles (sin theta = 0), whichever way the "
        "axes are turned",
        "use method: finite_element, where no direction is special",
    ),
    own.DRIFT: (
        "the held end has drifted: velocities and angles do not know where it is",
        "use a shorter time_step and node_spacing, or method: finite_element",
    ),
    own.BODY_ON_FLOOR: (
        "the line touches the floor before its end does",
        "direct integration lays cable from its end only: use method: finite_element",
    ),
    own.SHORT_SECTION: (
        "the touchdown point has come to the part above the one that bends",
        "use method: finite_element, or a shorter solver.bending_length",
    ),
    own.USED_UP: (
        "more cable flows out of an interval than is in it, however short the step",
        "look for a jump in the pay-out, or give a larger node_spacing",
    ),
    own.OVERSHOT: (
        "the end goes through the floor, however short the step",
        "give a shorter time_step, or use method: finite_element",
    ),
}


def explain(status: int) -> tuple[str, str]:
    """Problem and advice of a status."""
    return MEANING[status]
