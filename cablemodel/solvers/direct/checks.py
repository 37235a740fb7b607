"""What a scene may not ask of the direct solver: refused by name, with advice."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cablemodel.errors import SceneError, SceneProblem
from cablemodel.solvers.direct.sections import bends

if TYPE_CHECKING:
    from cablemodel.scene import Scene

_ELSE = "or solver.method: finite_element"


def refuse_unsupported(scene: Scene) -> None:
    """Raise a SceneError for parts of a scene that this method does not simulate."""
    problems: list[SceneProblem] = []

    def refuse(path: str, value: object, problem: str, allowed: str) -> None:
        said = f"{problem} (given: {value})"
        problems.append(SceneProblem(path, value, said, f"{allowed}, {_ELSE}"))

    environment = scene.environment
    if environment.waves is not None:
        refuse("environment.waves", "waves", "direct integration has no waves", "null")
    for part, items in (("line", scene.line), ("payout.drum", scene.payout.drum)):
        for index, item in enumerate(items):
            if item.cable is not None and item.cable.elements is not None:
                refuse(
                    f"{part}.{index}.cable.elements",
                    item.cable.elements,
                    "direct integration has nodes, not elements",
                    "solver.node_spacing",
                )
    on_board = scene.line_and_drum
    for name in dict.fromkeys(item.cable.type for item in on_board if item.cable is not None):
        damping = scene.cable_types[name].axial_damping
        if damping != 0.0:
            path = f"cable_types.{name}.axial_damping"
            refuse(path, damping, "direct integration has no damping of the material", "0")
    _refuse_floor(scene, refuse)
    _refuse_ends(scene, refuse)
    if problems:
        raise SceneError(problems)


def _refuse_floor(scene: Scene, refuse: object) -> None:
    assert callable(refuse)
    floor = scene.environment.floor
    if floor is None:
        return
    if floor.depth_table is not None:
        refuse(
            "environment.floor.depth_table",
            "a table",
            "direct integration knows a plane floor only",
            "z, with or without slope",
        )
    if floor.damping is not None:
        refuse(
            "environment.floor.damping",
            floor.damping,
            "direct integration lays cable on a floor without damping",
            "null",
        )
    last = scene.line[-1]
    if last.cable is None:
        refuse(
            f"line.{len(scene.line) - 1}",
            "a body",
            "direct integration lays cable only: the line must not end with a body over a floor",
            "a cable last",
        )
    elif not bends(scene, last.cable):
        refuse(
            f"line.{len(scene.line) - 1}.cable.model",
            last.cable.model,
            "a perfectly flexible cable has no tension, so no equations, at the touchdown point",
            "hybrid or elastica, with bending_stiffness above 0",
        )
    if scene.end.kind == "anchor":
        refuse(
            "end", "an anchor", "direct integration lays the free end of a line on a floor", "free"
        )


def _refuse_ends(scene: Scene, refuse: object) -> None:
    assert callable(refuse)
    if scene.end.kind == "anchor" and scene.initial.kind == "static":
        refuse(
            "end",
            "an anchor",
            "velocities and angles do not say where a line with two held ends hangs: direct "
            "integration has no static state for it",
            "free, or initial: {points: [...]}",
        )
    if scene.initial.velocities not in (None, "rest"):
        refuse(
            "initial.velocities",
            scene.initial.velocities,
            "direct integration starts points at rest",
            "rest",
        )
    drum = scene.payout.drum
    if drum and drum[-1].body is not None:
        refuse(
            f"payout.drum.{len(drum) - 1}",
            "body",
            "a body at the inner end of the drum never leaves it",
            "a cable last",
        )
    rates = scene.payout.rate
    if rates and rates[0].rate != 0.0 and rates[0].t <= 0.0 and scene.initial.kind == "static":
        refuse(
            "payout.rate.0.rate",
            rates[0].rate,
            "a steady state with pay-out is not supported",
            "0 at t = 0",
        )
    if scene.initial.kind == "straight":
        for index, item in enumerate(scene.line):
            if item.cable is not None and not bends(scene, item.cable):
                refuse(
                    f"line.{index}.cable.model",
                    item.cable.model,
                    "an unstretched line has no tension, where a perfectly flexible cable has no "
                    "equations",
                    "elastica, with bending_stiffness above 0",
                )
