"""ROS 2 messages that are made of objects, and what else rclpy wants as its own."""

from __future__ import annotations

import importlib
from typing import Any

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from cablemodel_ros.diagnostics import Status
from cablemodel_ros.interface import Quality
from cablemodel_ros.settings import Parameter
from cablemodel_ros.times import Stamp


def message_class(name: str) -> Any:
    """Class of ``std_msgs/msg/Float64``; None where its package is not installed."""
    package, _, kind = name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), kind)
    except ModuleNotFoundError:
        return None


def qos(quality: Quality) -> QoSProfile:
    """Quality of service as rclpy has it."""
    return QoSProfile(
        depth=quality.depth,
        reliability=ReliabilityPolicy.RELIABLE
        if quality.reliable
        else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL
        if quality.keeps_last
        else DurabilityPolicy.VOLATILE,
    )


def descriptor(parameter: Parameter) -> ParameterDescriptor:
    """Descriptor of a parameter. A number may be given without its point (`rate: 50`)."""
    made = ParameterDescriptor(
        name=parameter.name,
        description=parameter.description + (f" [{parameter.unit}]" if parameter.unit else ""),
        read_only=parameter.change == "never",
        dynamic_typing=isinstance(parameter.default, float),
        additional_constraints=f"{parameter.allowed}; may change: {parameter.change}",
    )
    if parameter.minimum is not None and parameter.maximum is not None:
        if isinstance(parameter.default, int):
            made.integer_range = [
                IntegerRange(from_value=int(parameter.minimum), to_value=int(parameter.maximum))
            ]
        else:
            made.floating_point_range = [
                FloatingPointRange(from_value=parameter.minimum, to_value=parameter.maximum)
            ]
    return made


def message_time(stamp: Stamp) -> Time:
    """A message's time, of ROS time."""
    whole, rest = divmod(stamp.ns, 1_000_000_000)
    return Time(sec=whole, nanosec=rest)


def clock(stamp: Stamp) -> Clock:
    """A message of /clock."""
    return Clock(clock=message_time(stamp))


def diagnostics(statuses: list[Status], node: str, stamp: Time) -> DiagnosticArray:
    """A message of /diagnostics."""
    array = DiagnosticArray()
    array.header.stamp = stamp
    array.status = [
        DiagnosticStatus(
            level=bytes([status.level]),
            name=f"{node}: {status.name}",
            message=status.message,
            hardware_id=node,
            values=[KeyValue(key=key, value=value) for key, value in status.values.items()],
        )
        for status in statuses
    ]
    return array
