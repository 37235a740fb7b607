"""One line of a deck, between two points: a scene of one line."""

from __future__ import annotations

from typing import Any

from cablemodel.moordyn_deck.deck import LINE, POINT, Deck, line_type, point, point_body, wide
from cablemodel.moordyn_deck.text import cable_of, type_of


def one_line(
    deck: Deck, environment: dict[str, float], wanted: int | None
) -> tuple[dict[str, Any], str]:
    """Parts of a scene by its keys, and a comment; empty where something is wrong.

    environment: gravity [m/s2], density [kg/m3], depth [m]: made as deep as the lowest point.
    wanted: ID of the line; by default the only one.
    """
    rows = [row for row in deck.rows.get("lines", []) if wide(deck, row, LINE, "LINES")]
    found = [row for row in rows if wanted is None or row.entries[0] == str(wanted)]
    listed = ", ".join(row.entries[0] for row in rows)
    if len(found) != 1:
        if rows:
            deck.refuse(None, "LINES", f"there is no single line {wanted}", listed)
        return {}, ""
    row = found[0]
    others = [other for other in rows if other is not row]
    if others:
        deck.left.append(f"the other lines: {', '.join(other.entries[0] for other in others)}")
    if deck.has_solids:
        deck.left.append("bodies and rods, which are not on this line")
    length = deck.number(row, LINE, "UnstrLen")
    if length <= 0.0:
        deck.refuse(row, "UnstrLen", f"{length:g} is not above 0", "a length in m")
    kind = line_type(deck, row)
    ends = [point(deck, row, name) for name in ("AttachA", "AttachB")]
    for end in ends:
        if end.get("kind") == "free":
            shared = [o.entries[0] for o in others if end["id"] in o.entries[2:4]]
            if shared:
                joined = f"the free point {end['id']} joins it to line {', '.join(shared)}"
                deck.refuse(row, "AttachA, AttachB", joined, "ends of no other line")
    if not all(ends) or deck.problems:
        return {}, ""
    # From the vessel outwards: the coupled end, else the fixed one; B is the fairlead.
    order = ("coupled", "fixed", "free")
    a, b = ends
    near, far = sorted((b, a), key=lambda end: order.index(end["kind"]))
    if near["kind"] == "free" or far["kind"] == "coupled":
        both = "no end is held" if near["kind"] == "free" else "both ends are coupled"
        deck.refuse(row, "AttachA, AttachB", both, "one coupled or fixed end, and a fixed or free")
        return {}, ""
    for end in (near, far):
        if end["kind"] != "free" and (end["mass"] or end["volume"] or end["area"]):
            deck.left.append(f"mass, volume and drag of point {end['id']}, which is held")
    if near["kind"] == "coupled":
        deck.left.append("the coupled point's motion, which no deck holds: vessel.velocity")
    if max(near["place"][2], far["place"][2]) > 0.0:
        deck.left.append("the dry part above z = 0: water is everywhere in a scene without waves")
    # MoorDyn's floor is no higher than its lowest point.
    rows = [point for point in deck.rows["points"] if wide(deck, point, POINT, "POINTS")]
    lowest = min(deck.number(point, POINT, "Z") for point in rows)
    environment["wtrdpth"] = max(environment["wtrdpth"], -lowest)
    items = [cable_of(kind, length)]
    if far["kind"] == "free":
        deck.left.append("the free point's place, from which MoorDyn seeks rest")
        items += point_body(deck, far, environment)
    scene = {
        "cable_types": {kind["name"]: type_of(kind)},
        "line": items,
        "end": "free" if far["kind"] == "free" else {"anchor": far["place"]},
        "vessel": {"position": near["place"]},
    }
    return scene, f"The {near['kind']} point {near['id']} is the vessel."
