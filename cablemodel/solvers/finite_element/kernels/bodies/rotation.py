"""Rotations by rotation vectors, and by roll, pitch and yaw.

A body turns by R = R0 exp([theta]) from a fixed R0. Its angular velocity in its own axes is
Omega = T(theta) d(theta)/dt, with

    exp([theta]) = 1 + s [theta] + c [theta]^2,  T = 1 - c [theta] + d [theta]^2,
    s = sin(p)/p, c = (1 - cos(p))/p^2, d = (p - sin(p))/p^3, p = |theta|

(Rodrigues; Geradin & Cardona 2001, chapter 4). The factors are power series in p^2: exact to
rounding up to p = 3, smooth at zero.
"""

import math

from cablemodel.solvers.shared.access import vector
from cablemodel.solvers.shared.compile import kernel

TERMS = 14  # of the series: up to p = 3 the next one is below 1e-18


@kernel
def series(square):
    """s, c and d, from p^2."""
    s = 1.0
    c = 1.0
    d = 1.0
    for n in range(1, TERMS):
        k = 2 * (TERMS - n)
        s = 1.0 - s * square / (k * (k + 1))
        c = 1.0 - c * square / ((k + 1) * (k + 2))
        d = 1.0 - d * square / ((k + 2) * (k + 3))
    return s, 0.5 * c, d / 6.0


@kernel
def slopes_of_series(square):
    """Derivatives of c and d by p^2."""
    dc = 0.0
    dd = 0.0
    power = 1.0
    c = 0.5  # 1 / (2k + 2)!
    d = 1.0 / 6.0
    for k in range(1, TERMS):
        c /= -(2 * k + 1) * (2 * k + 2)
        d /= -(2 * k + 2) * (2 * k + 3)
        dc += k * c * power
        dd += k * d * power
        power *= square
    return dc, dd


@kernel
def cross(a, b, out):
    """out = a x b, three words each; out is neither of them."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@kernel
def to_earth_axes(R, x, out):
    """out = R x; R: 9 words by rows."""
    for i in range(3):
        out[i] = R[3 * i] * x[0] + R[3 * i + 1] * x[1] + R[3 * i + 2] * x[2]


@kernel
def to_body_axes(R, x, out):
    """out = R^T x."""
    for i in range(3):
        out[i] = R[i] * x[0] + R[3 + i] * x[1] + R[6 + i] * x[2]


@kernel
def angles_of(R, out):
    """Roll, pitch and yaw of R = Rz Ry Rx, 9 words by rows."""
    out[0] = math.atan2(R[7], R[8])
    out[1] = math.atan2(-R[6], math.sqrt(R[0] * R[0] + R[3] * R[3]))
    out[2] = math.atan2(R[3], R[0])


@kernel
def square_of_cross(x, f, out, g):
    """out = (1 + f [x] + g [x]^2), 9 words by rows."""
    x2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
    for i in range(3):
        for j in range(3):
            out[3 * i + j] = g * x[i] * x[j]
        out[4 * i] += 1.0 - g * x2
    out[1] -= f * x[2]
    out[2] += f * x[1]
    out[3] += f * x[2]
    out[5] -= f * x[0]
    out[6] -= f * x[1]
    out[7] += f * x[0]


@kernel
def turn_and_rates(R0, x, turn, rates):
    """R = R0 exp([x]) and T(x), 9 words by rows each, from a rotation vector."""
    square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
    s, c, d = series(square)
    square_of_cross(x, s, rates, c)
    for i in range(3):
        for j in range(3):
            value = 0.0
            for k in range(3):
                value += R0[3 * i + k] * rates[3 * k + j]
            turn[3 * i + j] = value
    square_of_cross(x, -c, rates, d)


@kernel
def convective_spin(x, v, out):
    """(dT/dt) v, what the angular acceleration has beside T dv/dt, v = dx/dt."""
    square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
    _s, _c, d = series(square)
    dc, dd = slopes_of_series(square)
    along = 2.0 * (x[0] * v[0] + x[1] * v[1] + x[2] * v[2])
    once = vector()
    twice = vector()
    cross(x, v, once)
    cross(x, once, twice)
    for i in range(3):
        out[i] = -dc * along * once[i] + dd * along * twice[i]
    cross(v, once, twice)
    for i in range(3):
        out[i] += d * twice[i]


@kernel
def attitude(x, v, a, turn, spin, spin_rate):
    """Axes (9 words by rows), angular velocity and its rate in the earth's frame, from roll, pitch
    and yaw about x, then y, then z of the turned frame, R = Rz Ry Rx, and their rates."""
    cr = math.cos(x[0])
    sr = math.sin(x[0])
    cp = math.cos(x[1])
    sp = math.sin(x[1])
    cy = math.cos(x[2])
    sy = math.sin(x[2])
    turn[0] = cy * cp
    turn[1] = cy * sp * sr - sy * cr
    turn[2] = cy * sp * cr + sy * sr
    turn[3] = sy * cp
    turn[4] = sy * sp * sr + cy * cr
    turn[5] = sy * sp * cr - cy * sr
    turn[6] = -sp
    turn[7] = cp * sr
    turn[8] = cp * cr
    # Axes of the three rates: of roll the frame's own x, of pitch the turned y, of yaw z.
    spin[0] = v[0] * turn[0] - v[1] * sy
    spin[1] = v[0] * turn[3] + v[1] * cy
    spin[2] = v[0] * turn[6] + v[2]
    # The axis of pitch turns with the yaw, that of roll with both.
    mx = -v[1] * sy
    my = v[1] * cy
    mz = v[2]
    spin_rate[0] = a[0] * turn[0] - a[1] * sy - v[1] * v[2] * cy
    spin_rate[1] = a[0] * turn[3] + a[1] * cy - v[1] * v[2] * sy
    spin_rate[2] = a[0] * turn[6] + a[2]
    spin_rate[0] += v[0] * (my * turn[6] - mz * turn[3])
    spin_rate[1] += v[0] * (mz * turn[0] - mx * turn[6])
    spin_rate[2] += v[0] * (mx * turn[3] - my * turn[0])
