"""Topics and services of the node and their quality of service: one table, also for the docs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from cablemodel import variables
from cablemodel_ros.samples import APPLIED_ODOMETRY, APPLIED_TWIST, TWIST, VESSEL_WRENCH


@dataclass(frozen=True)
class Quality:
    """Quality of service of a topic."""

    depth: int
    reliable: bool = True
    keeps_last: bool = False
    """Transient-local: who subscribes later gets the last message."""

    def __str__(self) -> str:
        kind = "reliable" if self.reliable else "best effort"
        return f"{kind}, {self.depth}" + (", transient local" if self.keeps_last else "")


OUTPUT = Quality(10)
"""For controllers: works with reliable and best-effort subscribers."""
SHAPE = Quality(1)
"""Large and often: only the newest matters."""
COMMAND = Quality(1, reliable=False)
"""The newest command only, from any publisher; a flood of them costs the flooder."""
SINGLE = Quality(1)
"""A single message counts, so it must not get lost."""
CLOCK = Quality(1, reliable=False)
LATCHED = Quality(1, keeps_last=True)
DIAGNOSTICS = Quality(10)


@dataclass(frozen=True)
class Topic:
    """A topic of the node."""

    name: str
    message: str
    quality: Quality
    meaning: str
    rate: str = "every step"


def _outputs(variables_: Iterable[variables.Variable]) -> tuple[Topic, ...]:
    """Topics of rows of the table of variables, of which several may stand in one message.

    What they mean is said in docs/variables.md.
    """
    messages = {variable.topic: variable.message for variable in variables_}
    return tuple(
        Topic(name, message, SHAPE if message == variables.CLOUD else OUTPUT, "")
        for name, message in messages.items()
    )


OUTPUTS: tuple[Topic, ...] = _outputs(variables.OUTPUTS)

INPUTS_APPLIED = Topic(variables.APPLIED_INPUTS_TOPIC, variables.ARRAY, OUTPUT,
                       "all inputs of the step in 64-bit floats, as logged")  # fmt: skip
APPLIED: tuple[Topic, ...] = (
    Topic(APPLIED_ODOMETRY, variables.ODOMETRY, OUTPUT,
          "motion of the tow point as applied, in map axes"),
    Topic(APPLIED_TWIST, TWIST, OUTPUT, "velocity of the tow point as applied, in map axes"),
    INPUTS_APPLIED,
    Topic(VESSEL_WRENCH, variables.WRENCH, OUTPUT,
          "force and moment of the cable on the vessel about `vessel_frame`, in its axes"),
)  # fmt: skip

ALL_OUTPUTS = Topic(variables.OUTPUTS_TOPIC, variables.ARRAY, OUTPUT,
                    "all outputs but shapes in 64-bit floats, as logged")  # fmt: skip
"""Of a system."""

OTHERS: tuple[Topic, ...] = (
    Topic("~/scene", "std_msgs/msg/String", LATCHED, "the scene, in short and in full (JSON)",
          "once"),
    Topic("~/markers", "visualization_msgs/msg/MarkerArray", SHAPE, "for RViz", "`markers_rate`"),
    Topic("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", DIAGNOSTICS,
          "how the node is", "`diagnostics_rate`"),
    Topic("/clock", "rosgraph_msgs/msg/Clock", CLOCK,
          "simulated time, when it is not real time, or asked for", "every step"),
    Topic("/tf", "tf2_msgs/msg/TFMessage", OUTPUT,
          "map to the tow point's frame, with `tf`; to the vessel's, with `tf_vessel`",
          "every step"),
)  # fmt: skip

ODOM = Topic("~/odom", "nav_msgs/msg/Odometry", COMMAND,
             "motion of the vessel: pose in `odom_frame`, twist in `vessel_frame`")  # fmt: skip
CMD_VEL = Topic("cmd_vel", TWIST, COMMAND,
                "velocity of the vessel in map or vessel axes (`header.frame_id`), "
                "rates of roll, pitch and turn")  # fmt: skip
PAYOUT_RATE = Topic("~/payout_rate_cmd", variables.FLOAT64, SINGLE,
                    "pay-out rate, unstretched, positive out [m/s]")  # fmt: skip
FOREIGN_CLOCK = Topic("/clock", "rosgraph_msgs/msg/Clock", CLOCK,
                      "time to follow, with `use_sim_time`")  # fmt: skip
INPUTS: tuple[Topic, ...] = (ODOM, CMD_VEL, PAYOUT_RATE, FOREIGN_CLOCK)


def _input_of(row: variables.Input, quality: Quality, meaning: str) -> Topic:
    return Topic(row.topic, row.message, quality, meaning)


PART_ODOM = _input_of(
    variables.VESSEL_INPUTS[0],
    COMMAND,
    "motion of the vessel: pose in `odom_frame`, twist in its own axes",
)
PART_CMD_VEL = Topic(
    "~/NAME/cmd_vel",
    TWIST,
    COMMAND,
    "its velocity in map or its own axes, rates of roll, pitch and turn",
)
PART_WRENCH = _input_of(
    variables.BODY_INPUTS[0],
    COMMAND,
    "force [N] and torque [N.m] on the body about its origin, in map or its own axes",
)
FOIL_DEFLECTION = _input_of(variables.FOIL_INPUT, SINGLE, "deflection of the foil [rad]")
WINCH_RATE = _input_of(
    variables.WINCH_INPUT, SINGLE, "pay-out rate of the winch, unstretched, positive out [m/s]"
)
PART_INPUTS = (PART_ODOM, PART_CMD_VEL, PART_WRENCH, FOIL_DEFLECTION, WINCH_RATE)
"""Of a system; NAME is that of a vessel or driven end, of a body, of a foil: BODY/FOIL, and of a
winch."""

SERVICES: dict[str, str] = {
    "~/reset": "back to the initial state; commands are forgotten, a new log file begins",
    "~/save": "write scene (YAML) and state (NumPy) to `save_folder`; the answer names the file",
}


def topics_of(scene: Any) -> tuple[Topic, ...]:
    """Topics that a scene's model publishes at every step."""
    rows = _outputs(variables.outputs_of(scene))
    return (*rows, *((INPUTS_APPLIED, ALL_OUTPUTS) if variables.is_system(scene) else APPLIED))


def unstamped(topic: Topic) -> Topic:
    """cmd_vel as a plain Twist."""
    return replace(topic, message="geometry_msgs/msg/Twist")


def topic_of_part(topic: Topic, name: str) -> Topic:
    """An input of the part of a system."""
    return replace(topic, name=variables.topic_of_part(topic.name, name))


def cut_service(name: str) -> str:
    """Of a cut of a system."""
    return variables.topic_of_part(variables.CUT_INPUT.topic, name)


def _published(topics: Iterable[Topic]) -> list[str]:
    return [
        f"|`{topic.name}`|{topic.message}|{topic.quality}|{topic.rate}|{topic.meaning}|"
        for topic in topics
    ]


def _subscribed(topics: Iterable[Topic]) -> list[str]:
    return [f"|`{topic.name}`|{topic.message}|{topic.quality}|{topic.meaning}|" for topic in topics]


_PUBLISHED = ["|published|message|QoS|when||", "|---|---|---|---|---|"]
_SUBSCRIBED = ["", "|subscribed|message|QoS||", "|---|---|---|---|"]


def document() -> str:
    """Topics, but for outputs (docs/variables.md has them), and services as Markdown tables."""
    lines = [*_PUBLISHED, *_published((*APPLIED, *OTHERS))]
    lines += [*_SUBSCRIBED, *_subscribed(INPUTS)]
    lines += ["", "|service|type||", "|---|---|---|"]
    lines += [f"|`{name}`|{variables.TRIGGER}|{text}|" for name, text in SERVICES.items()]
    return "\n".join(lines) + "\n"


def document_of_systems() -> str:
    """Those that a system has by the names of its parts, as Markdown tables."""
    lines = ["|of each|published|message|", "|---|---|---|"]
    for part, rows in (
        ("line", variables.LINE_OUTPUTS),
        ("body", variables.BODY_OUTPUTS),
        ("vessel", variables.VESSEL_OUTPUTS),
        ("cut", variables.CUT_OUTPUTS),
        ("line, floor", variables.LINE_FLOOR),
        ("line, with `solver.error_estimate`", variables.LINE_ERRORS),
        ("body, with it", variables.BODY_ERRORS),
    ):
        lines += [f"|{part}|`{topic.name}`|{topic.message}|" for topic in _outputs(rows)]
    lines += [*_SUBSCRIBED, *_subscribed(PART_INPUTS)]
    return "\n".join(lines) + "\n"
