"""What Numba is told of our tables, and of the few things that it spells in its own way.

Of `tables.Table` and the records in it, `tables.fetch`, `records.within` and `within_spans`,
`bits.lowest_bit` and `bits.mix`; compiling imports it, a plain run and a ready loop (ready.py) do
not.

Whatever is read has 64 bits, however many it is kept in, and an array in a record is a table, too:
a function is compiled for each mix of types that it is called with, half of all would be twice.
"""

import functools
import hashlib
import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.datamodel import PrimitiveModel, StructModel
from numba.core.imputils import lower_getattr_generic, lower_setattr_generic
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    intrinsic,
    overload,
    register_model,
    typeof_impl,
    unbox,
)
from numba.np import numpy_support

from innervate.kernel.bits import FACTOR, lowest_bit, mix
from innervate.kernel.records import within, within_spans
from innervate.kernel.tables import Table, fetch

INSIDE = {"forceinline": True, "no_cfunc_wrapper": True}  # becomes part of its callers


class TableType(types.Type):  # type: ignore[misc]
    """Numba's type of a Table; `row` > 0 makes its items rows of that many numbers."""

    def __init__(self, dtype: Any, row: int, step: int) -> None:
        self.dtype = dtype
        self.row = row
        self.step = step  # bytes from one item to the next
        super().__init__(name=f"Table({dtype}, {row}, {step})")


@register_model(TableType)
class _TableModel(StructModel):  # type: ignore[misc]
    def __init__(self, manager: Any, table: Any) -> None:
        members = [("address", types.CPointer(types.uint8)), ("length", types.int64)]
        super().__init__(manager, table, members)


class RecordType(types.Type):  # type: ignore[misc]
    """Numba's type of a record where it lies in a table; what stands behind its fields is none."""

    def __init__(self, kept: types.Record) -> None:
        self.kept = kept
        fields = [(name, str(kept.typeof(name)), kept.offset(name)) for name in kept.fields]
        told = hashlib.blake2b(str(fields).encode(), digest_size=8).hexdigest()
        super().__init__(name=f"Record({told})")


@register_model(RecordType)
class _RecordModel(PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, record: Any) -> None:
        super().__init__(manager, record, ir.IntType(8).as_pointer())


@infer_getattr
class _Fields(AttributeTemplate):  # type: ignore[misc]
    key = RecordType

    def generic_resolve(self, record: Any, name: str) -> Any:
        return _read_as(record.kept.typeof(name))


def _read_as(field: Any) -> Any:
    if isinstance(field, types.NestedArray):
        return _array_of(field)
    return types.int64 if isinstance(field, types.Integer) else field


def _array_of(field: types.NestedArray) -> TableType:
    return TableType(field.dtype, 0, field.dtype.bitwidth // 8)


def _place(context: Any, builder: Any, record: Any, value: Any, name: str) -> tuple[Any, Any]:
    """What is kept under a name, and where."""
    field = record.kept.typeof(name)
    place = builder.gep(value, [ir.Constant(ir.IntType(64), record.kept.offset(name))])
    kind = field.dtype if isinstance(field, types.NestedArray) else field
    return field, builder.bitcast(place, context.get_data_type(kind).as_pointer())


@lower_getattr_generic(RecordType)  # type: ignore[untyped-decorator]
def _read_field(context: Any, builder: Any, record: Any, value: Any, name: str) -> Any:
    field, place = _place(context, builder, record, value, name)
    if not isinstance(field, types.NestedArray):
        kept = context.unpack_value(builder, field, place)
        return context.cast(builder, kept, field, _read_as(field))
    proxy = cgutils.create_struct_proxy(_array_of(field))(context, builder)
    proxy.address = builder.bitcast(place, ir.IntType(8).as_pointer())
    proxy.length = ir.Constant(ir.IntType(64), field.nitems)
    return proxy._getvalue()


@lower_setattr_generic(RecordType)  # type: ignore[untyped-decorator]
def _write_field(context: Any, builder: Any, signature: Any, args: Any, name: str) -> Any:
    record, given = signature.args
    field, place = _place(context, builder, record, args[0], name)
    context.pack_value(builder, field, context.cast(builder, args[1], given, field), place)


@typeof_impl.register(Table)
def _typeof_table(value: Table, _context: Any) -> TableType:
    return _type_of(value.array.dtype, value.array.shape[1] if value.array.ndim == 2 else 0)


@functools.cache
def _type_of(dtype: np.dtype[Any], row: int) -> TableType:
    """Worked out anew for every table, this was nine tenths of calling a compiled loop."""
    kept = numpy_support.from_dtype(dtype)
    item = RecordType(kept) if isinstance(kept, types.Record) else kept
    return TableType(item, row, dtype.itemsize * max(row, 1))


@unbox(TableType)
def _unbox_table(table: Any, obj: Any, c: Any) -> Any:
    proxy = cgutils.create_struct_proxy(table)(c.context, c.builder)
    for name in ("address", "length"):
        value = c.pyapi.object_getattr_string(obj, name)
        number = c.pyapi.long_as_longlong(value)
        if name == "address":
            number = c.builder.inttoptr(number, ir.IntType(8).as_pointer())
        setattr(proxy, name, number)
        c.pyapi.decref(value)
    is_error = cgutils.is_not_null(c.builder, c.pyapi.err_occurred())
    return NativeValue(proxy._getvalue(), is_error=is_error)


def _item_pointer(context: Any, builder: Any, table: Any, value: Any, index: Any) -> Any:
    proxy = cgutils.create_struct_proxy(table)(context, builder, value=value)
    offset = builder.mul(index, ir.Constant(ir.IntType(64), table.step), flags=["nsw"])
    return builder.gep(proxy.address, [offset], inbounds=True)


@intrinsic  # type: ignore[untyped-decorator]
def _load(typing_context: Any, table: Any, index: Any) -> Any:
    if table.row:
        result: Any = TableType(table.dtype, 0, table.step // table.row)
    else:
        result = table.dtype
    widen = isinstance(result, types.Integer)

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        pointer = _item_pointer(context, builder, table, args[0], args[1])
        if table.row:
            proxy = cgutils.create_struct_proxy(result)(context, builder)
            proxy.address = pointer
            proxy.length = ir.Constant(ir.IntType(64), table.row)
            return proxy._getvalue()
        data = context.get_data_type(table.dtype)
        if widen:
            value = builder.load(builder.bitcast(pointer, data.as_pointer()))
            return context.cast(builder, value, table.dtype, types.int64)
        return pointer

    return (types.int64 if widen else result)(table, types.int64), generate


@intrinsic  # type: ignore[untyped-decorator]
def _store(typing_context: Any, table: Any, index: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        pointer = _item_pointer(context, builder, table, args[0], args[1])
        data = context.get_data_type(table.dtype)
        number = context.cast(builder, args[2], types.int64, table.dtype)
        builder.store(number, builder.bitcast(pointer, data.as_pointer()))
        return context.get_dummy_value()

    return types.void(table, types.int64, types.int64), generate


@intrinsic  # type: ignore[untyped-decorator]
def _length(typing_context: Any, table: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return cgutils.create_struct_proxy(table)(context, builder, value=args[0]).length

    return types.int64(table), generate


@overload(operator.getitem, jit_options=INSIDE)  # type: ignore[untyped-decorator]
def _getitem(table, index):
    if isinstance(table, TableType):
        return lambda table, index: _load(table, index)
    return None


@overload(operator.setitem, jit_options=INSIDE)  # type: ignore[untyped-decorator]
def _setitem(table, index, value):
    if isinstance(table, TableType):
        return lambda table, index, value: _store(table, index, value)
    return None


@overload(len, jit_options=INSIDE)  # type: ignore[untyped-decorator]
def _len(table):
    if isinstance(table, TableType):
        return lambda table: _length(table)
    return None


@intrinsic  # type: ignore[untyped-decorator]
def _prefetch(typing_context: Any, table: Any, index: Any, line: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        pointer = _item_pointer(context, builder, table, args[0], args[1])
        offset = builder.mul(args[2], ir.Constant(ir.IntType(64), 64))
        address = builder.gep(pointer, [offset])
        flag, kind = ir.IntType(32), ir.IntType(8).as_pointer()
        shape = ir.FunctionType(ir.VoidType(), [kind, flag, flag, flag])
        function = builder.module.declare_intrinsic("llvm.prefetch", [kind], shape)
        builder.call(function, [address, flag(1), flag(3), flag(1)])
        return context.get_dummy_value()

    return types.void(table, types.int64, types.int64), generate


@overload(fetch, jit_options=INSIDE)  # type: ignore[untyped-decorator]
def _fetch(table, index, line):
    return lambda table, index, line: _prefetch(table, index, line)


@intrinsic  # type: ignore[untyped-decorator]
def _count_trailing_zeros(typing_context: Any, word: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), generate


@intrinsic  # type: ignore[untyped-decorator]
def _mix64(typing_context: Any, state: Any, word: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        product = builder.mul(builder.xor(args[0], args[1]), ir.Constant(ir.IntType(64), FACTOR))
        return builder.xor(product, builder.lshr(product, ir.Constant(ir.IntType(64), 32)))

    return types.int64(types.int64, types.int64), generate


@overload(lowest_bit, inline="always")  # type: ignore[untyped-decorator]
def _lowest_bit(word):
    return lambda word: _count_trailing_zeros(word)


@overload(mix, inline="always")  # type: ignore[untyped-decorator]
def _mix(state, word):
    return lambda state, word: _mix64(state, word)


@overload(within, jit_options=INSIDE)  # type: ignore[untyped-decorator]
def _within(words, low, high):
    def every(words, low, high):  # type: ignore[no-untyped-def]
        wrong = False
        for i in range(len(low)):
            wrong |= (words[i] < low[i]) | (words[i] > high[i])
        return not wrong

    return every


@overload(within_spans, jit_options=INSIDE)  # type: ignore[untyped-decorator]
def _within_spans(words, low, high, spans):
    def every(words, low, high, spans):  # type: ignore[no-untyped-def]
        wrong = begin = 0  # negative as soon as a difference is, even of words that wrap round
        for k in range(len(spans)):
            end, least, most = spans[k].end, spans[k].low, spans[k].high
            if least <= most:
                for i in range(begin, end):
                    wrong |= (words[i] - least) | (most - words[i])
            else:
                for i in range(begin, end):
                    wrong |= (words[i] - low[i]) | (high[i] - words[i])
            begin = end
        return wrong >= 0

    return every
