"""The parameters ``fault.*`` of a node: what happens to the components that belong to it."""

from collections.abc import Callable

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from omni_vehicle_ros.errors import FaultError
from omni_vehicle_ros.faults import CARRIERS, KINDS, OK, Fault, kind_of, parse_fault

PREFIX = 'fault.'


class FaultParameters:
    """Takes what is set, or refuses it with the reason.

    Parameters
    ----------
    node
        Whose parameters they are.
    role
        Of the node.
    allowed
        Whether faults are taken.
    inject
        Called with the faults that were set.

    Attributes
    ----------
    initial
        The faults that the node was started with.
    """

    def __init__(self, node: Node, role: str, allowed: bool, inject: Callable[[list[Fault]], None]) -> None:
        self._allowed, self._inject = allowed, inject
        wheel = role.split('/')[0] + '/' if '/' in role else ''
        mine = [component for component, nodes in CARRIERS.items() if role in nodes]
        self._components = {f'{PREFIX}{component.removeprefix(wheel)}': component for component in mine}
        for name, component in self._components.items():
            text = f'What happens to {component}: {", ".join((OK, *KINDS[kind_of(component)]))}; some with a value.'
            node.declare_parameter(name, OK, ParameterDescriptor(description=text))
        at_start = self._faults([node.get_parameter(name) for name in self._components])
        self.initial = [fault for fault in at_start if fault.failure != OK]
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._set)

    def _faults(self, parameters: list[Parameter]) -> list[Fault]:
        """Return what parameters say.

        Raises
        ------
        FaultError
            One of them says nothing that there is.
        """
        found = []
        for parameter in parameters:
            if parameter.name in self._components:
                found.append(parse_fault(self._components[parameter.name], str(parameter.value)))
                if found[-1].failure != OK and not self._allowed:
                    raise FaultError(f'{parameter.name}: fault_injection is false; start the node with it set to true')
        return found

    def _check(self, changes: list[Parameter]) -> SetParametersResult:
        try:
            self._faults(changes)
        except FaultError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _set(self, changes: list[Parameter]) -> None:
        faults = self._faults(changes)
        if faults and self._allowed:
            self._inject(faults)
