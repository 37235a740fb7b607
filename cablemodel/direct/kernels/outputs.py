"""What is read off a state: stations along the cable, the numbers of every step, the floor."""

import math

from cablemodel.kernels.access import scalars
from cablemodel.kernels.layout import STATION_WORDS

from .compile import kernel
from .frame import to_earth, to_fixed
from .geometry import last_node, line_out
from .joints import bending_of, material_of
from .layout import (
    B_HALF,
    B_OFFSET,
    B_STATE,
    BODY_WORDS,
    CABLE,
    D_BODIES,
    D_END,
    D_SECTIONS,
    END_CONTACT,
    END_TOUCHDOWN,
    F1,
    F2,
    F3,
    K1,
    K2,
    N_BODY,
    N_COUNT,
    N_FIRST,
    N_KIND,
    N_POINT,
    O_BODY,
    O_LENGTH,
    O_PLACE,
    O_SECTION,
    O_STRAINS,
    O_Y,
    PHI,
    RIGID,
    SECTION_WORDS,
    T_WEIGHT,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
    X_FLOOR,
    X_LAID,
    X_RATE,
    X_VESSEL,
)


@kernel
def node_vector(I, M, node, which):
    """Earth-frame vector of a node: 0 velocity, 1 force, 2 moment over EI, 3 tangent."""
    y = I[O_Y] + WIDTH * node
    x1 = 0.0
    x2 = 0.0
    x3 = 1.0
    if which == 0:
        x1 = M[y + V1]
        x2 = M[y + V2]
        x3 = M[y + V3]
    elif which == 1:
        x1 = M[y + F1]
        x2 = M[y + F2]
        x3 = M[y + F3]
    elif which == 2:
        x1 = M[y + K1]
        x2 = M[y + K2]
        x3 = 0.0
    g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], x1, x2, x3)
    return to_earth(M, g1, g2, g3)


@kernel
def laid_direction(I, M):
    """Horizontal direction in which laid cable lies behind the end of the mesh, with the floor's
    slope: the tangent there."""
    return node_vector(I, M, last_node(I), 3)


@kernel
def station(I, M, section, left, x, out, row):
    """The state at a fraction x of the interval after node `left` into a row of `out`."""
    right = left + 1
    h = M[I[O_LENGTH] + right]
    tx0, ty0, tz0 = node_vector(I, M, left, 3)
    tx1, ty1, tz1 = node_vector(I, M, right, 3)
    e0 = h * (1.0 + M[I[O_STRAINS] + 2 * left])
    e1 = h * (1.0 + M[I[O_STRAINS] + 2 * right])
    y = 1.0 - x
    n0 = y * y * (1.0 + 2.0 * x)
    n1 = x * y * y * e0
    n2 = x * x * (3.0 - 2.0 * x)
    n3 = -x * x * y * e1
    p = I[O_PLACE] + 3 * left
    out[row] = n0 * M[p] + n1 * tx0 + n2 * M[p + 3] + n3 * tx1
    out[row + 1] = n0 * M[p + 1] + n1 * ty0 + n2 * M[p + 4] + n3 * ty1
    out[row + 2] = n0 * M[p + 2] + n1 * tz0 + n2 * M[p + 5] + n3 * tz1
    a = I[O_Y] + WIDTH * left
    b = a + WIDTH
    phi = y * M[a + PHI] + x * M[b + PHI]
    theta = y * M[a + THETA] + x * M[b + THETA]
    g1, g2, g3 = to_fixed(phi, theta, 0.0, 0.0, 1.0)
    out[row + 3], out[row + 4], out[row + 5] = to_earth(M, g1, g2, g3)
    g1, g2, g3 = to_fixed(
        phi,
        theta,
        y * M[a + V1] + x * M[b + V1],
        y * M[a + V2] + x * M[b + V2],
        y * M[a + V3] + x * M[b + V3],
    )
    out[row + 6], out[row + 7], out[row + 8] = to_earth(M, g1, g2, g3)
    out[row + 9] = y * M[a + F3] + x * M[b + F3]
    if I[section + N_KIND] == CABLE:
        k1 = (M[b + THETA] - M[a + THETA]) / h
        k2 = (M[b + PHI] - M[a + PHI]) / h * math.sin(theta)
        out[row + 10] = math.sqrt(k1 * k1 + k2 * k2)
        out[row + 11] = 0.0
    else:
        k1 = y * M[a + K1] + x * M[b + K1]
        k2 = y * M[a + K2] + x * M[b + K2]
        out[row + 10] = math.sqrt(k1 * k1 + k2 * k2)
        out[row + 11] = bending_of(I, M, section) * out[row + 10]


@kernel
def sample_stations(I, M, stations, out):
    """State at arc lengths `stations` [m]: rows of STATION_WORDS into out, as for the finite
    elements. Returns the index of the first station that is not on the line, or their number."""
    mesh = line_out(I, M)
    total = mesh + M[X_LAID]
    # A body may be last: what rounding puts behind the cable's end belongs to the cable's end.
    outermost = I[D_SECTIONS] - 1
    while I[I[O_SECTION] + SECTION_WORDS * outermost + N_KIND] == RIGID:
        outermost -= 1
    for n in range(len(stations)):
        s = stations[n]
        if not (s >= -1e-9 * total and s <= total * (1.0 + 1e-9)):
            return n
        row = STATION_WORDS * n
        arc = 0.0
        done = False
        for index in range(I[D_SECTIONS]):
            section = I[O_SECTION] + SECTION_WORDS * index
            if done or I[section + N_KIND] == RIGID:
                continue
            first = I[section + N_FIRST]
            last = first + I[section + N_COUNT] - 1
            for node in range(first + 1, last + 1):
                h = M[I[O_LENGTH] + node]
                if s <= arc + h or (index == outermost and node == last):
                    x = min(1.0, max(0.0, (s - arc) / h))
                    station(I, M, section, node - 1, x, out, row)
                    done = True
                    break
                arc += h
        beyond = s - mesh
        if M[X_LAID] > 0.0 and beyond > 0.0:
            tx, ty, tz = laid_direction(I, M)
            out[row] += beyond * tx
            out[row + 1] += beyond * ty
            out[row + 2] += beyond * tz
            for k in range(6, 12):
                out[row + k] = 0.0
        out[row + 12] = 1.0 if M[X_LAID] > 0.0 and beyond >= 0.0 else 0.0
    return len(stations)


@kernel
def body_stations(I, M, out):
    """Motion of every body of line and drum in rows of STATION_WORDS: place (3) of the centre of
    gravity, axis (3), velocity (3); the rest is not touched. What is on the drum is at the tow
    point."""
    for body in range(I[D_BODIES]):
        body_station(I, M, body, 0, out)
    for index in range(I[D_SECTIONS] + 1):
        section = I[O_SECTION] + SECTION_WORDS * index
        if I[section + N_POINT] >= 0:
            node = I[section + N_FIRST] - 1 if index < I[D_SECTIONS] else last_node(I)
            body_station(I, M, I[section + N_POINT], node, out)
        if index < I[D_SECTIONS] and I[section + N_KIND] == RIGID:
            body = I[section + N_BODY]
            node = I[section + N_FIRST]
            row = I[O_BODY] + BODY_WORDS * body
            body_station(I, M, body, node, out)
            at = STATION_WORDS * body
            arm = (1.0 + M[row + B_OFFSET]) * M[row + B_HALF]
            for k in range(3):
                out[at + k] += arm * out[at + 3 + k]
            y = I[O_Y] + WIDTH * node
            state = row + B_STATE
            g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], M[state], M[state + 1], M[state + 2])
            out[at + 6], out[at + 7], out[at + 8] = to_earth(M, g1, g2, g3)


@kernel
def body_station(I, M, body, node, out):
    """A body's row from the place, tangent and velocity of a node."""
    at = STATION_WORDS * body
    for k in range(3):
        out[at + k] = M[I[O_PLACE] + 3 * node + k]
    out[at + 3], out[at + 4], out[at + 5] = node_vector(I, M, node, 3)
    out[at + 6], out[at + 7], out[at + 8] = node_vector(I, M, node, 0)


@kernel
def summarise(I, M, out):
    """The numbers of cablemodel/kernels/outputs.py, in the same order."""
    state = scalars(M)
    fx, fy, fz = node_vector(I, M, 0, 1)
    out[0] = fx
    out[1] = fy
    out[2] = fz
    mx, my, mz = node_vector(I, M, 0, 2)
    bending = bending_of(I, M, I[O_SECTION])
    out[3] = bending * mx
    out[4] = bending * my
    out[5] = bending * mz
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    out[6] = math.copysign(size, M[I[O_Y] + F3])
    lowest = M[I[O_Y] + F3]
    highest = out[6]  # with the shear
    last = last_node(I)
    for node in range(last + 1):
        tension = M[I[O_Y] + WIDTH * node + F3]
        lowest = min(lowest, tension)
        highest = max(highest, tension)
    out[7] = lowest
    out[8] = highest
    laid = M[X_LAID]
    tx, ty, tz = laid_direction(I, M)
    out[9] = M[I[O_PLACE] + 3 * last] + laid * tx
    out[10] = M[I[O_PLACE] + 3 * last + 1] + laid * ty
    out[11] = M[I[O_PLACE] + 3 * last + 2] + laid * tz
    vx, vy, vz = node_vector(I, M, last, 0)
    if laid > 0.0:
        vx = 0.0
        vy = 0.0
        vz = 0.0
    out[12] = vx
    out[13] = vy
    out[14] = vz
    x, y, z = to_earth(M, M[X_VESSEL], M[X_VESSEL + 1], M[X_VESSEL + 2])
    out[15] = x
    out[16] = y
    out[17] = z
    x, y, z = to_earth(M, M[X_VESSEL + 3], M[X_VESSEL + 4], M[X_VESSEL + 5])
    out[18] = x
    out[19] = y
    out[20] = z
    out[21] = line_out(I, M) + laid
    out[22] = M[X_RATE]
    out[23] = state.paid_most - state.paid
    for k in range(24, 32):
        out[k] = 0.0
    for k in range(28, 31):
        out[k] = math.nan
    if I[D_END] != END_CONTACT and I[D_END] != END_TOUCHDOWN:
        return
    # The force at the end is the floor's; what lies beyond rests there with its weight.
    fx, fy, fz = node_vector(I, M, last, 1)
    section = I[O_SECTION] + SECTION_WORDS * (I[D_SECTIONS] - 1)
    out[24] = fx
    out[25] = fy
    out[26] = fz + M[material_of(I, section) + T_WEIGHT] * laid
    out[27] = laid
    for k in range(3):
        out[28 + k] = M[I[O_PLACE] + 3 * last + k]
    nx, ny, nz = to_earth(M, M[X_FLOOR], M[X_FLOOR + 1], M[X_FLOOR + 2])
    out[31] = fx * nx + fy * ny + fz * nz
