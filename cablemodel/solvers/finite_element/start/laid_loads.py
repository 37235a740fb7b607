"""Weight, drag and friction on cable that lies on the floor or hangs down to it, at t = 0.

What a first shape that lies on the floor, and a start that friction holds, are made from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import SceneError
from cablemodel.solvers.finite_element.start.sea_floor import contact_weight

if TYPE_CHECKING:
    from cablemodel.scene import Scene
from cablemodel.solvers.shared.numbers import LYING

FloatArray = NDArray[np.float64]

DRAGGED = 5e-4
"""Of the rate of a lay without tension: where a lay falls short of it by more, what lies is drawn
over the floor, and bears the friction of that. Less is rounding of a speed in knots."""
LAID_UNEVEN = 0.1
"""The same over a depth table, where that rate changes from place to place."""
FLOATS = 1.25
"""Times the drag that lifts what lies on a slope, over its weight: below that gap, in contact
layers, some is at rest, and none floats."""
LAID_FLAT = 0.04
"""Between a lay and the floor [rad]: below it the touchdown runs away from the vessel."""
LAID_STEEP = 0.01
"""Of the vessel's speed: pay-out of a lay up a slope that is steeper than the line hangs."""
SLOPE_STEP = 1e-4
"""Of the line's length: to either side of a place, for the slope of a table there."""


@dataclass(frozen=True)
class Piece:
    """A cable, or a body, between two arc lengths (of cables and bodies) from the vessel [m]."""

    start: float
    end: float
    weight: float
    """Submerged [N/m]; of a point body, which has no length, [N]."""
    contact: float
    """What the floor bears of it [N/m], [N]."""
    normal: float
    """Drag over the square of the speed across [N s2/m3], [N s2/m2]."""
    tangential: float
    """The same along it."""
    strain: tuple[float, ...] = ()
    """Coefficients c1, c2, ... of its strain [1/N^k]; none: it does not stretch."""

    def stretch(self, tension: float) -> float:
        """Length over the unstretched one under a tension [N]."""
        powers = enumerate(self.strain, start=1)
        return 1.0 + math.fsum(c * tension**power for power, c in powers)


def pieces(scene: Scene) -> list[Piece]:
    """The line that is out at t = 0, from the vessel outwards."""
    rho = 0.5 * scene.environment.water_density
    gravity = scene.environment.gravity
    found, arc = [], 0.0
    for item in scene.line:
        if item.cable is not None:
            kind = scene.cable_types[item.cable.type]
            end = arc + item.cable.length
            contact = contact_weight(kind, gravity)
            normal = rho * kind.drag_normal * kind.diameter
            along = rho * kind.drag_tangential * math.pi * kind.diameter
            weight, strain = kind.submerged_weight, tuple(kind.strain_coefficients)
            found.append(Piece(arc, end, weight, contact, normal, along, strain))
            arc = end
        elif item.body is not None:
            body = item.body
            length = 2.0 * body.half_length
            weight = body.submerged_weight
            across = rho * body.drag_coefficient * body.drag_area
            along = rho * body.drag_coefficient_axial * body.drag_area_axial if length else across
            over = length or 1.0
            loads = weight / over, abs(weight) / over, across / over, along / over
            found.append(Piece(arc, arc + length, *loads))
            arc += length
    return found


def water_velocity(scene: Scene, z: FloatArray) -> FloatArray:
    """Velocity of the current at heights z (n,) [m] at t = 0, (n, 3) [m/s]."""
    current = scene.environment.current
    if current is None:
        return np.zeros((len(z), 3))
    table = np.asarray(current.velocity)
    now = np.stack(
        [
            [np.interp(0.0, current.t, table[:, k, i]) for i in range(3)]
            for k in range(len(current.z))
        ]
    )
    return np.stack([np.interp(z, current.z, now[:, i]) for i in range(3)], axis=-1)


def behind(scene: Scene, velocity: FloatArray, current: FloatArray) -> FloatArray:
    """Away from where the vessel goes, else downstream, (2,)."""
    way = scene.motion().horizontal_direction()
    if way is None or float(np.hypot(*velocity)) > 0.0:
        way = velocity
    if not np.any(way):
        way = -current
    size = float(np.hypot(*way))
    return np.array([-1.0, 0.0]) if size == 0.0 else -np.asarray(way, dtype=float) / size


def slopes(scene: Scene, x: float, y: float) -> tuple[float, float]:
    """Rise of the floor per metre towards x and y at a place [-]."""
    floor = scene.environment.floor
    assert floor is not None
    if floor.z is not None:
        return floor.slope
    step = SLOPE_STEP * scene.line_length
    along = floor.height(x + step, y) - floor.height(x - step, y)
    across = floor.height(x, y + step) - floor.height(x, y - step)
    return 0.5 * along / step, 0.5 * across / step


def out_of_floor(scene: Scene, x: float, y: float) -> FloatArray:
    """A vector across the floor at a place, upwards, (3,)."""
    rise = slopes(scene, x, y)
    return np.array([-rise[0], -rise[1], 1.0])


def way_back(scene: Scene, velocity: FloatArray) -> FloatArray:
    """A vector along an even floor, back from a vessel of this velocity (3,), (3,)."""
    rise = float(np.dot(slopes(scene, 0.0, 0.0), velocity[:2]))
    return -np.array([*velocity[:2], rise])


def lay_angle(weight: float, drag: float) -> float:
    """Angle a of a lay from the horizontal [rad]: w cos a = D sin^2 a (Zajac 1957).

    weight: w [N/m]; drag: D, across a vertical cable at the vessel's speed [N/m].
    """
    return math.acos(2.0 * drag / (weight + math.hypot(weight, 2.0 * drag)))


def lay_rate(scene: Scene) -> float:
    """Pay-out with which a lay keeps up with its vessel, without slack and without tension [m/s].

    Over a floor that rises by b along the vessel's way, at the lay angle a, the touchdown moves
    along the floor faster than the vessel does, and the suspended cable gets shorter:
    U (sin a - sin b) / sin(a - b) (Zajac 1957). Uphill that is less than the speed, downhill it is
    more.
    """
    velocity = scene.motion().evaluate(0.0)[1]
    speed = float(np.hypot(velocity[0], velocity[1]))
    floor = scene.environment.floor
    if speed == 0.0 or floor is None or floor.z is None:
        return speed
    up = _rise_ahead(scene, scene.motion().evaluate(0.0)[0], velocity)
    down = _angle_of(scene, speed)
    if down is None:
        return speed
    if up >= down:
        return LAID_STEEP * speed  # the line does not come down to the floor behind it
    return speed * (math.sin(down) - math.sin(up)) / math.sin(down - up)


def lays_slack(scene: Scene) -> bool:
    """Whether a lay begins with more cable than it takes, by more than positions are promised."""
    rate = scene.rate_at_start
    return rate > 0.0 and rate > (1.0 + scene.solver.tolerance) * lay_rate(scene)


def lay_motion(scene: Scene) -> tuple[FloatArray, float]:
    """Velocity of the frame in which a start is at rest, (3,), and of the cable along it [m/s].

    The vessel's velocity and the pay-out; of a lay over a plane that rises by b along its way, the
    touchdown's, W = U sin a / sin(a - b) along the plane. In that frame what hangs is the same
    (W t_floor - U t_level points along it), and what has been laid is at rest or, where the lay is
    taut, slides along the floor and not into it.
    """
    place, velocity = scene.motion().evaluate(0.0)[:2]
    velocity = np.asarray(velocity, dtype=np.float64)
    rate = scene.rate_at_start
    floor, speed = scene.environment.floor, float(np.hypot(velocity[0], velocity[1]))
    if rate <= 0.0 or speed == 0.0 or velocity[2] != 0.0 or floor is None or floor.z is None:
        return velocity, rate
    alike = len({cable.type for cable in scene.cables}) == 1
    if scene.environment.current is not None or not alike:
        return velocity, rate
    up = _rise_ahead(scene, place, velocity)
    down = _angle_of(scene, speed)
    if up == 0.0 or down is None or down - up < LAID_FLAT:
        return velocity, rate
    over_ground = speed * math.sin(down) / math.sin(down - up)
    exact = speed * (math.sin(down) - math.sin(up)) / math.sin(down - up)
    way = np.array([*(velocity[:2] / speed * math.cos(up)), math.sin(up)])
    return over_ground * way, over_ground + rate - exact


def laid(scene: Scene) -> float:
    """Gap above the floor at which none of the cable has been laid, in contact layers; 0: what lies
    is dragged, and runs along itself like all of it in the frame of the start.

    What has been laid is at rest, and the momentum of a flow does not push it. At `LYING` even a
    taut cable would not touch a rigid floor. What lies on a slope and runs into it, in the frame of
    a vessel in a current, is lifted by drag of L times its weight: at a gap x, where the floor
    bears 2 x - x^2 less of that, it would float, but for what is at rest.
    """
    floor = scene.environment.floor
    if floor is None or is_dragged(scene):
        return 0.0
    return max(LYING, min(1.0, FLOATS * _lift(scene)))


def _lift(scene: Scene) -> float:
    """Of drag on cable that lies on a plane and runs with its vessel, over its weight [-]: of the
    outermost one."""
    velocity, rate = lay_motion(scene)
    floor = scene.environment.floor
    assert floor is not None
    if floor.z is None or not np.any(velocity[:2]):
        return 0.0
    up, way = out_of_floor(scene, 0.0, 0.0), way_back(scene, velocity)
    up, way = up / np.linalg.norm(up), way / np.linalg.norm(way)
    flow = water_velocity(scene, np.array([floor.z]))[0] - velocity - rate * way
    across = flow - (flow @ way) * way
    lies = [piece for piece in pieces(scene) if piece.end > piece.start][-1]
    drag = lies.normal * float(np.linalg.norm(across)) * float(across @ up)
    return max(0.0, drag / lies.contact)


def _rise_ahead(scene: Scene, place: FloatArray, velocity: FloatArray) -> float:
    """Angle by which the floor rises along the vessel's way [rad]."""
    rise = np.array(slopes(scene, float(place[0]), float(place[1])))
    return math.atan(float(rise @ velocity[:2]) / float(np.hypot(velocity[0], velocity[1])))


def _angle_of(scene: Scene, speed: float) -> float | None:
    """Lay angle of the line's cables together [rad]; None of what floats."""
    line = [piece for piece in pieces(scene) if piece.end > piece.start]
    weight = math.fsum(piece.weight * (piece.end - piece.start) for piece in line)
    drag = math.fsum(piece.normal * (piece.end - piece.start) for piece in line) * speed**2
    return lay_angle(weight, drag) if weight > 0.0 else None


def is_dragged(scene: Scene) -> bool:
    """Whether the vessel drags what lies over the floor: it pays out less than a lay takes and,
    down a slope, than its speed."""
    velocity = scene.motion().evaluate(0.0)[1]
    rate = min(lay_rate(scene), float(np.hypot(velocity[0], velocity[1])))
    floor = scene.environment.floor
    uneven = floor is not None and floor.z is None
    return rate - scene.rate_at_start > (LAID_UNEVEN if uneven else DRAGGED) * rate


def check_steady(scene: Scene) -> None:
    """Refuse a line to an anchor that has no steady state under way: the winch must pay out what a
    lay takes, or more, or take up what it goes along.

    Raises:
        SceneError: it does not, and what would do.
    """
    rate, velocity = scene.rate_at_start, scene.motion().evaluate(0.0)[1]
    anchor, place = np.asarray(scene.end.position), scene.motion().evaluate(0.0)[0]
    speed = float(np.hypot(velocity[0], velocity[1]))
    if rate == 0.0 or scene.environment.floor is None:
        raise SceneError.at(
            "initial",
            "static",
            "an anchored cable has no steady state while the vessel moves",
            "a vessel at rest at t = 0, or initial: {points: [...]}",
        )
    away = float(velocity[:2] @ (place - anchor)[:2])
    needed = lay_rate(scene) if away > 0.0 else -speed
    held = "its end is held, and what hangs would get"
    if rate < (1.0 - DRAGGED) * needed if away > 0.0 else rate < (1.0 + DRAGGED) * needed:
        problem = f"{held} ever tighter: there is no steady state"
    elif (rate > 0.0) is not (away > 0.0) or (rate < 0.0 and rate > (1.0 - DRAGGED) * needed):
        problem = f"{held} ever longer: there is no steady state"
    else:
        return
    where = "away from its anchor" if away > 0.0 else "to its anchor"
    at_least = "at least " if away > 0.0 else ""
    if speed == 0.0:
        where, allowed = "at rest", "0 m/s at t = 0"
    else:
        allowed = f"{at_least}{needed:.6g} m/s at t = 0 (the vessel goes {where})"
    raise SceneError.at("payout.rate", rate, problem, allowed)


def becomes_taut(scene: Scene) -> bool:
    """Whether a lay down a slope keeps up with its vessel's speed, and not with its touchdown."""
    rate = scene.rate_at_start
    if rate <= 0.0 or scene.environment.current is not None or is_dragged(scene):
        return False
    return rate < (1.0 - DRAGGED) * lay_rate(scene)
