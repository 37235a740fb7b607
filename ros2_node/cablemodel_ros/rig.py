"""What a session steps, behind one protocol: a scene of one line (`line_rig`), or a system
(`system_rig`).

What goes in is a table of ports, one for each topic, and what goes out is named by the table of
variables; nothing else in the node asks which of the two it has. A step is made so:

    message -> inputs -> Port.take (commands: checked, in the map, the newest kept)
    clock   -> control -> Rig.advance (helm: bounded motion) -> step_to of the model
            -> Rig.applied, Rig.outputs -> outputs (topics); with Rig.record -> recording (log)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from cablemodel import variables
from cablemodel.scene.schema import Solver
from cablemodel.solvers.protocol import Errors
from cablemodel_ros import interface
from cablemodel_ros.commands import Commands, Tally
from cablemodel_ros.frames import Floats
from cablemodel_ros.samples import Message
from cablemodel_ros.settings import Settings, those_set
from cablemodel_ros.timebase import Timebase
from cablemodel_ros.times import Moment, Simulated, Stamp


@dataclass(frozen=True)
class Port:
    """An input: its topic, and what takes the numbers of a message (see `inputs`); that gives an
    empty text, or why it refused."""

    topic: interface.Topic
    take: Callable[..., str]


Order = Callable[[], tuple[bool, str]]
"""What a service beyond those of every session does; gives whether it was done, and a text."""


def doubts(errors: Mapping[str, Errors], solver: Solver) -> Iterator[str]:
    """Of which line or body the positions are not known to keep what is asked of them, in words."""
    for name, its in errors.items():
        of = f" of {name}" if name else ""
        if math.isnan(its.position):
            yield "errors are not known: the finer run could not go on"
            return
        if its.position > solver.promised * its.length:
            allowed = f"more than {solver.asked} allows"
            yield f"positions{of} may be off by {its.position:.3g} m, {allowed}"


def error_values(errors: Mapping[str, Errors], tension: str) -> dict[str, str]:
    """Errors of lines and bodies, for diagnostics. tension: which one that of a line is of."""
    found = {}
    for name, its in errors.items():
        of = f"{name}: " if name else ""
        found[f"{of}estimated error of positions [m]"] = f"{its.position:.6g}"
        if its.tension is not None:
            found[f"{of}estimated error of the {tension} [N]"] = f"{its.tension:.6g}"
    return found


@dataclass(frozen=True)
class Frame:
    """A frame in the map, for /tf."""

    name: str
    position: Floats
    """Of its origin (3,) [m]."""
    axes: Floats
    """Its axes in the columns (3, 3)."""


@dataclass(frozen=True)
class Strand:
    """A line as it is drawn."""

    label: str
    """What its tension in figures begins with."""
    position: Floats
    """(n, 3) [m]."""
    tension: Floats
    """(n,) [N]."""
    top_tension: float
    """At its beginning [N]."""


class Rig(Protocol):
    """A model, what commands it, and what its messages are. Not thread-safe but for its ports.

    Attributes: ``scene``; ``model``; ``tallies`` (of commands, by topic); ``ports``; ``orders``
    (services by name); ``notes`` (what is odd in the settings, for the console).
    """

    scene: Any
    model: Any
    tallies: Mapping[str, Tally]
    ports: tuple[Port, ...]
    orders: Mapping[str, Order]
    notes: tuple[str, ...]

    @property
    def stale(self) -> Collection[str]:
        """Topics whose command has timed out."""

    @property
    def abrupt(self) -> Collection[str]:
        """Topics whose command ends at once when it has timed out, not over a ramp."""

    @property
    def waiting(self) -> Collection[str]:
        """Sources of motion that have given nothing yet."""

    @property
    def limited(self) -> int:
        """Steps in which a limit was at work, counted by vessels, winches and foils."""

    def warm_up(self) -> None:
        """Compile or load now whatever a step and its outputs need."""

    def update(self, settings: Settings) -> None:
        """Take over parameters that may change at any time."""

    def forget(self) -> None:
        """Drop all commands: the model was reset."""

    def advance(self, target: Simulated, now: Moment) -> Any:
        """Step to `target`, which is at the moment `now`; gives what was applied.

        Raises:
            StepError: the step cannot be made; the model stands as it was.
        """

    def applied(self, given: Any, step: float, stamp: Stamp) -> tuple[Message, list[Message]]:
        """Messages of what a step [s] applied: the exact record, and what controllers read."""

    def outputs(self, stamp: Stamp, wanted: Collection[str] | None = None) -> list[Message]:
        """All outputs; wanted: topics, None: all."""

    def record(self, stamp: Stamp) -> list[Message]:
        """What ``cablemodel run`` logs at an output time."""

    def frames(self) -> list[Frame]:
        """Frames that the settings ask for."""

    def image(self) -> bytes:
        """The model's state, for a file."""

    @property
    def attitude(self) -> Floats | None:
        """Vessel axes to map axes (3, 3), where the model's state does not hold that."""

    def take_attitude(self, rotation: Floats) -> None:
        """Begin, now and after a reset, with another attitude (3, 3)."""

    def take_image(self, image: bytes, scene: str) -> None:
        """Take up a state; `scene`: `scene_hash` of the scene that it is of, if known.

        Raises:
            SceneError: it is of another scene.
        """

    @property
    def scene_hash(self) -> str:
        """Of all in the scene that a state depends on."""

    def strands(self) -> list[Strand]:
        """All lines, for a picture."""

    def places(self) -> list[Floats]:
        """Of bodies (3,) [m], for a picture."""

    def findings(self) -> Iterator[str]:
        """What is to be warned of in the model."""

    def values(self) -> dict[str, str]:
        """More of the model for diagnostics."""

    def command_findings(self) -> Iterator[str]:
        """What is to be warned of in the commands, beyond what is stale, missing or refused."""

    def summary(self) -> dict[str, Any]:
        """What ``~/scene`` tells of it in short."""


def rig_of(scene: Any, settings: Settings, timebase: Timebase) -> Rig:
    """The rig of a scene.

    Raises:
        SceneError, StaticsError: the scene cannot be used; its own message says why.
        SettingsError: a parameter names what the scene does not have.
    """
    if variables.is_system(scene):
        from cablemodel_ros.system_rig import SystemRig

        return SystemRig(scene, settings, timebase)
    from cablemodel_ros.line_rig import LineRig

    return LineRig(scene, settings, timebase)


def notes_of(
    settings: Settings, unused: Iterable[str], ports: Iterable[Port], frames: Mapping[str, str]
) -> tuple[str, ...]:
    """What is odd in the settings.

    Args:
        settings: of the session.
        unused: parameters that mean nothing for the scene.
        ports: of the rig.
        frames: of vessels, by the topics of their odometry.
    """
    found = [
        f"parameter {name} is set, and means nothing for this scene"
        for name in those_set(unused, settings)
    ]
    topics = (port.topic.name for port in ports if settings.tf_vessel)
    found += [
        f"tf_vessel broadcasts map -> {frames[topic]}: what gives {topic} must not"
        for topic in topics
        if topic in frames
    ]
    return tuple(found)


def motion_ports(
    commands: Commands,
    source: str,
    odometry: interface.Topic,
    twist: interface.Topic,
    settings: Settings,
) -> tuple[Port, ...]:
    """What moves a vessel by `source`: odom, cmd_vel or scene."""
    if source == "odom":
        return (Port(odometry, commands.take_odometry),)
    if source == "scene":
        return ()
    if settings.cmd_vel_stamped:
        return (Port(twist, commands.take_twist),)
    frame = commands.seat.frame
    return (
        Port(
            interface.unstamped(twist),
            lambda linear, angular: commands.take_twist(None, frame, linear, angular),
        ),
    )
