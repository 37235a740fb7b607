"""Constant tables of the cubic Hermite element on x in [0, 1] and of the time integrators.

Shape functions act on the element vector (r0, h d0, r1, h d1): slopes are scaled by the element
length h, so every table is free of h. Gauss tables have three points, padded to four with weight
zero, so that loops over Gauss points vectorise.
"""

import numpy as np

STABILISATION = 3.0  # of a typical tension: the least stiffness of an element's third strain mode
ELEMENT_RIGID = 1e7  # least axial stiffness of a body of finite length, of a typical tension

_POINTS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15), 0.5])
_WEIGHTS = np.array([5.0, 8.0, 5.0, 0.0]) / 18.0


def _shape(x):
    return np.array(
        [1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2]
    )


def _slope(x):
    return np.array([6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x])


def _second(x):
    return np.array([12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2])


def _pairs(rows, columns):
    """(4 Gauss points, 16 pairs of shape functions) of weight * row_k * column_l."""
    return np.ascontiguousarray(np.einsum("g,kg,lg->gkl", _WEIGHTS, rows, columns).reshape(4, 16))


_H, _D, _E = _shape(_POINTS), _slope(_POINTS), _second(_POINTS)

# Values at the Gauss points, one array of four a shape function: r, h r', h^2 r''.
H0, H1, H2, H3 = (np.ascontiguousarray(row) for row in _H)
D0, D1, D2, D3 = (np.ascontiguousarray(row) for row in _D)
E0, E1, E2, E3 = (np.ascontiguousarray(row) for row in _E)

# Legendre polynomials of the tension modes: T(x) = T0 + T1 P1(x) (+ the stabilising mode P2).
P1 = 2 * _POINTS - 1
P2 = 6 * _POINTS**2 - 6 * _POINTS + 1
WEIGHT = _WEIGHTS
WEIGHT_P1 = _WEIGHTS * P1
WEIGHT_P2 = _WEIGHTS * P2

# Weighted tables (4 Gauss points, 4 shape functions) for residuals.
WH = np.ascontiguousarray((_WEIGHTS * _H).T)
WD = np.ascontiguousarray((_WEIGHTS * _D).T)
WE = np.ascontiguousarray((_WEIGHTS * _E).T)

# Weighted tables of pairs for the Jacobian: row function, column function.
S00, S01, S11 = _pairs(_H, _H), _pairs(_H, _D), _pairs(_D, _D)
S12, S21, S22 = _pairs(_D, _E), _pairs(_E, _D), _pairs(_E, _E)

# The same tables with less in them, for matrices in rows of all pairs of components. Of the slopes
# D and second derivatives E only functions 1, 2, 3 are independent: that of r0 is minus that of
# r1. PAIRS_D: these six pairs; PAIRS_H: pairs k <= l of the ten of H; both are symmetric.
PAIRS_D = ((1, 1), (2, 2), (3, 3), (1, 2), (1, 3), (2, 3))
PAIRS_H = ((0, 0), (1, 1), (2, 2), (3, 3), (0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
PAIRS_HD = tuple((k, l) for k in range(4) for l in (1, 2, 3))


def _lines(pairs, *tables):
    """(pairs, 3 Gauss points of each table): factors of a weighted sum over points and tables."""
    return np.array([[table[g, 4 * k + l] for table in tables for g in range(3)] for k, l in pairs])


LINES_D = _lines(PAIRS_D, S11)
LINES_DE = _lines(PAIRS_D, S11, S12, S21, S22)
LINES_H = _lines(PAIRS_H, S00)
LINES_HD = _lines(PAIRS_HD, S01)

# Exact consistent mass and load.
MASS = (
    np.array([[156.0, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
)
MASS_WD = np.concatenate((MASS, WD[:3])).ravel()
"""The mass's rows, then those of the slopes at three Gauss points."""
MASS_PAIRS = np.array([MASS[k, l] for k, l in PAIRS_H])
LOAD = np.array([1 / 2, 1 / 12, 1 / 2, -1 / 12])

# Contact with the sea floor: four points, shape functions (4 points, 4 functions).
_CONTACT = np.polynomial.legendre.leggauss(4)
CONTACT_POINTS = 0.5 + 0.5 * _CONTACT[0]
CONTACT_WEIGHTS = 0.5 * _CONTACT[1]
CONTACT_H = np.ascontiguousarray(_shape(CONTACT_POINTS).T)
STIFFENING, STEEPEST = 4.0, 5.0  # of contact below the floor: see `contact.contact_law`
DEPTH = 0.06  # of tau L: gap below which the floor pushes
BRISTLE = 0.02  # of tau L: way along the floor after which friction is mobilised, at most
FIRM_BRISTLE = 0.03  # of it, or of 100 tau T^2/(EA mu w), to anchors: steps work shorter ones loose
SHORTEST_BRISTLE = 5e-9  # of the length, bristles: shorter ones feel how far an equilibrium is off

# Small motions: times damping, whose matrix is a difference of two that stiffness fills.
SLOW_DAMPING = 1e3  # a free body's are differences, over 1e-6 of what it is: that stays small

# The wet part of an element: a cubic of a quadratic, times a quadratic, is of degree 8.
_WET = np.polynomial.legendre.leggauss(5)
WET_POINTS = 0.5 + 0.5 * _WET[0]
WET_WEIGHTS = 0.5 * _WET[1]


def _tableau(gamma, rows, embedded, stages):
    """Rows of an ESDIRK tableau in six columns; the last row is the solution (stiffly accurate)."""
    a = np.zeros((6, 6))
    for i, row in enumerate(rows, start=1):
        a[i, : len(row)] = row
        a[i, i] = gamma
    error = a[stages - 1].copy()
    error[: len(embedded)] -= embedded
    return a, a.sum(axis=1), error


# ESDIRK3(2)4L[2]SA and the implicit part of ARK4(3)6L[2]SA, Kennedy & Carpenter 2003, appendix C:
# L-stable, stiffly accurate, stage order 2. Index 0 is the scheme of order 3, index 1 of order 4.
_G3 = 1767732205903 / 4055673282236
_A3, _C3, _ERR3 = _tableau(
    _G3,
    [
        [_G3],
        [2746238789719 / 10658868560708, -640167445237 / 6845629431997],
        [
            1471266399579 / 7840856788654,
            -4482444167858 / 7529755066697,
            11266239266428 / 11593286722821,
        ],
    ],
    [
        2756255671327 / 12835298489170,
        -10771552573575 / 22201958757719,
        9247589265047 / 10645013368117,
        2193209047091 / 5459859503100,
    ],
    4,
)
_A4, _C4, _ERR4 = _tableau(
    0.25,
    [
        [1 / 4],
        [8611 / 62500, -1743 / 31250],
        [5012029 / 34652500, -654441 / 2922500, 174375 / 388108],
        [
            15267082809 / 155376265600,
            -71443401 / 120774400,
            730878875 / 902184768,
            2285395 / 8070912,
        ],
        [82889 / 524892, 0.0, 15625 / 83664, 69875 / 102672, -2260 / 8211],
    ],
    [
        4586570599 / 29645900160,
        0.0,
        178811875 / 945068544,
        814220225 / 1159782912,
        -3700637 / 11593932,
        61727 / 225920,
    ],
    6,
)


def _numerator(a, gamma, stages):
    """Of the stability function R(z) = P(z) / (1 - gamma z)^(stages - 1), P from its highest power.

    (6,), filled from its start. The last row is the solution: R = 1 + sum of z^(k + 1) b A^k 1.
    """
    series, stage = [1.0], np.ones(6)
    for _power in range(stages - 1):
        stage = a @ stage
        series.append(stage[stages - 1])
    poles = np.polynomial.polynomial.polypow([1.0, -gamma], stages - 1)
    found = np.zeros(6)
    found[:stages] = np.convolve(series, poles)[:stages][::-1]
    return found


def _tension_test(abscissae, degree, weight):
    """What the polynomial of that degree that fits values at the abscissae best misses, weighted.

    (6, 6), filled from its upper left corner.
    """
    powers = np.vander(abscissae, degree + 1)
    n = len(abscissae)
    test = np.zeros((6, 6))
    test[:n, :n] = weight * (np.eye(n) - powers @ np.linalg.pinv(powers))
    return test


# Errors of the tension at a step's end from the tensions of its implicit stages, which scatter by
# as much about a smooth curve: a parabola for order 4, a line for order 3. With these weights the
# largest residual exceeds nine tenths of the errors of stiff lines in smooth heave.
TENSION_TEST = np.stack([_tension_test(_C3[1:4], 1, 2.5), _tension_test(_C4[1:], 2, 1.5)])

NUMERATOR = np.stack([_numerator(_A3, _G3, 4), _numerator(_A4, 0.25, 6)])


def _underrated(a, error, stages, angle=0.1):
    """What a step misses of a ring over what its embedded solution says, for each radian that the
    ring turns in it: the error of a step is of one order more than the embedded one."""
    turn = 1j * angle
    slopes = np.linalg.solve(np.eye(stages) - turn * a[:stages, :stages], np.full(stages, turn))
    missed = 1.0 + a[stages - 1, :stages] @ slopes - np.exp(turn)
    return abs(missed / (error[:stages] @ slopes)) / angle


UNDERRATED = np.array([_underrated(_A3, _ERR3, 4), _underrated(_A4, _ERR4, 6)])


def _window(wave, powers):
    """Coefficients of wave(y) and of those powers of y whose sum, in Hann's window of two turns,
    y from -2 pi to 2 pi, finds that wave's amplitude and nothing of the powers.
    """
    points, weights = np.polynomial.legendre.leggauss(64)
    y = 2.0 * np.pi * points
    parts = np.stack([wave(y), *(y**n for n in powers)])
    products = (2.0 * np.pi * weights * 0.5 * (1.0 + np.cos(0.5 * y)) * parts) @ parts.T
    return np.linalg.solve(products, np.eye(len(parts))[0])


# Of what a cubic of time leaves of a tension: its cosine and its sine.
WINDOW = np.stack([_window(np.cos, (0, 2)), _window(np.sin, (1, 3))])

STAGES = np.array([4, 6])
GAMMA = np.array([_G3, 0.25])
STAGE_A = np.stack([_A3, _A4])
STAGE_C = np.stack([_C3, _C4])
STAGE_ERROR = np.stack([_ERR3, _ERR4])
