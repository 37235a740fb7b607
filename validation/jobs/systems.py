"""Systems of several lines: bridle, depressor, buoy on legs."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq, fsolve

import cablemodel as cm
from tests.verification.references.catenary import elastic_catenary
from validation.jobs.book import FOLDER, Answer, Result, job, picture, shape


def system(name: str) -> cm.SystemModel:
    """The system beside the page."""
    return cm.SystemModel(FOLDER / f"{name}.yaml")


@job
def bridle() -> Result:
    """Legs bear T / (2 cos(half angle)) each."""
    ours = system("bridle")
    drag = 0.5 * 1025.0 * 0.8 * 2.0**2
    half = math.asin(6.0 / 20.0)
    leg = drag / (2.0 * math.cos(half))
    found = ours.lines["port"].start_tension
    answers = [
        Answer("tension of the port leg", found, leg, "N", 0.005 * leg),
        Answer("pull on the tug", abs(ours.wrenches["tug"][0]), drag, "N", 0.005 * drag),
    ]
    shapes = {name: shape(line, 20) for name, line in ours.lines.items()}
    before = ours.bodies["fish"].position[0]
    ours.step(10.0)
    way = ours.bodies["fish"].position[0] - before
    answers.append(Answer("way in 10 s", way, 20.0, "m", 0.02))
    spreads = np.linspace(0.5, 18.0, 30)
    curve = drag / (2.0 * np.cos(np.arcsin(spreads / 20.0)))
    series = {"independent": (2.0 * spreads, curve), "cablemodel": ([12.0], [found])}
    return answers, picture(shapes, series, ("spread [m]", "tension of a leg [N]"), (0, 1))


@job
def depressor() -> Result:
    """Lift, drag, weight and moment of two foils about the tow point."""
    ours = system("depressor")
    foils = ours.scene.bodies["bird"].foils
    q = 0.5 * 1025.0 * 9.0

    def forces(nose_down, deflection):
        lift = drag = moment = 0.0
        for name, foil in foils.items():
            turn = deflection if name == "wing" else 0.0
            cl, cd = foil.coefficients(np.array([turn - nose_down]))[0]
            lift += q * foil.area * cl
            drag += q * foil.area * cd
            normal = cl * math.cos(nose_down) - cd * math.sin(nose_down)
            moment += foil.position[0] * q * foil.area * normal
        return lift, drag + q * 0.05, moment

    def expected(deflection):
        pitch = brentq(lambda angle: forces(angle, deflection)[2], -0.2, 0.2)
        lift, drag, _ = forces(pitch, deflection)
        down = 200.0 - lift
        return math.hypot(down, drag), 30.0 * down / math.hypot(down, drag)

    tension, depth = expected(-0.08)
    found = ours.lines["tow"].end_tension
    shapes = {"wing at -0.08 rad": shape(ours.lines["tow"], 30)}
    answers = [
        Answer("tension", found, tension, "N", 0.005 * tension),
        Answer("depth", -ours.bodies["bird"].position[2], depth, "m", 0.06),
    ]
    angles, mine, other = [-0.08, -0.05, -0.02, 0.01], [], []
    for angle in angles:
        for _ in range(10):  # the less it pulls, the longer it takes to settle
            ours.step(30.0, deflections={"bird.wing": angle})
        mine.append(-ours.bodies["bird"].position[2])
        other.append(expected(angle)[1])
    answers.append(Answer("depth with the wing at 0.01 rad", mine[-1], other[-1], "m", 0.1))
    shapes["wing at 0.01 rad"] = shape(ours.lines["tow"], 30) - [
        ours.vessels["tug"].position[0], 0, 0]  # fmt: skip
    series = {"cablemodel": (angles, mine), "independent": (angles, other)}
    return answers, picture(shapes, series, ("deflection of the wing [rad]", "depth [m]"))


@job
def buoy_on_legs() -> Result:
    """Three elastic catenaries that meet."""
    ours = system("buoy_on_legs")
    anchors = [np.array([60.0, 0, -70]), np.array([-30, 51.9615, -70]),
               np.array([-30, -51.9615, -70])]  # fmt: skip

    def rest(push):
        def left(place):
            total = np.array([push, 0.0, 15e3])
            for anchor in anchors:
                away = place - anchor
                flat = math.hypot(away[0], away[1])
                line = elastic_catenary(flat, float(away[2]), 90.0, 78.0, 30e6)
                high = line.low_vertical + 78.0 * 90.0
                total -= np.array([*(line.horizontal * away[:2] / flat), high])
            return total

        return fsolve(left, np.array([push / 2000.0, 0.0, -5.0]), xtol=1e-9)

    shapes = {name: shape(line, 40) for name, line in ours.lines.items() if name == "east"}
    pushes, mine, other = [0.0, 1500.0, 3000.0], [], []
    for push in pushes:
        for _ in range(2):
            ours.step(100.0, forces={"buoy": [push, 0, 0, 0, 0, 0]})
        mine.append(ours.bodies["buoy"].position)
        other.append(rest(push))
    shapes["east, pushed"] = shape(ours.lines["east"], 40)
    answers = [
        Answer("offset at 3 kN", mine[-1][0], other[-1][0], "m", 0.09),
        Answer("depth at 3 kN", -mine[-1][2], -other[-1][2], "m", 0.09),
        Answer("depth without a push", -mine[0][2], -other[0][2], "m", 0.09),
    ]
    series = {
        "cablemodel": ([place[0] for place in mine], pushes),
        "independent": ([place[0] for place in other], pushes),
    }
    return answers, picture(shapes, series, ("offset [m]", "push [N]"))


@job
def cut_loose() -> Result:
    """V tanh(t / tau) of what sinks; what is left bears its own weight."""
    ours = system("cut_loose")
    before = ours.lines["wire"].start_tension
    mass, weight, drag = 2800.0, 12e3, 0.5 * 1025.0 * 2.0
    fastest = math.sqrt(weight / drag)
    rise = mass * fastest / weight
    wire = 200.0 * (1.6 - 1025.0 * math.pi / 4 * 0.02**2) * 9.80665
    start = ours.bodies["load"].position[2]
    shapes = {"before": shape(ours.lines["wire"], 40)}
    times, found = [0.0], [0.0]
    tensions = []  # a wire that has snapped back rings on: no damping of its material is stated
    for k in range(1, 231):
        ours.step(1.0 if k <= 30 else 0.05)
        times.append(ours.time)
        found.append(start - float(ours.bodies["load"].position[2]))
        if k > 30:
            tensions.append(ours.lines["wire"].start_tension)
    mean = float(np.mean(tensions))
    since = np.maximum(np.array(times) - 5.0, 0.0)
    other = fastest * rise * np.log(np.cosh(since / rise))
    shapes["after 40 s"] = shape(ours.lines["wire"], 40)
    answers = [
        Answer("tension before", before, weight + wire, "N", 0.01 * (weight + wire)),
        Answer("mean tension from 25 s after on", mean, wire, "N", 0.03 * wire),
        Answer("fallen in 10 s", found[15], float(other[15]), "m", 0.2),
        Answer("speed in the end", -float(ours.bodies["load"].velocity[2]), fastest, "m/s", 0.02),
    ]
    series = {"cablemodel": (times, found), "independent": (times, other)}
    return answers, picture(shapes, series, ("time [s]", "fallen [m]"))
