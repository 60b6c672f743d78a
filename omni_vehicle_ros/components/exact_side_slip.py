"""The controller wheel_slip in its exact form, for ideal actuators: the plant solves it, this one says it."""

from omni_vehicle_ros.components.component import WARN, Output, Reporter
from omni_vehicle_ros.components.joints import module_joints
from omni_vehicle_ros.components.plant import Plant
from omni_vehicle_ros.control.health import health
from omni_vehicle_ros.messages import Value
from omni_vehicle_ros.parameters import SideSlipParameters
from omni_vehicle_ros.wheels import WHEELS


class ExactSideSlip:
    """Says the trims that the wheels have: real steer angle minus set-point, -K alpha above walking pace.

    A trim that depends at once on the slip that it corrects can't be sampled (it would diverge for gains of 1 and
    more), but it can be solved (thesis, chapter 5). ``trim_limit`` and ``minimum_speed`` belong to the sampled
    form.

    Parameters
    ----------
    parameters
        Of the sampled form; its ``trim_limit`` is where a warning begins.
    plant
        The vehicle, with slip gains.
    name
        Full name of the node, for diagnostics.
    """

    beat = 'joint_states'
    sources: tuple[str, ...] = ()

    def __init__(self, parameters: SideSlipParameters, plant: Plant, *, name: str = '/side_slip_controller') -> None:
        self.name = name
        self._limit = parameters.trim_limit
        self._plant = plant
        self._reporter = Reporter(name)

    def receive(self, topic: str, value: Value, now: int) -> None:
        """Take nothing: all of it is in the plant."""

    def step(self, stamp: int, missing: tuple[str, ...] = ()) -> list[Output]:
        """Return the trims at ``stamp`` [ns]."""
        trims = self._plant.trims
        beyond = ', '.join(wheel for wheel, trim in zip(WHEELS, trims, strict=True) if abs(trim) > self._limit)
        note = WARN, f'trim of {beyond} is beyond trim_limit, {self._limit:g} rad: the exact form has no limit'
        outputs = self._reporter.report(stamp, health([note] if beyond else [], 'controlling side slip'))
        for wheel, trim in zip(WHEELS, trims, strict=True):
            outputs.append(Output(f'{wheel}/trim', module_joints(wheel, stamp, trim, 0.0, 0.0, 0.0)))
        return outputs
