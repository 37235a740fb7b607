"""The lifecycle node `cable`: a thin shell that connects a session to ROS 2."""

from __future__ import annotations

import contextlib
import gc
import json
import os
import sys
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock as RclpyClock
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter as RclpyParameter
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger

from cablemodel.errors import CableModelError
from cablemodel.scene.problems import suggestion
from cablemodel.solvers.library import compiling_told
from cablemodel_ros import interface, messages
from cablemodel_ros.control import ControlLoop, ForeignClock
from cablemodel_ros.diagnostics import ERROR, WARN, Diagnostics, Status
from cablemodel_ros.inputs import Inputs
from cablemodel_ros.markers import Picture, markers
from cablemodel_ros.neighbours import Neighbours
from cablemodel_ros.outputs import Outputs
from cablemodel_ros.rig import Order
from cablemodel_ros.session import Names, Session
from cablemodel_ros.settings import BY_NAME, PARAMETERS, Settings, SettingsError
from cablemodel_ros.timebase import Followed, Published, RealTime, Timebase
from cablemodel_ros.times import Stamp

SUCCESS = TransitionCallbackReturn.SUCCESS
FAILURE = TransitionCallbackReturn.FAILURE
FAULT = TransitionCallbackReturn.ERROR

FAILED = 3
"""Exit status after a failure."""

_PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""Names a file of settings for Fast DDS, the middleware that ROS 2 comes with."""
_SWITCH = 5e-4
"""How long one thread may keep others from running Python [s]: the control loop must not wait
for five milliseconds (the default) while a flood of messages is handled."""


class CableNode(LifecycleNode):
    """Publishes what a cable does, and moves it as commands say; see docs/ros2.md."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("cable", **kwargs)
        self._session: Session | None = None
        self._loop: ControlLoop | None = None
        self._diagnostics: Diagnostics | None = None
        self._lock = threading.Lock()
        self._foreign: ForeignClock | None = None
        self._outputs: Outputs | None = None
        self._neighbours: Neighbours | None = None
        self._entities: list[Callable[[], Any]] = []
        self._steady = RclpyClock(clock_type=ClockType.STEADY_TIME)
        self._failure = ""
        self._errors: dict[str, str] = {}
        for parameter in PARAMETERS:
            default = list(p) if isinstance(p := parameter.default, tuple) else p
            self.declare_parameter(parameter.name, default, messages.descriptor(parameter))
        # What is wrong now (an override) stops the node here, not in the first transition.
        self._settings()
        self._tell_of_unknown_parameters()
        self.add_on_set_parameters_callback(self._check_parameters)
        self.add_post_set_parameters_callback(self._apply_parameters)
        self._diagnostics_publisher = self.create_publisher(
            DiagnosticArray, "/diagnostics", messages.qos(interface.DIAGNOSTICS)
        )
        self._follows = bool(self.get_parameter("use_sim_time").value)
        self._trouble = ""
        self.ended: Future = Future()
        """Done, with the exit status, when the process is to end by itself."""
        self.create_timer(1.0, self._repeat_trouble, clock=self._steady)

    # -- parameters -----------------------------------------------------------------------------

    def _settings(self) -> Settings:
        return Settings.of({p.name: self.get_parameter(p.name).value for p in PARAMETERS})

    def _tell_of_unknown_parameters(self) -> None:
        """Rclpy ignores values that are given at start-up to parameters that a node has not."""
        for name in self._parameter_overrides:
            if self.has_parameter(name) or name.startswith("qos_overrides."):
                continue
            hint = suggestion(name, list(BY_NAME)).replace(", ", "; ", 1)
            self.get_logger().warning(f"there is no parameter {name}: it is ignored{hint}")

    def _check_parameters(self, parameters: list[RclpyParameter]) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == "use_sim_time" and parameter.value != self._follows:
                reason = "use_sim_time may change at start-up only: stamps would jump"
                return SetParametersResult(successful=False, reason=reason)
            known = BY_NAME.get(parameter.name)
            if known is None:
                continue
            if known.change == "unconfigured" and self._session is not None:
                reason = f"parameter {known.name} may change only before the node is configured"
                return SetParametersResult(successful=False, reason=reason)
            try:
                known.checked(parameter.value)
            except SettingsError as error:
                return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply_parameters(self, parameters: list[RclpyParameter]) -> None:
        if self._loop is not None:
            self._loop.update(self._settings())

    # -- transitions ----------------------------------------------------------------------------

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Build the scene, warm the kernels up, make topics and services."""
        try:
            settings = self._settings()
            if self._follows and settings.publishes_clock:
                raise SettingsError(
                    "use_sim_time follows a foreign /clock; then real_time_factor must be 1 and "
                    "publish_clock false"
                )
            self._foreign = ForeignClock() if self._follows else None
            names = Names(self.get_fully_qualified_name(), self.resolve_topic_name)
            with compiling_told(self.get_logger().warning):
                self._session = Session(settings, self._timebase(settings), names)
            self._connect(settings)
        except (CableModelError, SettingsError, OSError) as error:
            self._report(f"cannot configure: {error}")
            self._tear_down()
            return FAILURE
        except Exception as error:
            self._report(f"cannot configure: {type(error).__name__}: {error}")
            self._tear_down()
            return FAULT
        # What lives now lives long: it need not be searched for garbage again and again.
        gc.collect()
        gc.freeze()
        self._trouble = ""
        self.get_logger().info(f"configured: {self._session.scene.title or 'untitled scene'}")
        return SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Start, or go on from the present state."""
        assert self._session is not None
        assert self._loop is not None
        super().on_activate(state)
        self._failure = ""
        summary = json.dumps(self._session.summary())
        assert self._outputs is not None
        self._outputs.publishers["~/scene"].publish(String(data=summary))
        self._loop.start()
        return SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Pause; the state stays."""
        if self._loop is not None:
            self._loop.stop()
        super().on_deactivate(state)
        return FAULT if self._failure else SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Forget the scene."""
        self._tear_down()
        return SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """The end, from any state."""
        self._tear_down()
        return SUCCESS

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """After a failure: nothing is kept, and the node can be configured again."""
        self._tear_down()
        return SUCCESS

    def _LifecycleNodeMixin__on_change_state(self, request: Any, response: Any) -> Any:  # noqa: N802
        """A transition that the present state does not have is answered, not raised.

        rclpy's own handler lets the error out into the executor, which ends the process.
        """
        try:
            return super()._LifecycleNodeMixin__on_change_state(request, response)
        except Exception as error:
            self.get_logger().error(self._refusal(request.transition, error))
            response.success = False
            return response

    def _refusal(self, transition: Any, error: Exception) -> str:
        machine = self._state_machine
        names = {number: label for number, label, *_ in machine.transition_graph}
        wanted = transition.label or names.get(transition.id, str(transition.id))
        allowed = [label for _, label, *_ in machine.available_transitions]
        if wanted in allowed:
            return f"transition {wanted} failed: {error}"
        state = machine.current_state[1]
        return f"transition {wanted} refused: the node is {state}; allowed: {', '.join(allowed)}"

    def _timebase(self, settings: Settings) -> Timebase:
        if self._foreign is not None:
            return Followed(self._foreign.now)
        if settings.publishes_clock:
            return Published()
        return RealTime(lambda: Stamp(self.get_clock().now().nanoseconds))

    # -- connections ----------------------------------------------------------------------------

    def _connect(self, settings: Settings) -> None:
        session = self._session
        assert session is not None
        self._outputs = Outputs(self, session)
        self._entities.append(self._outputs.destroy)
        self._loop = ControlLoop(
            session,
            self._lock,
            self._outputs.publish,
            self._on_failure,
            clock=self._foreign,
            listened=self._outputs.listened,
        )
        for note in session.rig.notes:
            self.get_logger().warning(note)
        self._diagnostics = Diagnostics(session, self._loop)
        self._neighbours = Neighbours(self, session, follows=self._foreign is not None)
        self._failed = self.create_guard_condition(self._fail)
        self._entities.append(lambda: self.destroy_guard_condition(self._failed))
        self._entities.append(Inputs(self, session, self._foreign, self._on_failure).destroy)
        services = {"~/reset": self._on_reset, "~/save": self._on_save}
        for name, order in session.rig.orders.items():
            services[name] = partial(self._on_order, order)
        for name, call in services.items():
            service = self.create_service(Trigger, name, call)
            self._entities.append(partial(self.destroy_service, service))
        self._repeat(settings.diagnostics_rate, self._publish_diagnostics)
        if settings.markers_rate > 0.0:
            self._repeat(settings.markers_rate, self._publish_markers)

    def _repeat(self, rate: float, call: Callable[[], None]) -> None:
        timer = self.create_timer(1.0 / rate, call, clock=self._steady)
        self._entities.append(lambda: self.destroy_timer(timer))

    def _tear_down(self) -> None:
        if self._loop is not None:
            self._loop.stop()
        if self._session is not None:
            self._session.close()
        for destroy in self._entities:
            destroy()
        self._entities.clear()
        self._session = self._loop = self._diagnostics = self._foreign = self._outputs = None
        self._neighbours = None
        self._failure = ""
        gc.unfreeze()

    def destroy_node(self) -> None:
        """Finish the log, then go."""
        self._tear_down()
        super().destroy_node()

    # -- out ------------------------------------------------------------------------------------

    def _publish_diagnostics(self) -> None:
        if self._diagnostics is None or self._neighbours is None:
            return
        with self._lock:
            statuses = self._diagnostics.statuses()
        commands = next(status for status in statuses if status.name == "commands")
        for finding in self._neighbours.findings():
            commands.add(WARN, finding)
        self._tell_of_errors(statuses)
        self._send(statuses)

    def _tell_of_errors(self, statuses: list[Status]) -> None:
        """On the console, too, once each: not everybody reads diagnostics. What stops the
        simulation is told there anyway."""
        errors = {s.name: s.message for s in statuses if s.level == ERROR}
        for name, message in errors.items():
            if message != self._errors.get(name) and not self._failure:
                self.get_logger().error(f"{name}: {message}")
        self._errors = errors

    def _send(self, statuses: list[Status]) -> None:
        name = self.get_fully_qualified_name().lstrip("/")
        array = messages.diagnostics(statuses, name, self.get_clock().now().to_msg())
        self._diagnostics_publisher.publish(array)

    def _publish_markers(self) -> None:
        if self._outputs is None or self._session is None:
            return
        publisher = self._outputs.publishers["~/markers"]
        if not publisher.is_activated or not publisher.get_subscription_count():
            return
        with self._lock:
            picture = Picture.of(self._session.rig)
            stamp = self._session.stamp()
        publisher.publish(markers(picture, messages.message_time(stamp)))

    # -- services -------------------------------------------------------------------------------

    def _on_reset(self, request: Any, response: Any) -> Any:
        if self._loop is None:
            response.success, response.message = False, "not configured"
            return response
        self._loop.reset()
        response.success, response.message = True, "back at the initial state"
        return response

    def _on_order(self, order: Order, request: Any, response: Any) -> Any:
        if self._loop is None or not self._loop.running:
            response.success, response.message = False, "not active: no step is made"
            return response
        with self._lock:
            response.success, response.message = order()
        return response

    def _on_save(self, request: Any, response: Any) -> Any:
        if self._session is None:
            response.success, response.message = False, "not configured"
            return response
        with self._lock:
            saved = self._session.save()
            folder = Path(self._session.settings.save_folder)
        try:
            path = saved.write(folder)
        except OSError as error:
            response.success, response.message = False, f"cannot save: {error}"
        else:
            response.success, response.message = True, str(path)
        return response

    # -- failure --------------------------------------------------------------------------------

    def _on_failure(self, reason: str) -> None:
        """Called by the control thread, which ends; the executor does the rest."""
        self._failure = reason
        self._failed.trigger()

    def _fail(self) -> None:
        if not self._failure:
            return
        policy = self._settings().on_failure
        then = "the node ends" if policy == "exit" else "the node is unconfigured until configured"
        self._report(f"the simulation stopped: {self._failure}; {then} (on_failure: {policy})")
        self.trigger_deactivate()  # fails, which leads through error processing
        self._end_if_wanted()

    def _end_if_wanted(self) -> None:
        """Let the process end where a failure is to be seen by who started it."""
        if self._settings().on_failure == "exit" and not self.ended.done():
            self._repeat_trouble()
            self._diagnostics_publisher.wait_for_all_acked(Duration(seconds=1.0))
            self.ended.set_result(FAILED)

    def autostart(self) -> None:
        """Configure and activate."""
        if self.trigger_configure() == SUCCESS:
            self.trigger_activate()
        else:
            self._end_if_wanted()

    def _report(self, message: str) -> None:
        self.get_logger().error(message)
        self._trouble = message

    def _repeat_trouble(self) -> None:
        """Tell why the node is not configured, until it is."""
        if self._trouble and self._session is None:
            self._send([Status("simulation", ERROR, [self._trouble])])


@contextlib.contextmanager
def until_shutdown(context: rclpy.Context | None = None) -> Iterator[None]:
    """What an interrupt or a shutdown ends within, ends quietly, however rclpy reports it.

    context: the one that is shut down, rclpy's own by default. A signal that comes between rclpy's
    look at the context and its wait makes an RCLError ("the given context is not valid"), as in
    ros2/ros2cli pull request 854; while the context is valid an RCLError is raised as it is.
    """
    try:
        yield
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except rclpy_implementation.RCLError:
        if rclpy.ok(context=context):
            raise


def main(args: list[str] | None = None) -> int:
    """Run the node until it is interrupted; 2 when it cannot start, 3 after a failure, where
    `on_failure` asks for that."""
    sys.setswitchinterval(_SWITCH)
    os.environ.setdefault(_PROFILES, str(Path(__file__).with_name("fastdds.xml")))
    rclpy.init(args=args)
    try:
        node = CableNode()
    except (SettingsError, ParameterException) as error:
        sys.stderr.write(f"cable: {error}\n")
        rclpy.shutdown()
        return 2
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        with until_shutdown():
            if node.get_parameter("autostart").value:
                node.autostart()
            executor.spin_until_future_complete(node.ended)
    finally:
        # A second interrupt must not leave the log unfinished.
        with contextlib.suppress(KeyboardInterrupt):
            node.destroy_node()
        rclpy.try_shutdown()
    return node.ended.result() if node.ended.done() else 0


if __name__ == "__main__":
    sys.exit(main())
