"""Topics and services of the node and their quality of service: one table, also for the docs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cablemodel import variables
from cablemodel_ros.samples import APPLIED_ODOMETRY, APPLIED_TWIST, NODES, TWIST, VESSEL_WRENCH


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
PAYOUT = Quality(1)
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


def _outputs() -> tuple[Topic, ...]:
    found: dict[str, list[variables.Variable]] = {}
    for variable in variables.OUTPUTS:
        found.setdefault(variable.topic, []).append(variable)
    when = {
        "bodies": " (scenes with bodies)",
        "drum": " (with a drum)",
        "floor": " (with a floor)",
        "error_estimate": " (with `solver.error_estimate`)",
    }
    return tuple(
        Topic(
            name,
            rows[0].message,
            SHAPE if name == NODES else OUTPUT,
            "; ".join(
                f"{row.quantity} [{row.unit or '-'}]"
                + (f" in `{row.member}`" if row.member else "")
                for row in rows
            )
            + when.get(rows[0].present, ""),
        )
        for name, rows in found.items()
    )


OUTPUTS: tuple[Topic, ...] = _outputs()

APPLIED: tuple[Topic, ...] = (
    Topic(APPLIED_ODOMETRY, variables.ODOMETRY, OUTPUT,
          "motion of the tow point as applied, in map axes"),
    Topic(APPLIED_TWIST, TWIST, OUTPUT, "velocity of the tow point as applied, in map axes"),
    Topic(variables.APPLIED_INPUTS_TOPIC, variables.ARRAY, OUTPUT,
          "all inputs of the step in 64-bit floats, as logged"),
    Topic(VESSEL_WRENCH, variables.WRENCH, OUTPUT,
          "force and moment of the cable on the vessel about `vessel_frame`, in its axes"),
)  # fmt: skip

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
PAYOUT_RATE = Topic("~/payout_rate_cmd", variables.FLOAT64, PAYOUT,
                    "pay-out rate, unstretched, positive out [m/s]")  # fmt: skip
FOREIGN_CLOCK = Topic("/clock", "rosgraph_msgs/msg/Clock", CLOCK,
                      "time to follow, with `use_sim_time`")  # fmt: skip
INPUTS: tuple[Topic, ...] = (ODOM, CMD_VEL, PAYOUT_RATE, FOREIGN_CLOCK)

SERVICES: dict[str, str] = {
    "~/reset": "back to the initial state; commands are forgotten, a new log file begins",
    "~/save": "write scene (YAML) and state (NumPy) to `save_folder`; the answer names the file",
}


def topics_of(scene: Any) -> tuple[Topic, ...]:
    """Topics that a scene's model publishes at every step."""
    names = {variable.topic for variable in variables.outputs_of(scene)}
    return tuple(topic for topic in OUTPUTS if topic.name in names) + APPLIED


def document() -> str:
    """Topics and services as Markdown tables."""
    lines = ["|published|message|QoS|when||", "|---|---|---|---|---|"]
    lines += [
        f"|`{topic.name}`|{topic.message}|{topic.quality}|{topic.rate}|{topic.meaning}|"
        for topic in (*OUTPUTS, *APPLIED, *OTHERS)
    ]
    lines += ["", "|subscribed|message|QoS||", "|---|---|---|---|"]
    lines += [
        f"|`{topic.name}`|{topic.message}|{topic.quality}|{topic.meaning}|" for topic in INPUTS
    ]
    lines += ["", "|service|type||", "|---|---|---|"]
    lines += [f"|`{name}`|std_srvs/srv/Trigger|{text}|" for name, text in SERVICES.items()]
    return "\n".join(lines) + "\n"
