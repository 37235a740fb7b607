"""The block's records: their words follow each other, and every view of them says the same."""

import numpy as np
import pytest

from cablemodel.kernels import layout as at
from cablemodel.kernels.record import Part, Several, Spare, dtype_of, records

RECORDS = records(at)


@pytest.mark.parametrize("record", RECORDS)
def test_every_word_belongs_to_one_field(record):
    owners = [
        name
        for name, field in record.FIELDS.items()
        for _word in range(field.word, field.word + field.words)
    ]
    assert len(owners) == record.WORDS
    assert list(dict.fromkeys(owners)) == list(record.FIELDS)
    assert [record.FIELDS[name].word for name in dict.fromkeys(owners)] == [
        owners.index(name) for name in dict.fromkeys(owners)
    ]


@pytest.mark.parametrize("record", RECORDS)
def test_numpy_places_fields_as_the_record_does(record):
    kind = dtype_of(record)
    assert kind.itemsize == 8 * record.WORDS
    assert {name: kind.fields[name][1] for name in kind.names} == {
        name: 8 * field.word for name, field in record.FIELDS.items()
    }


@pytest.mark.parametrize("record", RECORDS)
def test_views_by_name_write_what_numpy_reads(record):
    memory = np.zeros(record.WORDS + 1)
    view = record(memory, 1)
    structured = memory[1:].view(dtype_of(record))[0]
    for name, field in record.FIELDS.items():
        if isinstance(field, (Part, Spare)):
            continue
        memory[:] = 0.0
        if field.kind == "i8":
            memory = memory.view(np.int64)
            setattr(record(memory, 1), name, 7)
            memory = memory.view(np.float64)
        else:
            setattr(view, name, 7.0)
        assert np.all(structured[name] == 7)
        assert np.count_nonzero(memory) == field.words
        assert np.all(np.asarray(getattr(record(memory, 1), name)).view(np.int64) != 0)
        assert not isinstance(field, Several) or len(getattr(view, name)) == field.words


@pytest.mark.parametrize("record", RECORDS)
def test_every_field_says_what_it_is(record):
    silent = [n for n, f in record.FIELDS.items() if not isinstance(f, Spare) and not f.meaning]
    assert silent == []


def test_header_and_scalars_stand_where_a_block_has_them():
    assert at.Header.FIRST == 0
    assert at.Scalars.FIRST == at.Header.WORDS
