"""How many small motions of a system about a state grow, whether they swing or not.

Its slow motions, coupled by damping and lift, tell (modal flutter analysis; see
cablemodel/systems/stability.py). They lie nearly all in the space that (K + M g/L)^-1 M and
(K + M g/L)^-1 C make of a few motions (Z. Bai and Y. Su, SIAM J. Matrix Anal. Appl. 26 (2005) 640).
K is whole there, and C has a part: else motions lack what the others give way by, and some seem to
grow that do not. In that space M is 1, and q'' + C q' + K q = 0 has a matrix of a few rows; the
trace of its sign says how many of its eigenvalues have a real part above a rate.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.body_clamps import clamp_of_motion
from cablemodel.solvers.finite_element.kernels.element.tables import SLOW_DAMPING
from cablemodel.solvers.finite_element.kernels.line.block_solver import solve_parts
from cablemodel.solvers.finite_element.kernels.line.closures import close_increment
from cablemodel.solvers.finite_element.kernels.line.inertia import (
    lift_pressed,
    make_symmetric,
    negative_eigenvalues,
)
from cablemodel.solvers.finite_element.kernels.line.system import (
    assemble_here,
    constrain_vector,
    factor_assembled,
)
from cablemodel.solvers.shared.access import closure_of, free_body_of, header, scalars
from cablemodel.solvers.shared.compile import kernel, outlined, view
from cablemodel.solvers.shared.layout import JOINT_BODY, JOINT_NONE, MOTIONS
from cablemodel.solvers.shared.numbers import NO_SIZE

BESIDE = 3  # motions from which the space is made: as many may be alike
SAME_MOTION = 1e-8  # of a motion: what is left of one that the others make up
EVEN_SPREAD = 0.6180339887498949  # multiples of it are spread evenly over 0 ... 1


@kernel
def matrix_words(I):
    """Words of one matrix: of each node its own block, its parent's row and its own."""
    head = header(I)
    return 12 * head.dimension * head.dimension * head.nodes


@kernel
def work_words(I):
    """Words that `count_swinging` needs."""
    return 3 * matrix_words(I) + 6 * header(I).nodes * (MOTIONS + 2) + 12 * MOTIONS * MOTIONS


@outlined
def assemble_into(I, M, cv, ca, less, share, out):
    """Out of a matrix K + cv C + ca M another one, times a share."""
    head = header(I)
    assemble_here(I, M, cv, ca)
    area = 4 * head.dimension * head.dimension * head.nodes
    for part in range(3):
        start = head.diagonal if part == 0 else head.upper if part == 1 else head.lower
        for n in range(area):
            out[area * part + n] = share * (M[start + n] - less[area * part + n])


@kernel
def largest_of(I, A):
    """The largest entry of a matrix's diagonal."""
    head = header(I)
    size = 2 * head.dimension
    largest = 0.0
    for n in range(size * head.nodes):
        largest = max(largest, abs(A[size * n + n % size]))
    return largest


@outlined
def find_matrices(I, M, stiffness, damping, mass):
    """Stiffness, damping and mass over all nodes' places and slopes, each with what ties a node to
    its parent; tension is condensed out, what holds nodes left out. The matrix is used up."""
    for n in range(matrix_words(I)):
        stiffness[n] = 0.0
    assemble_into(I, M, 0.0, 0.0, stiffness, 1.0, stiffness)
    stiffest = largest_of(I, stiffness)
    for part in range(2):
        out = mass if part == 0 else damping
        ca = 1.0 if part == 0 else 0.0
        assemble_into(I, M, 1.0 - ca, ca, stiffness, 1.0, out)
        # A large factor keeps it from drowning in the stiffness.
        factor = max(1.0, stiffest / max(largest_of(I, out), NO_SIZE))
        if part == 1 and header(I).free_count != 0:
            factor = min(factor, SLOW_DAMPING)
        assemble_into(I, M, factor * (1.0 - ca), factor * ca, stiffness, 1.0 / factor, out)


@kernel
def put_matrix(I, M, a, A, b, B):
    """Make the matrix that has been assembled a A + b B, but for what bodies' arms keep in it."""
    head = header(I)
    area = 36 * head.nodes
    for node in range(head.nodes):
        joint = I[head.joint + node]
        tied = node > 0 and (joint == JOINT_NONE or joint == JOINT_BODY)
        for n in range(36 * node, 36 * node + 36):
            M[head.diagonal + n] = a * A[n] + b * B[n]
            if tied:
                M[head.upper + n] = a * A[area + n] + b * B[area + n]
                M[head.lower + n] = a * A[2 * area + n] + b * B[2 * area + n]


@outlined
def add_product(I, A, area, x, out):
    """out += A x in space; A: of each node its own block, and `area` words on what ties its parent
    to it, and it to its parent."""
    head = header(I)
    for node in range(head.nodes):
        joint = I[head.joint + node]
        tied = node > 0 and (joint == JOINT_NONE or joint == JOINT_BODY)
        own = 6 * node
        above = 6 * I[head.parent + node] if tied else own
        for i in range(6):
            for j in range(6):
                at = 36 * node + 6 * i + j
                out[own + i] += A[at] * x[own + j]
                if tied:
                    out[above + i] += A[area + at] * x[own + j]
                    out[own + i] += A[2 * area + at] * x[above + j]


@kernel
def multiply(I, M, A, x, stiffness, out):
    """out = A x; stiffness: A is that, and clamps at bodies have a part in it."""
    head = header(I)
    for n in range(6 * head.nodes):
        out[n] = 0.0
    add_product(I, A, 36 * head.nodes, x, out)
    if not stiffness:
        return
    for n in range(head.closure_count):
        row = closure_of(I, M, n)
        if row.clamp == 0.0 or row.node < 0.0:
            continue
        at = 6 * int(row.node) + 3
        to = 6 * int(free_body_of(I, M, int(row.body)).node) + 3
        for i in range(3):
            moment = row.stiffness * clamp_of_motion(I, M, row, i, x)
            for j in range(3):
                out[at + j] -= moment * row.slopes[3 * i + j]
                out[to + j] -= moment * row.follows[3 * i + j]


@outlined
def give_way(I, M, x):
    """What the matrix that is factored gives way by to forces x, in place; gaps stay closed."""
    head = header(I)
    constrain_vector(I, M, x)
    solve_parts(I, M, x)
    if head.closure_count != 0:
        for n in range(head.closure_count):
            row = closure_of(I, M, n)
            for i in range(3):
                row.gap[i] = 0.0
        close_increment(I, M, x)


@outlined
def dot(x, y):
    """Inner product of vectors of one length."""
    total = 0.0
    for n in range(len(x)):
        total += x[n] * y[n]
    return total


@outlined
def add_motion(I, M, mass, basis, found, x, y):
    """Add what x has beside the motions that were found, of the inertia 1; returns how many there
    are. y: room for one more."""
    count = len(x)
    multiply(I, M, mass, x, False, y)
    whole = dot(x, y)
    for _again in range(2):
        for n in range(found):
            other = view(basis, count * n, count)
            share = dot(other, y)
            for k in range(count):
                x[k] -= share * other[k]
        multiply(I, M, mass, x, False, y)
    square = dot(x, y)
    if not square > SAME_MOTION * SAME_MOTION * whole:
        return found
    own = view(basis, count * found, count)
    size = math.sqrt(square)
    for k in range(count):
        own[k] = x[k] / size
    return found + 1


@kernel
def find_motions(I, M, mass, damping, basis, x, y):
    """Motions of the inertia 1 in which the slow ones lie; returns how many."""
    count = len(x)
    found = 0
    done = 0
    for start in range(BESIDE):
        for k in range(count):
            part = EVEN_SPREAD * (k + 1) * (start + 1)
            x[k] = part - math.floor(part) - 0.5
        give_way(I, M, x)
        found = add_motion(I, M, mass, basis, found, x, y)
    while done < 2 * found and found < MOTIONS:
        pulled_by = mass if done % 2 == 0 else damping
        multiply(I, M, pulled_by, view(basis, count * (done // 2), count), False, x)
        done += 1
        give_way(I, M, x)
        found = add_motion(I, M, mass, basis, found, x, y)
    return found


@outlined
def count_swinging(I, M, rate, work):
    """Of small motions about a system's state how many grow faster than a rate [1/s]; -1: the
    matrix is singular. Tensions and matrix are used up. work: room for `work_words`, of which the
    first ones become the motions that are coupled (at most MOTIONS, nodes, 6); others stay."""
    head = header(I)
    state = scalars(M)
    count = 6 * head.nodes
    words = matrix_words(I)
    basis = view(work, 0, MOTIONS * count)
    x = view(work, MOTIONS * count, count)
    y = view(work, (MOTIONS + 1) * count, count)
    start = (MOTIONS + 2) * count
    stiffness = view(work, start, words)
    damping = view(work, start + words, words)
    mass = view(work, start + 2 * words, words)
    small = view(work, start + 3 * words, 12 * MOTIONS * MOTIONS)
    lift_pressed(I, M)
    find_matrices(I, M, stiffness, damping, mass)
    # The symmetric part of the mass, and the matrix of the motions.
    put_matrix(I, M, 1.0, mass, 0.0, mass)
    make_symmetric(I, M)
    area = 36 * head.nodes
    for part in range(3):
        own = head.diagonal if part == 0 else head.upper if part == 1 else head.lower
        for n in range(area):
            mass[area * part + n] = M[own + n]
    put_matrix(I, M, 1.0, stiffness, 1.0 / (state.period * state.period), mass)
    if factor_assembled(I, M) != 0:
        return -1
    found = find_motions(I, M, mass, damping, basis, x, y)
    return count_coupled(I, M, rate, stiffness, damping, basis, found, small, y)


@kernel
def count_coupled(I, M, rate, stiffness, damping, basis, found, small, y):
    """Of motions that are coupled how many grow faster than a rate [1/s]."""
    count = len(y)
    size = 2 * found
    S = view(small, 0, size * size)  # of (q, q' / w), w = sqrt(g/L), negative
    w = 1.0 / scalars(M).period
    for n in range(size * size):
        S[n] = 0.0
    for j in range(found):
        own = view(basis, count * j, count)
        for part in range(2):
            multiply(I, M, stiffness if part == 0 else damping, own, part == 0, y)
            for i in range(found):
                value = dot(view(basis, count * i, count), y)
                S[size * (found + i) + found * part + j] = value if part == 1 else value / w
        S[size * j + found + j] = -w
    for k in range(size):
        S[size * k + k] += rate
    return negative_eigenvalues(
        S, size, view(small, size * size, size * size), view(small, 2 * size * size, size * size)
    )
