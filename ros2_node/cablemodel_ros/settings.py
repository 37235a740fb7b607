"""The one table of the node's parameters, and the settings that a session is made from.

Descriptors of the node, checks, and the table in docs/ros2.md are generated from it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Change = Literal["never", "unconfigured", "always"]
"""When a parameter may change: only at start-up, while the node is not configured, or any time."""

Value = bool | int | float | str | tuple[float, ...]


class SettingsError(ValueError):
    """A parameter that cannot be used; names it, its value and what is allowed."""


@dataclass(frozen=True)
class Parameter:
    """One parameter of the node."""

    name: str
    default: Value
    description: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()
    change: Change = "unconfigured"

    @property
    def attribute(self) -> str:
        """Name in `Settings`: ``limits.speed`` is ``limits_speed``."""
        return self.name.replace(".", "_")

    @property
    def allowed(self) -> str:
        """What may be given, in words."""
        if self.choices:
            return " | ".join(self.choices)
        if self.minimum is not None:
            kind = "a whole number" if isinstance(self.default, int) else "a number"
            return f"{kind} from {self.minimum:g} to {self.maximum:g} {self.unit}".rstrip()
        kinds = {bool: "true or false", str: "text", tuple: "three numbers"}
        return kinds[type(self.default)]

    def checked(self, value: Any) -> Value:
        """The value in the parameter's own type.

        Raises:
            SettingsError: wrong type, not finite, or out of range.
        """
        wrong = SettingsError(f"parameter {self.name} is {value!r}; allowed: {self.allowed}")
        if isinstance(self.default, bool):
            if not isinstance(value, bool):
                raise wrong
            return value
        if isinstance(self.default, str):
            if not isinstance(value, str) or (self.choices and value not in self.choices):
                raise wrong
            return value
        if isinstance(self.default, tuple):
            try:
                numbers = tuple(float(number) for number in value)
            except (TypeError, ValueError):
                raise wrong from None
            if len(numbers) != len(self.default) or not all(map(math.isfinite, numbers)):
                raise wrong
            return numbers
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise wrong
        assert self.minimum is not None
        assert self.maximum is not None
        if not self.minimum <= value <= self.maximum:  # also refuses not-a-number
            raise wrong
        if isinstance(self.default, int):
            if value != int(value):
                raise wrong
            return int(value)
        return float(value)


PARAMETERS: tuple[Parameter, ...] = (
    Parameter("scene", "", "Path of a scene file, or the text of a scene (YAML)."),
    Parameter("initial_state", "", "Path of a state that ~/save wrote; empty: the scene's own."),
    Parameter("rate", 100.0, "Steps and publications per simulated second.", "Hz", 0.1, 1000.0),
    Parameter("real_time_factor", 1.0,
              "Simulated seconds per second; 0: as fast as possible. Other than 1 publishes "
              "/clock. With use_sim_time the node follows the foreign /clock instead.", "",
              0.0, 1000.0),
    Parameter("publish_clock", False,
              "Publish simulated time on /clock; stamps then count from 0."),
    Parameter("lag_limit", 0.5, "How far simulated time may fall behind before it slips.", "s",
              0.01, 60.0, change="always"),
    Parameter("vessel_input", "odom",
              "What moves the tow point, or a system's vessels: odometry, cmd_vel, or the scene's "
              "own schedule.",
              choices=("odom", "cmd_vel", "scene")),
    Parameter("vessel_inputs", "",
              "Of a system: vessels and driven ends that something else moves, as "
              "\"ship=scene vehicle=odom\"."),
    Parameter("payout_input", "command",
              "What sets the pay-out rate: ~/payout_rate_cmd or the scene's own schedule.",
              choices=("command", "scene")),
    Parameter("cmd_vel_stamped", True,
              "cmd_vel is TwistStamped; false: Twist, in the vessel frame.",
              change="never"),
    Parameter("vessel_frame", "base_link", "Name of the vessel's frame.", change="never"),
    Parameter("odom_frame", "map", "Frame of ~/odom's pose; taken to be aligned with the map."),
    Parameter("odom_relative", False,
              "Count positions of ~/odom from its first message, which is where the scene begins."),
    Parameter("odom_smoothing", 0.2,
              "Time constant with which the tow point follows ~/odom; noise of a sample is not "
              "taken for motion.", "s", 0.0, 10.0, change="always"),
    Parameter("tow_point", (0.0, 0.0, 0.0), "Tow point in the vessel frame.", "m"),
    Parameter("tow_point_frame", "tow_point",
              "Name of the frame at the tow point, parallel to the map.", change="never"),
    Parameter("initial_heading", 0.0,
              "Heading of the vessel at the start, for cmd_vel; 0 with initial_state: as saved.",
              "rad", -6.2832, 6.2832),
    Parameter("command_timeout", 0.5, "Age at which a command is stale and ramps to zero.", "s",
              0.02, 60.0, change="always"),
    Parameter("limits.speed", 10.0, "Highest speed of the tow point.", "m/s", 0.0, 100.0,
              change="always"),
    Parameter("limits.acceleration", 2.0, "Highest acceleration of the tow point.", "m/s2",
              0.001, 1000.0, change="always"),
    Parameter("limits.turn_rate", 1.0,
              "Highest rate of turn, for cmd_vel; of a system's vessels always.", "rad/s",
              0.0, 10.0, change="always"),
    Parameter("limits.turn_acceleration", 2.0, "Highest change of it, of a system's vessels.",
              "rad/s2", 0.001, 1000.0, change="always"),
    Parameter("limits.deflection_rate", 1.0, "Highest rate of a foil's deflection.", "rad/s",
              0.001, 1000.0, change="always"),
    Parameter("limits.payout_rate", 2.0, "Highest pay-out and reel-in rate.", "m/s", 0.0, 100.0,
              change="always"),
    Parameter("limits.payout_acceleration", 1.0, "Highest change of the pay-out rate.", "m/s2",
              0.001, 1000.0, change="always"),
    Parameter("limits.line_length_min", 1.0, "Reeling in stops with this much cable out.", "m",
              0.0, 1.0e5, change="always"),
    Parameter("limits.position_jump", 10.0,
              "An odometry position farther than this from the tow point is refused.", "m",
              0.0, 1.0e7, change="always"),
    Parameter("stations", 64, "Points of ~/nodes, spaced evenly along the cable.", "", 2, 5000),
    Parameter("markers_rate", 2.0, "Publications of ~/markers; 0: none.", "Hz", 0.0, 30.0),
    Parameter("diagnostics_rate", 1.0, "Publications of /diagnostics.", "Hz", 0.1, 20.0),
    Parameter("tf", False,
              "Broadcast the transform from map to the tow point's frame (needs tf2_msgs)."),
    Parameter("tf_vessel", False,
              "Broadcast the transform from map to the vessel frame too; only where nobody else "
              "(a localisation) does."),
    Parameter("log.folder", "", "Folder of the MCAP logs; empty: no log."),
    Parameter("log.max_size", 256.0, "Size at which the next file is begun.", "MB", 0.1, 1.0e5),
    Parameter("log.max_files", 8, "Files of this node's that stay; older ones go.", "",
              1, 100000),
    Parameter("autostart", False, "Configure and activate at start-up, without being told.",
              change="never"),
    Parameter("on_failure", "stay",
              "After a step that cannot be made: stay, unconfigured; retry from the last good "
              "state; exit, with status 3.", choices=("stay", "retry", "exit"), change="always"),
    Parameter("save_folder", ".", "Folder that ~/save writes to.", change="always"),
)  # fmt: skip

BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}


@dataclass(frozen=True)
class Settings:
    """Checked values of all parameters; see `PARAMETERS` for their meaning."""

    scene: str
    initial_state: str
    rate: float
    real_time_factor: float
    publish_clock: bool
    lag_limit: float
    vessel_input: str
    vessel_inputs: str
    payout_input: str
    cmd_vel_stamped: bool
    vessel_frame: str
    odom_frame: str
    odom_relative: bool
    odom_smoothing: float
    tow_point: tuple[float, ...]
    tow_point_frame: str
    initial_heading: float
    command_timeout: float
    limits_speed: float
    limits_acceleration: float
    limits_turn_rate: float
    limits_turn_acceleration: float
    limits_deflection_rate: float
    limits_payout_rate: float
    limits_payout_acceleration: float
    limits_line_length_min: float
    limits_position_jump: float
    stations: int
    markers_rate: float
    diagnostics_rate: float
    tf: bool
    tf_vessel: bool
    log_folder: str
    log_max_size: float
    log_max_files: int
    autostart: bool
    on_failure: str
    save_folder: str

    @classmethod
    def of(cls, values: Mapping[str, Any] | None = None) -> Settings:
        """Settings from values by parameter name; defaults for the rest.

        Raises:
            SettingsError: an unknown name or an impossible value.
        """
        values = dict(values or {})
        taken = {p.attribute: p.checked(values.pop(p.name, p.default)) for p in PARAMETERS}
        if values:
            raise SettingsError(f"unknown parameter {', '.join(values)}")
        return cls(**taken)  # type: ignore[arg-type]

    @property
    def publishes_clock(self) -> bool:
        """Whether simulated time goes out on /clock: when asked, and when it is not real time."""
        return self.publish_clock or self.real_time_factor != 1.0


def those_set(names: Iterable[str], settings: Settings) -> tuple[str, ...]:
    """Those of parameters that are not at their defaults."""
    parameters = (BY_NAME[name] for name in names)
    return tuple(p.name for p in parameters if getattr(settings, p.attribute) != p.default)


def document() -> str:
    """The parameters as a Markdown table."""
    words = {"never": "at start-up only", "unconfigured": "before configure", "always": "any time"}
    lines = ["|parameter|default|allowed|may change||", "|---|---|---|---|---|"]
    for p in PARAMETERS:
        default = list(p.default) if isinstance(p.default, tuple) else p.default
        text = str(default).lower() if isinstance(p.default, bool) else str(default)
        allowed = p.allowed.replace(" | ", ", ")
        lines.append(
            f"|`{p.name}`|{f'`{text}`' if text else 'empty'}|{allowed}|"
            f"{words[p.change]}|{p.description}|"
        )
    return "\n".join(lines) + "\n"
