"""A sea within a cell of space and time: one short series for all its components.

From the middle of a cell to a place (x along the waves' way, z upwards) and a time t in it a
component changes by

    e^(k (z + i x) - i w t) = e^(k_c (z + i x) - i w_c t) e^((k - k_c) (z + i x) - i (w - w_c) t),

a carrier's change, which all have in common, and one whose exponent is small: its series ends
early. The terms are products of powers of z + i x and t, whose factors are summed over all
components once for a cell. The bottom's mirror of the waves, e^-k (z - i x), and the surface have
series of their own.

Short waves die out with the depth, so that cells may be larger there: the water has layers, each
with a carrier and cells of its own. Which cell a place belongs to is a matter of the place and the
time alone, so that the water's motion does not depend on what was asked before; a slot of the
memory holds the last cell that was asked for by one Gauss point or body. How large cells may be:
cablemodel/solvers/finite_element/start/waves.py.
"""

from cablemodel.solvers.finite_element.kernels.water.airy import (
    ROUND,
    column,
    columns,
    follow_components,
    living,
    sine_and_cosine,
)
from cablemodel.solvers.shared.access import cell_of, header, scalars, sea_layer_at, word_of
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view
from cablemodel.solvers.shared.layout import (
    CELL_DEGREE,
    CELL_LAYERS,
    CELL_TERMS,
    HOLDS_ALL,
    HOLDS_WATER,
    MIRROR_DEGREE,
    MIRROR_TERMS,
    MOTION_WORDS,
    W_AMPLITUDE,
)

OVER = tuple(1.0 / max(n, 1) for n in range(10))


@inlined
def amplitudes(I, M, count):
    """Views of two more columns, beside those of `columns`: parts of complex amplitudes."""
    head = header(I)
    space = head.motion + MOTION_WORDS + 4 * head.wave_count
    return view(M, space, count), view(M, space + head.wave_count, count)


@kernel
def sum_terms(I, M, layer, series, count, terms, turn):
    """Write a series of the first `count` components from their parts, in `amplitudes`.

    layer: its first word. They are complex numbers, times (-i)^(p + turn q) in the term x^q t^p.
    """
    a, b = amplitudes(I, M, count)
    # Five terms at a time: sums that do not wait for one another, and stay in registers.
    for first in range(0, terms, 5):
        r0, r1, r2, r3, r4 = 0.0, 0.0, 0.0, 0.0, 0.0
        i0, i1, i2, i3, i4 = 0.0, 0.0, 0.0, 0.0, 0.0
        powers = view(M, layer + CELL_TERMS + first, CELL_TERMS * count)
        for n in range(count):
            p = CELL_TERMS * n
            x = a[n]
            y = b[n]
            r0 += powers[p] * x
            i0 += powers[p] * y
            r1 += powers[p + 1] * x
            i1 += powers[p + 1] * y
            r2 += powers[p + 2] * x
            i2 += powers[p + 2] * y
            r3 += powers[p + 3] * x
            i3 += powers[p + 3] * y
            r4 += powers[p + 4] * x
            i4 += powers[p + 4] * y
        at = view(series, 2 * first, 10)
        at[0], at[2], at[4], at[6], at[8] = r0, r1, r2, r3, r4
        at[1], at[3], at[5], at[7], at[9] = i0, i1, i2, i3, i4
    j = 0
    degree = 0
    while j < 2 * terms:
        for q in range(degree + 1):
            quarter = (degree - q + turn * q) % 4
            re = series[j]
            im = series[j + 1]
            if quarter == 1:
                re, im = im, -re
            elif quarter == 2:
                re, im = -re, -im
            elif quarter == 3:
                re, im = -im, re
            series[j] = re
            series[j + 1] = im
            j += 2
        degree += 1


@inlined
def series_at(terms, degree, x, y, t):
    """A series at x + i y and t: its real and imaginary part, and those of its rate in t."""
    re = 0.0
    im = 0.0
    re_rate = 0.0
    im_rate = 0.0
    for q in range(degree, -1, -1):
        a = 0.0
        b = 0.0
        a_rate = 0.0
        b_rate = 0.0
        for total in range(degree, q - 1, -1):
            term = total * (total + 1) + 2 * q
            a_rate = a_rate * t + a
            b_rate = b_rate * t + b
            a = a * t + terms[term]
            b = b * t + terms[term + 1]
        re, im = re * x - im * y + a, im * x + re * y + b
        re_rate, im_rate = (
            re_rate * x - im_rate * y + a_rate,
            im_rate * x + re_rate * y + b_rate,
        )
    return re, im, re_rate, im_rate


@outlined
def fill_cell(I, M, layer, cell, t, way, level, surface):
    """Write the series of the cell whose middle is here, that of the surface if it is asked for."""
    head = header(I)
    every = head.wave_count
    # The waves' own series are the same with the surface and without.
    alive = living(I, M, level)
    cell.alive = alive
    count = every if surface else alive
    follow_components(I, M, count, way, level, t)
    cosine, sine, along, upward = columns(I, M, count)
    a, b = amplitudes(I, M, count)
    if surface:
        amplitude = view(M, column(I, W_AMPLITUDE), count)
        for n in range(count):
            a[n] = amplitude[n] * cosine[n]
            b[n] = amplitude[n] * sine[n]
        sum_terms(I, M, word_of(M, layer), cell.surface, count, CELL_TERMS, 3)
    for n in range(alive):
        speed = 0.5 * (along[n] + upward[n])
        a[n] = speed * cosine[n]
        b[n] = speed * sine[n]
    sum_terms(I, M, word_of(M, layer), cell.rising, alive, CELL_TERMS, 0)
    if layer.mirror != 0.0:
        for n in range(alive):
            speed = 0.5 * (along[n] - upward[n])
            a[n] = speed * cosine[n]
            b[n] = speed * sine[n]
        sum_terms(I, M, word_of(M, layer), cell.mirror, alive, MIRROR_TERMS, 0)


@inlined
def begin_stage(I, M):
    """From now on Newton's method keeps the water of the first iteration where it hardly moves.

    Within a stage only, so that the water's motion does not depend on what was asked before.
    """
    if header(I).cell_terms != 0:
        first = cell_of(I, M, 0)
        first.stage += 1.0
        first.within = 1.0


@inlined
def end_stage(I, M):
    """Water is that of its place again."""
    if header(I).cell_terms != 0:
        cell_of(I, M, 0).within = 0.0


@inlined
def is_kept(I, M, cell, way, level, surface):
    """Whether a slot holds what this stage has found a little way off (`cell_stays`)."""
    first = cell_of(I, M, 0)
    # A stage with the surface has a number and a half.
    number = first.stage + (0.5 if surface else 0.0)
    return (
        cell.stage == number
        and first.within != 0.0
        and abs(way - cell.way) + abs(level - cell.level) < scalars(M).cell_stays
    )


@inlined
def keep(I, M, cell, way, level, surface):
    """Say that a slot's water is that of this place and stage, if one is under way."""
    first = cell_of(I, M, 0)
    if first.within != 0.0:
        cell.stage = first.stage + (0.5 if surface else 0.0)
        cell.way = way
        cell.level = level


@inlined
def layer_at(I, M, level):
    """First word of the layer of water at a level z <= 0 [m]."""
    head = header(I)
    layer = head.cell_layers
    words = CELL_TERMS * (head.wave_count + 1)
    last = layer + (CELL_LAYERS - 1) * words
    while layer < last and sea_layer_at(M, layer + words).depth <= -level:
        layer += words
    return layer


@kernel
def sum_in_cell(I, M, slot, way, level, surface):
    """`sum_components` by the cell of the place and the waves' time; the surface if asked for.

    slot: where the cell may be kept, from 0.
    """
    head = header(I)
    state = scalars(M)
    cell = cell_of(I, M, slot)
    layer = head.cell_layers if surface else layer_at(I, M, level)
    sea_layer = sea_layer_at(M, layer)
    span = sea_layer.time
    width = sea_layer.width
    cell_t = (state.wave_time / span + ROUND) - ROUND
    cell_x = (way / width + ROUND) - ROUND
    cell_z = (level / width + ROUND) - ROUND
    same = cell_t == cell.t and cell_x == cell.x and cell_z == cell.z
    enough = cell.held == HOLDS_ALL or (cell.held == HOLDS_WATER and not surface)
    if not (same and cell.layer == layer and enough):
        fill_cell(I, M, sea_layer, cell, cell_t * span, cell_x * width, cell_z * width, surface)
        cell.held = HOLDS_ALL if surface else HOLDS_WATER
        cell.t = cell_t
        cell.x = cell_x
        cell.z = cell_z
        cell.layer = layer
    if cell.alive == 0.0 and not surface:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    t = state.wave_time - cell_t * span
    x = way - cell_x * width
    z = level - cell_z * width
    frequency = sea_layer.frequency
    number = sea_layer.number
    half_sine, half_cosine = sine_and_cosine(0.5 * (number * x - frequency * t))
    sine = 2.0 * half_sine * half_cosine
    cosine = 1.0 - 2.0 * half_sine * half_sine
    up = 1.0
    for n in range(9, 0, -1):
        up = 1.0 + number * z * up * OVER[n]
    re, im, re_rate, im_rate = series_at(cell.rising, CELL_DEGREE, z, x, t)
    # In time the carrier turns by -i w_c.
    re_rate += frequency * im
    im_rate -= frequency * re
    u = up * (cosine * re - sine * im)
    w = up * (sine * re + cosine * im)
    du = up * (cosine * re_rate - sine * im_rate)
    dw = up * (sine * re_rate + cosine * im_rate)
    if sea_layer.mirror != 0.0:
        re, im, re_rate, im_rate = series_at(cell.mirror, MIRROR_DEGREE, -z, x, t)
        re_rate += frequency * im
        im_rate -= frequency * re
        u += (cosine * re - sine * im) / up
        w -= (sine * re + cosine * im) / up
        du += (cosine * re_rate - sine * im_rate) / up
        dw -= (sine * re_rate + cosine * im_rate) / up
    height = 0.0
    if surface:
        re, im, _re_rate, _im_rate = series_at(cell.surface, CELL_DEGREE, x, 0.0, t)
        height = cosine * re - sine * im
    return height, u, w, du, dw
