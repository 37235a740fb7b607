"""A clamped tow point past which cable runs: a spring that turns the cable's slope.

Elements at a tow point where nothing runs resolve the layer of thickness sqrt(EI/T) in which a
clamped cable bends, and their slope there is prescribed. Where cable runs they begin, hinged, at
the end of the layer (`clamp_layer.py`). Where that has no room their slope is turned towards the
clamp's direction with the energy of a layer, 4 k (1 - cos(angle/2)), k being the layer's
sqrt(EI T), or what of it the element does not resolve (`rigid.clamp_stiffness`). A perfectly
flexible cable passes no moment: k = 0. Nor does a clamp hold a body of finite length that passes.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.body_clamps import update_body_clamps
from cablemodel.solvers.finite_element.kernels.bodies.clamp_layer import share_of_layer
from cablemodel.solvers.finite_element.kernels.bodies.rigid import (
    clamp_stiffness,
    stiffen_gently,
    update_clamps,
)
from cablemodel.solvers.finite_element.kernels.bodies.slopes import half_cosine, slope_direction
from cablemodel.solvers.shared.access import (
    constraint_of,
    edge_of,
    header,
    scalars,
    tension_of,
    vector,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.layout import (
    BY_SPRING,
    EXACTLY,
)


@kernel
def clamp_spring(I, M):
    """Stiffness of the clamp [N m]; 0 where there is none."""
    row = constraint_of(I, M, 0)
    if row.clamped != BY_SPRING or winch_of(I, M, 0).passing_body != 0.0:
        return 0.0
    return row.spring


@kernel
def slope_at_vessel(I, M, q, cable):
    """Direction of the slope into `cable`; (its length, cosine of its angle with the clamp's)."""
    dimension = header(I).dimension
    return slope_direction(dimension, q, dimension, constraint_of(I, M, 0).direction, cable)


@kernel
def add_clamp_moment(I, M, q, out):
    """Add minus the clamp's force on the slope to the forces of the vessel's node."""
    head = header(I)
    k = clamp_spring(I, M)
    if k == 0.0:
        return
    dimension = head.dimension
    clamp = constraint_of(I, M, 0).direction
    cable = vector()
    length, cosine = slope_at_vessel(I, M, q, cable)
    force = k / (length * half_cosine(cosine))
    for i in range(dimension):
        out[dimension + i] -= force * (clamp[i] - cosine * cable[i])


@kernel
def add_clamp_tangent(I, M, q):
    """Add its derivative to the vessel node's block of the Newton matrix."""
    head = header(I)
    k = clamp_spring(I, M)
    if k == 0.0:
        return
    dimension = head.dimension
    size = 2 * dimension
    clamp = constraint_of(I, M, 0).direction
    cable = vector()
    length, cosine = slope_at_vessel(I, M, q, cable)
    half = half_cosine(cosine)
    first = k / (length * length * half)
    second = 0.25 * first / (half * half)
    for i in range(dimension):
        for j in range(dimension):
            unit = 1.0 if i == j else 0.0
            value = cable[i] * clamp[j] + clamp[i] * cable[j]
            value += cosine * (unit - 3.0 * cable[i] * cable[j])
            at = head.diagonal + size * (dimension + i) + dimension + j
            across = (clamp[i] - cosine * cable[i]) * (clamp[j] - cosine * cable[j])
            M[at] += first * value + second * across


@kernel
def clamp_energy(I, M, q):
    """What the spring holds [J]."""
    k = clamp_spring(I, M)
    if k == 0.0:
        return 0.0
    _length, cosine = slope_at_vessel(I, M, q, vector())
    return 4.0 * k * (1.0 - half_cosine(cosine))


@kernel
def update_springs(I, M, share):
    """Stiffness of all clamps by the tensions, of which `share` is the present one."""
    head = header(I)
    state = scalars(M)
    if head.rigid > 0:
        update_clamps(I, M, share)
    if head.closure_count != 0:
        update_body_clamps(I, M, share)
    row = constraint_of(I, M, 0)
    if row.clamped != BY_SPRING:
        return
    if winch_of(I, M, 0).passing_body != 0.0:
        row.share = 0.0
        return
    tension = tension_of(I, M, 1).mean - tension_of(I, M, 1).slope
    before = state.clamp_tension
    state.clamp_tension += share * (tension - before)
    edge = edge_of(I, M, 1)
    row.share = share_of_layer(I, M)
    target = clamp_stiffness(M, edge, state.clamp_tension, edge.length, False)
    part = row.share
    if part == 1.0:
        target = 0.0
    elif part > 0.0 and target > 0.0:
        # What the element has of the layer's stiffness, and this in series, are what is left of it.
        layer = math.sqrt(edge.bending_full * row.layer_tension)
        target = 1.0 / (1.0 / target + part / ((1.0 - part) * layer))
    k = row.spring
    if target > k:
        q = M[head.position : head.position + 2 * head.dimension]
        _length, cosine = slope_at_vessel(I, M, q, vector())
        bend = 4.0 * (1.0 - half_cosine(cosine))
        target = stiffen_gently(M, k, target, state.clamp_tension, before, bend, share)
    row.spring = target


@kernel
def release_slope(I, M):
    """Cable begins to run past the tow point: from now on a spring holds what was prescribed."""
    head = header(I)
    row = constraint_of(I, M, 0)
    if row.clamped == EXACTLY:
        row.clamped = BY_SPRING
        update_springs(I, M, 1.0)
        head.factored = 0
        head.has_history = 0
