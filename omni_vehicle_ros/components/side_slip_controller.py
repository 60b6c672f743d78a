"""The side-slip controller: tyre slip in, steering trims out."""

from omni_vehicle_ros.components.component import Output, Reporter
from omni_vehicle_ros.control.side_slip import SideSlipController as Law
from omni_vehicle_ros.messages import Joints, Value
from omni_vehicle_ros.parameters import SideSlipParameters
from omni_vehicle_ros.wheels import WHEELS, PerWheel, per_wheel, steer_joint

_NO_NUMBER = float('nan')


class SideSlipController:
    """One PID for each wheel on its measured side slip."""

    beat = 'tyres/side_slip'
    sources: tuple[str, ...] = ()

    def __init__(self, parameters: SideSlipParameters, *, name: str = '/side_slip_controller') -> None:
        self.name = name
        self._law = Law(parameters)
        self._slip: PerWheel = (0.0, 0.0, 0.0, 0.0)
        self._speed: PerWheel = (0.0, 0.0, 0.0, 0.0)
        self._reporter = Reporter(name)

    def configure(self, parameters: SideSlipParameters) -> None:
        """Go on with other gains and limits; integrals start anew."""
        self._law = Law(parameters)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take the side slip of the four tyres; what is missing counts as no number."""
        if not isinstance(value, Joints):
            return
        slip = dict(zip(value.names, value.position, strict=False))
        speed = dict(zip(value.names, value.velocity, strict=False))
        self._slip = per_wheel(lambda i: slip.get(WHEELS[i], _NO_NUMBER))
        self._speed = per_wheel(lambda i: speed.get(WHEELS[i], _NO_NUMBER))

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return the trims that belong to ``stamp`` [ns]."""
        trims = self._law.update(stamp, self._slip, self._speed)
        outputs = self._reporter.report(stamp, *self._law.status)
        for wheel, trim in zip(WHEELS, trims, strict=True):
            outputs.append(Output(f'{wheel}/steer_trim', Joints(stamp, (steer_joint(wheel),), (trim,))))
        return outputs
