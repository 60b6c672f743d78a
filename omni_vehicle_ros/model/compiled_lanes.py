"""Lanes for numba: vectors of float64 that the physics take for numbers, and masks that they take for truth values.

LLVM has such vectors, of any length, and turns each operation into the widest instructions of the processor. numba only
needs to be told of them. Every operation on a lane is that of IEEE 754 on a number, in the same order; so lanes give
the same bits as one vehicle after the other. Imported by `batch` alone, as it imports numba.
"""

import builtins
import math
import operator
from collections.abc import Callable
from typing import Any

from numba.core import cgutils, types
from numba.core.cgutils import ir  # llvmlite, as numba has it
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typeconv import Conversion
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, models, overload, register_model

from omni_vehicle_ros.model import lanes

WIDTH = 8
"""Lanes: two or four to an instruction on most processors, all eight with AVX-512."""
Function = Callable[..., Any]
VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
BITS = ir.VectorType(ir.IntType(1), WIDTH)


class LanesType(types.Type):
    """A float64 in each lane."""

    def __init__(self) -> None:
        super().__init__(f'Lanes{WIDTH}')

    def can_convert_from(self, typingctx: Any, other: types.Type) -> Conversion | None:
        """Take a number as the same in all lanes."""
        return Conversion.safe if isinstance(other, (types.Float, types.Integer)) else None

    def unify(self, typingctx: Any, other: types.Type) -> types.Type | None:
        """Take a variable for lanes that is a number in one place and lanes in another."""
        return self if isinstance(other, (types.Float, types.Integer)) else None


class MaskType(types.Type):
    """A truth value in each lane."""

    def __init__(self) -> None:
        super().__init__(f'Mask{WIDTH}')

    def can_convert_from(self, typingctx: Any, other: types.Type) -> Conversion | None:
        """Take a truth value as the same in all lanes."""
        return Conversion.safe if isinstance(other, types.Boolean) else None

    def unify(self, typingctx: Any, other: types.Type) -> types.Type | None:
        """Do as `LanesType`."""
        return self if isinstance(other, types.Boolean) else None


LANES, MASK = LanesType(), MaskType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: types.Type) -> None:
        super().__init__(manager, kind, VECTOR)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: types.Type) -> None:
        super().__init__(manager, kind, BITS)


def _everywhere(builder: ir.IRBuilder, value: ir.Value, kind: ir.VectorType) -> ir.Value:
    place = ir.Constant(ir.IntType(32), 0)
    one = builder.insert_element(ir.Constant(kind, ir.Undefined), value, place)
    order = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(one, one, order)


@lower_cast(types.Float, LANES)
@lower_cast(types.Integer, LANES)
def _number_to_lanes(context: Any, builder: ir.IRBuilder, fromty: types.Type, toty: types.Type, value: ir.Value) -> Any:
    return _everywhere(builder, context.cast(builder, value, fromty, types.float64), VECTOR)


@lower_cast(types.Boolean, MASK)
def _truth_to_mask(context: Any, builder: ir.IRBuilder, fromty: types.Type, toty: types.Type, value: ir.Value) -> Any:
    return _everywhere(builder, context.cast(builder, value, fromty, types.boolean), BITS)


def _define(function: Callable[..., Any], arguments: int, kind: types.Type, found: types.Type, make: Any) -> None:
    """Tell numba of a function of lanes or masks; ``make`` builds it from the builder and the values."""

    @infer_global(function)
    class _Template(ConcreteTemplate):
        cases = [signature(found, *(kind,) * arguments)]  # noqa: RUF012

    @lower_builtin(function, *(kind,) * arguments)
    def _lower(context: Any, builder: ir.IRBuilder, sig: Any, values: list[ir.Value]) -> Any:
        return make(builder, *values)


def _compared(word: str) -> Any:
    return lambda builder, one, other: builder.fcmp_ordered(word, one, other)


def _llvm(name: str) -> Any:
    """Return what calls a function of LLVM itself, element by element."""

    def make(builder: ir.IRBuilder, *values: ir.Value) -> ir.Value:
        kind = ir.FunctionType(VECTOR, [VECTOR] * len(values))
        function = cgutils.get_or_insert_function(builder.module, kind, f'llvm.{name}.v{WIDTH}f64')
        return builder.call(function, values)

    return make


def _chosen(word: str) -> Any:
    # As Python's min and max do: the first unless the second is beyond it.
    return lambda builder, one, other: builder.select(builder.fcmp_ordered(word, other, one), other, one)


OPERATIONS: tuple[tuple[Function, int, Any], ...] = (
    (operator.add, 2, ir.IRBuilder.fadd), (operator.iadd, 2, ir.IRBuilder.fadd), (operator.sub, 2, ir.IRBuilder.fsub),
    (operator.mul, 2, ir.IRBuilder.fmul), (operator.truediv, 2, ir.IRBuilder.fdiv),
    (operator.neg, 1, ir.IRBuilder.fneg),
    (math.copysign, 2, _llvm('copysign')), (builtins.abs, 1, _llvm('fabs')), (math.sqrt, 1, _llvm('sqrt')),
    (builtins.min, 2, _chosen('<')), (builtins.max, 2, _chosen('>')),
)  # fmt: skip
"""Functions of lanes, how many arguments they take, and what builds them."""
COMPARISONS: tuple[tuple[Function, str], ...] = (
    (operator.lt, '<'), (operator.le, '<='), (operator.gt, '>'), (operator.ge, '>='), (operator.eq, '=='),
)  # fmt: skip
for _function, _arguments, _make in OPERATIONS:
    _define(_function, _arguments, LANES, LANES, _make)
for _function, _word in COMPARISONS:
    _define(_function, 2, LANES, MASK, _compared(_word))
_define(operator.ne, 2, LANES, MASK, lambda builder, one, other: builder.fcmp_unordered('!=', one, other))
_define(operator.and_, 2, MASK, MASK, ir.IRBuilder.and_)
_define(operator.or_, 2, MASK, MASK, ir.IRBuilder.or_)


def _lane_by_lane(function: Callable[..., float], arguments: int) -> None:
    """Tell numba of a function of the C library, which takes the lanes one after the other."""
    one = signature(types.float64, *(types.float64,) * arguments)

    @infer_global(function)
    class _Template(ConcreteTemplate):
        cases = [signature(LANES, *(LANES,) * arguments)]  # noqa: RUF012

    @lower_builtin(function, *(LANES,) * arguments)
    def _lower(context: Any, builder: ir.IRBuilder, sig: Any, values: list[ir.Value]) -> Any:
        number = context.get_function(function, one)
        found = ir.Constant(VECTOR, ir.Undefined)
        for place in (ir.Constant(ir.IntType(32), lane) for lane in range(WIDTH)):
            result = number(builder, [builder.extract_element(value, place) for value in values])
            found = builder.insert_element(found, result, place)
        return found


LIBRARY: tuple[tuple[Function, int], ...] = (
    (math.cos, 1), (math.sin, 1), (math.atan, 1), (math.exp, 1), (math.expm1, 1), (math.atan2, 2),
)  # fmt: skip
for _function, _arguments in LIBRARY:
    _lane_by_lane(_function, _arguments)


@intrinsic
def _select(typingctx: Any, condition: types.Type, one: types.Type, other: types.Type) -> Any:
    def build(context: Any, builder: ir.IRBuilder, sig: Any, values: list[ir.Value]) -> Any:
        return builder.select(*values)

    return signature(LANES, MASK, LANES, LANES), build


@intrinsic
def _anywhere(typingctx: Any, condition: types.Type) -> Any:
    def build(context: Any, builder: ir.IRBuilder, sig: Any, values: list[ir.Value]) -> Any:
        bits = ir.IntType(WIDTH)
        return builder.icmp_unsigned('!=', builder.bitcast(values[0], bits), ir.Constant(bits, 0))

    return signature(types.boolean, MASK), build


# Lambdas, since numba wants the very same words on both levels and mypy would want types on one.
overload(lanes.select)(
    lambda condition, one, other: (
        (lambda condition, one, other: _select(condition, one, other))
        if condition == MASK
        else (lambda condition, one, other: one if condition else other)
    )
)
overload(lanes.anywhere)(
    lambda condition: (lambda condition: _anywhere(condition)) if condition == MASK else (lambda condition: condition)
)


def _element(context: Any, builder: ir.IRBuilder, kind: Any, value: ir.Value, row: ir.Value, column: ir.Value) -> Any:
    array = context.make_array(kind)(context, builder, value)
    return cgutils.get_item_pointer(context, builder, kind, array, [row, column])


@intrinsic
def _load(typingctx: Any, numbers: types.Type, row: types.Type, column: types.Type) -> Any:
    def build(context: Any, builder: ir.IRBuilder, sig: Any, values: list[ir.Value]) -> Any:
        where = _element(context, builder, sig.args[0], *values)
        return builder.load(builder.bitcast(where, VECTOR.as_pointer()), align=8)

    return signature(LANES, numbers, types.intp, types.intp), build


@intrinsic
def _store(typingctx: Any, numbers: types.Type, row: types.Type, column: types.Type, value: types.Type) -> Any:
    def build(context: Any, builder: ir.IRBuilder, sig: Any, values: list[ir.Value]) -> Any:
        where = _element(context, builder, sig.args[0], *values[:3])
        builder.store(values[3], builder.bitcast(where, VECTOR.as_pointer()), align=8)
        return context.get_dummy_value()

    return signature(types.void, numbers, types.intp, types.intp, LANES), build


overload(lanes.load)(lambda numbers, row, column: lambda numbers, row, column: _load(numbers, row, column))
overload(lanes.store)(
    lambda numbers, row, column, value: lambda numbers, row, column, value: _store(numbers, row, column, value)
)
