"""ROS parameters from the parameter classes: descriptor, range, coercion and refusal with the reason."""

import dataclasses
from array import array
from collections.abc import Callable
from typing import Any, TypeVar

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from omni_vehicle_ros.errors import ParameterError
from omni_vehicle_ros.parameters import Parameters, check_value

P = TypeVar('P', bound=Parameters)


def declare(node: Node, parameters: type[P], *, only: tuple[str, ...] = (), changeable: bool = False) -> P:
    """Declare the fields of a parameter class on a node, unless they are, and return what was set.

    Whole numbers are taken for real ones. Parameters are read-only unless ``changeable``.

    Raises
    ------
    ParameterError
        A value is of the wrong type or out of range.
    """
    values = {}
    for entry in dataclasses.fields(parameters):  # type: ignore[arg-type]
        if only and entry.name not in only:
            continue
        default = list(entry.default) if isinstance(entry.default, tuple) else entry.default
        declared = declare_plain(node, entry.name, default, _descriptor(entry, changeable))
        given = default if declared is None else declared  # an empty list in a YAML file is no value
        values[entry.name] = check_value(entry, _plain(given))
        _store_coerced(node, entry.name, values[entry.name])
    return parameters.from_mapping(values)


def declare_plain(node: Node, name: str, default: Any, descriptor: ParameterDescriptor | None = None) -> Any:
    """Declare one parameter on a node, unless it is, and return its value."""
    if node.has_parameter(name):
        return node.get_parameter(name).value
    return node.declare_parameter(name, default, descriptor or ParameterDescriptor()).value


def why_fixed(node: Node, name: str, changes: list[Parameter]) -> str:
    """Return why some parameters of a node can not be set while it runs; nothing if none is read-only.

    Parameters
    ----------
    node
        Has the parameters.
    name
        Its full name.
    changes
        What is to be set.
    """
    for change in changes:
        if node.has_parameter(change.name) and node.describe_parameter(change.name).read_only:
            return (
                f'{change.name} can not change while the vehicle drives: it is read at the start; '
                f'restart {name} with -p {change.name}:={_plain(change.value)}'
            )
    return ''


def _descriptor(entry: 'dataclasses.Field[Any]', changeable: bool) -> ParameterDescriptor:
    unit, choices = entry.metadata['unit'], entry.metadata['choices']
    text = (
        entry.metadata['text'] + (f' [{unit}]' if unit else '') + (f' One of: {", ".join(choices)}.' if choices else '')
    )
    descriptor = ParameterDescriptor(description=text, dynamic_typing=True, read_only=not changeable)
    low, high = entry.metadata['low'], entry.metadata['high']
    if low is not None or high is not None:
        bounds = (-1e308 if low is None else float(low), 1e308 if high is None else float(high))
        descriptor.additional_constraints = f'{low} .. {high}'
        if isinstance(entry.default, float):
            descriptor.floating_point_range = [FloatingPointRange(from_value=bounds[0], to_value=bounds[1])]
    return descriptor


def _plain(value: Any) -> Any:
    """Return a list where rclpy has an array."""
    return list(value) if isinstance(value, array) else value


def _store_coerced(node: Node, name: str, value: Any) -> None:
    """Let the node hold the value in its declared type, so that ``ros2 param get`` shows a double."""
    coerced = Parameter(name, value=list(value) if isinstance(value, tuple) else value)
    if node.get_parameter(name).type_ is not coerced.type_:
        node._parameters[name] = coerced


def on_change(node: Node, current: P, apply: Callable[[P], None]) -> Callable[[], None]:
    """Call ``apply`` with the new parameters whenever some of ``current`` are set; refuse bad ones with the reason.

    ``apply`` refuses them by a ParameterError. Returns what to call to end that.
    """
    held = [current]

    def check(changes: list[Parameter]) -> SetParametersResult:
        names = {entry.name for entry in dataclasses.fields(held[0])}  # type: ignore[arg-type]
        values = {change.name: _plain(change.value) for change in changes if change.name in names}
        if values:
            try:
                changed = type(held[0]).from_mapping({**held[0].as_dict(), **values})
                apply(changed)
            except ParameterError as error:
                return SetParametersResult(successful=False, reason=str(error))
            held[0] = changed
        return SetParametersResult(successful=True)

    def store(changes: list[Parameter]) -> None:
        for change in changes:
            if hasattr(held[0], change.name):
                _store_coerced(node, change.name, getattr(held[0], change.name))

    node.add_on_set_parameters_callback(check)
    node.add_post_set_parameters_callback(store)

    def end() -> None:
        node.remove_on_set_parameters_callback(check)
        node.remove_post_set_parameters_callback(store)

    return end
