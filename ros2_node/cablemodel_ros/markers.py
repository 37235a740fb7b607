"""What RViz shows: the cable coloured by tension, its bodies, its ends, the tension in figures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from numpy.typing import NDArray
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

if TYPE_CHECKING:
    from cablemodel import CableModel

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Picture:
    """What is needed of a model, taken while it stands still."""

    position: Floats
    """(n, 3) [m]."""
    tension: Floats
    """(n,) [N]."""
    bodies: list[Floats]
    top_tension: float
    diameter: float

    @classmethod
    def of(cls, model: CableModel, stations: int) -> Picture:
        """A picture at evenly spaced stations."""
        state = model.sample(np.linspace(0.0, model.line_length, stations))
        diameter = max(item.diameter for item in model.scene.cable_types.values())
        bodies = [body.position for body in model.bodies]
        return cls(state.position, state.tension, bodies, model.top_tension, diameter)


def markers(picture: Picture, stamp: Time, frame: str = "map") -> MarkerArray:
    """The markers of a picture."""
    extent = float(np.ptp(picture.position, axis=0).max())
    width = max(picture.diameter, 0.003 * extent)  # a thin cable would not be seen

    def marker(kind: int, number: int) -> Marker:
        made = Marker(ns="cable", id=number, type=kind, action=Marker.ADD)
        made.header.frame_id, made.header.stamp = frame, stamp
        made.pose.orientation.w = 1.0
        made.color.a = 1.0
        return made

    line = marker(Marker.LINE_STRIP, 0)
    line.scale.x = width
    line.points = [Point(x=x, y=y, z=z) for x, y, z in picture.position.tolist()]
    line.colors = colours(picture.tension)
    figures = marker(Marker.TEXT_VIEW_FACING, 1)
    figures.text = f"{picture.top_tension:.0f} N"
    figures.scale.z = max(0.04 * extent, 10.0 * picture.diameter)
    figures.color.r = figures.color.g = figures.color.b = 1.0
    at = picture.position[0] + np.array([0.0, 0.0, 0.05 * extent])
    figures.pose.position = Point(x=at[0], y=at[1], z=at[2])
    found = [line, figures]
    for number, place in enumerate(picture.bodies):
        sphere = marker(Marker.SPHERE, 10 + number)
        sphere.pose.position = Point(x=place[0], y=place[1], z=place[2])
        sphere.scale.x = sphere.scale.y = sphere.scale.z = 4.0 * width
        sphere.color.r, sphere.color.g = 1.0, 0.8
        found.append(sphere)
    return MarkerArray(markers=found)


def colours(tension: Floats) -> list[ColorRGBA]:
    """Blue where it is lowest, red where it is highest; magenta where the cable is pushed."""
    low, high = float(tension.min()), float(tension.max())
    share = (tension - low) / max(high - low, 1e-9)
    return [
        ColorRGBA(r=1.0, g=0.0, b=1.0, a=1.0)
        if value < 0.0
        else ColorRGBA(r=x, g=0.3, b=1.0 - x, a=1.0)
        for x, value in zip(share.tolist(), tension.tolist(), strict=True)
    ]
