"""What is legal in a scene, but seldom meant."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from cablemodel.model import CableModel, CableState
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.line import CableType, LineItem
    from cablemodel.scene.vessel import RatePoint, Vessel
    from cablemodel.systems import SystemModel, SystemScene
    from cablemodel.systems.free_bodies import Hull

Angles = list[tuple[str, "float | None"]]
"""Where they stand in a scene [rad]."""
KNOT = 1852.0 / 3600.0
"""A knot [m/s]."""
_AIR = 100.0
"""Densities [kg/m3] below this are air; nothing is surprising about it above z = 0."""
_LIGHTEST, _HEAVIEST = 100.0, 12_000.0
"""Densities [kg/m3] of cables: foam and lead."""
_ROUGHEST = 0.5
"""Tangential drag coefficient of the roughest lines, on the circumference: chain has up to 0.4."""
_AS_KILOGRAMS = 0.05
"""Part by which a weight may differ from a mass that stands in its place."""
_TONNES = (0.95, 1.1)
"""Densities of water in t/m3; air has 1.2 kg/m3."""
_HANGING_STRAIN = 0.5
"""Of a cable by its own weight: no cable stretches by half its length before it is used."""
_WHOLE_DEGREE = 1e-6
"""Angles so near to whole degrees were given in degrees."""
_HEAVIER = 1e-6
"""Part of a weight in air by which rounding may make that in water the larger one."""
_ABOVE_WATER = 0.01
"""Height [m] by which a cable may stand above z = 0 without a word."""
_FASTEST = 20.0
"""Speeds [m/s] of ships and water that tow or carry a cable (39 knots)."""
_FASTEST_WINCH = 10.0
"""Rates [m/s] of winches; a cable ship lays at up to 4, a linear winch runs at 6."""
_THICKEST = 0.4
"""Diameters [m] of cables and hoses; the thickest power cable has 0.3."""
_HEAVE = 2
"""Turns from up to down and back that make a motion one of heave."""
_NO_FORCE = 1e-6
"""Forces [N] that rounding makes of none."""
_OVERLAP = 0.01
"""Part of a hull's radius by which it may be within another without a word."""
_BALLS = 33
"""Along a hull, or around it, that stand for it."""
_EMPTY = 1e-6
"""Part of a pay-out that the drum may lack: rounding."""


def scene_warnings(scene: Scene) -> list[str]:
    """What is seen without a start."""
    from cablemodel.solvers.finite_element.start.scales import is_flexible

    found = list(scene.notes)
    settings = scene.run
    if settings.output_interval > settings.duration:
        found.append(
            f"run.output_interval ({settings.output_interval:g} s) is longer than run.duration "
            f"({settings.duration:g} s): only the start and the end are output"
        )
    found += _angles_without_unit(_path_angles("vessel", scene.vessel) + _wave_angles(scene))
    found += _fast_vessel("the tow point", scene.motion().typical_speed)
    found += _heave_that_ends("vessel", scene.vessel, scene.run.duration)
    if scene.vessel.path is not None and scene.vessel.interpolation != "linear":
        found.append("vessel.interpolation is between rows of velocity: a path is as it is")
    found += _fast_water(scene)
    found += _fast_winch("payout.rate", scene.payout.rate)
    density = scene.environment.water_density
    if _TONNES[0] <= density <= _TONNES[1]:
        found.append(
            f"environment.water_density is {density:g} kg/m3, that of air; t/m3 need their unit: "
            f"{density:g} t/m3"
        )
    if scene.vessel.connection.kind == "clamped" and is_flexible(scene, scene.cables[0]):
        found.append("vessel.connection is clamped, but the first cable has no bending: no effect")
    items = scene.line_and_drum
    found += _type_warnings(scene, items, "the line or its drum")
    found += _item_warnings(scene, items)
    found += _end_of_the_drum("payout", scene.payout.rate, scene.payout.drum, scene.run.duration)
    for name, strain in _stretched_by_weight(scene).items():
        kind = scene.cable_types[name]
        found.append(
            f"cable type {name} would stretch by {100 * strain:.3g} % under the line's own weight; "
            + _stiffness_asked(kind)
        )
    return found


def system_warnings(scene: SystemScene) -> list[str]:
    """What looks wrong in the scene of a system."""
    from cablemodel.systems.lines import bends_at

    items = [item for line in scene.lines.values() for item in line.items]
    items += [item for winch in scene.winches.values() for item in winch.drum]
    found = _type_warnings(scene, items, "any line or drum") + _item_warnings(scene, items)
    found += _angles_without_unit(_part_angles(scene) + _wave_angles(scene))
    for name, body in scene.bodies.items():
        weight = body.weight_in(scene.environment)
        found += _heavier_in_water(scene, f"bodies.{name}", weight, body.mass, "")
    for name, vessel in scene.vessels.items():
        found += _fast_vessel(f"vessels.{name}", vessel.motion().typical_speed)
        found += _heave_that_ends(f"vessels.{name}", vessel, scene.run.duration)
        found += _waves_beyond_responses(scene, name)
    found += _fast_water(scene)
    for name, winch in scene.winches.items():
        found += _fast_winch(f"winches.{name}.rate", winch.rate)
        found += _end_of_the_drum(f"winches.{name}", winch.rate, winch.drum, scene.run.duration)
    for name, line in scene.lines.items():
        for word, end in (("from", line.start), ("to", line.end)):
            if end.clamped is not None and not bends_at(scene, line, end):
                problem = "is clamped, but the cable there has no bending: no effect"
                found.append(f"lines.{name}.{word} {problem}")
    return found


def _waves_beyond_responses(scene: SystemScene, name: str) -> list[str]:
    """Of a vessel whose responses are not given for the waves that it meets at the start."""
    from cablemodel.scene.sea import sea
    from cablemodel.systems.motion import first_angles

    vessel, water = scene.vessels[name], sea(scene)
    if not vessel.raos or water is None:
        return []
    headings = [row.heading_deg for row in vessel.raos]
    periods = [row.period for row in vessel.raos]
    heading = math.degrees(water.direction - first_angles(vessel)[2])
    heading = abs(math.remainder(heading, 360.0))  # of mirror images, as rows are
    found = []
    one_side = min(headings) >= 0.0 and max(headings) <= 180.0
    for words, met, given in (
        (f"go {heading:.3g} deg from its bow at the start", heading, headings if one_side else ()),
        (f"have a period of {water.period:.3g} s", water.period, periods),
    ):
        if given and not min(given) - 1e-6 <= met <= max(given) + 1e-6:
            found.append(
                f"vessels.{name}.raos: waves {words}, rows are for {min(given):g} to "
                f"{max(given):g}: beyond them the response is as at the last"
            )
    return found


def _type_warnings(scene: CableScene, items: Iterable[LineItem], where: str) -> list[str]:
    """Cable types that are not used, or whose numbers look wrong."""
    found = []
    used = {item.cable.type for item in items if item.cable is not None}
    for name in sorted(scene.cable_types):
        kind = scene.cable_types[name]
        if name not in used:
            found.append(f"cable_types.{name} is not used in {where}")
            continue
        density = kind.mass / (0.25 * math.pi * kind.diameter**2)
        if not _LIGHTEST < density < _HEAVIEST:
            flexible = density > _HEAVIEST and kind.bending_stiffness == 0.0
            chain = " Of chain it is that of its volume, 1.8 times the bar's." if flexible else ""
            found.append(
                f"cable type {name} has a density of {density:.3g} kg/m3 (water: "
                f"{scene.environment.water_density:g}): are its diameter ({kind.diameter:g} m) and "
                f"its mass ({kind.mass:g} kg/m) right?{chain}"
            )
        if kind.diameter > _THICKEST:
            found.append(
                f"cable type {name} is {kind.diameter:g} m thick; mm need their unit: is its "
                "diameter right?"
            )
        weight = kind.submerged_weight or 0.0
        if weight < 0.0 and scene.environment.waves is None:  # a surface to float on
            found.append(f"cable type {name} floats: its submerged weight is {weight:g} N/m")
        found += _heavier_in_water(scene, f"cable type {name}", weight, kind.mass, "/m")
        if kind.drag_tangential > _ROUGHEST:
            found.append(
                f"cable type {name} has a drag_tangential of {kind.drag_tangential:g}, on the "
                "circumference: a coefficient on the diameter is to be divided by pi"
            )
        area = 0.25 * math.pi * kind.diameter**2
        wet = kind.mass - scene.environment.water_density * area
        if weight != 0.0 and abs(weight - wet) < _AS_KILOGRAMS * abs(wet):
            found.append(
                f"cable type {name} has a submerged_weight of {weight:g} N/m: its mass less the "
                f"water's is {wet:.4g} kg/m, or {wet * scene.environment.gravity:.4g} N/m; kgf/m "
                "need their unit"
            )
    return found


def _item_warnings(scene: CableScene, items: Iterable[LineItem]) -> list[str]:
    """Bodies in lines whose numbers look wrong."""
    found = []
    for item in items:
        if (body := item.body) is not None:
            what = f"body {body.name}" if body.name else "a body"
            found += _heavier_in_water(scene, what, body.submerged_weight, body.mass, "")
            asked = "drag_area_axial" in body.model_fields_set or body.half_length == 0.0
            if body.drag_area > 0.0 and not asked:
                found.append(
                    f"{what} has a drag_area, but no drag along its axis: drag_area_axial is "
                    "not given"
                )
            for way in ("", "_axial"):
                area, given = f"drag_area{way}", f"drag_coefficient{way}"
                if given in body.model_fields_set and getattr(body, area) == 0.0:
                    found.append(f"{what} has a {given}, but no {area}: it has no effect")
            if body.centre_offset != 0.0 and body.half_length == 0.0:
                found.append(f"{what} has a centre_offset, but no half_length: it has no effect")
    return found


def _fast_vessel(what: str, speed: float) -> list[str]:
    """A vessel that moves as none does [m/s]: a unit left out, or the wrong one."""
    if speed <= _FASTEST:
        return []
    return [
        f"{what} moves at up to {speed:.3g} m/s ({speed / KNOT:.3g} knots): is the "
        "vessel's velocity right? kn need their unit"
    ]


def _heave_that_ends(name: str, vessel: Vessel, duration: float) -> list[str]:
    """Of a tow point that goes up and down by a table that ends before the run does."""
    if vessel.velocity is None:
        return []
    times = vessel.velocity.column("t")
    upwards = vessel.velocity.column("velocity")[:, 2]
    turns = np.count_nonzero(np.diff(np.sign(upwards[upwards != 0.0])))
    if turns < _HEAVE or times[-1] >= duration:
        return []
    last = upwards[-1]
    goes_on = f"at {last:.3g} m/s, its last speed upwards" if last else "without heave"
    return [
        f"{name}.velocity ends at {times[-1]:g} s, run.duration is {duration:g} s: from then on it "
        f"goes on {goes_on}"
    ]


def _fast_water(scene: CableScene) -> list[str]:
    """A current that flows as none does."""
    current = scene.environment.current
    flow = 0.0 if current is None else float(np.linalg.norm(current.velocity, axis=-1).max())
    found = []
    if current is not None and len(current.z) > 1 and current.z[0] >= 0.0 < current.z[-1]:
        found.append(
            f"environment.current.table is all at or above the still water, up to z = "
            f"{current.z[-1]:g} m: z is up, and a depth of {current.z[-1]:g} m has z = "
            f"{-current.z[-1]:g}"
        )
    if flow <= _FASTEST:
        return found
    return [
        *found,
        f"environment.current reaches {flow:.3g} m/s ({flow / KNOT:.3g} knots): is it "
        "right? kn need their unit",
    ]


def _fast_winch(what: str, table: Iterable[RatePoint]) -> list[str]:
    """A winch that runs as none does."""
    rate = max((row.rate for row in table), key=abs)
    if abs(rate) <= _FASTEST_WINCH:
        return []
    return [
        f"{what} reaches {rate:.3g} m/s: no winch is as fast; is it right? m/min need their unit"
    ]


def _waves_of_a_winch(scene: Scene, tension: float) -> list[str]:
    """A winch that changes its rate so quickly that of waves along an undamped line, taut by its
    load, more is missed than tensions may be wrong by.

    Of a uniform bar between winch and load: a = dv/dt of the upper end for a time T leaves a first
    wave of at most 4 m L a / pi^2. Beyond the k-th are 1 / k of that.
    """
    end = scene.run.duration
    changes = [
        (before, after)
        for before, after in pairwise(scene.payout.rate)
        if after.rate != before.rate and after.t <= end
    ]
    load = scene.line[-1].body
    if not changes or load is None or load.submerged_weight < 0.5 * tension:
        return []
    from cablemodel.solvers.finite_element.kernels.time.tension import LOSS_FACTOR
    from cablemodel.solvers.finite_element.kernels.time.waves import OVERTONES

    cables = [(cable.length, scene.cable_types[cable.type]) for cable in scene.cables]
    mass = sum(length * kind.mass for length, kind in cables)
    softness = [(length, kind.strain_coefficients[0]) for length, kind in cables]
    turn = math.pi / math.sqrt(mass * sum(length * soft for length, soft in softness))
    needed = LOSS_FACTOR / (max(soft for _, soft in softness) * turn)
    if any(kind.axial_damping >= needed for _, kind in cables):
        return []
    promised = 10.0 * scene.solver.tolerance * tension
    found = []
    for before, after in changes:
        change, lasts = abs(after.rate - before.rate), after.t - before.t
        wave = 4.0 / math.pi**2 * mass * change / lasts
        if wave > OVERTONES * promised:
            found.append(
                f"payout.rate changes by {change:.3g} m/s within {lasts:.3g} s at {before.t:g} s: "
                f"waves of up to {wave / 1e3:.2g} kN then run along the line without an end, and "
                f"only the first {OVERTONES} are followed; an axial_damping of {needed:.2g} N s, "
                f"a loss of {100 * LOSS_FACTOR:g} %, ends them"
            )
    return found


def _path_angles(place: str, vessel: Vessel) -> Angles:
    found: Angles = []
    for index, leg in enumerate(vessel.path or ()):
        at = f"{place}.path.{index}"
        if leg.straight is not None:
            found.append((f"{at}.straight.heading", leg.straight.heading))
        if leg.turn is not None:
            found.append((f"{at}.turn.angle", leg.turn.angle))
            found.append((f"{at}.turn.heading", leg.turn.heading))
    return found


def _wave_angles(scene: CableScene) -> Angles:
    found: Angles = []
    if (waves := scene.environment.waves) is not None:
        if waves.regular is not None:
            found.append(("environment.waves.regular.direction", waves.regular.direction))
            found.append(("environment.waves.regular.phase", waves.regular.phase))
        if waves.jonswap is not None:
            found.append(("environment.waves.jonswap.direction", waves.jonswap.direction))
        if waves.components is not None:
            found.append(("environment.waves.components.direction", waves.components.direction))
    return found


def _part_angles(scene: SystemScene) -> Angles:
    """Of vessels, bodies and foils."""
    found: Angles = []
    for name, vessel in scene.vessels.items():
        found += _path_angles(f"vessels.{name}", vessel)
        if vessel.attitude is not None:
            largest = np.abs(vessel.attitude.column("attitude")).max(axis=0)
            found += [(f"vessels.{name}.attitude", float(angle)) for angle in largest]
    for name, body in scene.bodies.items():
        found += [(f"bodies.{name}.attitude", angle) for angle in body.attitude]
        for foil, wing in body.foils.items():
            place = f"bodies.{name}.foils.{foil}"
            found += [(f"{place}.deflection", wing.deflection), (f"{place}.stall", wing.stall)]
    return found


def _angles_without_unit(angles: Angles) -> list[str]:
    """Angles of more than a turn that are no whole degrees: degrees without their unit."""
    found = []
    for place, angle in angles:
        if angle is None or abs(angle) <= 2.0 * math.pi:
            continue
        degrees = math.degrees(angle)
        if abs(degrees - round(degrees)) > _WHOLE_DEGREE:
            found.append(
                f"{place}: {angle:g} rad is {abs(angle) / (2.0 * math.pi):.3g} turns; degrees need "
                f"their unit: {angle:g} deg"
            )
    return found


def _heavier_in_water(
    scene: CableScene, what: str, weight: float, mass: float, per: str
) -> list[str]:
    """A weight in water that is more than that in air."""
    in_air = mass * scene.environment.gravity
    if weight <= (1.0 + _HEAVIER) * in_air:
        return []
    return [
        f"{what} is heavier in water ({weight:g} N{per}) than in air ({mass:g} kg{per}, "
        f"{in_air:.4g} N{per}): are its submerged weight, in N{per}, and its mass right?"
    ]


def _end_of_the_drum(
    where: str, rows: tuple[RatePoint, ...], drum: tuple[LineItem, ...], end: float
) -> list[str]:
    """A pay-out until a time that asks for more than the drum holds. where: path of its winch."""
    if all(row.rate <= 0.0 for row in rows):
        return []
    from scipy.interpolate import PPoly

    cables = sum(item.cable.length for item in drum if item.cable is not None)
    bodies = sum(2.0 * item.body.half_length for item in drum if item.body is not None)
    held = cables + bodies
    times = np.array(sorted({0.0, end, *(row.t for row in rows if 0.0 < row.t < end)}))
    rates = np.interp(times, [row.t for row in rows], [row.rate for row in rows])
    slopes = np.diff(rates) / np.diff(times)
    rate = PPoly(np.stack([slopes, rates[:-1]]), times)
    paid_out = rate.antiderivative()
    turns = rate.roots(extrapolate=False)
    stretches = np.unique([*times, *turns[np.isfinite(turns)]])
    enough = (1.0 + _EMPTY) * held + _EMPTY
    for first, last in pairwise(stretches):  # monotonic each
        if paid_out(last) <= enough:
            continue
        reached = paid_out.solve(held, extrapolate=False)
        inside = reached[(reached >= first) & (reached <= last)]
        empty = float(inside[0]) if len(inside) else float(first)
        return [
            f"{where}.drum holds {held:g} m, and {where}.rate asks for "
            f"{paid_out(stretches).max():.6g} m within the run: it is empty at t = {empty:.6g} s, "
            "and no more is paid out"
        ]
    return []


def _stretched_by_weight(scene: Scene) -> dict[str, float]:
    """Cable types that the line's weight stretches by more than half, and by how much: hanging
    down from the vessel, as far as the water is deep."""
    x, y, z = scene.vessel.position
    floor, gravity = scene.environment.floor, scene.environment.gravity
    room = math.inf if floor is None else max(z - floor.height(x, y), 0.0)
    hanging: list[tuple[str | None, float, float]] = []
    """Cable type (None: a body), length [m] and weight [N]."""
    for item in scene.line:
        if room <= 0.0:
            break
        if item.cable is not None:
            kind, length = scene.cable_types[item.cable.type], min(item.cable.length, room)
            weight = max(kind.mass * gravity, abs(kind.submerged_weight or 0.0)) * length
            hanging.append((item.cable.type, length, weight))
            room -= length
        elif item.body is not None:
            hanging.append((None, 0.0, abs(item.body.submerged_weight)))
    found: dict[str, float] = {}
    below = 0.0
    for name, _, weight in reversed(hanging):
        if name is not None:
            strain = _strain(scene.cable_types[name], below + 0.5 * weight)
            if strain > _HANGING_STRAIN:
                found[name] = max(strain, found.get(name, 0.0))
        below += weight
    return found


def _strain(kind: CableType, tension: float) -> float:
    return sum(c * tension ** (k + 1) for k, c in enumerate(kind.strain_coefficients))


def _stiffness_asked(kind: CableType) -> str:
    if kind.axial_stiffness is None:
        return "is its tension_strain right?"
    return (
        f"is its axial stiffness right? {kind.axial_stiffness:g} N; MN need their unit: "
        f"{kind.axial_stiffness:g} MN"
    )


def start_warnings(scene: Scene, model: CableModel, state: CableState) -> list[str]:
    """What is seen at the start."""
    found = []
    said = _stretched_by_weight(scene)
    for name in sorted({cable.type for cable in scene.cables} - said.keys()):
        found += _stretched_at_start(scene, name, model.tension_max)
    found += _in_water_above(scene, "the cable", float(state.position[:, 2].max()))
    found += _waves_of_a_winch(scene, model.tension_max)
    if model.floor_length > 0.0:
        found += _straight_on_the_floor(scene)
    slack = 10.0 * scene.solver.tolerance * max(abs(model.tension_max), abs(model.tension_min))
    if model.tension_min < -max(slack, _NO_FORCE):
        found.append(f"the cable is compressed at the start: {model.tension_min:.3g} N")
    return found


def _straight_on_the_floor(scene: Scene) -> list[str]:
    """Of a lay whose slack has to fold what lies straight at the start."""
    from cablemodel.solvers.finite_element.start.laid_loads import lays_slack
    from cablemodel.solvers.finite_element.start.scales import is_flexible

    bends = not is_flexible(scene, scene.cables[-1])
    starts_alone = scene.initial.kind == "static" and scene.end.kind == "free"
    if not (starts_alone and bends and lays_slack(scene)):
        return []
    return [
        "the lay begins with slack, and what lies at the start is straight: it is pushed, and "
        "tensions are not yet those of the lay, until it has folded"
    ]


def _stretched_at_start(scene: CableScene, name: str, tension: float, line: str = "") -> list[str]:
    from cablemodel.solvers.finite_element.start.scales import LARGE_STRAIN

    strain = _strain(scene.cable_types[name], tension)
    if strain <= LARGE_STRAIN:
        return []
    where = f" of lines.{line}" if line else ""
    asked = "are its axial stiffness and that length" if line else "is its axial stiffness"
    return [
        f"cable type {name} would stretch by {100 * strain:.1f} % under the highest tension"
        f"{where} at the start; {asked} right?"
    ]


def _in_water_above(scene: CableScene, what: str, above: float) -> list[str]:
    wet = scene.environment.water_density > _AIR and scene.environment.waves is None
    if not wet or above <= _ABOVE_WATER:
        return []
    return [
        f"{what} reaches {above:.3g} m above z = 0; without waves there is water everywhere, also "
        "there"
    ]


def system_start_warnings(model: SystemModel) -> list[str]:
    """What is seen at the start of a system."""
    scene = model.scene
    found = []
    highest = {name: line.sample().position[:, 2].max() for name, line in model.lines.items()}
    for name, line in model.lines.items():
        items = scene.lines[name].items
        for kind in sorted({item.cable.type for item in items if item.cable is not None}):
            found += _stretched_at_start(scene, kind, line.tension_range[1], name)
    name = max(highest, key=lambda line: highest[line])
    found += _in_water_above(scene, f"lines.{name}", float(highest[name]))
    return found + _parted_at_start(model) + _held_too_softly(model) + _hulls_overlap(model)


def _hulls_overlap(model: SystemModel) -> list[str]:
    """Of hulls that are within each other at the start: bodies do not touch."""
    found = []
    balls = []
    motions = model.bodies
    for name, body in model.scene.bodies.items():
        if body.hull is not None:
            motion = motions[name]
            places, radius = _balls_in(body.hull)
            balls.append((name, motion.position + places @ motion.axes.T, radius))
    for (name, ours, radius), (other, theirs, reach) in combinations(balls, 2):
        gap = np.linalg.norm(ours[:, None] - theirs[None], axis=2).min() - radius - reach
        if gap < -_OVERLAP * min(radius, reach):
            found.append(
                f"bodies.{name}.hull is {-gap:.3g} m within that of {other} at the start, and "
                "bodies do not push each other apart: place them by position, or by their lines"
            )
    return found


def _balls_in(hull: Hull) -> tuple[NDArray[np.float64], float]:
    """Middles (n, 3) in the body's axes, and the radius, of balls that fill a hull [m]: what they
    have in common with others the hull has, too."""
    height = hull.diameter if hull.height is None else hull.height
    radius = 0.5 * min(hull.diameter, height)
    rim, end = 0.5 * hull.diameter - radius, 0.5 * height - radius
    turns = np.linspace(0.0, 2.0 * math.pi, _BALLS)
    flat = [(r * math.cos(a), r * math.sin(a), 0.0) for r in (0.0, 0.5 * rim, rim) for a in turns]
    long = [(0.0, 0.0, z) for z in np.linspace(-end, end, _BALLS)]
    return np.array(hull.centre) + np.array(flat if rim > 0.0 else long), radius


def _parted_at_start(model: SystemModel) -> list[str]:
    """Of what breaks above a tension that it has from the beginning on."""
    found = []
    for name, cut in model.scene.cuts.items():
        if cut.tension is None:
            continue
        arc = model.scene.lines[cut.line].arc_at(cut.at)
        tension = float(model.lines[cut.line].sample([arc]).tension[0])
        if tension > cut.tension:
            found.append(
                f"cuts.{name}: {cut.line} has {tension:.4g} N there at the start, and breaks at "
                f"once above tension = {cut.tension:.4g} N"
            )
    return found


def _held_too_softly(model: SystemModel) -> list[str]:
    """Of friction that takes hold too softly in a run, the line that this matters to most."""
    scene = model.scene
    accuracy = scene.solver.accuracy or scene.solver.tolerance
    worst, reach, wrong, more = "", 0.0, 0.0, 1.0
    others = []
    for name, line in model.lines.items():
        its_reach, its_wrong = held_by_springs(model, name)
        times = its_wrong / (10.0 * accuracy * max(max(map(abs, line.tension_range)), 1e-300))
        if times > 1.0:
            others.append(name)
        if times > more:
            worst, reach, wrong, more = name, its_reach, its_wrong, times
    if not worst:
        return []
    others.remove(worst)
    anchored = any(end.anchor is not None for end in scene.lines[worst].ends)
    when = " as it moves" if anchored and model.built.friction_holds else ""
    also = f" (and {', '.join(others)})" if others else ""
    bristle = 1e3 * model.built.block.scalars.bristle
    return [
        f"lines.{worst}{also}: friction takes hold over {bristle:.2g} mm, so a "
        f"change of tension reaches some {reach:.2g} m further along the floor than Coulomb's "
        f"friction lets it: what lies, and its anchor, may feel up to {wrong:.4g} N too much or "
        f"too little{when}, {more:.2g} times what is promised; less at a finer tolerance, as its "
        "root"
    ]


def held_by_springs(model: SystemModel, name: str) -> tuple[float, float]:
    """How far tension gets along what lies of a line at the start by the springs that friction is
    made of [m], and by how much it may be wrong there [N]; zeros where nothing lies.

    A change dT dies out over sqrt(EA u / (mu w)), where springs of a length u bear mu w; Coulomb's
    friction ends it at once where its front has come to.
    """
    scene = model.scene
    floor = scene.environment.floor
    if floor is None or floor.friction == 0.0:
        return 0.0, 0.0
    state = model.lines[name].sample()
    lying = state.on_floor[1:] & state.on_floor[:-1]
    middles, lengths = 0.5 * (state.s[1:] + state.s[:-1]), np.diff(state.s)
    farthest = most = along = 0.0
    for item in scene.lines[name].items:
        if item.cable is None:
            continue
        within = (middles > along) & (middles < along + item.cable.length)
        along += item.cable.length
        lies = float(lengths[within & lying].sum())
        kind = scene.cable_types[item.cable.type]
        holds = floor.friction * max(0.0, kind.submerged_weight)
        if lies == 0.0 or holds == 0.0:
            continue
        reach = math.sqrt(model.built.block.scalars.bristle / (kind.strain_coefficients[0] * holds))
        if holds * min(reach, lies) > most:
            farthest, most = reach, holds * min(reach, lies)
    return farthest, most
