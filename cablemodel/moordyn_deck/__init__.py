"""Decks of MoorDyn (its input files, version 2) as scenes.

What the two programs share is taken as it is: of a line's type diameter, mass, EA, EI, drag
coefficients on d and on pi d, added mass; mass, volume, drag and added mass of a free point, whose
drag is that of a sphere; mass, inertia, volume and coefficients of bodies and rods. What a scene
cannot state is refused by name and line where it is a load or a constraint, and told where it is
damping, numerics or output, or where a scene has only the nearest thing.
"""

from __future__ import annotations

from pathlib import Path

from cablemodel.errors import SceneError
from cablemodel.moordyn_deck.deck import environment, sections
from cablemodel.moordyn_deck.one_line import one_line
from cablemodel.moordyn_deck.system import system
from cablemodel.moordyn_deck.text import written
from cablemodel.moordyn_deck.water import water


def read_deck(
    text: str, source: str = "", line: int | None = None, folder: Path | None = None
) -> tuple[str, list[str]]:
    """A scene in YAML from the text of a MoorDyn deck of version 2.

    Args:
        text: the deck.
        source: what its errors call it.
        line: ID of the line to take, alone; by default all, with points, bodies and rods.
        folder: where its files of waves and currents are; by default the present one.

    Returns:
        The scene's text, in SI units, with axes and places of the deck: of one line from its
        coupled point, or else from a fixed one; of several lines, or of bodies and rods, a system.
        What is coupled is at rest as long as the scene says nothing else. And what was left out or
        is only like it, in words.

    Raises:
        SceneError: naming, by the deck's lines and columns, all that a scene cannot state.
    """
    deck = sections(text)
    still, moving = environment(deck), water(deck, folder)
    alone = len(deck.rows.get("lines", [])) == 1 and not deck.has_solids
    if line is not None or alone:
        scene, comment = one_line(deck, still, line)
    else:
        scene, comment = system(deck, still)
    if deck.problems:
        raise SceneError(deck.problems, source)
    left = list(dict.fromkeys(deck.left))
    return written(scene, still, moving, comment, left, source), left
