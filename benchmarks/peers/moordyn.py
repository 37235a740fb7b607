"""MoorDyn (C++ core, from PyPI) on the benchmark scenes.

What is like for like, and what is not:

- Equations: lumped masses, tension along straight segments, normal and tangential Morison drag
  on the unstretched diameter and length (no factor sqrt(e)), added mass on the normal
  acceleration. Tangential drag is 1/2 rho Cdt (pi d) |u_t| u_t per length, as in cablemodel, so
  Cdt is passed on unchanged (MoorDyn's source, ``Line.cpp``: ``Dq = 0.25 vq rho Cdt pi d ...``
  per half segment). A segment never pushes: compression is cut to zero.
- The top is 100 m below the surface (10 m in waves of 2 m), so that its surface logic plays no
  role, and far above the bed. Gravity is set so that the submerged weight is exact:
  g' = w / (m - rho pi d^2 / 4).
- The starting shape is written into MoorDyn's serialised state (Serialize, Deserialize): its own
  ways of starting (catenary, dynamic relaxation) give none of these shapes exactly.
- Coupled points move with constant velocity within a coupling step. Steps of ``coupling_step``
  carry the exact positions at both ends; a moving vessel needs them short for its top tension.
- Waves are given from outside (WaveKin 1), at its nodes, 100 times a second, as of the middle of
  that time: its own are stretched to the surface, ours are not. Its Froude-Krylov force is ours,
  rho A (1 + Ca) of the acceleration across and rho A (1 + CaAx) along with CaAx = 0 (MoorDyn's
  source, ``Line.cpp``: ``Ap``, ``Aq``), and its tension, too, is the effective one. Making the
  water's motion is not charged to it: it is kept from a run before, in which nodes were where they
  are in the timed one.
- The top force is the net force on the coupled point: the first segment's tension plus the
  weight and drag of half a segment, which converges with order two.
"""

from __future__ import annotations

import contextlib
import math
import os
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.scenes import BenchmarkScene, Cable, Wave

WAVES_HELD = 0.01
"""How long the water's motion at the nodes is held, about [s]."""
Water = tuple[list[Any], list[Any]]
"""Velocity and acceleration of the water at the nodes (n, 3)."""
BED = 2000.0
"""Water depth [m]."""


@dataclass(frozen=True)
class Settings:
    """How MoorDyn integrates.

    segments: number of equal segments. scheme: MoorDyn's tScheme. step_factor: time step times
    the highest axial frequency [-]; RK4 is stable up to 2.83 on the imaginary axis.
    damping: share of critical damping of the shortest axial mode (MoorDyn's BA = -damping) [-].
    coupling_step: longest time between two inputs of the vessel's motion [s].
    """

    segments: int
    scheme: str = "RK4"
    step_factor: float = 2.7
    damping: float = 0.0
    coupling_step: float = 0.005


def highest_frequency(scene: BenchmarkScene, segments: int) -> float:
    """Highest natural frequency of the chain of lumped masses [rad/s].

    Axial 2N/L sqrt(EA/m), or bending 4 (N/L)^2 sqrt(EI/m) where that is higher.
    """
    cable = scene.cable
    spacing = cable.length / segments
    axial = 2.0 / spacing * math.sqrt(cable.axial_stiffness / cable.mass)
    bending = 4.0 / spacing**2 * math.sqrt(cable.bending_stiffness / cable.mass)
    return max(axial, bending)


def deck(
    cable: Cable,
    settings: Settings,
    time_step: float,
    *,
    points: str,
    lines: str,
    bending: float,
    gravity: float,
    density: float,
    waves: bool = False,
) -> str:
    """MoorDyn's input file for lines of one cable: rows of points and lines, and the options."""
    damping = -settings.damping if settings.damping else 0.0
    return f"""MoorDyn input file
---------------------- LINE TYPES ----------------------
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
K {cable.diameter!r} {cable.mass!r} {cable.axial_stiffness!r} {damping!r} \
{bending!r} {cable.drag_normal!r} {cable.added_mass!r} \
{cable.drag_tangential!r} 0.0
---------------------- POINTS ----------------------
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
{points}
---------------------- LINES ----------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (ID) (ID) (m) (-) (-)
{lines}
---------------------- OPTIONS ----------------------
0 writeLog
1 disableOutput
{settings.scheme} tScheme
{gravity!r} g
{density!r} rho
{BED!r} WtrDpth
{time_step!r} dtM
{int(waves)} WaveKin
0.5 dtIC
600 TmaxIC
1e-7 threshIC
---------------------- OUTPUTS ----------------------
FairTen1
---------------------- need this line ----------------------
"""


def input_file(scene: BenchmarkScene, settings: Settings, time_step: float) -> str:
    """MoorDyn's input file for a scene: one line from the vessel (point 1) to a free point."""
    cable = scene.cable
    area = math.pi / 4.0 * cable.diameter**2
    gravity = cable.submerged_weight / (cable.mass - scene.water_density * area)
    if scene.anchor is None:
        kind, tip = "Free", [float(x) for x in scene.starting_points(settings.segments)[-1]]
    else:
        kind, tip = "Fixed", list(scene.anchor)
    return deck(
        cable,
        settings,
        time_step,
        points=(
            f"1 Coupled 0 0 {-scene.depth!r} 0 0 0 0\n"
            f"2 {kind} {tip[0]!r} {tip[1]!r} {tip[2] - scene.depth!r} 0 0 0 0"
        ),
        lines=f"1 K 2 1 {cable.length!r} {settings.segments} -",
        bending=cable.bending_stiffness,
        gravity=gravity,
        density=scene.water_density,
        waves=scene.wave is not None,
    )


@contextlib.contextmanager
def silence() -> Iterator[None]:
    """MoorDyn's core prints to the process's own output while it reads its input: hide that."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(1), os.dup(2)]
    with open(os.devnull, "wb") as sink:
        os.dup2(sink.fileno(), 1)
        os.dup2(sink.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept[0], 1)
            os.dup2(kept[1], 2)
            for descriptor in kept:
                os.close(descriptor)


class MoorDynRunner:
    """One MoorDyn system at the scene's initial state."""

    def __init__(
        self,
        scene: BenchmarkScene,
        times: Sequence[float],
        settings: Settings,
        *,
        rehearsal: bool = False,
    ) -> None:
        import moordyn

        self._waters: dict[float, Iterable[Water]] = {}
        self._wave = scene.wave if rehearsal else None
        if scene.wave is not None and not rehearsal:
            before = MoorDynRunner(scene, times, settings, rehearsal=True)
            for time in times:
                before.advance(time)
            before.close()
            self._waters = before._waters
        self._api: Any = moordyn
        self._offset = np.array([0.0, 0.0, -scene.depth])
        self._segments = settings.segments
        self._longest_step = settings.step_factor / highest_frequency(scene, settings.segments)
        self._directory = tempfile.TemporaryDirectory()
        path = Path(self._directory.name) / "line.txt"
        path.write_text(input_file(scene, settings, self._longest_step))
        start = list(scene.motion(0.0) + self._offset)
        with silence():
            self._system = moordyn.Create(str(path))
            moordyn.SetVerbosity(self._system, moordyn.LEVEL_NONE)
            # Its own relaxation finds a static start; other starts are written into its state.
            begin = moordyn.Init if scene.start == "static" else moordyn.Init_NoIC
            begin(self._system, start, list(scene.start_velocity))
            if scene.wave is not None:
                moordyn.ExternalWaveKinInit(self._system)
        self._line = moordyn.GetLine(self._system, 1)
        if scene.start != "static":
            self._write_state(scene)
        self._node = 0
        if scene.probe is not None:
            # Nodes count from the far end.
            share = settings.segments * (1.0 - scene.probe / scene.cable.length)
            if share != round(share):
                raise ValueError(f"{settings.segments} segments have no node at the probe")
            self._node = round(share)
        self._plan = self._plan_inputs(scene, times, settings)
        self._top = np.array(start, dtype=np.float64)
        self._force: tuple[float, ...] = (0.0, 0.0, 0.0)
        self._steps = 0

    def _write_state(self, scene: BenchmarkScene) -> None:
        """Put the scene's starting shape and velocity into the integrator's state.

        Layout of MoorDyn's serialised state (8-byte words): free point at 13 (position,
        velocity), then a count and a width, then position and velocity of every inner node,
        end A (the free end) first.
        """
        points = scene.starting_points(self._segments)[::-1] + self._offset
        velocity = np.array(scene.start_velocity)
        data = bytearray(self._api.Serialize(self._system))
        words = np.frombuffer(data, dtype=np.uint64)
        numbers = np.frombuffer(data, dtype=np.float64)
        inner = self._segments - 1
        if words[19] != inner or words[20] != 6:
            raise RuntimeError("MoorDyn's serialised state has another layout than expected")
        numbers[13:16] = points[0]
        numbers[16:19] = velocity
        nodes = numbers[21 : 21 + 6 * inner].reshape(inner, 6)
        nodes[:, :3] = points[1:-1]
        nodes[:, 3:] = velocity
        self._api.Deserialize(self._system, bytes(data))

    def _plan_inputs(
        self, scene: BenchmarkScene, times: Sequence[float], settings: Settings
    ) -> dict[float, tuple[float, float, list[Any], NDArray[np.float64]]]:
        """Inputs of every coupling step, made before the clock starts.

        Per reference time: internal step [s], coupling step [s], a list of (position, velocity,
        time) and the vessel's last position.
        """
        moving = any(scene.motion(t) != scene.motion(0.0) for t in times)
        plan = {}
        before = 0.0
        for until in times:
            longest = settings.coupling_step if moving else until - before
            if scene.wave is not None:
                longest = min(longest, WAVES_HELD)
            count = max(1, math.ceil((until - before) / longest - 1e-9))
            coupling = (until - before) / count
            # Whole internal steps in a coupling step: a remainder would cost a step of its own.
            internal = coupling / max(1, math.ceil(coupling / self._longest_step - 1e-9))
            instants = before + coupling * np.arange(count + 1)
            positions = np.array([scene.motion(float(t)) for t in instants]) + self._offset
            velocities = np.diff(positions, axis=0) / coupling
            inputs = list(
                zip(
                    positions[:-1].tolist(),
                    velocities.tolist(),
                    instants[:-1].tolist(),
                    strict=True,
                )
            )
            plan[until] = (internal, coupling, inputs, positions[-1])
            before = until
        return plan

    def advance(self, time: float) -> None:
        """Step to that time; it must be one of those given at the start."""
        internal, coupling, inputs, end = self._plan[time]
        system = self._system
        step = self._api.Step
        self._api.SetDt(system, internal)
        force = self._force
        waters = self._waters.get(time)
        if self._wave is not None:
            waters = self._rehearsed(self._wave, time)
        if waters is None:
            for position, velocity, instant in inputs:
                force = step(system, position, velocity, instant, coupling)
        else:
            hold = self._api.ExternalWaveKinSet
            for water, (position, velocity, instant) in zip(waters, inputs, strict=True):
                hold(system, *water, instant)
                force = step(system, position, velocity, instant, coupling)
        self._force = force
        self._top = end
        self._steps += len(inputs) * round(coupling / internal)

    def _rehearsed(self, wave: Wave, time: float) -> Iterator[Water]:
        """The water of one coupling step after the other, where the nodes then are; kept."""
        _internal, coupling, inputs, _end = self._plan[time]
        kept: list[Water] = []
        self._waters[time] = kept
        for _position, _velocity, instant in inputs:
            kept.append(self._water(wave, instant + 0.5 * coupling))
            yield kept[-1]

    def _water(self, wave: Wave, time: float) -> Water:
        """Velocity and acceleration of the water at the nodes, as lists (n, 3)."""
        nodes = np.array(self._api.ExternalWaveKinGetCoordinates(self._system))
        velocity, acceleration = wave.water(time, nodes)
        return velocity.tolist(), acceleration.tolist()

    def tip(self) -> NDArray[np.float64]:
        """Free end, or the probe, relative to the vessel (3,) [m]."""
        node = np.array(self._api.GetLineNodePos(self._line, self._node), dtype=np.float64)
        return node - self._top

    def top_tension(self) -> float:
        """Magnitude of the net force on the coupled point [N]."""
        return math.hypot(*self._force)

    def statistics(self) -> dict[str, float]:
        """Segments and internal steps."""
        return {"elements": float(self._segments), "steps": float(self._steps)}

    def close(self) -> None:
        """Free the system and its input file."""
        with silence():
            self._api.Close(self._system)
        self._directory.cleanup()
