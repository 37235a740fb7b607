"""Decks of MoorDyn with one thing changed, for tests of what reads them."""

from __future__ import annotations

from collections.abc import Iterator


def every_change(text: str, others: tuple[str, ...]) -> Iterator[str]:
    """Texts with every line left out, and every word another, in turn."""
    lines = text.splitlines()
    for k in range(len(lines)):
        yield "\n".join([*lines[:k], *lines[k + 1 :]])
    for k, whole in enumerate(lines):
        for word in set(whole.split()):
            for other in others:
                yield "\n".join([*lines[:k], whole.replace(word, other), *lines[k + 1 :]])
