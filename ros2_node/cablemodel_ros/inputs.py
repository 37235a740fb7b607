"""What comes in by topics: subscriptions that hand messages to a session's ports.

Commands come at the rate of a controller. rclpy's executor gathers every service, timer and event
of the node anew before each message that it takes, which costs more than the step that the message
is for; so a thread waits for these subscriptions alone.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation

from cablemodel_ros import interface, messages, wire
from cablemodel_ros.control import ForeignClock
from cablemodel_ros.session import Session


class _Apart(ReentrantCallbackGroup):
    """What the executor leaves alone. A message wakes who waits for its subscription's events,
    too: they have to be waited for in the same place."""

    def can_execute(self, entity: Any) -> bool:
        return False


class Inputs:
    """Subscribes to the topics of a session's ports, and takes their messages in a thread.

    Args:
        node: the node that subscribes.
        session: what takes the commands, from any thread.
        foreign: clock to follow, or None.
        failed: called (from the thread) with the reason when a message could not be taken; the
            thread ends.
    """

    def __init__(
        self,
        node: Any,
        session: Session,
        foreign: ForeignClock | None,
        failed: Callable[[str], None],
    ) -> None:
        self._node, self._failed = node, failed
        self._group = _Apart()
        self._made: list[Any] = []
        for port in session.rig.ports:
            self._subscribe(port.topic, self._telling(port.take))
        if foreign is not None:
            self._subscribe(interface.FOREIGN_CLOCK, foreign.set)
        self._end = GuardCondition(None, None, context=node.context)
        self._thread = threading.Thread(target=self._run, name="cable inputs", daemon=True)
        self._ending = False
        self._thread.start()

    def destroy(self) -> None:
        """No message comes any more."""
        self._ending = True
        self._end.trigger()
        if self._thread is not threading.current_thread():
            self._thread.join()
        self._end.destroy()
        for subscription in self._made:
            self._node.destroy_subscription(subscription)
        self._made.clear()

    def _subscribe(self, topic: interface.Topic, take: Callable[..., None]) -> None:
        kind, quality = messages.message_class(topic.message), messages.qos(topic.quality)
        arguments = wire.ARGUMENTS[topic.message]

        def call(data: bytes) -> None:
            try:
                found = arguments(data)
            except wire.UNREADABLE:
                self._warn(f"{topic.name}: a message that ends too early")
            else:
                take(*found)

        self._made.append(
            self._node.create_subscription(
                kind, topic.name, call, quality, callback_group=self._group, raw=True
            )
        )

    def _telling(self, take: Callable[..., str]) -> Callable[..., None]:
        """The same, which tells what was refused."""

        def call(*arguments: Any) -> None:
            refusal = take(*arguments)
            if refusal:
                self._warn(refusal)

        return call

    def _warn(self, what: str) -> None:
        self._node.get_logger().warning(what, throttle_duration_sec=1.0)

    def _run(self) -> None:
        try:
            self._take_messages()
        except Exception as error:
            # A shutdown of the context ends a wait so.
            if self._node.context.ok():
                self._failed(f"{type(error).__name__}: {error}")

    def _take_messages(self) -> None:
        """One of each topic that has some, again and again; and what is to be told of publishers
        whose quality of service or type does not fit."""
        events = [event for made in self._made for event in made.event_handlers]
        context = self._node.context
        waiting = rclpy_implementation.WaitSet(
            len(self._made), 1, 0, 0, 0, len(events), context.handle
        )
        while not self._ending and context.ok():
            waiting.clear_entities()
            waiting.add_guard_condition(self._end.handle)
            for subscription in self._made:
                waiting.add_subscription(subscription.handle)
            for event in events:
                event.add_to_wait_set(waiting)
            waiting.wait(-1)
            ready = waiting.get_ready_entities("subscription")
            for subscription in self._made:
                if subscription.handle.pointer in ready:
                    taken = subscription.handle.take_message(subscription.msg_type, True)
                    if taken is not None:
                        subscription.callback(taken[0])
            for event in events:
                told = event.take_data() if event.is_ready(waiting) else None
                if told:
                    event.callback(told)
