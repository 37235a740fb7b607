"""The one table of variables: what a run gives, and its name in every interface.

The FMU's description, the ROS 2 topics, the channels of the log and ``docs/variables.md`` are all
generated from this table, so that a name is written once. Units are SI; axes are east, north, up.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal

Present = Literal["always", "bodies", "drum", "floor", "error_estimate"]
"""When a scene has a variable: in every scene, or only with bodies, a drum, a sea floor, or where
an estimate of its errors is asked for."""

FLOAT64 = "std_msgs/msg/Float64"
WRENCH = "geometry_msgs/msg/WrenchStamped"
ODOMETRY = "nav_msgs/msg/Odometry"
POSES = "geometry_msgs/msg/PoseArray"
POINT = "geometry_msgs/msg/PointStamped"
CLOUD = "sensor_msgs/msg/PointCloud2"
ARRAY = "std_msgs/msg/Float64MultiArray"
TRIGGER = "std_srvs/srv/Trigger"

NODE_NAME = "cable"
"""Name of the ROS 2 node: the ``~`` of a topic stands for ``/cable``."""


@dataclass(frozen=True)
class Variable:
    """One quantity, and what it is called in each interface."""

    quantity: str
    """What it is, in words."""
    unit: str
    """SI unit as written in FMI and in docs; empty for a pure number."""
    python: str
    """Attribute of :class:`~cablemodel.CableModel`; ``bodies.position`` is that of each body and
    ``state.position`` that of the state along the cable."""
    fmu: str
    """Name in the FMU, all indices from 1: i over x, y, z; j over bodies; k over stations."""
    topic: str
    """ROS 2 topic and channel of the log, relative to the node (``~/...``)."""
    message: str
    """ROS 2 message type."""
    shape: tuple[int | Literal["bodies", "stations"], ...] = ()
    """Shape of one sample; a word stands for a count that the scene or the export decides."""
    present: Present = "always"
    """In which scenes it exists."""
    member: str = ""
    """Where in the message it stands, if the message holds more than one quantity."""

    @property
    def resolved_topic(self) -> str:
        """Topic with ``~`` replaced by the node's name: ``/cable/tension_top``."""
        return resolved(self.topic)

    def of_part(self, name: str) -> Variable:
        """The same of a part of a system: NAME stands for it in all names."""

        def named(text: str) -> str:
            return text.replace("NAME", name)

        return replace(
            self,
            quantity=f"{name}: {self.quantity}",
            python=named(self.python),
            fmu=named(self.fmu),
            topic=topic_of_part(self.topic, name),
        )

    def in_scene(self, scene: Any) -> bool:
        """Whether a scene has this variable."""
        return self.present in features(scene)

    def fmu_names(self, *, bodies: int = 0, stations: int = 0) -> Iterator[str]:
        """Every scalar name in the FMU: ``line.position[2,3]``, in the order of a C array."""
        counts: dict[str, int] = {"bodies": bodies, "stations": stations}
        names = [self.fmu]
        for letter, length in zip(self._index_letters(), self.shape, strict=True):
            count = counts[length] if isinstance(length, str) else length
            names = [
                _with_index(name, letter, index) for name in names for index in range(1, count + 1)
            ]
        yield from names if self.fmu else ()

    def _index_letters(self) -> tuple[str, ...]:
        letter = {"bodies": "j", "stations": "k"}
        return tuple(letter.get(str(length), "i") for length in self.shape)


def _with_index(name: str, letter: str, index: int) -> str:
    """Replace an index letter inside brackets: (``body[j].position[i]``, ``j``, 2)."""
    for before, after in ((f"[{letter}]", f"[{index}]"), (f"[{letter},", f"[{index},")):
        if before in name:
            return name.replace(before, after)
    return name.replace(f",{letter}]", f",{index}]")


SLACK_LABELS = ("time", "longest", "since", "start", "end")
"""What a message of being slack holds, in its order: names are ``slack_time``, ..."""


def _slack(name: str) -> tuple[Variable, ...]:
    """For how long so far, and where, a line has carried no tension."""
    rows = (
        ("time spent slack", "s"),
        ("longest slack spell", "s"),
        ("start of the last slack spell (NaN: none)", "s"),
        ("slack from this arc length (NaN: nowhere)", "m"),
        ("slack to this arc length", "m"),
    )
    dotted, folder = (f"{name}.", f"{name}/") if name else ("", "")
    return tuple(
        Variable(words, unit, f"{dotted}slack_{key}", f"{dotted}slack.{key}",
                 f"~/{folder}slack", ARRAY, member=f"data[{k}]")
        for k, ((words, unit), key) in enumerate(zip(rows, SLACK_LABELS, strict=True))
    )  # fmt: skip


OUTPUTS: tuple[Variable, ...] = (
    Variable("tension at the tow point", "N", "top_tension", "tension.top",
             "~/tension_top", FLOAT64),
    Variable("lowest tension along the cable", "N", "tension_min", "tension.min",
             "~/tension_min", FLOAT64),
    Variable("highest tension along the cable", "N", "tension_max", "tension.max",
             "~/tension_max", FLOAT64),
    *_slack(""),
    Variable("force of the cable on the vessel", "N", "top_force", "force.top[i]",
             "~/top_wrench", WRENCH, (3,), member="wrench.force"),
    Variable("moment of the cable on the vessel, when clamped", "N.m", "top_moment",
             "moment.top[i]", "~/top_wrench", WRENCH, (3,), member="wrench.torque"),
    Variable("position of the far end", "m", "tip_position", "end.position[i]",
             "~/end_odom", ODOMETRY, (3,), member="pose.pose.position"),
    Variable("velocity of the far end", "m/s", "tip_velocity", "end.velocity[i]",
             "~/end_odom", ODOMETRY, (3,), member="twist.twist.linear"),
    Variable("position of a body", "m", "bodies.position", "body[j].position[i]",
             "~/bodies", POSES, ("bodies", 3), "bodies", member="poses[j].position"),
    Variable("direction of a body, away from the vessel", "", "bodies.direction",
             "body[j].direction[i]", "~/bodies", POSES, ("bodies", 3), "bodies",
             member="poses[j].orientation (turns x onto it)"),
    Variable("cable that is out, unstretched", "m", "line_length", "line.length",
             "~/line_length", FLOAT64),
    Variable("cable on the drum, unstretched", "m", "drum_length", "drum.length",
             "~/drum_length", FLOAT64, present="drum"),
    Variable("applied pay-out rate, unstretched, positive out", "m/s", "payout_rate",
             "payout.applied", "~/payout_rate", FLOAT64),
    Variable("position along the cable", "m", "state.position", "line.position[k,i]",
             "~/nodes", CLOUD, ("stations", 3), member="x y z"),
    Variable("effective tension along the cable", "N", "state.tension", "line.tension[k]",
             "~/nodes", CLOUD, ("stations",), member="tension"),
    Variable("curvature along the cable", "1/m", "state.curvature", "line.curvature[k]",
             "~/nodes", CLOUD, ("stations",), member="curvature"),
    Variable("unstretched arc length from the vessel", "m", "state.s", "",
             "~/nodes", CLOUD, ("stations",), member="s"),
    Variable("touchdown point (NaN when the cable is clear of the floor)", "m",
             "touchdown_position", "touchdown.position[i]", "~/touchdown", POINT, (3,), "floor"),
    Variable("concentrated reaction at the touchdown point", "N", "touchdown_reaction",
             "touchdown.reaction", "~/touchdown_reaction", FLOAT64, present="floor"),
    Variable("total force of the floor on the cable", "N", "floor_force", "floor.force[i]",
             "~/floor_force", WRENCH, (3,), "floor", member="wrench.force"),
    Variable("length of cable on the floor", "m", "floor_length", "floor.length",
             "~/floor_length", FLOAT64, present="floor"),
    Variable("estimated error of positions, the largest along the cable", "m", "position_error",
             "error.position", "~/position_error", FLOAT64, present="error_estimate"),
    Variable("estimated error of the tension at the tow point", "N", "tension_error",
             "error.tension", "~/tension_error", FLOAT64, present="error_estimate"),
)  # fmt: skip

LINE_OUTPUTS: tuple[Variable, ...] = (
    Variable("tension at its beginning", "N", "NAME.start_tension", "NAME.tension.start",
             "~/NAME/tension_start", FLOAT64),
    Variable("tension at its end", "N", "NAME.end_tension", "NAME.tension.end",
             "~/NAME/tension_end", FLOAT64),
    Variable("lowest tension along it", "N", "NAME.tension_min", "NAME.tension.min",
             "~/NAME/tension_min", FLOAT64),
    Variable("highest tension along it", "N", "NAME.tension_max", "NAME.tension.max",
             "~/NAME/tension_max", FLOAT64),
    *_slack("NAME"),
    Variable("position along it", "m", "NAME.state.position", "NAME.line.position[k,i]",
             "~/NAME/nodes", CLOUD, ("stations", 3), member="x y z"),
    Variable("effective tension along it", "N", "NAME.state.tension", "NAME.line.tension[k]",
             "~/NAME/nodes", CLOUD, ("stations",), member="tension"),
    Variable("curvature along it", "1/m", "NAME.state.curvature", "NAME.line.curvature[k]",
             "~/NAME/nodes", CLOUD, ("stations",), member="curvature"),
    Variable("unstretched arc length from its beginning", "m", "NAME.state.s", "",
             "~/NAME/nodes", CLOUD, ("stations",), member="s"),
)  # fmt: skip
"""Of each line of a system."""

LINE_FLOOR: tuple[Variable, ...] = (
    Variable("touchdown point (NaN: none)", "m",
             "NAME.touchdown_position", "NAME.touchdown.position[i]", "~/NAME/touchdown", POINT,
             (3,), "floor"),
    Variable("concentrated reaction there", "N", "NAME.touchdown_reaction",
             "NAME.touchdown.reaction", "~/NAME/touchdown_reaction", FLOAT64, present="floor"),
    Variable("force of the floor on it and its bodies", "N", "NAME.floor_force",
             "NAME.floor.force[i]", "~/NAME/floor_force", WRENCH, (3,), "floor",
             member="wrench.force"),
    Variable("length of it on the floor", "m", "NAME.floor_length", "NAME.floor.length",
             "~/NAME/floor_length", FLOAT64, present="floor"),
)  # fmt: skip
"""Of each line of a system over a floor."""

BODY_OUTPUTS: tuple[Variable, ...] = (
    Variable("position of its origin", "m", "NAME.position", "NAME.position[i]",
             "~/NAME/odom", ODOMETRY, (3,), member="pose.pose.position"),
    Variable("roll, pitch and yaw", "rad", "NAME.attitude", "NAME.attitude[i]",
             "~/NAME/odom", ODOMETRY, (3,), member="pose.pose.orientation"),
    Variable("velocity of its origin", "m/s", "NAME.velocity", "NAME.velocity[i]",
             "~/NAME/odom", ODOMETRY, (3,), member="twist.twist.linear (in its own axes)"),
    Variable("angular velocity", "rad/s", "NAME.angular_velocity", "NAME.angular_velocity[i]",
             "~/NAME/odom", ODOMETRY, (3,), member="twist.twist.angular (in its own axes)"),
)  # fmt: skip
"""Of each free body of a system; in the earth's frame."""

VESSEL_OUTPUTS: tuple[Variable, ...] = (
    *BODY_OUTPUTS,
    Variable("force of all lines on it", "N", "NAME.force", "NAME.force[i]",
             "~/NAME/wrench", WRENCH, (3,), member="wrench.force (in its own axes)"),
    Variable("moment of all lines about its origin", "N.m", "NAME.moment", "NAME.moment[i]",
             "~/NAME/wrench", WRENCH, (3,), member="wrench.torque (in its own axes)"),
)  # fmt: skip
"""Of each vessel or driven end; in the earth's frame."""


CUT_OUTPUTS: tuple[Variable, ...] = (
    Variable("when the line was cut there (NaN: not yet)", "s", "NAME.time", "NAME.time",
             "~/NAME/time", FLOAT64),
)  # fmt: skip
"""Of each cut of a system."""


WINCH_OUTPUTS: tuple[Variable, ...] = (
    Variable("applied pay-out rate, unstretched, positive out", "m/s", "NAME.payout_rate",
             "NAME.applied", "~/NAME/payout_rate", FLOAT64),
    Variable("unstretched length of its line", "m", "NAME.line_length", "NAME.line.length",
             "~/NAME/line_length", FLOAT64),
    Variable("cable on the drum, unstretched", "m", "NAME.drum_length", "NAME.drum.length",
             "~/NAME/drum_length", FLOAT64),
)  # fmt: skip
"""Of each winch of a system."""

LINE_ERRORS: tuple[Variable, ...] = (
    Variable("estimated error of positions along it", "m", "NAME.position_error",
             "NAME.error.position", "~/NAME/position_error", FLOAT64, present="error_estimate"),
    Variable("estimated error of its ends' tensions", "N", "NAME.tension_error",
             "NAME.error.tension", "~/NAME/tension_error", FLOAT64, present="error_estimate"),
)  # fmt: skip
"""Of each line of a system."""

BODY_ERRORS: tuple[Variable, ...] = (
    Variable("estimated error of its position", "m", "NAME.position_error",
             "NAME.error.position", "~/NAME/position_error", FLOAT64, present="error_estimate"),
)  # fmt: skip
"""Of each free body of a system."""


@dataclass(frozen=True)
class Input:
    """One input of a step, and what it is called in each interface."""

    quantity: str
    unit: str
    python: str
    """Argument of ``CableModel.step``."""
    fmu: str
    topic: str
    """ROS 2 source; empty where the node has none."""
    message: str
    shape: tuple[int, ...] = ()


INPUTS: tuple[Input, ...] = (
    Input("velocity of the tow point", "m/s", "vessel_velocity", "vessel.velocity[i]",
          "~/odom or cmd_vel", "nav_msgs/msg/Odometry or geometry_msgs/msg/TwistStamped", (3,)),
    Input("position of the tow point", "m", "vessel_position", "vessel.position[i]",
          "~/odom", "nav_msgs/msg/Odometry", (3,)),
    Input("pay-out rate, unstretched, positive out", "m/s", "payout_rate", "payout.rate",
          "~/payout_rate_cmd", FLOAT64),
    Input("current, added to the scene's", "m/s", "current", "current.velocity[i]", "", "", (3,)),
)  # fmt: skip

_STEP_OF_SYSTEM: tuple[tuple[str, int], ...] = (("time", 1), ("step", 1))

VESSEL_INPUTS: tuple[Input, ...] = (
    Input("position of its origin", "m", "position", "NAME.position_input[i]",
          "~/NAME/odom_in", ODOMETRY, (3,)),
    Input("velocity of its origin", "m/s", "velocity", "NAME.velocity_input[i]",
          "~/NAME/odom_in", ODOMETRY, (3,)),
    Input("roll, pitch and yaw", "rad", "attitude", "NAME.attitude_input[i]",
          "~/NAME/odom_in", ODOMETRY, (3,)),
    Input("rates of roll, pitch and yaw", "rad/s", "attitude_rate", "NAME.attitude_rate_input[i]",
          "~/NAME/odom_in", ODOMETRY, (3,)),
)  # fmt: skip
"""Of each vessel or driven end of a system: fields of ``VesselInput``."""

BODY_INPUTS: tuple[Input, ...] = (
    Input("outside force", "N", "force", "NAME.force_input[i]", "~/NAME/wrench_in", WRENCH, (3,)),
    Input("outside torque about its origin", "N.m", "torque", "NAME.torque_input[i]",
          "~/NAME/wrench_in", WRENCH, (3,)),
)  # fmt: skip
"""Of each free body of a system."""

FOIL_INPUT = Input("deflection", "rad", "deflection", "NAME.deflection", "~/NAME/deflection",
                   FLOAT64)  # fmt: skip
"""Of each foil of a system, by the names of its body and its own: BODY.FOIL, in a topic
BODY/FOIL."""

WINCH_INPUT = Input("pay-out rate, unstretched, positive out", "m/s", "rate", "NAME.rate",
                    "~/NAME/payout_rate_cmd", FLOAT64)  # fmt: skip
"""Of each winch of a system."""

CUT_INPUT = Input("above 0.5: make the cut now", "", "cut", "NAME.cut", "~/NAME/cut", TRIGGER)
"""Of each cut of a system: in ROS 2 a service."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of the FMU, and where the scene has it."""

    quantity: str
    unit: str
    fmu: str
    """n counts the cables of the line, or of the drum, from the vessel, and j the bodies, from 1;
    K is the name of a cable type."""
    scene: str
    """Path in the scene, whose indices count from 0; empty where it has none."""
    tunable: bool
    """Whether it may change during a run; otherwise it is fixed at the initialization."""


PARAMETERS: tuple[Parameter, ...] = (
    Parameter("true: the scene's own schedules drive what is not connected", "",
              "use_scene_inputs", "", False),
    Parameter("which inputs move the tow point", "", "vessel.input", "", False),
    Parameter("when in a step the value of an input holds", "", "input.timing", "", False),
    Parameter("position of the tow point at the start", "m", "vessel.start_position[i]",
              "vessel.position", False),
    Parameter("velocity of the tow point at the start", "m/s", "vessel.start_velocity[i]",
              "vessel.velocity", False),
    Parameter("coefficient of normal drag", "", "cable_types.K.drag_normal",
              "cable_types.K.drag_normal", True),
    Parameter("coefficient of tangential drag, times pi diameter", "",
              "cable_types.K.drag_tangential", "cable_types.K.drag_tangential", True),
    Parameter("coefficient of added mass", "", "cable_types.K.added_mass",
              "cable_types.K.added_mass", True),
    Parameter("weight in water", "N/m", "cable_types.K.submerged_weight",
              "cable_types.K.submerged_weight", True),
    Parameter("coefficient of drag across the axis", "", "body[j].drag_coefficient",
              "line.N.body.drag_coefficient", True),
    Parameter("coefficient of drag along the axis", "", "body[j].drag_coefficient_axial",
              "line.N.body.drag_coefficient_axial", True),
    Parameter("weight in water", "N", "body[j].submerged_weight",
              "line.N.body.submerged_weight", True),
    Parameter("unstretched length of a cable of the line", "m",
              "line.cable[n].length", "line.N.cable.length", False),
    Parameter("unstretched length of a cable on the drum, as they leave it", "m",
              "drum.cable[n].length", "payout.drum.N.cable.length", False),
)  # fmt: skip
"""What an FMU's user may set before the start or, where tunable, during a run."""


VESSEL_CHOICE = Parameter("which inputs move it", "", "NAME.input", "", False)
"""Of each vessel or driven end of a system."""

VESSEL_STARTS: tuple[Parameter, ...] = (
    Parameter("position at the start", "m", "NAME.start_position[i]",
              "vessels.NAME.position", False),
    Parameter("velocity at the start", "m/s", "NAME.start_velocity[i]",
              "vessels.NAME.velocity", False),
    Parameter("attitude at the start", "rad", "NAME.start_attitude[i]",
              "vessels.NAME.attitude", False),
)  # fmt: skip
"""The same, in the order of VesselStart in the FMU's c/cable.h."""

FREE_BODY_PARAMETERS: tuple[Parameter, ...] = (
    Parameter("drag area", "m2", "NAME.drag_area[i]", "bodies.NAME.drag_area", True),
    Parameter("weight in water", "N", "NAME.submerged_weight", "bodies.NAME.submerged_weight",
              True),
)  # fmt: skip
"""Of each free body of a system."""

SYSTEM_LENGTHS: tuple[Parameter, ...] = (
    Parameter("unstretched length of a cable of a line, from its beginning", "m",
              "NAME.cable[n].length", "lines.NAME.items.N.cable.length", False),
    Parameter("the same on a winch's drum, as they leave it", "m",
              "NAME.cable[n].length", "winches.NAME.drum.N.cable.length", False),
)  # fmt: skip
"""Of each line and winch of a system."""


def parameter(fmu: str) -> Parameter:
    """The row of :data:`PARAMETERS` with this name."""
    return next(row for row in PARAMETERS if row.fmu == fmu)


APPLIED_INPUTS_TOPIC = "~/applied_inputs"
STATE_TOPIC = "~/state"
LINE_STATE_TOPIC = "~/NAME/state"
OUTPUTS_TOPIC = "~/outputs"
"""Of a system: all outputs over time, exact; the other topics are for viewers."""


def topic_of_part(topic: str, name: str) -> str:
    """A topic of the table with the name of a part, of which that of a foil is BODY.FOIL."""
    return topic.replace("NAME", name.replace(".", "/"))


def state_topics_of(scene: Any) -> dict[str, str]:
    """Topics (``~/...``) of the exact states of each line; of a scene of one line that of ""."""
    if not is_system(scene):
        return {"": STATE_TOPIC}
    return {name: topic_of_part(LINE_STATE_TOPIC, name) for name in scene.lines}


def output_labels(scene: Any) -> tuple[str, ...]:
    """Names of the numbers of OUTPUTS_TOPIC: the time, and every component of every output."""
    rows = [
        (row.python, max((1, *(size for size in row.shape if isinstance(size, int)))))
        for row in outputs_of(scene)
        if row.message != CLOUD
    ]
    return _labels((("time", 1), *rows))


STATE_FIELDS: tuple[tuple[str, int], ...] = (
    ("s", 1),
    ("position", 3),
    ("tangent", 3),
    ("velocity", 3),
    ("tension", 1),
    ("curvature", 1),
    ("bending_moment", 1),
    ("on_floor", 1),
)
"""Fields of a logged state and their components, in the order of the rows of ``~/state``."""

DERIVED: tuple[str, ...] = ("wall_tension",)
"""What states have beside them, one number a node, made of them and of the scene when asked for."""


def _labels(fields: tuple[tuple[str, int], ...]) -> tuple[str, ...]:
    """Name of every component: position.x, position.y, position.z, tension, ..."""
    return tuple(
        name if count == 1 else f"{name}.{axis}"
        for name, count in fields
        for axis in ("xyz"[:count] if count > 1 else " ")
    )


def span(fields: tuple[tuple[str, int], ...], name: str) -> slice:
    """Where a field's components stand among the labels of all fields."""
    first = 0
    for field, count in fields:
        if field == name:
            return slice(first, first + count)
        first += count
    raise KeyError(name)


STATE_LABELS: tuple[str, ...] = _labels(STATE_FIELDS)

APPLIED_INPUT_FIELDS: tuple[tuple[str, int], ...] = (
    ("time", 1),
    ("step", 1),
    ("vessel_position", 3),
    ("vessel_velocity", 3),
    ("payout_rate", 1),
    ("current", 3),
    *((f"{item.python}_given", 1) for item in INPUTS),
)
"""Fields of a logged step: its end and length [s], the values reached at its end, and for every
input whether the caller gave it (1) or the scene's own table drove it (0)."""

APPLIED_INPUT_LABELS: tuple[str, ...] = _labels(APPLIED_INPUT_FIELDS)


def inputs_of_system(scene: Any) -> tuple[tuple[str, Input], ...]:
    """Every input of a system's step: name of its part, and its row."""
    foils = [f"{name}.{foil}" for name, body in scene.bodies.items() for foil in body.foils]
    return tuple(
        (name, row)
        for rows, names in (
            (VESSEL_INPUTS, scene.vessels),
            (BODY_INPUTS, scene.bodies),
            ((FOIL_INPUT,), foils),
            ((WINCH_INPUT,), scene.winches),
            ((CUT_INPUT,), scene.cuts),
        )
        for name in names
        for row in rows
    )


def input_labels(scene: Any) -> tuple[str, ...]:
    """Names of the numbers that a logged step holds. Of a system: end and length of the step, and
    what the caller gave, NaN where he gave nothing."""
    if not is_system(scene):
        return APPLIED_INPUT_LABELS
    rows = [(f"{name}.{row.python}", max((1, *row.shape))) for name, row in inputs_of_system(scene)]
    return _labels((*_STEP_OF_SYSTEM, *rows))


@cache
def resolved(topic: str) -> str:
    """Topic with a leading ``~`` replaced by the node's name."""
    return f"/{NODE_NAME}{topic[1:]}" if topic.startswith("~") else topic


def features(scene: Any) -> frozenset[str]:
    """What a scene has, in the words of :attr:`Variable.present`."""
    found = {"always"}
    if any(getattr(item, "body", None) is not None for item in (*scene.line, *_drum(scene))):
        found.add("bodies")
    if _drum(scene):
        found.add("drum")
    if scene.environment.floor is not None:
        found.add("floor")
    if scene.solver.error_estimate:
        found.add("error_estimate")
    return frozenset(found)


def is_system(scene: Any) -> bool:
    """Whether a scene has lines by name."""
    return "lines" in vars(scene)


def _drum(scene: Any) -> tuple[Any, ...]:
    payout = getattr(scene, "payout", None)
    return tuple(payout.drum) if payout is not None else ()


@cache
def _outputs_of_parts(*kinds: tuple[str, ...]) -> tuple[Variable, ...]:
    """The rows of parts of these names, by their kinds: asked for at every output."""
    rows_of_kinds = (
        LINE_OUTPUTS, BODY_OUTPUTS, VESSEL_OUTPUTS, WINCH_OUTPUTS, CUT_OUTPUTS,
        LINE_FLOOR, LINE_ERRORS, BODY_ERRORS,
    )  # fmt: skip
    return tuple(
        row.of_part(name)
        for rows, names in zip(rows_of_kinds, kinds, strict=True)
        for name in names
        for row in rows
    )


def outputs_of(scene: Any) -> tuple[Variable, ...]:
    """The rows of the table that a scene has; of a system those of its parts, by their names."""
    if is_system(scene):
        kinds = scene.lines, scene.bodies, scene.vessels, scene.winches, scene.cuts
        over = scene.lines if scene.environment.floor is not None else ()
        judged = (scene.lines, scene.bodies) if scene.solver.error_estimate else ((), ())
        return _outputs_of_parts(*(tuple(names) for names in (*kinds, over, *judged)))
    return tuple(variable for variable in OUTPUTS if variable.in_scene(scene))


def topics_of(scene: Any) -> dict[str, str]:
    """Output topics (resolved) of a scene, in the table's order, and their message types."""
    return {variable.resolved_topic: variable.message for variable in outputs_of(scene)}


_WHEN: dict[str, str] = {
    "always": "",
    "bodies": "scenes with bodies",
    "drum": "scenes with a drum",
    "floor": "scenes with a floor",
    "error_estimate": "`solver.error_estimate`",
}


def document() -> str:
    """The table as a page of the docs (Markdown)."""
    lines = [
        "# Variables",
        "",
        "For those who read results or drive a cable by name. "
        "Generated from `cablemodel/variables.py` by `python -m cablemodel.variables "
        "docs/variables.md`; do not edit.",
        "",
        "Units are SI. Axes are x east, y north, z up; arc length s is unstretched and counts from",
        "the vessel. FMU indices count from 1: i over x, y, z; j over bodies; k over stations. "
        f"`~` is `/{NODE_NAME}`.",
        "",
        "## Outputs",
        "",
        "|quantity|unit|Python|FMU|ROS 2 and log|message|in it|only in|",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in OUTPUTS:
        cells = (
            row.quantity, row.unit or "-", f"`{_python_text(row.python)}`",
            f"`{row.fmu}`" if row.fmu else "-", f"`{row.topic}`", row.message,
            row.member, _WHEN[row.present],
        )  # fmt: skip
        lines.append("|" + "|".join(cells) + "|")
    lines += [
        "",
        "Tensions are *effective* tensions: those of the equations, whose weight is that in",
        "water. The *wall tension*, what the material carries, is less by the pressure of the",
        "water around the cable times its cross-section, and equal above the water (as in",
        "OrcaFlex). Python has it as `state().wall_tension`, a run as `run.states.wall_tension`,",
        "an export of states as a column; it is made of a state and the scene, from a log as well.",
        "",
        "A line is *slack* from when its lowest tension comes to 0 until that is 2 % of the",
        "largest at the start, or of its weight in water (with a free end 0): folds pull a little.",
        "Cable that the floor bears does not count.",
        "",
        "## Inputs",
        "",
        "|quantity|unit|Python: `step(...)`|FMU|ROS 2|message|",
        "|---|---|---|---|---|---|",
    ]
    for item in INPUTS:
        entries = (
            item.quantity, item.unit, f"`{item.python}`", f"`{item.fmu}`",
            f"`{item.topic}`" if item.topic else "-", item.message or "-",
        )  # fmt: skip
        lines.append("|" + "|".join(entries) + "|")
    lines += [
        "",
        *_systems(),
        "## Parameters of the FMU",
        "",
        "Fixed at the initialization, or tunable in a run. n counts cables of line or drum from",
        "the vessel, j bodies; K is a cable type, N a place in the scene's list, from 0.",
        "",
        "|quantity|unit|FMU|scene||",
        "|---|---|---|---|---|",
    ]
    for entry in (*PARAMETERS, *VESSEL_STARTS, *FREE_BODY_PARAMETERS, *SYSTEM_LENGTHS):
        texts = (
            entry.quantity, entry.unit or "-", f"`{entry.fmu}`",
            f"`{entry.scene}`" if entry.scene else "-", "tunable" if entry.tunable else "fixed",
        )  # fmt: skip
        lines.append("|" + "|".join(texts) + "|")
    lines += [
        "",
        "## Only in the log: what replay needs, exact",
        "",
        f"Both are `{ARRAY}`, in 64-bit floats.",
        "",
        f"- `{APPLIED_INPUTS_TOPIC}`, one for every step: "
        + ", ".join(f"`{label}`" for label in APPLIED_INPUT_LABELS)
        + ". `time` is the end of the step, values are those reached there, NaN where neither",
        "  given nor reported; `..._given` is 1 where the caller gave the input, else 0.",
        f"- `{STATE_TOPIC}`, at every output, or in long runs at some of them: the time [s] first",
        "  (`data_offset` is 1), then a matrix with a row for each of "
        + ", ".join(f"`{label}`" for label in STATE_LABELS)
        + " and a column for each node from the vessel to the far end.",
        "",
    ]
    return "\n".join(lines)


def _systems() -> list[str]:
    """Outputs and inputs of a system's parts."""
    lines = [
        "## Of systems",
        "",
        "NAME is that of a line, body, vessel, winch or cut. Outputs are `run[...]` and those of",
        "`SystemModel.outputs()`; inputs are arguments of `SystemModel.step`.",
        "",
        "The touchdown point of a line is the one nearest to its beginning or, where only its",
        "beginning is at an anchor or lies, nearest to its end. A line that is cut counts whole.",
        "",
        "|of a|quantity|unit|Python|FMU|ROS 2 and log|",
        "|---|---|---|---|---|---|",
    ]
    outputs = (
        ("line", LINE_OUTPUTS), ("body", BODY_OUTPUTS),
        ("vessel", VESSEL_OUTPUTS[len(BODY_OUTPUTS) :]), ("winch", WINCH_OUTPUTS),
        ("cut", CUT_OUTPUTS), ("line", LINE_FLOOR), ("line", LINE_ERRORS), ("body", BODY_ERRORS),
    )  # fmt: skip
    for part, rows in outputs:
        name = "body, vessel" if rows is BODY_OUTPUTS else part
        lines += [_cells(name, row, row.python, row.fmu) for row in rows]
    lines += ["", "|input of a|quantity|unit|Python|FMU|ROS 2|", "|---|---|---|---|---|---|"]
    inputs = (
        ("vessel", "vessels[NAME].{}", VESSEL_INPUTS), ("body", "forces[NAME], {}", BODY_INPUTS),
        ("foil", "deflections[NAME]", (FOIL_INPUT,)), ("winch", "rates[NAME]", (WINCH_INPUT,)),
        ("cut", "cuts", (CUT_INPUT,)),
    )  # fmt: skip
    for part, python, given in inputs:
        lines += [_cells(part, row, python.format(_OF_SIX.get(row.python, row.python)), row.fmu)
                  for row in given]  # fmt: skip
    return [*lines, ""]


_OF_SIX = {"force": "the first 3 of 6", "torque": "the last 3 of 6"}
"""Where in an argument of a step they are."""


def _cells(part: str, row: Variable | Input, python: str, fmu: str) -> str:
    names = (f"`{python}`", f"`{fmu}`" if fmu else "-", f"`{row.topic}`")
    when = _WHEN[row.present] if isinstance(row, Variable) else ""
    quantity = f"{row.quantity} ({when.removeprefix('scenes with a ')})" if when else row.quantity
    return "|" + "|".join((part, quantity, row.unit or "-", *names)) + "|"


def _python_text(name: str) -> str:
    """Attribute as a user types it."""
    return name.replace("bodies.", "bodies[j].").replace("state.", "state().")


if __name__ == "__main__":
    import sys
    from pathlib import Path

    Path(sys.argv[1]).write_text(document(), encoding="utf-8")
