"""From the scene of a system to a block at its initial state."""

from __future__ import annotations

from cablemodel.errors import SceneError
from cablemodel.solvers.finite_element.start import firm_friction, search
from cablemodel.systems.built import Built
from cablemodel.systems.equilibrium import Equilibria
from cablemodel.systems.joined import joined
from cablemodel.systems.lays import lays, start, without
from cablemodel.systems.scene import SystemScene


def build(scene: SystemScene) -> Built:
    """A block at the system's initial state, t = 0: at rest in the frame of its vessels.

    Raises:
        SceneError: vessels that move apart at t = 0; a winch that runs while its line touches the
            floor.
        StaticsError: no equilibrium was found, or not within `solver.start_time_limit`.

    Warns:
        UnstableStartWarning: the system leaves it by itself, and no other was found.
        OverturnedStartWarning: another was, in which bodies are turned over.
    """
    with search.searching(scene) as sought:
        try:
            apart = lays(scene)
            if not apart:
                return _built(scene, sought, scene)
            rest = without(scene, apart)
            built = None if rest is None else _built(rest, sought, scene)
            starts = [(lay, start(lay, scene)) for lay in apart]
        except search.OutOfTimeError:
            raise sought.gives_up() from None
    whole = joined(scene, built, starts)
    if built is not None:
        whole.unstable, whole.friction_holds = built.unstable, built.friction_holds
    return whole


def _built(scene: SystemScene, sought: search.Search, whole: SystemScene) -> Built:
    """What starts as a system, of a whole whose floor and scales it has."""
    search_for = Equilibria.of(scene, whole, sought)
    built = search_for.find()
    if not search_for.velocity.any():
        sought.tries("with friction")
        built.friction_holds = firm_friction.take_hold(built.block)
    _start_flowing(scene, built)
    return built


def _start_flowing(scene: SystemScene, built: Built) -> None:
    """Velocities of what hangs on winches that pay out from t = 0 on; refuses what touches the
    floor there."""
    from cablemodel.solvers import library as entry

    rows = [built.winch(number) for number in range(len(scene.winches))]
    for row, winch in zip(rows, scene.winches.values(), strict=True):
        row.rate = winch.rate_at_start
    node = entry.start_flowing(built.block.ints, built.block.reals)
    if node < 0:
        return
    runs = [n for n, row in enumerate(rows) if row.rate != 0.0 and row.node <= node]
    name, winch = list(scene.winches.items())[max(runs, key=lambda n: rows[n].node)]
    part, arc = built.where(node)
    where = part if part in scene.bodies else f"{part} at {arc:.4g} m"
    problem = f"{where} touches the sea floor, and {winch.line} is tied to more"
    allowed = "0 m/s at t = 0, or a line by itself, which may end at an anchor"
    raise SceneError.at(f"winches.{name}.rate", winch.rate_at_start, problem, allowed)
