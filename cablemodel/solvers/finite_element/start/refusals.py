"""What a scene may ask for that the finite elements do not simulate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cablemodel.errors import SceneError, SceneProblem

if TYPE_CHECKING:
    from cablemodel.scene import Scene


def refuse_unsupported(scene: Scene) -> None:
    """Raise a SceneError for parts of a scene that this engine does not simulate."""
    problems: list[SceneProblem] = []

    def refuse(path: str, value: object, what: str, allowed: str) -> None:
        problems.append(SceneProblem(path, value, f"{what} not supported yet", allowed))

    for part, items in (("line", scene.line), ("payout.drum", scene.payout.drum)):
        for index, item in enumerate(items):
            if item.body is not None and item.body.rotary_inertia > 0.0 == item.body.half_length:
                path = f"{part}.{index}.body.rotary_inertia"
                what = "a point body with rotary inertia is"
                refuse(path, item.body.rotary_inertia, what, "0, or a half_length")
    if scene.payout.drum and scene.payout.drum[-1].body is not None:
        path = f"payout.drum.{len(scene.payout.drum) - 1}"
        what = "a body at the inner end of the drum never leaves it: this is"
        refuse(path, "body", what, "a cable last")
    if scene.solver.method != "finite_element":
        method = scene.solver.method
        problems.append(
            SceneProblem(
                "solver.method", method, f"{method} has no finite elements", "finite_element"
            )
        )
    if problems:
        raise SceneError(problems)
