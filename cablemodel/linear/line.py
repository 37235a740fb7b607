"""The linear model of one line: places are counted from its tow point."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.linear.equations import SIZE, Equations, not_linear, refuse
from cablemodel.linear.parts import Drives, Outputs, Response, Winding, of_axes
from cablemodel.solvers import library as entry
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.linear.model import LinearModel
    from cablemodel.model import CableModel

FloatArray = NDArray[np.float64]


def linear_model(model: CableModel) -> LinearModel:
    """The linear model of a line about its present state; see `CableModel.linearise`."""
    return LineEquations(model).linear_model()


class LineEquations(Equations):
    """Derivatives of a line's equations of motion at a model's state; the model stays."""

    def __init__(self, model: CableModel) -> None:
        block = copy.deepcopy(model._finite_elements("linearise"))
        winch, edges = block.winch, Header.edges

        def slack_at(node: int) -> str:
            start = block.array(edges, node + 1, at.EDGE_WORDS)[node, at.Edge.start]
            return f"the line is slack, {start + winch.paid:.6g} m from the vessel"

        refuse(block, "the line", slack_at)
        if winch.passing_body != 0.0:
            raise not_linear("a body passes the tow point")
        entry.to_three_dimensions(block.ints, block.reals)
        head = block.header
        first = block.array(Header.constraints, int(head.constraint_count), at.CONSTRAINT_WORDS)[0]
        # One that the winch may turn both ways; a clamp gives way to a spring when it first does.
        winds = winch.travel_least < winch.travel < winch.travel_most and (
            bool(head.payout) or first[at.Constraint.clamped] == 0.0
        )
        winding = Winding(0, "", model.line_length, float(winch.rate), float(winch.slope))
        super().__init__(block, [winding] if winds else [])
        bodies = block.array(Header.bodies, int(head.body_count), at.BODY_WORDS)
        bodies = bodies[bodies[:, at.Body.node] >= 0.0]
        self._bodies = bodies[np.argsort(bodies[:, at.Body.node], kind="stable")]

    def _begin(self) -> None:
        self.place, self.velocity, self.acceleration = (
            self.block.array(word, self.nodes, SIZE)[0, :3].copy()
            for word in (Header.position, Header.velocity, Header.acceleration)
        )

    def _shift(self) -> FloatArray:
        """Motions of all unknowns as the tow point moves, (nodes SIZE, 3): the line goes along,
        where nothing else holds it."""
        if int(self.block.header.constraint_count) > 1:
            return self._top()
        shift = np.zeros((self.nodes, SIZE, 3))
        shift[:, :3] = np.eye(3)
        return shift.reshape(-1, 3)

    def _top(self) -> FloatArray:
        """Places of node 0, and of hinges there, as the tow point moves alone, (nodes SIZE, 3)."""
        block = self.block
        parent, joint = (block.integers(w, self.nodes) for w in (Header.parent, Header.joint))
        top = np.zeros((self.nodes, SIZE, 3))
        top[0, :3] = np.eye(3)
        for node in range(1, self.nodes):
            if joint[node] == at.JOINT_HINGE:
                top[node] = top[parent[node]]
        return top.reshape(-1, 3)

    def own_acceleration(self) -> FloatArray:
        """That of the tow point."""
        return np.asarray(self._top() @ self.acceleration)

    def carried(self) -> FloatArray:
        """That of the tow point."""
        return np.asarray(self._shift() @ self.velocity)

    def drives(self) -> Drives:
        """The tow point."""
        found, shift = Drives(self.nodes * SIZE), self._shift()
        place = self.place + np.array([*self.block.scalars.origin])
        places, speeds = of_axes("vessel_position"), of_axes("vessel_velocity")
        for axis in range(3):
            found.level(places[axis], place[axis], place=shift[:, axis], grows_by=speeds[axis])
        for axis in range(3):
            found.level(speeds[axis], self.velocity[axis], velocity=shift[:, axis])
        for axis, name in enumerate(of_axes("vessel_acceleration")):
            found.input(name, speeds[axis], acceleration=shift[:, axis])
        return found

    def outputs(self, response: Response, drives: Drives) -> Outputs:
        """Those of the tow point, the tip and bodies, and the levels."""
        block, nodes, found = self.block, self.nodes, Outputs()
        position = block.array(Header.position, nodes, SIZE)
        velocity = block.array(Header.velocity, nodes, SIZE)
        origin = np.array([*block.scalars.origin])
        top = self._top().T  # the support: node 0, and hinges there
        force, pull = -(top @ response.force), -(top @ response.rest)
        size = np.linalg.norm(pull)
        if size == 0.0:
            raise not_linear("no force at the tow point, so no top tension")
        sign = np.copysign(1.0, pull @ position[0, 3:])
        found.add(of_axes("top_force"), force, pull)
        found.add("top_tension", (sign * pull / size) @ force, sign * size)
        places = response.place.reshape(nodes, SIZE, -1)[:, :3]
        speeds = response.velocity.reshape(nodes, SIZE, -1)[:, :3]
        found.add(of_axes("tip_position"), places[-1], position[-1, :3] + origin)
        found.add(of_axes("tip_velocity"), speeds[-1], velocity[-1, :3])
        parent = block.integers(Header.parent, nodes)
        for number, body in enumerate(self._bodies):
            node, outer = int(body[at.Body.node]), 1.0
            if body[at.Body.length] > 0.0:
                outer = 0.5 * (1.0 + body[at.Body.offset])
            other = int(parent[node])
            found.add(
                of_axes(f"bodies[{number}].position"),
                outer * places[node] + (1.0 - outer) * places[other],
                outer * position[node, :3] + (1.0 - outer) * position[other, :3] + origin,
            )
        for number, (name, value) in enumerate(zip(drives.levels, drives.values, strict=True)):
            if not name.startswith("current"):
                found.add(name, response.level(number), value)
        return found
