"""No two things share a word of the block."""

from collections import defaultdict

import pytest

from cablemodel.kernels import layout as at


def places(*prefixes: str) -> dict[int, list[str]]:
    """Names of words by their number."""
    found = defaultdict(list)
    for name, value in vars(at).items():
        if name.startswith(prefixes) and isinstance(value, int):
            found[value].append(name)
    return found


@pytest.mark.parametrize(
    ("prefixes", "first", "beyond"),
    [
        (("I_", "O_"), 0, at.HEADER_WORDS),
        (("S_",), at.HEADER_WORDS, at.HEADER_WORDS + at.SCALAR_WORDS),
        (("E_",), 0, at.EDGE_WORDS),
        (("B_",), 0, at.BODY_WORDS),
    ],
)
def test_names_of_words_are_apart(prefixes: tuple[str, ...], first: int, beyond: int) -> None:
    found = places(*prefixes)
    assert {number: names for number, names in found.items() if len(names) > 1} == {}
    assert first <= min(found)
    assert max(found) < beyond
