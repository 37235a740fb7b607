"""How many small motions about a state grow faster than a rate: Sylvester's law of inertia.

About an equilibrium they obey M q'' + C q' + K q = 0, and as many of them grow by exp(l t) with l
above a rate r as the pivots of A(r) = r^2 M + r C + K have negative eigenvalues; see
cablemodel/solvers/finite_element/stability.py. Where A is not symmetric those with a negative real
part are counted: of a pivot P of n unknowns (n - trace(sign P)) / 2, with sign P the limit of
X <- (X + X^-1) / 2 from P (J. D. Roberts, Int. J. Control 32 (1980) 677).

In a system the symmetric part of A is looked at. Ends that closures hold are free in the tree: with
S = G K^-1 G^T of n closures' forces, all motions that leave their gaps closed have as many negative
ones as K and -S have together, less n.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import promised_tension
from cablemodel.solvers.finite_element.kernels.line.closures import column_word
from cablemodel.solvers.finite_element.kernels.line.system import (
    assemble_here,
    factor_assembled,
)
from cablemodel.solvers.shared.access import closure_of, edge_of, header
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, own_numbers, view
from cablemodel.solvers.shared.layout import (
    JOINT_ARM,
    JOINT_BODY,
    JOINT_FREE,
    JOINT_HINGE,
    JOINT_NONE,
)

SIGN_ROUNDS = 100  # of the iteration to a sign: twenty where a real part is 1e-6 of the imaginary
SIGN_CALM = 1e-8  # relative change of what has come to it
SIGN_NEAR = 0.1  # the same below which nothing needs to be scaled any more
BALANCINGS = 4  # of rows and columns: blocks of stiff cable hold places and slopes
STABILISED = 1e-3  # of the stabilisation of slack elements: from 1e-4 to 1e-2 starts are told alike

own_block = own_numbers(36)
"""own_block(): zeros, a block of the matrix of nodes."""


@inlined
def is_hinge(I, node):
    """Whether only the slope of a node is its own in the elimination."""
    joint = I[header(I).joint + node]
    return joint == JOINT_HINGE or joint == JOINT_ARM or joint == JOINT_FREE


@kernel
def is_held(I, M):
    """Whether the matrix that is factored has no negative pivot: their symmetric parts say so."""
    head = header(I)
    size = 2 * head.dimension
    work = own_block()
    for node in range(head.nodes):
        D = view(M, head.diagonal + size * size * node, size * size)
        hinge = is_hinge(I, node)
        if hinge or head.rigid > 0:
            for k in range(size // 2 if hinge else 0, size):
                if D[size * k + k] <= 0.0:
                    return False
            continue
        # The inverse of the node's block is kept: it has as many negative pivots.
        for i in range(size):
            for j in range(size):
                work[size * i + j] = D[size * i + j]
        if not is_positive(work, size):
            return False
    return True


@outlined
def is_positive(P, size):
    """Whether the symmetric part of a block is positive definite; the block is used up."""
    for i in range(size):
        for j in range(i + 1):
            P[size * i + j] = 0.5 * (P[size * i + j] + P[size * j + i])
            P[size * j + i] = P[size * i + j]
    for k in range(size):
        pivot = P[size * k + k]
        if not pivot > 0.0:
            return False
        for i in range(k + 1, size):
            factor = P[size * i + k] / pivot
            for j in range(k + 1, size):
                P[size * i + j] -= factor * P[size * k + j]
    return True


@kernel
def take_pivot(I, M, node, P):
    """A node's pivot, or its inverse or transpose, which have as many negative eigenvalues, into P.
    Returns its size: of a node at a hinge it is that of its slope."""
    head = header(I)
    size = 2 * head.dimension
    D = view(M, head.diagonal + size * size * node, size * size)
    hinge = is_hinge(I, node)
    first = size // 2 if hinge else 0
    count = size - first
    for i in range(count):
        for j in range(count):
            value = D[size * (first + i) + first + j]
            if hinge or head.rigid > 0:  # the factors L and U, of which U's pivots are inverse
                value = 0.0
                for k in range(min(i, j) + 1):
                    right = D[size * (first + k) + first + j]
                    if k == j:
                        right = 1.0 / right
                    value += right if k == i else D[size * (first + i) + first + k] * right
            P[count * i + j] = value
    return count


@kernel
def balance(P, size):
    """Make rows and columns of a block alike in size; eigenvalues stay."""
    for _round in range(BALANCINGS):
        for k in range(size):
            row = 0.0
            column = 0.0
            for i in range(size):
                if i != k:
                    row += abs(P[size * k + i])
                    column += abs(P[size * i + k])
            if row > 0.0 and column > 0.0:
                factor = math.sqrt(row / column)
                for i in range(size):
                    P[size * k + i] /= factor
                    P[size * i + k] *= factor


@kernel
def invert_pivoting(A, B, size):
    """B = A^-1 by Gauss-Jordan with pivots; A is used up. Returns log |det A|, inf if there is
    none."""
    determinant = 0.0
    for i in range(size):
        for j in range(size):
            B[size * i + j] = 1.0 if i == j else 0.0
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(A[size * i + k]) > abs(A[size * best + k]):
                best = i
        pivot = A[size * best + k]
        if not abs(pivot) > 0.0:
            return math.inf
        determinant += math.log(abs(pivot))
        for j in range(size):
            a = A[size * best + j] / pivot
            b = B[size * best + j] / pivot
            A[size * best + j] = A[size * k + j]
            B[size * best + j] = B[size * k + j]
            A[size * k + j] = a
            B[size * k + j] = b
        for i in range(size):
            if i == k:
                continue
            factor = A[size * i + k]
            for j in range(size):
                A[size * i + j] -= factor * A[size * k + j]
                B[size * i + j] -= factor * B[size * k + j]
    return determinant


@outlined
def negative_eigenvalues(P, size, X, inverse):
    """How many eigenvalues of a matrix have a negative real part, as far as its sign was found. It
    is used up, and so is room for two of them."""
    balance(P, size)
    scaled = True
    for _round in range(SIGN_ROUNDS):
        for n in range(size * size):
            X[n] = P[n]
        determinant = invert_pivoting(X, inverse, size)
        if not abs(determinant) < math.inf:
            return size
        scale = math.exp(-determinant / size) if scaled else 1.0
        change = 0.0
        largest = 0.0
        for n in range(size * size):
            value = 0.5 * (scale * P[n] + inverse[n] / scale)
            change = max(change, abs(value - P[n]))
            largest = max(largest, abs(value))
            P[n] = value
        scaled = scaled and change > SIGN_NEAR * largest
        if change <= SIGN_CALM * largest:
            break
    trace = 0.0
    for k in range(size):
        trace += P[size * k + k]
    return math.floor(0.5 * (size - trace) + 0.5)


@kernel
def count_negative(I, M):
    """How many eigenvalues with a negative real part the pivots have of what is factored."""
    head = header(I)
    P = own_block()
    X = own_block()
    inverse = own_block()
    total = 0
    for node in range(head.nodes):
        count = take_pivot(I, M, node, P)
        if not is_positive(P, count):
            take_pivot(I, M, node, P)
            total += negative_eigenvalues(P, count, X, inverse)
    count = 3 * head.closure_count
    if count > 0:
        S = view(M, column_word(I, count), count * count)
        for k in range(count):
            row = closure_of(I, M, k // 3)
            if S[count * k + k] > 0.0:
                total += 1
            if row.node < 0.0 or row.clamp == 0.0:
                total -= 1
    return total


@outlined
def lift_pressed(I, M):
    """Leave out what presses elements by no more than tensions may be wrong by: means below zero,
    slopes, and the stabilisation's part. What is left of that presses nothing, and holds."""
    head = header(I)
    allowed = promised_tension(M)
    tension = view(M, head.tension, 2 * head.nodes)
    for node in range(head.nodes):
        mean = tension[2 * node]
        if not abs(mean) < allowed:
            continue
        mean = max(mean, 0.0)
        tension[2 * node] = mean
        tension[2 * node + 1] = min(max(tension[2 * node + 1], -mean), mean)
        edge_of(I, M, node).stabilisation *= STABILISED


@outlined
def make_symmetric(I, M):
    """Of the matrix that has been assembled, the symmetric part."""
    head = header(I)
    size = 2 * head.dimension
    area = size * size
    for node in range(head.nodes):
        D = view(M, head.diagonal + area * node, area)
        for i in range(size):
            for j in range(i):
                D[size * i + j] = 0.5 * (D[size * i + j] + D[size * j + i])
                D[size * j + i] = D[size * i + j]
        joint = I[head.joint + node]
        if node == 0 or not (joint == JOINT_NONE or joint == JOINT_BODY):
            continue
        U = view(M, head.upper + area * node, area)
        L = view(M, head.lower + area * node, area)
        for i in range(size):
            for j in range(size):
                U[size * i + j] = 0.5 * (U[size * i + j] + L[size * j + i])
                L[size * j + i] = U[size * i + j]


@outlined
def count_growing(I, M, rate):
    """Of small motions about the state how many grow faster than a rate [1/s]; -1: a pivot is none.
    The matrix is used up, and of a system what `lift_pressed` changes stays so."""
    head = header(I)
    if head.parts != 0:
        lift_pressed(I, M)
    assemble_here(I, M, rate, rate * rate)
    if head.parts != 0:
        make_symmetric(I, M)
    if factor_assembled(I, M) != 0:
        return -1
    return count_negative(I, M)
