"""Records of blocks and of model files: words follow each other, and every view says the same."""

import ast
from pathlib import Path

import numpy as np
import pytest

import cablemodel.solvers
from cablemodel.solvers.direct.block import SIZES as DIRECT_SIZES
from cablemodel.solvers.direct.block import DirectBlock
from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.finite_element.block import SIZES, Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.compile import row_of
from cablemodel.solvers.shared.record import (
    Part,
    Record,
    Several,
    Spare,
    Text,
    c_struct,
    dtype_of,
    real,
    records,
)
from cablemodel_fmu import file_records

RECORDS = [*records(at), *records(own), *records(file_records)]


def test_kernels_and_c_tell_records_by_their_names():
    names = [record.__name__ for record in RECORDS]
    assert len(names) > 15
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("record", RECORDS)
def test_numpy_places_fields_as_the_record_does(record):
    """NumPy puts them one behind the other: none overlaps, no word is left out."""
    kind = dtype_of(record)
    assert kind.itemsize == 8 * record.WORDS
    assert {name: kind.fields[name][1] for name in kind.names} == {
        name: 8 * field.word for name, field in record.FIELDS.items()
    }


@pytest.mark.parametrize("record", RECORDS)
def test_views_by_name_write_what_numpy_reads(record):
    memory = np.zeros(record.WORDS + 1, dtype=np.int64)
    structured = memory[1:].view(dtype_of(record))[0]
    for name, field in record.FIELDS.items():
        if isinstance(field, (Part, Spare, Text)):
            continue
        memory[:] = 0
        view = record(memory if field.kind == "i8" else memory.view(np.float64), 1)
        setattr(view, name, 7)
        assert np.all(structured[name] == 7)
        assert np.all(getattr(view, name) == 7)
        assert np.count_nonzero(memory) == field.words
        assert not isinstance(field, Several) or len(getattr(view, name)) == field.words


@pytest.mark.parametrize("record", RECORDS)
def test_every_field_says_what_it_is(record):
    silent = [n for n, f in record.FIELDS.items() if not isinstance(f, Spare) and not f.meaning]
    assert silent == []
    assert all(f" {name}" in c_struct(record) for name in record.FIELDS)


SHARING = [record for record in RECORDS if record.WITHIN is not None]
"""Users of scratch memory that others have at other times, or beside them."""


def rooms():
    """Words of scratch memory, by the header's word where it starts: of one node, one slot."""
    found = {}
    for kind, sizes in ((DirectBlock, DIRECT_SIZES), (Block, SIZES)):
        ones = dict.fromkeys(sizes, 1)
        if kind is DirectBlock:
            ones["nodes"] = 0  # there is one slot more than nodes
        found.update(kind.arrays(**ones)[1])
    found[at.Header.stage_velocity.place] += found[at.Header.stage_acceleration.place]
    return found


def taken(record):
    """Words of a record that it uses."""
    used = [field for field in record.FIELDS.values() if not isinstance(field, Spare)]
    return {field.word + n for field in used for n in range(field.words)}


@pytest.mark.parametrize("record", SHARING)
def test_users_of_scratch_memory_have_room_and_do_not_meet(record):
    assert rooms()[record.WITHIN] >= record.WORDS
    for other in record.BESIDE:
        assert other.WITHIN == record.WITHIN
        assert not taken(record) & taken(other)


def test_spare_rows_are_in_both_stages_arrays_one_behind_the_other():
    _image, workspace = Block.arrays(**dict.fromkeys(SIZES, 1))
    places = [place for place, _length in workspace]
    first = places.index(at.Header.stage_velocity.word)
    assert places[first + 1] == at.Header.stage_acceleration.word
    assert [length for _place, length in workspace[first : first + 2]] == [at.STAGE_ROWS] * 2
    assert rooms()[at.Header.stage_velocity.place] == at.SPARE_ROWS


def test_who_uses_spare_rows_has_declared_them():
    """Kernels name them by constants, and those are words of records of that memory."""
    trees = [
        ast.parse(path.read_text(encoding="utf-8"))
        for path in Path(*cablemodel.solvers.__path__).rglob("kernels/**/*.py")
    ]
    declared, used = set(), set()
    for node in (node for tree in trees for node in ast.walk(tree)):
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "spare_row":
            used.add(ast.unparse(node.args[1]))
        if isinstance(node, ast.Assign):
            name, value = node.targets[0], node.value
            pairs = [(name, value)]
            if isinstance(name, ast.Tuple) and isinstance(value, ast.Tuple):
                pairs = list(zip(name.elts, value.elts, strict=True))
            for name, value in pairs:
                record = getattr(at, ast.unparse(value).split(".")[0], None)
                if getattr(record, "WITHIN", None) == at.Header.stage_velocity.place:
                    declared.add(ast.unparse(name))
    assert len(used) > 20
    assert used <= declared


def test_a_second_record_at_a_place_must_say_that_it_shares_it():
    class Another(Record):
        number = real("of it")

    with pytest.raises(TypeError, match="Another and ElementPoints are both at `gauss`"):
        row_of(Another, at.Header.gauss)


def test_the_direct_solver_has_room_for_the_water_at_gauss_points():
    _image, workspace = DirectBlock.arrays(**dict.fromkeys(DIRECT_SIZES, 1))
    assert dict(workspace)[at.Header.gauss.place] >= at.ElementPoints.WORDS


def test_what_there_is_one_of_stands_where_a_block_has_it():
    assert at.Header.FIRST == 0
    assert at.Scalars.FIRST == at.Header.WORDS
    assert own.OwnHeader.FIRST == at.Scalars.FIRST + at.Scalars.WORDS
    assert own.OwnScalars.FIRST == own.OwnHeader.FIRST + own.OwnHeader.WORDS
