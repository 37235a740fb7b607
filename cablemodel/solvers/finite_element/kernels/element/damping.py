"""Damping by a cable's material: a force D = B d|r'|/dt along it beside the tension T.

Kelvin and Voigt's law. T stays the tension that the strain belongs to, T + D is what the cable
carries. D has the two modes of T, so that what bends within an element damps nothing.

Where limp cable goes slack another B is in use (`limp.py`).
"""

from typing import Any

from cablemodel.solvers.finite_element.kernels.element.tables import (
    D0,
    D1,
    D2,
    D3,
    WEIGHT,
    WEIGHT_P1,
)
from cablemodel.solvers.finite_element.kernels.mesh.payout import rate_words
from cablemodel.solvers.shared.access import (
    edge_of,
    header,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import POINT_WORDS


@inlined
def damped_by(edge, mean, slope):
    """The modes of D in an element [N], by its mean rate of strain, alone and times P1 [1/s]."""
    d0 = edge.damping * mean + edge.damping_01 * slope
    d1 = edge.damping_01 * mean + edge.damping_11 * slope
    return d0, d1


def damping_kernel(dimension: int) -> Any:
    """with_damping for elements of this dimension."""

    @inlined
    def with_damping(points, edge, t0, t1, v0, v1):
        """The modes of T + D in an element, from those of T and the velocities of its ends; points:
        its ElementPoints, with their tangents."""
        if edge.damping != 0.0:
            ih = 1.0 / edge.length
            mean = 0.0
            slope = 0.0
            for g in range(3):
                rate = 0.0
                for i in range(dimension):
                    d = dimension + i
                    along = (v1[i] - v0[i]) * ih * D2[g] + v0[d] * D1[g] + v1[d] * D3[g]
                    rate += points.tangent[POINT_WORDS * i + g] * along
                mean += WEIGHT[g] * rate
                slope += WEIGHT_P1[g] * rate
            d0, d1 = damped_by(edge, mean, slope)
            t0 += d0
            t1 += d1
        return t0, t1

    return with_damping


@inlined
def damp_evenly(edge, damping):
    """Let all of an element be damped so much [N s]: the mean of P1^2 is a third."""
    edge.damping = damping
    edge.damping_01 = 0.0
    edge.damping_11 = 3.0 * damping


@kernel
def strain_rate(I, M, element):
    """Mean of d|r'|/dt over an element of the state, alone and times P1 [1/s]."""
    head = header(I)
    dimension = head.dimension
    h = edge_of(I, M, element).length
    parent = I[head.parent + element]
    q0 = head.position + 2 * dimension * parent
    q1 = head.position + 2 * dimension * element
    v0, _a0 = rate_words(I, M, parent)
    v1, _a1 = rate_words(I, M, element)
    mean = 0.0
    slope = 0.0
    for g in range(3):
        square = 0.0
        product = 0.0
        for i in range(dimension):
            d = dimension + i
            stretched = (M[q0 + i] * D0[g] + M[q1 + i] * D2[g]) / h
            stretched += M[q0 + d] * D1[g] + M[q1 + d] * D3[g]
            rate = (M[v0 + i] * D0[g] + M[v1 + i] * D2[g]) / h
            rate += M[v0 + d] * D1[g] + M[v1 + d] * D3[g]
            square += stretched * stretched
            product += stretched * rate
        mean += WEIGHT[g] * product / square**0.5
        slope += WEIGHT_P1[g] * product / square**0.5
    return mean, slope


@kernel
def damping_in(I, M, element):
    """The modes of D in an element of the state [N], and what it takes from the motion [W/m]."""
    edge = edge_of(I, M, element)
    if edge.damping == 0.0:
        return 0.0, 0.0, 0.0
    mean, slope = strain_rate(I, M, element)
    d0, d1 = damped_by(edge, mean, slope)
    return d0, d1, d0 * mean + d1 * slope


@kernel
def carried(I, M, element):
    """Mean of T + D in an element of the state [N]."""
    d0, _d1, _lost = damping_in(I, M, element)
    return tension_of(I, M, element).mean + d0
