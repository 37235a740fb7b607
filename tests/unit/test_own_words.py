"""Records and vectors of a kernel's own: zeros at each call, apart from all others."""

import numba
import numpy as np
from numba import float64, int64

from cablemodel.solvers.shared.access import vector
from cablemodel.solvers.shared.compile import OPTIONS, REALS, kernel, own_record
from cablemodel.solvers.shared.record import Record, part, real, reals


class Inner(Record):
    number = real("one")
    several = reals(3, "of them")


class Outer(Record):
    before = real("the part")
    part = part(Inner, "within")
    after = reals(2, "the part")


outer = own_record(Outer)


@kernel
def fill(record, value):
    """Another kernel sees the caller's record, not a copy."""
    record.before = value
    record.part.number = value + 1.0
    for i in range(3):
        record.part.several[i] = value + 2.0 + i
    record.after[0] = value + 5.0
    record.after[1] = value + 6.0


@kernel
def sum_of_own(value):
    """Has a record too, which may not be the caller's."""
    own = outer()
    fill(own, value)
    return own.before + own.part.number + own.part.several[2] + own.after[1]


@numba.jit(**OPTIONS)
def probe(out, rounds):
    kept = outer()
    fill(kept, 100.0)
    place = vector()
    place[1] = 7.0
    found = 0.0
    for n in range(rounds):
        fresh = outer()
        step = vector()
        found += abs(fresh.before) + abs(fresh.part.several[1]) + abs(fresh.after[1])
        found += abs(step[0]) + abs(step[1]) + abs(step[2])
        fill(fresh, 1.0 + n)
        for i in range(3):
            step[i] = 1.0
    out[0] = found
    out[1] = sum_of_own(10.0)
    out[2] = kept.before
    out[3] = kept.part.number
    for i in range(3):
        out[4 + i] = kept.part.several[i]
        out[9 + i] = place[i]
    out[7] = kept.after[0]
    out[8] = kept.after[1]
    return 0


def test_a_kernels_own_words():
    """Zeros also the second time round a loop; others' stay; fields are where they belong."""
    probe.compile(int64(REALS, int64))
    out = np.full(12, np.nan)
    assert probe(out, 5) == 0
    assert out[0] == 0.0
    assert out[1] == 10.0 + 11.0 + 14.0 + 16.0
    np.testing.assert_array_equal(out[2:9], 100.0 + np.arange(7))
    np.testing.assert_array_equal(out[9:], [0.0, 7.0, 0.0])


def test_many_calls_do_not_fill_the_stack():
    """A record in a loop is one: a million of them would be 56 MB."""
    out = np.zeros(12)
    assert probe(out, 1_000_000) == 0
    assert out[0] == 0.0


def test_vectors_are_typed_as_the_blocks_arrays():
    @numba.jit(**OPTIONS)
    def first(values):
        place = vector()
        place[0] = values[0]
        chosen = place if values[0] > 0.0 else values
        return chosen[0]

    first.compile(float64(REALS))
    assert first(np.array([3.0])) == 3.0
    assert first(np.array([-3.0])) == -3.0
