"""Records of blocks and of model files: words follow each other, and every view says the same."""

import numpy as np
import pytest

from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.finite_element.block import SIZES, Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.record import (
    Part,
    Several,
    Spare,
    Text,
    c_struct,
    dtype_of,
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


@pytest.mark.parametrize(
    "together",
    [
        (at.SearchRows, at.LimpRows),
        (at.SearchRows, at.MeshRows),
        (at.BeginRows,),
        (at.FilterRows,),
        (at.SolvedRows,),
        (at.AlongRows,),
        (at.ConsistentRows,),
        (at.GivenShapeRows,),
        (at.ResponseRows,),
    ],
)
def test_users_of_spare_rows_that_are_at_work_together_do_not_meet(together):
    """Both stages' arrays, one behind the other, hold them."""
    taken = [
        field.word + n
        for rows in together
        for field in rows.FIELDS.values()
        if not isinstance(field, Spare)
        for n in range(field.words)
    ]
    assert len(taken) == len(set(taken))
    assert max(taken) < at.SPARE_ROWS
    _image, workspace = Block.arrays(**dict.fromkeys(SIZES, 1))
    places = [place for place, _length in workspace]
    first = places.index(at.Header.stage_velocity.word)
    assert places[first + 1] == at.Header.stage_acceleration.word
    assert [length for _place, length in workspace[first : first + 2]] == [at.STAGE_ROWS] * 2


@pytest.mark.parametrize("rows", [at.AlongRows, at.SlackRows])
def test_what_looks_along_lines_leaves_what_was_solved_for(rows):
    """Only compliances, which have been given back by then, are in its place."""
    own = [field for field in rows.FIELDS.values() if not isinstance(field, Spare)]
    softness = at.SolvedRows.softness
    assert min(field.word for field in own) >= softness.word
    assert max(field.word + field.words for field in own) <= softness.word + softness.words
    assert softness.word + softness.words == at.SolvedRows.WORDS == at.SPARE_ROWS


def test_what_there_is_one_of_stands_where_a_block_has_it():
    assert at.Header.FIRST == 0
    assert at.Scalars.FIRST == at.Header.WORDS
    assert own.OwnHeader.FIRST == at.Scalars.FIRST + at.Scalars.WORDS
    assert own.OwnScalars.FIRST == own.OwnHeader.FIRST + own.OwnHeader.WORDS
