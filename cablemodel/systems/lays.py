"""Lines that a winch lays, or takes up, from t = 0 on: each starts as a scene of its own.

Such a line is tied to nothing but its vessel's point and, it may be, an anchor on the sea floor: in
a system it moves as it would alone. A scene of one line is made of it, whose start
(`solvers/finite_element/start`) is put into the system (`joined.py`).

An anchor holds what has been laid. Where there is more cable than a lay takes to it, what lies does
so in a bow, which friction holds. Where there is less, it lies straight, and the anchor pulls.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from cablemodel.errors import SceneError, SceneProblem, StaticsError
from cablemodel.scene import Scene
from cablemodel.scene.environment import Floor
from cablemodel.scene.line import End
from cablemodel.scene.problems import problems_of
from cablemodel.scene.schema import RunSettings
from cablemodel.scene.vessel import Payout, Vessel
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import (
    continuation,
    from_scene,
    laid_loads,
    laid_start,
    refinement,
    sea_floor,
    search,
)
from cablemodel.solvers.finite_element.start.first_state import hold_supports, steady_velocity
from cablemodel.solvers.finite_element.start.frame import earth
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.curves import bends, crossing, way_along
from cablemodel.solvers.shared.layout import Header
from cablemodel.solvers.shared.numbers import (
    END_BEND,
    REFINEMENT_BENT,
    REFINEMENT_ROUNDS,
    RELATIVE_ROUNDING,
)
from cablemodel.systems.guess import held_place
from cablemodel.systems.scene import SystemScene, SystemWinch

FloatArray = NDArray[np.float64]
Place = tuple[float, float, float]

_FROM_POINTS = re.compile(r"(, or start from|; give) initial: .*$")
"""Advice that a line of a system cannot follow."""
BEGINS = 1e-3
"""Length of the run of a scene of which the start alone is wanted [s]."""
BOW_PARTS = 400
"""Chords along which the length of a bow is measured."""
SMALLEST_HARDENING = 1.0 / 32.0
"""Of the way from one floor to another, where at once finds no equilibrium."""


@dataclass(frozen=True)
class Lay:
    """A line that starts alone."""

    line: str
    name: str
    """Of its winch."""
    winch: SystemWinch
    anchor: Place | None
    """Where its far end is held; None: it is free."""
    scene: Scene
    """Of it alone, from the winch outwards, with a free end."""


def lays(scene: SystemScene) -> list[Lay]:
    """Lines of a system that start alone."""
    return [_alone(scene, name) for name in scene.winches if scene.runs_alone(name)]


def without(scene: SystemScene, apart: list[Lay]) -> SystemScene | None:
    """The system without lines that start alone; None: there is nothing else."""
    names = {lay.line for lay in apart}
    lines = {name: line for name, line in scene.lines.items() if name not in names}
    if not lines:
        return None
    winches = {name: winch for name, winch in scene.winches.items() if winch.line not in names}
    cuts = {name: cut for name, cut in scene.cuts.items() if cut.line not in names}
    return scene.model_copy(update={"lines": lines, "winches": winches, "cuts": cuts})


def _alone(scene: SystemScene, name: str) -> Lay:
    """The line of a winch, as a scene of its own."""
    winch = scene.winches[name]
    line = scene.lines[winch.line]
    end, other = line.ends if winch.at == "start" else line.ends[::-1]
    place = held_place(scene, end)
    assert place is not None
    velocity = scene.vessels[end.owner].motion().evaluate(0.0)[1]
    with _named(scene, name):
        alone = Scene(
            environment=scene.environment,
            cable_types=scene.cable_types,
            line=line.items if winch.at == "start" else line.items[::-1],
            vessel=Vessel.model_validate(
                {"position": place.tolist(), "velocity": [float(part) for part in velocity]}
            ),
            payout=Payout(rate=winch.rate, drum=winch.drum),
            solver=scene.solver,
            run=RunSettings(duration=BEGINS, output_interval=BEGINS),
        )
    return Lay(winch.line, name, winch, other.anchor, alone)


def start(lay: Lay, whole: SystemScene) -> Block:
    """The first state of a line that starts alone, in three dimensions, on the system's floor.

    Raises:
        SceneError: it has no steady state.
        StaticsError: none was found.
    """
    with _named(whole, lay.name):
        if lay.anchor is None:
            block = from_scene.build(lay.scene, planar=False)
        else:
            block = _to_anchor(lay.scene, lay.anchor)
        _on_floor_of(whole, block, lay.scene)
    return block


def _to_anchor(scene: Scene, anchor: Place) -> Block:
    """The first state of a line to an anchor; scene: of it with a free end."""
    held = Scene(
        **{name: getattr(scene, name) for name in Scene.model_fields if name != "end"},
        end=End(anchor=anchor),
    )
    laid_loads.check_steady(held)
    if scene.rate_at_start < 0.0:
        return _pulled(held, None)
    block = from_scene.build(scene, planar=False)
    lies = np.flatnonzero(laid_start.which_lie(block, scene))
    if len(lies) < 2:
        return _pulled(held, None)
    foot = int(lies[0])
    # What stretches what lies by no more than tensions may be wrong by.
    kind = scene.cable_types[scene.cables[-1].type]
    stretch = from_scene.promised_tension(block, scene) * float(kind.strain_coefficients[0])
    bow = _bow(block, scene, foot, np.asarray(anchor), stretch)
    if bow is None:
        return _pulled(held, from_scene.drawn_to(block, np.asarray(anchor)))
    for _round in range(REFINEMENT_ROUNDS):
        if bow is None or not _halved(block, scene, foot, *bow):
            break
        bow = _bow(block, scene, foot, np.asarray(anchor), stretch)
    assert bow is not None  # halves are as long as the whole
    _lay_along(block, scene, foot, np.asarray(anchor), *bow)
    return block


def _halved(block: Block, scene: Scene, foot: int, places: FloatArray, slopes: FloatArray) -> bool:
    """Whether elements have been halved that would bend too much with their nodes, from one on, at
    other places (n, 3) with slopes (n, 3): those of static shapes (start/refinement.py)."""
    from cablemodel.solvers import library as entry

    h = np.linalg.norm(np.diff(places, axis=0), axis=1)
    first, last = bends(places, slopes, h)
    jumps = np.linalg.norm(first[1:] - last[:-1], axis=1)
    jump = np.maximum(np.append(jumps, 0.0), np.insert(jumps, 0, 0.0))
    jump[-1] = max(jump[-1], END_BEND * float(np.linalg.norm(first[-1] - last[-1])))
    allowed = REFINEMENT_BENT * scene.solver.tolerance * scene.line_length
    bent = np.zeros(int(block.header.nodes))
    bent[foot + 1 : foot + 1 + len(h)] = h**2 * jump
    halved = refinement.image_before(block, lambda i, m: entry.halve_bent(i, m, bent, allowed))
    return halved is not None


def _pulled(held: Scene, points: FloatArray | None) -> Block:
    """The first state of a line that its anchor pulls; points: from which it is sought (n, 3) [m].

    Raises:
        SceneError: none of it lies, and its shape changes as the vessel goes on.
    """
    block = from_scene.build(held, planar=False, near=points)
    if laid_start.which_lie(block, held)[:-1].any():
        return block
    anchor = np.asarray(held.end.position)
    problem = f"{math.dist(held.vessel.position, anchor):.4g} m from the winch, so that "
    problem += f"none of {held.line_length:g} m of line lies: what hangs has no steady state"
    raise SceneError.at("end.anchor", anchor.tolist(), problem, "one nearer, or more cable out")


def _bow(
    block: Block, scene: Scene, foot: int, anchor: FloatArray, stretch: float
) -> tuple[FloatArray, FloatArray] | None:
    """Places (n, 3) of what lies, and its slopes (n, 3), in a bow from where it comes down to its
    anchor; None: it is too short for one.

    foot: the node nearest to the vessel that lies; stretch: that what lies may have [-].

    Raises:
        SceneError: the anchor is elsewhere than behind the vessel.
    """
    floor = scene.environment.floor
    assert floor is not None
    nodes = int(block.header.nodes)
    lies = earth(block, block.array(Header.position, nodes, 6)[foot:, :3])
    lies = _down(floor, lies)
    arcs = way_along(lies)
    back = lies[-1] - lies[0]
    way = back[:2] / float(np.hypot(*back[:2]))
    left = np.array([-way[1], way[0]])
    off = anchor[:2] - lies[0, :2]
    ahead, aside = float(off @ way), float(off @ left)
    if ahead <= 0.0:
        problem = f"the line comes down {-ahead:.4g} m behind it"
        allowed = "one behind where it comes down, or less cable out"
        raise SceneError.at("end.anchor", anchor.tolist(), problem, allowed)
    share = np.linspace(0.0, 1.0, BOW_PARTS + 1)
    # Both leave the way of the vessel without a turn, and without a bend.
    across = aside * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    belly = 64.0 * (share * (1.0 - share)) ** 3

    def curve(size: float) -> FloatArray:
        """Places (n, 3) on the floor [m]."""
        points = np.tile(lies[0], (len(share), 1))
        points[:, :2] += np.outer(ahead * share, way) + np.outer(across + size * belly, left)
        return _down(floor, points)

    def missing(size: float) -> float:
        return float(way_along(curve(size))[-1] - arcs[-1])

    sign = 1.0 if aside >= 0.0 else -1.0
    straight, most = missing(0.0), sign * float(arcs[-1])
    if straight > stretch * arcs[-1]:
        allowed_aside = scene.solver.tolerance * scene.line_length
        if abs(aside) <= allowed_aside:
            return None
        problem = (
            f"it is {abs(aside):.4g} m aside of the way of the vessel, and the line {straight:.4g} "
            "m too short to lie in a bow to it: it would be drawn over the floor"
        )
        allowed = f"one within {allowed_aside:.3g} m of that way, or so much more cable out"
        raise SceneError.at("end.anchor", anchor.tolist(), problem, allowed)
    if floor.friction == 0.0 and straight < -stretch * arcs[-1]:
        problem = f"the line is {-straight:.4g} m too long, and no friction holds a bow of it"
        allowed = "one so much farther away, or less cable out"
        raise SceneError.at("end.anchor", anchor.tolist(), problem, allowed)
    size = 0.0
    if straight < 0.0:
        size = crossing(
            missing, 0.0, most, at_low=straight, at_high=missing(most), near=0.0,
            width=RELATIVE_ROUNDING * abs(most),
        )  # fmt: skip
    points = curve(size)
    steps = way_along(points)
    steps *= arcs[-1] / steps[-1]
    tangents = np.gradient(points, steps, axis=0)
    places = np.column_stack([np.interp(arcs, steps, points[:, k]) for k in range(3)])
    slopes = np.column_stack([np.interp(arcs, steps, tangents[:, k]) for k in range(3)])
    places[-1, :2] = anchor[:2]
    places = _down(floor, places)
    return places, slopes / np.linalg.norm(slopes, axis=1)[:, None]


def _down(floor: Floor, points: FloatArray) -> FloatArray:
    """Points (n, 3) brought down, or up, to the floor [m]."""
    heights = [floor.height(float(x), float(y)) for x, y in points[:, :2]]
    return np.column_stack([points[:, :2], heights])


def _lay_along(
    block: Block,
    scene: Scene,
    foot: int,
    anchor: FloatArray,
    places: FloatArray,
    slopes: FloatArray,
) -> None:
    """Lay what lies, from a node on, along other places (n, 3) of the earth [m] with slopes (n, 3)
    to its anchor (3,); it sinks as deep into the floor as it did, and friction holds it as it did.

    On long bristles first, where it slides to where no tension is left.

    Raises:
        StaticsError: it does not come to rest there.
    """
    floor = scene.environment.floor
    assert floor is not None
    nodes, state = int(block.header.nodes), block.scalars
    q = block.array(Header.position, nodes, 6)
    rest = block.array(Header.rest, nodes, 6)
    drawn = q[foot:] - rest[foot:]
    old = earth(block, q[foot:, :3])
    q[foot:, :3] = places + old - _down(floor, old) - state.origin
    q[foot:, 3:] = slopes * np.linalg.norm(q[foot:, 3:], axis=1)[:, None]
    q[-1, :3] = anchor - state.origin
    _hold_end(block)
    bristle = float(state.bristle)
    for length in (laid_start.longest_bristle(block, scene), bristle):
        rest[foot:] = q[foot:] - drawn * length / bristle
        state.bristle = length
        status = _settled(block, scene)
        state.bristle = bristle
        if status != at.OK:
            raise StaticsError("no start was found in which friction holds what lies in a bow")


def _hold_end(block: Block) -> None:
    """Hold the far end of a line where it is: in the row that is kept for it."""
    row = block.array(Header.constraints, 2, at.CONSTRAINT_WORDS)[1]
    last = int(block.header.nodes) - 1
    row[at.Constraint.node], row[at.Constraint.kind] = last, at.HELD_BY_ANCHOR
    row[at.Constraint.position.span] = block.array(Header.position, last + 1, 6)[last, :3]
    block.header.constraint_count = 2


def _settled(block: Block, scene: Scene) -> int:
    """Equilibrium from a state that is nearly one, its friction as it is; a status."""
    rate = float(block.winch.rate)
    frame = steady_velocity(block, scene)
    block.winch.rate = laid_loads.lay_motion(scene)[1]
    status = continuation.in_few_steps(block, partial(search.equilibrium, block, frame))
    block.winch.rate = rate
    hold_supports(block)
    return status


def _on_floor_of(whole: SystemScene, block: Block, scene: Scene) -> None:
    """Put a start on the floor of a system, whose contact layer is that of its longest line.

    Raises:
        StaticsError: no start was found there.
    """
    state, nodes = block.scalars, int(block.header.nodes)
    before = float(state.floor_depth), float(state.bristle)
    wanted = sea_floor.contact_depth(whole), sea_floor.bristle_length(whole)
    if before == wanted:
        return
    q, rest = block.array(Header.position, nodes, 6), block.array(Header.rest, nodes, 6)
    drawn = (q - rest) / before[1]

    def at_share(share: float) -> int:
        state.floor_depth, state.bristle = (
            a * (b / a) ** share for a, b in zip(before, wanted, strict=True)
        )
        rest[:] = q - state.bristle * drawn
        return _settled(block, scene)

    if continuation.continued(block, at_share, step=1.0, smallest=SMALLEST_HARDENING) != at.OK:
        raise StaticsError("no start was found on the system's floor")
    state.floor_depth, state.bristle = wanted


@contextmanager
def _named(scene: SystemScene, name: str) -> Iterator[None]:
    """Errors of the line of a winch alone, in the words of the system's scene."""
    winch = scene.winches[name]
    line = scene.lines[winch.line]
    end, far = (line.start, "to") if winch.at == "start" else (line.end, "from")

    def path(own: str) -> str:
        head, _dot, tail = own.partition(".")
        if head == "vessel":
            return f"vessels.{end.owner}.{tail}".rstrip(".")
        if head == "payout":
            return f"winches.{name}.{tail}".rstrip(".")
        if head == "end":
            return f"lines.{winch.line}.{far}.{tail}".rstrip(".")
        if head == "line":
            return f"lines.{winch.line}.items"
        return own

    try:
        yield
    except (SceneError, ValidationError) as error:
        own = error.problems if isinstance(error, SceneError) else problems_of(error, Scene)
        problems = [SceneProblem(path(p.path), p.value, p.problem, p.allowed) for p in own]
        raise SceneError(problems) from None
    except StaticsError as error:
        where = f"lines.{winch.line}, which winches.{name} runs at t = 0"
        raise StaticsError(f"{where}: {_FROM_POINTS.sub('', str(error))}") from None
