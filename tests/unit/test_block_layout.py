"""The blocks' records: their words follow each other, and every view of them says the same."""

import numpy as np
import pytest

from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.finite_element.kernels.element import limp
from cablemodel.solvers.finite_element.kernels.mesh import touchdown_mesh
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.record import Part, Several, Spare, c_struct, dtype_of, records

RECORDS = [*records(at), *records(own)]


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
        if isinstance(field, (Part, Spare)):
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


@pytest.mark.parametrize("module", [limp, touchdown_mesh])
def test_rows_that_a_user_names_do_not_meet(module):
    """Of the memory that is free before a step; it holds four stages' velocities in space."""
    rows = [value for name, value in vars(module).items() if name.startswith("ROW_")]
    assert sorted(rows) == list(range(len(rows)))
    assert 4 <= len(rows) <= at.SPARE_ROWS


def test_what_there_is_one_of_stands_where_a_block_has_it():
    assert at.Header.FIRST == 0
    assert at.Scalars.FIRST == at.Header.WORDS
    assert own.OwnHeader.FIRST == at.Scalars.FIRST + at.Scalars.WORDS
    assert own.OwnScalars.FIRST == own.OwnHeader.FIRST + own.OwnHeader.WORDS
