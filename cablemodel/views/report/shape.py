"""The moving shape in three dimensions: what the page needs to draw it at any instant."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.views.drawing import COLOURS
from cablemodel.views.report.charts import INK, TENSION_SCALE, axis_style, base_layout
from cablemodel.views.report.samples import Frames

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemScene

Floats = NDArray[np.float64]

LINES, HELD, BODIES, SKELETONS, NAMES, TRACK, SEA, FLOOR = range(8)
"""Traces of the figure, in order; the page moves them by their number."""

_THIN = 0.3
"""Least side of the view, as a part of its largest: a plane shape has no third dimension."""
_MARGIN = 0.05
_NEAR = 0.35
"""Surface and floor are shown where they are nearer to the shape than this part of its size."""
_AIR = 100.0
"""Densities [kg/m3] below this have no surface to show."""
_FLOOR_CELLS = 60

_TURN, _RISE, _AWAY = math.radians(24.0), math.radians(16.0), 1.6
"""The eye looks from this much beside and above the shape's broadside, and from how far off."""


@dataclass(frozen=True)
class View:
    """A box (3, 2) [m] to look into, the same scale along all axes."""

    box: Floats
    follows: bool
    """Whether x and y count from the tow point, or what else the view follows."""

    @classmethod
    def around(cls, positions: Floats, follows: bool, levels: tuple[float, ...] = ()) -> View:
        """A view of all positions (..., 3) and of the heights that are near them."""
        points = positions.reshape(-1, 3)
        low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
        size = float(np.max(high - low))
        for level in levels:
            if low[2] - _NEAR * size <= level <= high[2] + _NEAR * size:
                low[2], high[2] = min(low[2], level), max(high[2], level)
        sides = high - low
        size = float(np.max(sides)) or 1.0
        wanted = np.maximum(sides, _THIN * size) + 2 * _MARGIN * size
        middle = (low + high) / 2
        return cls(np.stack([middle - wanted / 2, middle + wanted / 2], axis=1), follows)

    @property
    def aspect(self) -> Floats:
        """Sides of the box as they are drawn (3,), the longest being 1."""
        sides = self.box[:, 1] - self.box[:, 0]
        return np.asarray(sides / np.max(sides))

    def layout(self, direction: Floats) -> dict[str, Any]:
        """Its part of a plotly scene."""
        aspect = self.aspect
        found: dict[str, Any] = {
            f"{axis}axis": {
                **axis_style(),
                "title": {"text": f"{axis} [m]", "font": {"size": 12}},
                "range": list(limits),
                "nticks": max(3, round(8 * side)),
                "gridcolor": "#ccd4dc",
                "showbackground": True,
                "backgroundcolor": "#f7f9fb",
                "showspikes": False,
            }
            for axis, limits, side in zip("xyz", self.box, aspect, strict=True)
        }
        found["aspectmode"] = "manual"
        found["aspectratio"] = dict(zip("xyz", map(float, aspect), strict=True))
        found["camera"] = {"eye": _eye(direction), "center": {"x": 0, "y": 0, "z": 0}}
        return found


def _eye(direction: Floats) -> dict[str, float]:
    """Where to look from: across the horizontal direction (2,) that the shape spreads in.

    The page moves the eye along its line of sight until the box fills the figure.
    """
    across = math.atan2(direction[1], direction[0]) - math.pi / 2 + _TURN
    return {
        "x": _AWAY * math.cos(_RISE) * math.cos(across),
        "y": _AWAY * math.cos(_RISE) * math.sin(across),
        "z": _AWAY * math.sin(_RISE),
    }


def shape_figure(
    scene: Scene | SystemScene, frames: Frames, newtons: float, unit: str
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The figure at the first instant, and the data by which the page moves it.

    Tensions are divided by ``newtons`` [N per ``unit``].
    """
    shapes, reference, ground = frames.shapes, frames.reference, frames.ground
    marks = (frames.held.places, frames.bodies.places, frames.skeletons)
    points = np.concatenate([shapes.position, *marks], axis=1)
    levels = _levels(scene, frames)
    views = {
        "follow": View.around(points - ground[:, None], True, levels),
        "map": View.around(points, False, levels),
    }
    travel = float(np.max(np.linalg.norm(reference.place - reference.place[0], axis=-1)))
    follow = travel > 0.5 * shapes.length
    view = views["follow" if follow else "map"]
    direction = _spread(points - ground[:, None])
    floor = _floor(scene, views)
    tension = shapes.tension / newtons

    def moved(places: Floats) -> NDArray[np.float32]:
        return (places - ground[:, None]).astype(np.float32)

    figure = {
        "data": _traces(frames, view, tension, unit),
        "layout": {
            **base_layout(),
            "margin": {"l": 0, "r": 0, "t": 46, "b": 0},
            "scene": {**view.layout(direction), "dragmode": "turntable"},
            "uirevision": "shape",
        },
    }
    moving = {
        "views": {name: one.layout(direction) for name, one in views.items()},
        "boxes": {name: one.box for name, one in views.items()},
        "follow": follow,
        # By more than the page can tell.
        "travels": travel > float(np.finfo(np.float32).eps) * shapes.length,
        "reference": reference.name,
        "position": moved(shapes.position),
        # The traces after that of the lines, in their order.
        "marks": [moved(places) for places in (*marks, frames.names.places)],
        "ground": ground[:, :2],
        "tension": tension.astype(np.float32),
        "s": shapes.s.astype(np.float32),
        "sea": _has_sea(scene) and view.box[2, 0] <= 0.0 <= view.box[2, 1],
        "floor": floor,
    }
    return figure, moving


def _traces(frames: Frames, view: View, tension: Floats, unit: str) -> list[dict[str, Any]]:
    """All traces at the first instant; surface and floor are for the page to fill."""
    shapes = frames.shapes
    origin = frames.ground[0] if view.follows else np.zeros(3)
    # A gap between two lines has no name.
    named = [
        word
        for name, at in shapes.places.items()
        for word in (*[f"{name}<br>" if name else ""] * (at.stop - at.start), "")
    ][:-1]
    lines = {
        "type": "scatter3d",
        "mode": "lines",
        "name": "lines",
        **_places(shapes.position[0] - origin),
        "text": named,
        "customdata": np.stack([shapes.s[0], tension[0]], axis=-1),
        "hovertemplate": f"%{{text}}s = %{{customdata[0]:.2f}} m<br>%{{customdata[1]:.4g}} {unit}"
        "<br>(%{x:.2f}, %{y:.2f}, %{z:.2f}) m<extra></extra>",
        "line": {
            "width": 9,
            "color": tension[0],
            "cmin": float(np.nanmin(tension)),
            "cmax": max(float(np.nanmax(tension)), float(np.nanmin(tension)) + 1e-9),
            "colorscale": TENSION_SCALE,
            "colorbar": {
                "title": {"text": f"tension [{unit}]", "side": "top", "font": {"size": 11}},
                "orientation": "h",
                "thickness": 9,
                "len": 0.5,
                "x": 0.5,
                "xanchor": "center",
                "y": 1.0,
                "yanchor": "bottom",
                "outlinewidth": 0,
                "tickfont": {"size": 10},
                "nticks": 5,
            },
        },
    }
    held = {
        "type": "scatter3d", "mode": "markers", "name": frames.held.kind,
        **_places(frames.held.places[0] - origin),
        "text": list(frames.held.names),
        "marker": {"size": 5, "color": INK, "symbol": "square"},
        "hovertemplate": "%{text}<extra></extra>",
    }  # fmt: skip
    bodies = {
        "type": "scatter3d", "mode": "markers", "name": "bodies",
        **_places(frames.bodies.places[0] - origin),
        "text": [name or "body" for name in frames.bodies.names],
        "marker": {"size": 6, "color": COLOURS[2], "line": {"color": "#fff", "width": 1}},
        "hovertemplate": "%{text}<br>(%{x:.2f}, %{y:.2f}, %{z:.2f}) m<extra></extra>",
    }  # fmt: skip
    skeletons = {
        "type": "scatter3d", "mode": "lines", "name": "vessels and bodies",
        **_places(frames.skeletons[0] - origin),
        "line": {"width": 3, "color": INK}, "hoverinfo": "skip",
    }  # fmt: skip
    names = {
        "type": "scatter3d", "mode": "text", "name": "names",
        **_places(frames.names.places[0] - origin),
        "text": list(frames.names.names), "textposition": "top right", "hoverinfo": "skip",
    }  # fmt: skip
    track = {
        "type": "scatter3d", "mode": "lines", "name": f"track of {frames.reference.name}",
        **_places(frames.reference.place),
        "line": {"width": 2, "color": "#9aa5b1"}, "hoverinfo": "skip", "visible": not view.follows,
    }  # fmt: skip
    surfaces = [_surface("#4f9fd8", 0.22), _surface("#b08a57", 0.55)]
    return [lines, held, bodies, skeletons, names, track, *surfaces]


def _places(points: Floats) -> dict[str, Floats]:
    """Coordinates of points (n, 3) by their axes."""
    return dict(zip("xyz", points.T, strict=True))


def _surface(colour: str, opacity: float) -> dict[str, Any]:
    empty: list[float] = []
    return {
        "type": "surface", "x": empty, "y": empty, "z": [empty], "showscale": False,
        "opacity": opacity, "hoverinfo": "skip", "visible": False,
        "colorscale": [[0, colour], [1, colour]],
        "contours": {axis: {"highlight": False} for axis in "xyz"},
        "lighting": {"ambient": 0.9, "diffuse": 0.3, "specular": 0.02},
    }  # fmt: skip


def _has_sea(scene: Scene | SystemScene) -> bool:
    return scene.environment.water_density > _AIR


def _levels(scene: Scene | SystemScene, frames: Frames) -> tuple[float, ...]:
    """Heights that a view should hold where they are near: still water, and the floor below."""
    found = [0.0] if _has_sea(scene) else []
    if scene.environment.floor is not None:
        places = frames.shapes.position.reshape(-1, 3)
        places = places[np.isfinite(places[:, 0])][::10]
        heights = [scene.environment.floor.height(x, y) for x, y, _ in places]
        found += [float(min(heights)), float(max(heights))]
    return tuple(found)


def _spread(offsets: Floats) -> Floats:
    """Horizontal unit direction (2,) along which the shapes are widest."""
    flat = offsets[..., :2].reshape(-1, 2)
    flat = flat[np.all(np.isfinite(flat), axis=-1)]
    values, vectors = np.linalg.eigh(flat.T @ flat)
    if values[1] <= 0.0:
        return np.array([1.0, 0.0])
    direction = vectors[:, 1]
    leading = direction[np.argmax(np.abs(direction))]
    return np.asarray(direction * math.copysign(1.0, leading))


def _floor(scene: Scene | SystemScene, views: dict[str, View]) -> dict[str, Any] | None:
    """Heights of the floor on a grid that holds everything that is ever seen, if any of it is."""
    floor = scene.environment.floor
    if floor is None:
        return None
    seen = views["map"].box[:2]
    around = views["follow"].box[:2, 1] - views["follow"].box[:2, 0]
    x, y = (
        np.linspace(low - side, high + side, _FLOOR_CELLS + 1)
        for (low, high), side in zip(seen, around, strict=True)
    )
    z = np.array([[floor.height(a, b) for a in x] for b in y])
    if np.max(z) < min(view.box[2, 0] for view in views.values()):
        return None
    return {"x": x, "y": y, "z": z, "level": bool(np.ptp(z) < 1e-9)}
