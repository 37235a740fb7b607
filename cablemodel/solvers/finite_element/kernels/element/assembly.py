"""Residual and Jacobian of a whole line, of elements in a plane or in space.

What differs between the two are the forces at the Gauss points and their derivatives.
"""

from typing import Any

from cablemodel.solvers.finite_element.kernels.element.element_pairs import (
    ELEMENT_OF,
    PAIR_WORDS,
    invert_compliance,
    strain_missed,
    third_tension,
)
from cablemodel.solvers.finite_element.kernels.element.stretch import take_rests
from cablemodel.solvers.finite_element.kernels.element.tables import (
    LINES_D,
    LINES_DE,
    LINES_H,
    LINES_HD,
    MASS_PAIRS,
)
from cablemodel.solvers.finite_element.kernels.line.products import table_product
from cablemodel.solvers.finite_element.kernels.water.shear import add_shear
from cablemodel.solvers.finite_element.kernels.water.waves import (
    element_water,
    wave_loads,
    wet_rows,
)
from cablemodel.solvers.shared.access import (
    compliance_of,
    edge_of,
    element_points,
    header,
    scalars,
)
from cablemodel.solvers.shared.compile import kernel, view

_product_d = table_product(LINES_D)
_product_de = table_product(LINES_DE)
_product_h = table_product(LINES_H)
_product_hd = table_product(LINES_HD)


def residual_kernel(
    dimension: int,
    geometry: Any,
    element_current: Any,
    with_damping: Any,
    axial_forces: Any,
    add_bending_forces: Any,
    load_forces: Any,
    add_forces: Any,
) -> Any:
    """residual(I, M, q, v, a, tension, out, out_constraint) of all elements.

    The others: kernels that write what stands at an element's Gauss points (ElementPoints), and add
    what comes of that to the nodes.
    """
    size = 2 * dimension

    @kernel
    def residual(I, M, q, v, a, tension, out, out_constraint):
        """Forces conjugate to (r, d), (nodes, 2, dimension), and constraint residuals, (nodes, 2).

        out is set to zero first; residual = inertia + internal forces - loads, so the force that a
        support must exert is the residual at its node.
        """
        head = header(I)
        points = element_points(I, M, 0)
        nodes = head.nodes
        drag = head.drag
        sheared = head.depth_count > 1
        waves = head.wave_count
        ends = view(M, head.end_force, size * nodes)
        joints = view(I, head.joint, nodes)
        parents = view(I, head.parent, nodes)
        out[0 : size * nodes] = 0.0
        for node in range(1, nodes):
            if joints[node] != 0:
                out_constraint[2 * node] = 0.0
                out_constraint[2 * node + 1] = 0.0
                continue
            parent = parents[node]
            edge = edge_of(I, M, node)
            h = edge.length
            bending = edge.bending
            x0 = view(q, size * parent, size)
            x1 = view(q, size * node, size)
            v0 = view(v, size * parent, size)
            v1 = view(v, size * node, size)
            a0 = view(a, size * parent, size)
            a1 = view(a, size * node, size)
            geometry(points, x0, x1, h)
            t0 = tension[2 * node]
            t1 = tension[2 * node + 1]
            pull0, pull1 = with_damping(points, edge, t0, t1, v0, v1)
            axial_forces(points, pull0, pull1, third_tension(points, edge))

            r0, r1 = strain_missed(M, points, edge, t0, t1)
            out_constraint[2 * node] = h * r0
            out_constraint[2 * node + 1] = h * r1

            if bending != 0.0:
                add_bending_forces(points, x0, x1, h, bending)
            if waves != 0:
                wave_loads(I, M, points, edge, x0, x1, v0, v1, a0, a1)
            elif drag != 0:
                if sheared:
                    element_current(I, M, points, x0, x1, h)
                load_forces(
                    points,
                    v0,
                    v1,
                    a0,
                    a1,
                    h,
                    edge.drag_normal,
                    edge.drag_tangential,
                    edge.added_mass,
                )

            add_forces(
                points,
                edge,
                a0,
                a1,
                drag,
                view(out, size * parent, size),
                view(out, size * node, size),
                view(ends, size * node, size),
            )
        if scalars(M).stiffened != 0.0:
            take_rests(I, M, out_constraint)

    return residual


def jacobian_kernel(
    dimension: int,
    geometry: Any,
    element_current: Any,
    with_damping: Any,
    tangent_matrices: Any,
    pairs: tuple[Any, Any, Any, Any],
) -> Any:
    """jacobian(I, M, q, v, a, tension, ca, cv) of all elements.

    tangent_matrices writes the rows of A11, A12, A21, A22, A00 and A01 at the Gauss points (see
    PlanarElement and SpatialElement). pairs: of `pair_kernels`.
    """
    size = 2 * dimension
    area = size * size
    words = 4 * size
    row = PAIR_WORDS[dimension]
    element_of = ELEMENT_OF[dimension]
    constraint_gradient, add_tension, combine, scatter = pairs

    @kernel
    def jacobian(I, M, q, v, a, tension, ca, cv):
        """Blocks of d residual/d q + cv d residual/d v + ca d residual/d a, T condensed out.

        Fills, for every element, its share of the diagonal blocks of both nodes, the two
        off-diagonal blocks, the gradient B of its constraint (2, 4 dimension) and the inverse of
        the compliance (3).
        """
        head = header(I)
        work = element_of(I, M, 0)
        points = work.points
        nodes = head.nodes
        drag = head.drag
        sheared = head.depth_count > 1
        waves = head.wave_count
        diagonal = view(M, head.diagonal, area * nodes)
        upper = view(M, head.upper, area * nodes)
        lower = view(M, head.lower, area * nodes)
        joints = view(I, head.joint, nodes)
        parents = view(I, head.parent, nodes)
        diagonal[:] = 0.0
        for node in range(1, nodes):
            if joints[node] != 0:
                continue
            parent = parents[node]
            edge = edge_of(I, M, node)
            h = edge.length
            bending = edge.bending
            x0 = view(q, size * parent, size)
            x1 = view(q, size * node, size)
            a0 = view(a, size * parent, size)
            a1 = view(a, size * node, size)
            v0 = view(v, size * parent, size)
            v1 = view(v, size * node, size)
            geometry(points, x0, x1, h)
            if waves != 0:
                element_water(I, M, points, edge, x0, x1)
            elif drag != 0 and sheared:
                element_current(I, M, points, x0, x1, h)
            t0 = tension[2 * node]
            t1 = tension[2 * node + 1]
            eas = edge.stabilisation
            pull0, pull1 = with_damping(points, edge, t0, t1, v0, v1)
            tangent_matrices(
                work,
                x0,
                x1,
                v0,
                v1,
                a0,
                a1,
                h,
                pull0,
                pull1,
                third_tension(points, edge),
                bending,
                drag,
                edge.drag_normal,
                edge.drag_tangential,
                edge.added_mass,
                ca,
                cv,
            )

            # Gradient of the constraints, and the compliance.
            constraint_gradient(work, h, view(M, head.gradient + words * node, words))
            stiffness = compliance_of(I, M, node)
            s00, s01, s11 = invert_compliance(M, edge, t0, t1, stiffness)
            s22 = 5.0 * eas / h
            s00 += cv * edge.damping / h
            s01 += cv * edge.damping_01 / h
            s11 += cv * edge.damping_11 / h

            if waves != 0:
                wet_rows(I, M, points, edge, work.motion_rows, work.mixed_rows, row, ca)
            elif drag != 0 and sheared:
                add_shear(I, M, points, edge, work.motion_rows, row, x0, x1, v0, v1)
            if bending != 0.0:
                _product_de(work.slope_sums, work.slope_rows, row)
            else:
                _product_d(work.slope_sums, work.slope_rows, row)
            add_tension(work, s00, s01, s11, s22)
            if drag != 0:
                _product_h(work.motion_sums, work.motion_rows, row)
                _product_hd(work.mixed_sums, work.mixed_rows, row)
            else:
                for n in range(10 * row):
                    work.motion_sums[n] = 0.0
                for n in range(12 * row):
                    work.mixed_sums[n] = 0.0
            mass = ca * edge.mass * h
            for n in range(10):
                for i in range(dimension):
                    work.motion_sums[row * n + (dimension + 1) * i] += mass * MASS_PAIRS[n]
            combine(work, h)
            scatter(
                work,
                view(diagonal, area * parent, area),
                view(upper, area * node, area),
                view(lower, area * node, area),
                view(diagonal, area * node, area),
            )

    return jacobian
