"""Compare a towed cable in its steady state with the closed form.

Far behind a steadily moving vessel a cable with a free end is straight: at its angle a to the
horizontal, weight and drag across the cable balance at every point,

    w cos a = 1/2 rho Cdn d U^2 sin^2 a,

and what is left along the cable adds up to the tension at the vessel,

    T = L (w sin a + 1/2 rho Cdt pi d U^2 cos^2 a).

Drag acts on the stretched cable, whose diameter shrinks as its length grows: per unstretched
length it is larger by sqrt(1 + strain), here 1 + 5e-5 at most, and the cable is longer by its
strain.

    python examples/towed_cable.py [LOG]

reads the log of a run of scenes/towed_cable.yaml, or makes the run where there is no log.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import cablemodel as cm

ROOT = Path(__file__).resolve().parents[1]
SCENE = ROOT / "scenes" / "towed_cable.yaml"
LOG = ROOT / "out" / "towed_cable.mcap"

NOT_YET_STEADY = 3e-4
"""Part of its length by which the end still may be from its steady place after 200 s: a finely
converged run is 1.4e-4 away by then, and comes nearer by a factor of e every 20 s."""


@dataclass(frozen=True)
class SteadyTow:
    """The closed form: angle [rad], place of the end from the tow point [m], top tension [N]."""

    angle: float
    tip_x: float
    tip_z: float
    top_tension: float


def steady_tow(scene: cm.Scene, speed: float) -> SteadyTow:
    """Steady state of a single cable with a free end, towed along x.

    The strain, and with it the drag, is taken at the mean tension: it changes by 1e-4 along the
    cable, and the drag by half of that.
    """
    (cable,) = scene.cables
    kind = scene.cable_types[cable.type]
    weight = kind.submerged_weight
    assert weight is not None
    pressure = 0.5 * scene.environment.water_density * kind.diameter * speed**2
    (softness,) = kind.strain_coefficients
    strain = 0.0
    for _ in range(5):
        across = kind.drag_normal * pressure * math.sqrt(1.0 + strain)
        along = kind.drag_tangential * math.pi * pressure * math.sqrt(1.0 + strain)
        # across sin^2 a = w cos a is a quadratic equation for cos a.
        cosine = (math.sqrt(weight**2 + 4.0 * across**2) - weight) / (2.0 * across)
        angle = math.acos(cosine)
        tension = cable.length * (weight * math.sin(angle) + along * cosine**2)
        strain = softness * tension / 2.0
    length = cable.length * (1.0 + strain)
    return SteadyTow(angle, -length * cosine, -length * math.sin(angle), tension)


def main() -> None:
    log = Path(sys.argv[1]) if len(sys.argv) > 1 else LOG
    run = cm.open_run(log) if log.exists() else cm.simulate(cm.load_scene(SCENE))
    assert run.complete, run.reason
    end = run.time[-1]
    _, velocity, _ = run.scene.motion().evaluate(end)
    exact = steady_tow(run.scene, float(velocity[0]))
    top, tip = run.states[-1].position[[0, -1]]
    x, _, z = tip - top
    length = run.scene.line_length
    rows = [
        (
            "angle to the horizontal [deg]",
            math.degrees(math.atan2(-z, -x)),
            math.degrees(exact.angle),
        ),
        ("end behind the vessel [m]", -x, -exact.tip_x),
        ("end below the vessel [m]", -z, -exact.tip_z),
        ("tension at the vessel [N]", run.top_tension[-1], exact.top_tension),
    ]
    print(f"Towed cable after {end:g} s, against the closed form of the steady state")
    print(f"{'':32}{'simulated':>12}{'closed form':>14}{'difference':>14}")
    for name, computed, closed in rows:
        print(f"{name:32}{computed:12.4f}{closed:14.4f}{computed - closed:14.1e}")

    off = math.hypot(x - exact.tip_x, z - exact.tip_z) / length
    tension_off = abs(run.top_tension[-1] / exact.top_tension - 1.0)
    tolerance = run.scene.solver.tolerance
    allowed, tension_allowed = tolerance + NOT_YET_STEADY, 10.0 * tolerance + NOT_YET_STEADY
    print(f"\nThe end is {off:.1e} of the length from its steady place ({allowed:.1e} allowed),")
    print(f"the tension {tension_off:.1e} of itself from its own ({tension_allowed:.1e} allowed).")
    assert off <= allowed, "the shape is not that of the closed form"
    assert tension_off <= tension_allowed, "the tension is not that of the closed form"


if __name__ == "__main__":
    main()
