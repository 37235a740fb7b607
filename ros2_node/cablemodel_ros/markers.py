"""What RViz shows: lines coloured by tension, their bodies, the tension of each in figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from numpy.typing import NDArray
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from cablemodel_ros.rig import Rig, Strand

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Picture:
    """What is needed of a model, taken while it stands still."""

    strands: list[Strand]
    bodies: list[Floats]
    """Their places (3,) [m]."""
    diameter: float
    """Of the thickest cable [m]."""

    @classmethod
    def of(cls, rig: Rig) -> Picture:
        """A picture at evenly spaced stations."""
        diameter = max(item.diameter for item in rig.scene.cable_types.values())
        return cls(rig.strands(), rig.places(), diameter)


def markers(picture: Picture, stamp: Time, frame: str = "map") -> MarkerArray:
    """The markers of a picture."""
    points = np.concatenate([strand.position for strand in picture.strands])
    extent = float(np.ptp(points, axis=0).max())
    width = max(picture.diameter, 0.003 * extent)  # a thin cable would not be seen
    found: list[Marker] = []

    def marker(kind: int) -> Marker:
        made = Marker(ns="cable", id=len(found), type=kind, action=Marker.ADD)
        made.header.frame_id, made.header.stamp = frame, stamp
        made.pose.orientation.w = 1.0
        made.color.a = 1.0
        found.append(made)
        return made

    for strand in picture.strands:
        line = marker(Marker.LINE_STRIP)
        line.scale.x = width
        line.points = [Point(x=x, y=y, z=z) for x, y, z in strand.position.tolist()]
        line.colors = colours(strand.tension)
        figures = marker(Marker.TEXT_VIEW_FACING)
        figures.text = f"{strand.label}{strand.top_tension:.0f} N"
        figures.scale.z = max(0.04 * extent, 10.0 * picture.diameter)
        figures.color.r = figures.color.g = figures.color.b = 1.0
        at = strand.position[0] + np.array([0.0, 0.0, 0.05 * extent])
        figures.pose.position = Point(x=at[0], y=at[1], z=at[2])
    for place in picture.bodies:
        sphere = marker(Marker.SPHERE)
        sphere.pose.position = Point(x=place[0], y=place[1], z=place[2])
        sphere.scale.x = sphere.scale.y = sphere.scale.z = 4.0 * width
        sphere.color.r, sphere.color.g = 1.0, 0.8
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
