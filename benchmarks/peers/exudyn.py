"""Exudyn (C++ core, from PyPI) on the release in a vacuum (S2v).

What is like for like, and what is not:

- Equations: planar ANCF cable elements (cubic in position, slopes as unknowns), axial and bending
  stiffness, consistent mass, implicit generalised alpha of index 3 or trapezoidal: the same beam
  as cablemodel's elastica. The top is held by two coordinate constraints, whose multipliers are the
  top force.
- It has no drag and no added mass: in water its forces would be Python functions called for every
  element in every iteration, which would measure Python. Hence the vacuum; S1, S2w, S2a, S3, S4 and
  the jumper are left out.
- A run is one call of its solver from start to end, as its documentation does it; the end and the
  top force are kept by its own sensors. That call is timed.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.scenes import GRAVITY, BenchmarkScene


@dataclass(frozen=True)
class Settings:
    """How Exudyn computes.

    elements: number of equal elements. time_step [s]. spectral_radius: of generalised alpha [-];
    None: the implicit trapezoidal rule. reduced: integration of lower order in the elements.
    sparse: Eigen's sparse solver instead of Exudyn's dense one.
    """

    elements: int
    time_step: float
    spectral_radius: float | None = 0.6
    reduced: bool = True
    sparse: bool = True


class ExudynRunner:
    """One Exudyn system at the scene's start."""

    def __init__(self, scene: BenchmarkScene, times: Sequence[float], settings: Settings) -> None:
        import exudyn
        from exudyn import itemInterface as item  # noqa: N813

        if scene.water_density != 0.0 or scene.start != "straight":
            raise ValueError(f"{scene.name}: Exudyn has no drag and no added mass")
        self._api: Any = exudyn
        self._times = tuple(times)
        self._settings = settings
        self._container = exudyn.SystemContainer()
        self._system: Any = self._container.AddSystem()
        system, cable, count = self._system, scene.cable, settings.elements
        length = cable.length / count
        nodes = [
            system.AddNode(item.NodePoint2DSlope1(referenceCoordinates=[i * length, 0.0, 1.0, 0.0]))
            for i in range(count + 1)
        ]
        for first, second in itertools.pairwise(nodes):
            element = system.AddObject(
                item.ObjectANCFCable2D(
                    physicsLength=length,
                    massPerLength=cable.mass,
                    bendingStiffness=cable.bending_stiffness,
                    axialStiffness=cable.axial_stiffness,
                    nodeNumbers=[first, second],
                    useReducedOrderIntegration=int(settings.reduced),
                )
            )
            marker = system.AddMarker(item.MarkerBodyMass(bodyNumber=element))
            system.AddLoad(
                item.LoadMassProportional(markerNumber=marker, loadVector=[0.0, -GRAVITY, 0.0])
            )
        ground = system.AddNode(item.NodePointGround())
        held = system.AddMarker(item.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        self._forces = []
        for coordinate in (0, 1):
            marker = system.AddMarker(
                item.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate)
            )
            constraint = system.AddObject(item.CoordinateConstraint(markerNumbers=[held, marker]))
            self._forces.append(self._sensor(item, objectNumber=constraint))
        self._end = system.AddSensor(
            item.SensorNode(
                nodeNumber=nodes[-1],
                outputVariableType=exudyn.OutputVariableType.Position,
                storeInternal=True,
                writeToFile=False,
            )
        )
        system.Assemble()
        self._row = -1

    def _sensor(self, item: Any, objectNumber: int) -> Any:  # noqa: N803
        return self._system.AddSensor(
            item.SensorObject(
                objectNumber=objectNumber,
                outputVariableType=self._api.OutputVariableType.Force,
                storeInternal=True,
                writeToFile=False,
            )
        )

    def advance(self, time: float) -> None:
        """The first call makes the whole run; the others look up what its sensors kept."""
        if self._row < 0:
            self._run()
        self._row = self._times.index(time)

    def _run(self) -> None:
        chosen, end = self._settings, self._times[-1]
        settings = self._api.SimulationSettings()
        stepping = settings.timeIntegration
        stepping.endTime = end
        stepping.numberOfSteps = round(end / chosen.time_step)
        stepping.verboseMode = 0
        stepping.newton.useModifiedNewton = True
        if chosen.spectral_radius is not None:
            stepping.generalizedAlpha.spectralRadius = chosen.spectral_radius
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = self._times[0]
        settings.show.statistics = False
        kinds = self._api.LinearSolverType
        settings.linearSolver.solverType = kinds.EigenSparse if chosen.sparse else kinds.EXUdense
        kind = self._api.DynamicSolverType
        solver = kind.TrapezoidalIndex2 if chosen.spectral_radius is None else kind.GeneralizedAlpha
        if not self._system.SolveDynamic(settings, solverType=solver, showHints=False):
            raise RuntimeError("Exudyn's solver gave up")

    def _kept(self, sensor: Any) -> NDArray[np.float64]:
        rows = np.asarray(self._system.GetSensorStoredData(sensor))
        found = int(np.argmin(np.abs(rows[:, 0] - self._times[self._row])))
        if abs(rows[found, 0] - self._times[self._row]) > 1e-9:
            raise RuntimeError("Exudyn's sensors kept other instants than asked for")
        return rows[found, 1:]

    def tip(self) -> NDArray[np.float64]:
        """Free end relative to the vessel (3,) [m]."""
        x, z = self._kept(self._end)[:2]
        return np.array([x, 0.0, z])

    def top_tension(self) -> float:
        """Magnitude of the force that holds the top [N]."""
        return float(np.hypot(*(self._kept(sensor)[0] for sensor in self._forces)))

    def statistics(self) -> dict[str, float]:
        """Elements and steps."""
        steps = round(self._times[-1] / self._settings.time_step)
        return {"elements": float(self._settings.elements), "steps": float(steps)}

    def close(self) -> None:
        """Free the system."""
        self._system.Reset()
