"""Hulls at the surface, bodies and vessels in waves, against hydrostatics and closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cablemodel as cm
from cablemodel.cli.plausibility import system_warnings
from cablemodel.scene.sea import sea
from cablemodel.systems import SystemModel, VesselInput, load_system

RHO, G = 1025.0, 9.80665
TAIL = {"cable": {"type": "thread", "length": 4.0}}
"""A light line that hangs from a floating body, which a system needs one of."""


def floating(body: dict[str, Any], **environment: Any) -> dict[str, Any]:
    return {
        "environment": {"water_density": RHO, "gravity": G, **environment},
        "cable_types": {"thread": {"diameter": 0.002, "mass": 0.02, "axial_stiffness": 1e5}},
        "bodies": {"buoy": {"inertia": 8e3, "points": {"eye": [0, 0, -1.0]}, **body}},
        "lines": {"tail": {"from": "buoy.eye", "to": "free", "items": [TAIL]}},
    }


CYLINDER = {
    "mass": 15e3, "hull": {"diameter": 4.0, "height": 3.0}, "centre_of_gravity": [0, 0, -0.5],
    "drag_area": 0.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def cylinder() -> SystemModel:
    return SystemModel(floating(CYLINDER))


def test_a_cylinder_floats_by_archimedes(cylinder: SystemModel) -> None:
    hangs = cylinder.lines["tail"].start_tension / G
    draught = 1.5 - cylinder.bodies["buoy"].position[2]
    assert draught == pytest.approx((15e3 + hangs) / (RHO * math.pi * 4.0), rel=1e-6)


def test_a_ball_floats_by_archimedes() -> None:
    model = SystemModel(floating({"mass": 2000.0, "hull": {"diameter": 2.0}}))
    depth = 1.0 - model.bodies["buoy"].position[2]  # of its lowest point
    hangs = model.lines["tail"].start_tension / G
    cap = math.pi * depth**2 * (3.0 - depth) / 3.0
    assert RHO * cap == pytest.approx(2000.0 + hangs, rel=1e-6)


def test_what_nothing_holds_starts_adrift() -> None:
    """With the water, and floats there as at rest; a drogue that deeper water holds back does not
    start by itself."""
    model = SystemModel(floating(CYLINDER, current=[0.4, -0.3, 0.0]))
    still = SystemModel(floating(CYLINDER))
    start = model.bodies["buoy"].position
    assert start == pytest.approx(still.bodies["buoy"].position, abs=1e-5)
    assert model.bodies["buoy"].velocity == pytest.approx([0.4, -0.3, 0.0], abs=1e-9)
    model.step(20.0)
    moved = model.bodies["buoy"].position - start
    assert moved == pytest.approx([8.0, -6.0, 0.0], abs=1e-4)
    rows = [{"z": z, "velocity": [v, 0, 0]} for z, v in ((0, 0.8), (-3, 0.1))]
    with pytest.raises(cm.SceneError, match="differs over depth, and nothing holds the system"):
        SystemModel(floating({**CYLINDER, "drag_area": 3.0}, current={"table": rows}))


def period(times: np.ndarray, values: np.ndarray) -> float:
    """Between upward zeros."""
    up = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    zeros = times[up] - values[up] * np.diff(times)[up] / np.diff(values)[up]
    return float(np.mean(np.diff(zeros)))


def test_heave_and_pitch_have_their_periods(cylinder: SystemModel) -> None:
    """2 pi sqrt(m / (rho g A)), and 2 pi sqrt(I / (m g GM)) about the centre of gravity."""
    model = SystemModel(cylinder.scene)
    rest = model.bodies["buoy"].position[2]
    model.step(1.0, forces={"buoy": [0, 0, 2e3, 0, 2e3, 0]})
    times, heave, pitch = [], [], []
    for _ in range(400):
        model.step(0.05)
        body = model.bodies["buoy"]
        times.append(model.time)
        heave.append(body.position[2] - rest)
        pitch.append(body.attitude[1])
    area = math.pi * 4.0
    draught = 15e3 / (RHO * area)
    heaves = 2.0 * math.pi * math.sqrt(15e3 / (RHO * G * area))
    assert period(np.array(times), np.array(heave)) == pytest.approx(heaves, rel=0.01)
    # From the keel: buoyancy at half of the draught, its metacentre I_waterplane / V above.
    metacentre = 0.5 * draught + 0.25 * math.pi * 2.0**4 / (area * draught)
    height = metacentre - 1.0
    pitches = 2.0 * math.pi * math.sqrt(8e3 / (15e3 * G * height))
    assert period(np.array(times), np.array(pitch)) == pytest.approx(pitches, rel=0.02)


def test_added_mass_has_the_share_of_the_hull_that_is_wet(cylinder: SystemModel) -> None:
    """So does the heave's period: 2 pi sqrt((m + s a) / (rho g A)), s the share."""
    added = 20e3
    given = cylinder.scene.to_dict()
    given["bodies"]["buoy"]["added_mass"] = [0.0, 0.0, added]
    model = SystemModel(given)
    rest = model.bodies["buoy"].position[2]
    model.step(1.0, forces={"buoy": [0, 0, 2e3, 0, 0, 0]})
    times = model.time + 0.05 * np.arange(1, 401)
    heave = []
    for t in times:
        model.step_to(float(t))
        heave.append(model.bodies["buoy"].position[2] - rest)
    area = math.pi * 4.0
    share = 15e3 / (RHO * area * 3.0)
    heaves = 2.0 * math.pi * math.sqrt((15e3 + share * added) / (RHO * G * area))
    assert period(times, np.array(heave)) == pytest.approx(heaves, rel=0.01)


def test_a_buoy_follows_a_long_wave() -> None:
    """A wave far longer than the buoy carries it up and down with the surface."""
    wave = {"regular": {"height": 1.0, "period": 20.0}, "ramp": 20.0}
    body = {**CYLINDER, "drag_area": 10.0, "drag_turning": 500.0}
    model = SystemModel(floating(body, waves=wave))
    rest = model.bodies["buoy"].position[2]
    heave, surface = [], []
    water = sea(model.scene)
    assert water is not None
    for k in range(160):
        model.step(0.5)
        if k >= 80:
            place = model.bodies["buoy"].position
            heave.append(place[2] - rest)
            surface.append(float(water.elevation(model.time, place[0], place[1])))
    assert np.ptp(surface) == pytest.approx(1.0, rel=0.02)
    assert np.abs(np.array(heave) - surface).max() < 0.03


@pytest.mark.parametrize(
    ("time", "height", "draught"), [(4.0, 4.0, 2.2), (6.0, 4.0, 2.2), (6.0, 20.0, 14.0)]
)
def test_a_buoy_heaves_by_the_pressure_of_the_wave_at_its_keel(
    time: float, height: float, draught: float
) -> None:
    """Froude and Krylov's force on an upright cylinder, rho g A eta e^(-k d), with the inertia and
    drag of water that moves as at the middle of what is wet: an equation of one unknown. Of a spar
    the pressure at the keel is a fifth of that at the surface."""
    radius, added, area, rise = 1.5, 6e3, 30.0, 10.0
    plane = math.pi * radius**2
    mass = RHO * plane * draught
    buoy = {
        "mass": mass, "hull": {"diameter": 2.0 * radius, "height": height},
        "inertia": mass * height**2 / 8.0, "centre_of_gravity": [0, 0, -0.2 * height],
        "added_mass": [0, 0, added], "drag_area": [0, 0, area], "drag_turning": 400.0,
    }  # fmt: skip
    amplitude, frequency = 0.1, 2.0 * math.pi / time
    wave = {"regular": {"height": 2.0 * amplitude, "period": time}, "ramp": rise}
    model = SystemModel(floating(buoy, waves=wave))
    rest = model.bodies["buoy"].position[2]
    times = np.arange(40.0, 40.0 + 5.0 * time, 0.05)
    heave = []
    for t in times:
        model.step_to(float(t))
        heave.append(model.bodies["buoy"].position[2] - rest)
    number, wet = frequency**2 / G, draught / height
    deep, middle = math.exp(-number * draught), math.exp(-0.5 * number * draught)

    def rates(t: float, state: np.ndarray) -> list[float]:
        x = min(1.0, t / rise)
        a = amplitude * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
        way, phase = a * math.cos(frequency * t), -a * frequency * math.sin(frequency * t)
        past = phase * middle - state[1]
        force = RHO * G * plane * (way * deep - state[0])
        force += wet * (0.5 * RHO * area * past * abs(past) - added * frequency**2 * way * middle)
        return [state[1], force / (mass + wet * added)]

    expected = solve_ivp(rates, (0.0, times[-1]), [0.0, 0.0], t_eval=times, rtol=1e-8).y[0]

    own = math.sqrt(RHO * G * plane / (mass + wet * added))  # which the ramp leaves in it
    waves = [part(f * times) for f in (frequency, own) for part in (np.cos, np.sin)]
    modes = np.column_stack([*waves, np.ones_like(times)])

    def size(values: np.ndarray) -> float:
        return math.hypot(*np.linalg.lstsq(modes, values)[0][:2])

    assert size(np.array(heave)) == pytest.approx(size(expected), rel=0.02)


@pytest.mark.parametrize("place", [[100.0, -50.0, -1.0], [-4e3, 3e3, 1.0]])
def test_what_nothing_holds_starts_where_the_scene_puts_it(place: list[float]) -> None:
    model = SystemModel(floating({**CYLINDER, "position": place}))
    assert model.bodies["buoy"].position[:2] == pytest.approx(place[:2], abs=1e-4)


def test_a_deep_spar_that_nothing_holds_starts_in_the_middle() -> None:
    """Its tail weighs so little beside it that rounding moved it by 20,000 km."""
    spar = {
        "mass": RHO * math.pi * 1.5**2 * 50.0, "hull": {"diameter": 3.0, "height": 60.0},
        "inertia": 1.6e8, "centre_of_gravity": [0, 0, -12.0],
    }  # fmt: skip
    body = SystemModel(floating(spar)).bodies["buoy"]
    assert body.position[:2] == pytest.approx([0.0, 0.0], abs=1e-3)


@pytest.mark.parametrize("hull", [False, True])
def test_a_wing_in_the_air_does_not_lift(hull: bool) -> None:
    """A body with a wing that hangs above the waves hangs as heavy as one without, and still."""
    body: dict[str, Any] = {
        "mass": 200.0, "inertia": 20.0, "points": {"eye": [0, 0, 0.5]},
        "foils": {"wing": {"area": 1.0, "deflection": 0.1}},
    }  # fmt: skip
    body |= {"hull": {"diameter": 0.8}} if hull else {"submerged_weight": 1500.0}
    model = SystemModel(
        {
            "environment": {
                "water_density": RHO, "gravity": G, "current": [1.0, 0, 0],
                **({} if hull else {"waves": {"regular": {"height": 0.5, "period": 8.0}}}),
            },
            "cable_types": {"wire": {"diameter": 0.01, "mass": 0.4, "axial_stiffness": 5e6}},
            "vessels": {"crane": {"position": [0, 0, 20.0], "points": {"hook": [0, 0, 0]}}},
            "bodies": {"load": body},
            "lines": {
                "wire": {
                    "from": "crane.hook", "to": "load.eye",
                    "items": [{"cable": {"type": "wire", "length": 10.0}}],
                }
            },
        }
    )  # fmt: skip
    assert model.lines["wire"].end_tension == pytest.approx(200.0 * G, rel=1e-6)
    assert model.bodies["load"].attitude == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)


@pytest.mark.parametrize("direction", [0.0, 3.9])
def test_a_raft_pitches_with_the_slope_of_the_wave_below_it(direction: float) -> None:
    """A flat raft, whose own pitching is four times as fast as the wave of 7 of its diameters: at
    the amplitude of an oscillator and in phase with the slope, wherever waves go to."""
    height, time, draught, radius = 0.6, 6.0, 0.5, 4.0
    mass = RHO * math.pi * radius**2 * draught
    raft = {
        "mass": mass, "hull": {"diameter": 2.0 * radius, "height": 2.0 * draught},
        "inertia": [mass * radius**2 / 4.0] * 2 + [mass * radius**2 / 2.0],
        "drag_area": 2.0, "drag_turning": 400.0,
    }  # fmt: skip
    wave = {"regular": {"height": height, "period": time, "direction": direction}, "ramp": 12.0}
    model = SystemModel(floating(raft, waves=wave))
    water = sea(model.scene)
    assert water is not None
    way = np.array([math.cos(direction), math.sin(direction), 0.0])
    rows = []
    for t in np.arange(48.0, 72.0, 0.1):
        model.step_to(float(t))
        body = model.bodies["buoy"]
        ends = [body.position + sign * way for sign in (-1.0, 1.0)]
        low, high = (float(water.elevation(t, *end[:2])) for end in ends)
        pitch = math.atan2(float(body.axes[:, 2] @ way), float(body.axes[2, 2]))
        phase = 2.0 * math.pi * t / time
        rows.append([pitch, -0.5 * (high - low), math.cos(phase), math.sin(phase)])
    pitch, slope, c, s = np.array(rows).T
    answer = complex(pitch @ c, pitch @ s) / complex(slope @ c, slope @ s)
    # Of buoyancy about its centre of gravity, in the middle of the raft, and of its own inertia.
    metacentre = radius**2 / (4.0 * draught) - 0.5 * draught
    natural = math.sqrt(G * metacentre / (radius**2 / 4.0))
    frequency = 2.0 * math.pi / time
    assert abs(answer) == pytest.approx(1.0 / (1.0 - (frequency / natural) ** 2), rel=0.05)
    assert np.angle(answer) == pytest.approx(0.0, abs=0.05)


def test_a_raft_in_waves_is_the_same_whichever_way_they_go() -> None:
    """Turned about z by an angle, with the waves, it moves alike to rounding."""
    motions = []
    for turn in (0.0, 0.6, 2.9):
        raft = {
            "mass": 12e3, "hull": {"diameter": 6.0, "height": 1.2}, "inertia": [30e3, 30e3, 50e3],
            "centre_of_gravity": [0.3, 0.1, 0.0], "drag_area": [3.0, 4.0, 10.0],
            "drag_turning": 100.0, "attitude": [0.0, 0.0, turn],
        }  # fmt: skip
        wave = {"regular": {"height": 0.8, "period": 4.5, "direction": turn + 0.4}, "ramp": 4.5}
        model = SystemModel(floating(raft, waves=wave))
        c, s = math.cos(turn), math.sin(turn)
        way = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        motions.append([])
        for t in np.arange(1.0, 16.0):
            model.step_to(float(t))
            body = model.bodies["buoy"]
            motions[-1].append([*(way @ body.position), *(way @ body.axes[:, 2])])
    first, *others = (np.array(rows) for rows in motions)
    assert np.ptp(first[:, 3]) > 0.1
    for turned in others:
        assert turned == pytest.approx(first, abs=1e-4)


RAOS = [
    {"heading_deg": heading, "period": period, "surge": 0.3, "surge_phase_deg": -90.0,
     "sway": 0.1, "heave": 0.8, "heave_phase_deg": 10.0, "roll_deg": 1.0, "pitch_deg": 2.0,
     "pitch_phase_deg": 90.0, "yaw_deg": 0.5}
    for heading in (0.0, 90.0, 180.0) for period in (6.0, 12.0)
]  # fmt: skip


def ship(**vessel: Any) -> dict[str, Any]:
    return {
        "environment": {
            "water_density": RHO,
            "waves": {"regular": {"height": 2.0, "period": 9.0}, "ramp": 9.0},
        },
        "cable_types": {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}},
        "vessels": {"ship": {"points": {"aft": [-20.0, 4.0, 3.0]}, **vessel}},
        "bodies": {
            "fish": {
                "mass": 500.0, "submerged_weight": 3e3, "inertia": 100.0, "drag_area": 0.5,
                "points": {"eye": [0, 0, 0.3]}, "drag_turning": 5.0,
            }
        },
        "lines": {
            "wire": {
                "from": "ship.aft", "to": "fish.eye",
                "items": [{"cable": {"type": "wire", "length": 60}}],
            }
        },
    }  # fmt: skip


@pytest.mark.parametrize(
    ("direction", "roll", "heave"),
    [(0.0, 0.0, 0.4), (45.0, 1.0, 0.55), (337.5, -0.5, 0.475), (315.0, -1.0, 0.55)],
    ids=["bow", "as given", "between, on the other side", "the other side"],
)
def test_a_vessel_answers_as_its_rows_say(direction: float, roll: float, heave: float) -> None:
    """At the headings that are given, whichever they are, and linearly between them."""
    answers = ((0.0, 0.0, 0.4), (45.0, 1.0, 0.55), (90.0, 4.0, 1.0), (135.0, 1.0, 0.6), (180, 0, 0))
    rows = [
        {"heading_deg": heading, "period": period, "roll_deg": turns, "heave": rises}
        for heading, turns, rises in answers for period in (8.0, 12.0)
    ]  # fmt: skip
    scene = ship(raos=rows)
    waves = {"height": 2.0, "period": 10.0, "direction": f"{direction} deg"}
    scene["environment"]["waves"] = {"regular": waves, "ramp": 5.0}
    model = SystemModel(scene)
    found = []
    for time in np.arange(10.0, 20.0, 0.25):
        model.step_to(float(time))
        motion = model.vessels["ship"]
        found.append((motion.attitude[0], motion.position[2]))
    w = 2.0 * math.pi / 10.0
    times = np.arange(10.0, 20.0, 0.25)
    wave = np.column_stack([np.cos(w * times), np.sin(w * times)])  # cos(-w t + phase)
    parts, *_ = np.linalg.lstsq(wave, np.array(found), rcond=None)
    assert np.degrees(parts[:, 0]) == pytest.approx([roll, 0.0], abs=1e-9)
    assert parts[:, 1] == pytest.approx([heave, 0.0], abs=1e-9)


def test_a_vessel_that_the_waves_move_is_one_that_is_moved_so() -> None:
    """The responses summed here, given as the vessel's motion, move the line alike."""
    yaw = -0.6  # of the heading's rows, which are all alike, at 34 degrees
    vessel = {"velocity": [1.5, 0.5, 0.0], "attitude": [0.0, 0.0, yaw]}
    answers = SystemModel(ship(raos=RAOS, **vessel))
    moved = SystemModel(ship(**vessel))
    water = sea(answers.scene)
    assert water is not None
    a, w, k = float(water.amplitude[0]), float(water.frequency[0]), float(water.number[0])
    names = ("surge", "sway", "heave", "roll_deg", "pitch_deg", "yaw_deg")
    row = RAOS[0]

    def motion(t: float) -> np.ndarray:
        """Place and angles."""
        mean = np.array([1.5 * t, 0.5 * t])
        theta = k * mean[0] - w * t
        found = []
        for name in names:
            size = float(row[name]) * (math.pi / 180.0 if name.endswith("_deg") else 1.0)
            phase = math.radians(float(row.get(name.removesuffix("_deg") + "_phase_deg", 0.0)))
            found.append(a * size * math.cos(theta - phase))
        u = water.share(t) * np.array(found)
        c, s = math.cos(yaw), math.sin(yaw)
        place = [mean[0] + c * u[0] - s * u[1], mean[1] + s * u[0] + c * u[1], u[2]]
        return np.array([*place, u[3], u[4], yaw + u[5]])

    step, worst, largest = 0.05, 0.0, 0.0
    for n in range(1, 401):
        t = n * step
        expected, rate = motion(t), (motion(t + 1e-4) - motion(t - 1e-4)) / 2e-4
        answers.step(step)
        there = answers.vessels["ship"]
        assert there.position == pytest.approx(expected[:3], abs=1e-9)
        assert there.attitude == pytest.approx(expected[3:], abs=1e-9)
        assert there.velocity == pytest.approx(rate[:3], abs=1e-6)
        moved.step(
            step,
            vessels={
                "ship": VesselInput(
                    position=expected[:3], velocity=rate[:3],
                    attitude=expected[3:], attitude_rate=rate[3:],
                )
            },
        )  # fmt: skip
        one, other = answers.lines["wire"].start_tension, moved.lines["wire"].start_tension
        worst, largest = max(worst, abs(one - other)), max(largest, one)
    assert worst < 10.0 * answers.scene.solver.tolerance * largest
    gap = np.linalg.norm(answers.bodies["fish"].position - moved.bodies["fish"].position)
    assert gap < 60.0 * answers.scene.solver.tolerance


def test_a_line_in_waves_is_that_of_a_scene_of_one_line() -> None:
    """The same line below the same point in the same sea, by both ways of writing it."""
    environment = {
        "water_density": RHO,
        "waves": {"jonswap": {"hs": 2.0, "tp": 8.0, "seed": 3}, "ramp": 10.0},
    }
    kinds = {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}}
    items = [
        {"cable": {"type": "wire", "length": 80}},
        {
            "body": {
                "mass": 300, "submerged_weight": "2 kN", "drag_area": 0.3, "drag_coefficient": 1.0,
                "drag_area_axial": 0.3,
            }
        },
    ]  # fmt: skip
    one = cm.CableModel(
        cm.load_scene(
            {
                "environment": environment, "cable_types": kinds, "line": items,
                "vessel": {"velocity": [2.0, 0, 0]},
            }
        )
    )  # fmt: skip
    system = SystemModel(
        {
            "environment": environment,
            "cable_types": kinds,
            "vessels": {"ship": {"points": {"hook": [0, 0, 0]}, "velocity": [2.0, 0, 0]}},
            "lines": {"line": {"from": "ship.hook", "to": "free", "items": items}},
        }
    )
    largest = 0.0
    worst = 0.0
    for _ in range(60):
        one.step(0.5)
        system.step(0.5)
        tension = system.lines["line"].start_tension
        worst = max(worst, abs(tension - one.top_tension))
        largest = max(largest, one.top_tension)
        end = system.lines["line"].sample([80.0]).position[0]
        assert np.linalg.norm(end - one.tip_position) < 2e-3 * 80.0
    assert worst < 2.0 * 10.0 * 1e-3 * largest


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"submerged_weight": 1.0}, r"bodies\.buoy.*both submerged_weight and hull are given"),
        ({"hull": {"diameter": -1.0}}, r"bodies\.buoy\.hull\.diameter"),
    ],
)
def test_wrong_hulls_are_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(cm.SceneError, match=message):
        cm.load_system(floating({**CYLINDER, **change}))


def test_check_tells_of_waves_beyond_the_rows_of_responses() -> None:
    """They are taken as at the last row: of beam seas for waves from astern."""
    rows = [{"heading_deg": h, "period": t, "heave": 0.5} for h in (60, 90) for t in (6, 9)]
    given: dict[str, Any] = {
        "environment": {"waves": {"regular": {"height": 1.0, "period": 8.0, "direction": -1.2}}},
        "cable_types": {"wire": {"diameter": 0.01, "mass": 0.4, "axial_stiffness": 1e6}},
        "vessels": {"ship": {"points": {"hook": [0, 0, 0]}, "raos": rows}},
        "lines": {
            "wire": {
                "from": "ship.hook", "to": "free",
                "items": [{"cable": {"type": "wire", "length": 20}}],
            }
        },
    }  # fmt: skip
    assert not [text for text in system_warnings(load_system(given)) if "raos" in text]
    given["environment"]["waves"]["regular"] |= {"period": 12.0, "direction": 0.0}
    heading, period = [text for text in system_warnings(load_system(given)) if "raos" in text]
    assert "ship.raos: waves go 0 deg from its bow at the start, rows are for 60 to 90" in heading
    assert "waves have a period of 12 s, rows are for 6 to 9" in period


def test_responses_without_waves_or_rows_are_named() -> None:
    scene = ship(raos=RAOS)
    del scene["environment"]["waves"]
    with pytest.raises(cm.SceneError, match=r"vessels\.ship\.raos.*no waves"):
        cm.load_system(scene)
    with pytest.raises(cm.SceneError, match=r"vessels\.ship\.raos.*5 rows"):
        cm.load_system(ship(raos=RAOS[:-1]))


@pytest.mark.parametrize("call", [0.5, 5.0])
def test_a_step_that_comes_to_nothing_leaves_the_next_one_good(call: float) -> None:
    """Rope without bending stiffness between a float below and a buoy at the surface is pressed
    together in each trough: Newton's method may leave all bounds in a step, and goes on with a
    shorter one. On average the mooring bears what the float lifts, and less than what the rope and
    the buoy, which drifts in a current of 0.4 m/s, add to that."""
    rope = {"diameter": 0.024, "mass": 0.4, "submerged_weight": 0.6, "axial_stiffness": 2e6}
    wire = {"diameter": 0.012, "mass": 0.55, "submerged_weight": 4.25, "axial_stiffness": 7e6}
    lift = 6000.0
    model = SystemModel({
        "environment": {
            "floor": {"z": -150, "friction": 0.5}, "current": [0.4, 0, 0],
            "waves": {"regular": {"height": 3.0, "period": 8.0}, "ramp": 15.0},
        },
        "cable_types": {
            "rope": {**rope, "drag_normal": 1.2}, "wire": {**wire, "drag_normal": 1.2}
        },
        "bodies": {
            "float": {
                "mass": 800.0, "submerged_weight": -lift, "inertia": 75.0, "added_mass": 320.0,
                "drag_area": 0.7, "drag_turning": 0.2, "position": [0, 0, -40],
                "points": {"low": [0, 0, -0.8], "high": [0, 0, 0.8]},
            },
            "buoy": {
                "mass": 700.0, "hull": {"diameter": 1.6, "height": 1.2}, "inertia": 150.0,
                "centre_of_gravity": [0, 0, -0.3], "added_mass": 400.0, "added_inertia": 80.0,
                "drag_area": 1.2, "drag_turning": 1.0, "points": {"eye": [0, 0, -0.6]},
            },
        },
        "lines": {
            "mooring": {
                "from": {"anchor": [0, 0, -150]}, "to": "float.low",
                "items": [{"cable": {"type": "wire", "length": 108}}],
            },
            "pennant": {
                "from": "float.high", "to": "buoy.eye",
                "items": [{"cable": {"type": "rope", "length": 55}}],
            },
        },
    })  # fmt: skip
    borne = []
    while model.time < 90.0:
        model.step(call)
        mooring = model.lines["mooring"]
        borne.append((mooring.end_tension, mooring.start_tension))
    upper, lower = np.mean(borne, axis=0)
    assert upper == pytest.approx(lift, abs=250.0)
    assert lower == pytest.approx(upper - 108 * 4.25, rel=0.01)
