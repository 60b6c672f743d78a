"""A node with a managed lifecycle (REP-2002's states): what is made when it is configured is there until clean-up."""

from collections.abc import Callable, Iterator

from lifecycle_msgs.srv import ChangeState
from rclpy.context import Context
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.subscription import Subscription

from omni_vehicle_ros import interface
from omni_vehicle_ros.control.health import WARN
from omni_vehicle_ros.errors import OmniVehicleError
from omni_vehicle_ros.messages import Diagnostics, Status, Text, Value
from omni_vehicle_ros.nodes.exchange import Exchange, Inlet, Outlet
from omni_vehicle_ros.nodes.ports import publish_on, subscribe_to
from omni_vehicle_ros.nodes.refusals import REFUSALS, RCLError, one_line

SUCCESS, FAILURE = TransitionCallbackReturn.SUCCESS, TransitionCallbackReturn.FAILURE


class StartError(OmniVehicleError):
    """A node could not start, or stopped for want of the others."""


class ManagedNode(LifecycleNode):
    """Unconfigured, it has parameters only; inactive, its ports, too; active, it takes messages and acts.

    Parameters
    ----------
    role
        Which node of the wiring table this is, with ``/`` for modules: ``front_left/wheel_module``.
    context
        The ROS context it lives in.
    namespace
        Namespace of the node; None takes it from the command line.
    exchange
        Of the process.

    Attributes
    ----------
    active
        Whether it takes messages and acts.
    now
        Simulated time [ns].
    unserved
        Subscriptions that no executor serves: who made them takes their messages when it suits.
    """

    def __init__(self, role: str, *, context: Context, exchange: Exchange, namespace: str | None) -> None:
        super().__init__(role.split('/')[-1], context=context, namespace=namespace)
        self.role = role
        self.exchange = exchange
        self.active = False
        self.now = 0
        self.unserved: tuple[Subscription, ...] = ()
        self.outlets: dict[str, Outlet] = {}
        self._inputs: list[Subscription] = []
        self._configured = self._starting = False
        self._refused: Exception | None = None
        self._service_change_state.callback = self._answering(self._service_change_state.callback)

    @staticmethod
    def _answering(change: Callable[..., ChangeState.Response]) -> Callable[..., ChangeState.Response]:
        """Return what also answers a transition that the present state does not have, where rclpy would raise."""

        def answer(request: ChangeState.Request, response: ChangeState.Response) -> ChangeState.Response:
            try:
                return change(request, response)
            except RCLError:
                response.success = False
                return response

        return answer

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """The subscriptions that an executor serves."""
        unserved = getattr(self, 'unserved', ())  # rclpy asks while it makes the node
        return (one for one in super().subscriptions if one not in unserved)

    @property
    def full_name(self) -> str:
        """The name of the node with its namespace."""
        return f'{self.get_namespace().rstrip("/")}/{self.get_name()}'

    @property
    def vehicle_namespace(self) -> str:
        """The namespace of the vehicle: that of the node, less the name of the wheel."""
        namespace = self.get_namespace().rstrip('/')
        wheel = self.role.split('/')[0] if '/' in self.role else ''
        return namespace.removesuffix(f'/{wheel}') if wheel else namespace

    def bring_up(self) -> None:
        """Configure and activate.

        Raises
        ------
        Exception
            One of `REFUSALS`: what it refused.
        """
        self._starting = True
        for transition in (self.trigger_configure, self.trigger_activate):
            if transition() != SUCCESS:
                raise self._refused or StartError(f'{self.full_name} could not be started')
        self._starting = False

    def build(self) -> None:
        """Make component and ports; called when the node is configured, and again after each clean-up."""

    def rest(self) -> None:
        """Say what must be said when it acts no more."""

    def finish(self) -> None:
        """Finish what must not be left half done; called once for each `build`, whatever happened."""

    def end(self) -> None:
        """Come to an end with the process."""
        self.active = False
        self.clean_up()

    def open_ports(self, rows: list[interface.Topic]) -> None:
        """Make the publishers of some topics."""
        for row in rows:
            self.outlets[row.name] = self.exchange.outlet(publish_on(self, row, self.vehicle_namespace), row)

    def subscribe(
        self, row: interface.Topic, hear: Callable[[bytes], None], take: Callable[[str, Value], None] | None = None, *,
        depth: int | None = None, latched: bool = False, reliable: bool = True, always: bool = False,
    ) -> Inlet:
        """Take the messages of a topic as long as the node is active.

        Parameters
        ----------
        row
            The topic.
        hear
            Takes the bytes of a message.
        take
            Takes topic and value of one that a node of this process hands over; without it, ``hear`` gets these, too.
        depth, latched, reliable
            As in `subscribe_to`.
        always
            Whether bytes are taken also when the node is not active.
        """
        name = row.name

        def heard(data: bytes) -> None:
            self.exchange.heard += 1
            if always or self.active:
                hear(data)

        def taken(value: Value) -> None:
            if self.active:
                take(name, value)  # type: ignore[misc]

        subscription = subscribe_to(
            self, row, self.vehicle_namespace, heard, depth=depth, latched=latched, reliable=reliable
        )
        self._inputs.append(subscription)
        inlet = Inlet(subscription, heard, None if take is None else taken)
        self.exchange.add_inlet(inlet)
        return inlet

    def say(self, topic: str, value: Value | Text) -> None:
        """Publish one message."""
        self.outlets[topic].say(value)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Make component and ports; refuse with the reason in the log."""
        self._refused = None
        try:
            self.build()
        except REFUSALS as error:
            self._refused = error
            if not self._starting:  # else whoever starts it says so
                self.get_logger().error(one_line(error))
            self._close_ports()
            return FAILURE
        self._configured = True
        return SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take messages and act from now on."""
        self.active = True
        return SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take no more messages, and say so."""
        self._stop()
        return SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Let go of component and ports."""
        self.clean_up()
        return SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Come to an end from any state."""
        self._stop()
        self.clean_up()
        return SUCCESS

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Go back to what can be configured again."""
        self._stop()
        self.clean_up()
        return SUCCESS

    def clean_up(self) -> None:
        """Let go of all that `build` made."""
        if self._configured:
            self._configured = False
            try:
                self.finish()
            finally:
                self._close_ports()

    def _close_ports(self) -> None:
        self.exchange.forget(self._inputs, self.outlets.values())
        for subscription in self._inputs:
            self.destroy_subscription(subscription)
        for outlet in self.outlets.values():
            self.destroy_publisher(outlet.publisher)
        self._inputs, self.outlets, self.unserved = [], {}, ()

    def _stop(self) -> None:
        if self.active:
            self.active = False
            self.rest()
            text = 'inactive: it takes no command and gives none'
            self.say('/diagnostics', Diagnostics(self.now, (Status(WARN, self.full_name, text),)))
