"""Figures 15 to 17 of Sun and Leonard (1998) for scenes/touchdown.yaml.

python examples/touchdown.py touchdown.png
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import cablemodel as cm
from cablemodel.views.plot import STYLE

SCENE = Path(__file__).parents[1] / "scenes" / "touchdown.yaml"
SHAPES = np.arange(30.0, 126.0, 6.0)
TIME = 96.0


def main(path: str = "touchdown.png") -> None:
    import matplotlib

    model = cm.CableModel(cm.load_scene(SCENE))
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 5.6), layout="constrained")
        shapes, tension, near, curvature = figure.subplots(2, 2).ravel()
        for time in SHAPES:
            model.step_to(float(time))
            cable = model.sample(np.linspace(0.0, model.line_length, 400)).position
            body = model.bodies[0].position
            shapes.plot(cable[:, 0], cable[:, 2], color="0.2", linewidth=0.7)
            shapes.plot(body[0], body[2], "o", color="#d1495b", markersize=3)
            if time == TIME:
                draw_tension(model, tension, near, curvature)
        shapes.axhline(-70.0, color="#8c6d46", linewidth=1.0)
        shapes.set_aspect("equal", adjustable="datalim")
        label(shapes, "every 6 s from 30 to 120 s", "x [m]", "z [m]")
        figure.savefig(path, dpi=120)


def draw_tension(model, tension, near, curvature) -> None:
    """Tension along the cable, and both tension and curvature next to the touchdown."""
    whole = model.sample(np.linspace(0.0, model.line_length, 2001))
    tension.plot(whole.s, whole.tension, color="0.2")
    label(tension, f"tension at {TIME:.0f} s", "arc length from the vessel [m]", "tension [N]")
    behind = whole.position[:, 0] <= model.touchdown_position[0]
    touchdown = whole.s[np.argmax(behind)]
    close = model.sample(np.linspace(touchdown - 8.0, touchdown + 2.0, 1001))
    reaction = f"reaction {model.touchdown_reaction:.1f} N at the touchdown"
    above = "arc length above the touchdown [m]"
    near.plot(touchdown - close.s, close.tension, color="0.2")
    near.axhline(0.0, color="0.6", linewidth=0.7)
    label(near, reaction, above, "tension [N]")
    curvature.plot(touchdown - close.s, close.curvature, color="0.2")
    label(curvature, "curvature", above, "curvature [1/m]")


def label(axes, title: str, x: str, y: str) -> None:
    axes.set_title(title)
    axes.set_xlabel(x)
    axes.set_ylabel(y)


if __name__ == "__main__":
    main(*sys.argv[1:])
