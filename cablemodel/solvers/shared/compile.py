"""How kernels are compiled: one place for the options that let them run without Python.

Kernels obey the rules of docs/architecture.md: scalars and preallocated arrays only, no allocation,
no exceptions, an int status where something can fail. `fastmath` stays off, so that the
just-in-time and the ahead-of-time build give the same bits.
"""

import ctypes
import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numba
from llvmlite import ir
from llvmlite.binding import Linkage
from numba import types
from numba.core import cgutils
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import AnalysisPass, register_pass
from numba.core.targetconfig import ConfigStack
from numba.core.typed_passes import AnnotateTypes
from numba.core.types.functions import BaseFunction
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    infer_getattr,
    intrinsic,
    lower_getattr_generic,
    lower_setattr_generic,
    models,
    register_model,
)
from numba.np import arrayobj
from numba.np.arrayobj import make_array, populate_array

from cablemodel.cache import cache_root
from cablemodel.solvers.shared.record import INTEGER, Field, Part, Record, Several

_intrinsic: Any = intrinsic  # for callers, what it makes takes one argument less

OPTIONS: dict[str, Any] = {
    "nopython": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": False,
    "boundscheck": False,
    "_nrt": False,
}

# Nobody calls inner kernels from Python or C.
INNER: dict[str, Any] = {**OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}

# Entry points take the instance block twice, as 64-bit integers and as doubles.
INTEGERS = types.Array(types.int64, 1, "C")
REALS = types.Array(types.float64, 1, "C")


def source_hash() -> str:
    """Hash of every kernel source and of the compiler's version: the key of the kernel cache."""
    solvers = Path(__file__).parents[1]
    digest = hashlib.sha256(numba.__version__.encode())
    for folder in ("shared", "finite_element/kernels"):
        for path in sorted((solvers / folder).rglob("*.py")):
            digest.update(path.relative_to(solvers).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Folder of compiled kernels; numba itself does not notice edits in imported modules."""
    return cache_root() / source_hash()


def modules_of(library: Any, seen: set[Any] | None = None) -> Iterator[Any]:
    """Modules of all that a library calls, directly or not, each once; not its own."""
    seen = set() if seen is None else seen
    for called in library._linking_libraries:
        if called not in seen:
            seen.add(called)
            if isinstance(called, _InnerLibrary):
                yield called._final_module
                yield from modules_of(called, seen)
            else:
                yield called._get_module_for_linking()  # it holds what it calls


class _InnerLibrary(JITCodeLibrary):
    """Code of an inner kernel: its own IR, for the entry points that call it.

    Numba would link all that it calls into it, and make machine code of that, for calls from
    Python that nobody makes: gigabytes, and a third of the time of the first start.
    """

    def finalize(self) -> None:
        """Leave its module as it is: an entry point links it, and optimises what it holds, once."""
        self._raise_if_finalized()
        self._finalize_dynamic_globals()
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == Linkage.external:
                function.linkage = "linkonce_odr"  # each caller may bring it along
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """With all that it calls, for a caller of numba's own kind, as tests make them."""
        if self._shared_module is None:
            self._shared_module = self._final_module.clone()
            for module in modules_of(self):
                self._shared_module.link_in(module, preserve=True)
        return self._shared_module

    def get_pointer_to_function(self, name: str) -> int:
        """What a call from Python ends in: a TypeError."""
        self._ensure_finalized()
        address = ctypes.cast(ctypes.pythonapi.PyErr_BadArgument, ctypes.c_void_p).value
        assert address is not None
        return address

    @property
    def codegen(self) -> Any:
        return _NoEnvironment(self._codegen)


class _OutlinedLibrary(_InnerLibrary):
    """The same for a kernel that stays one function, however many callers it has."""

    def finalize(self) -> None:
        mangled = f"{len(self.name)}{self.name}B"
        for function in self._final_module.functions:
            if mangled in function.name and not function.is_declaration:
                function.add_function_attribute("noinline")
        super().finalize()


class _EntryLibrary(JITCodeLibrary):
    """Code of an entry point: machine code of all that it calls, itself and through others."""

    def finalize(self) -> None:
        for module in modules_of(self):
            self._final_module.link_in(module, preserve=True)
        self._linking_libraries = []
        super().finalize()


class _NoEnvironment:
    """Numba's code generator for a kernel that is not loaded, so has no environment to set."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing: kernels raise nothing, so they never look at it."""


def _compiler(library: type[JITCodeLibrary]) -> type[CompilerBase]:
    """Numba's compiler, which puts code into a library of this kind."""

    @register_pass(mutates_CFG=False, analysis_only=True)
    class ChooseLibrary(AnalysisPass):
        _name = f"cablemodel_{library.__name__}"

        def __init__(self) -> None:
            super().__init__()

        def run_pass(self, state: Any) -> bool:
            state.library = library(state.targetctx.codegen(), state.func_id.func_qualname)
            state.library.enable_object_caching()
            return False

    class Compiler(CompilerBase):
        def define_pipelines(self) -> list[Any]:
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.add_pass_after(ChooseLibrary, AnnotateTypes)
            passes.finalize()
            return [passes]

    return Compiler


_inner = _compiler(_InnerLibrary)
_outlined = _compiler(_OutlinedLibrary)
entry_compiler = _compiler(_EntryLibrary)


def _for_any_value(dispatcher: Any) -> Any:
    """Compile a kernel once for all constants that it is called with, not once for each."""
    template = dispatcher.get_call_template

    def get_call_template(args: Any, kws: Any) -> Any:
        general = tuple(types.unliteral(kind) for kind in args)
        return template(general, {name: types.unliteral(kind) for name, kind in kws.items()})

    dispatcher.get_call_template = get_call_template
    return dispatcher


def kernel(function: Callable[..., Any]) -> Any:
    """An inner kernel, compiled into the entry points that call it; not callable from Python."""
    return _for_any_value(numba.jit(**INNER, pipeline_class=_inner)(function))


def outlined(function: Callable[..., Any]) -> Any:
    """A large inner kernel that is never inlined: its code exists once."""
    return _for_any_value(numba.jit(**INNER, pipeline_class=_outlined)(function))


def inlined(function: Callable[..., Any]) -> Any:
    """A small kernel that is always inlined by the compiler.

    So is all that it calls and that was not compiled before: numba passes the option on.
    """
    return _for_any_value(numba.jit(**INNER, pipeline_class=_inner, forceinline=True)(function))


@contextmanager
def calls_resolved_once() -> Iterator[None]:
    """While kernels are compiled: what a built-in function means for given types is found once.

    Numba tries all its templates anew for every operator in every kernel, a quarter of a first
    start. What was found is forgotten in the end, and nothing else is compiled meanwhile.
    """
    built_in: Any = BaseFunction
    stack: Any = ConfigStack
    resolve = built_in.get_call_type
    known: dict[Any, Any] = {}

    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        flags = stack.top_or_none()
        if kws or flags is None:
            return resolve(self, context, args, kws)
        key = self, context, args, flags
        if key not in known:
            found = resolve(self, context, args, kws)
            known[self, context, args, flags.copy()] = found, self._impl_keys[found.args]
        found, meant = known[key]
        self._impl_keys[found.args] = meant  # by which the call is compiled, the last one found
        return found

    with global_compiler_lock:
        built_in.get_call_type = get_call_type
        try:
            yield
        finally:
            built_in.get_call_type = resolve


@contextmanager
def indices_from_zero() -> Iterator[None]:
    """While kernels are compiled: an index counts from the array's begin, as in C.

    Numba looks at every index that may be negative whether it counts from the end: a twentieth of a
    step's instructions and of the library, and loops that are not vectorised. None is in a kernel.
    """
    arrays: Any = arrayobj
    fix_integer_index = arrays.fix_integer_index

    def from_zero(context: Any, builder: Any, kind: Any, index: Any, size: Any) -> Any:
        return context.cast(builder, index, kind, types.intp)

    with global_compiler_lock:
        arrays.fix_integer_index = from_zero
        try:
            yield
        finally:
            arrays.fix_integer_index = fix_integer_index


def entry_point(
    signature: Any, folder: Callable[[], Path] = cache_folder
) -> Callable[[Callable[..., Any]], Any]:
    """A kernel that Python, the FMU and the node call: fixed signature, cached in a folder.

    The signature is kept on the dispatcher and compiled when first called (or loaded from the
    cache), so that importing this package compiles nothing.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        config: Any = numba.config
        previous = config.CACHE_DIR
        config.CACHE_DIR = str(folder())
        try:
            dispatcher = numba.jit(**OPTIONS, cache=True, pipeline_class=entry_compiler)(function)
        finally:
            config.CACHE_DIR = previous
        dispatcher.entry_signature = signature
        compiled = dispatcher.compile

        def compile_remembering(signature: Any) -> Any:
            with calls_resolved_once(), indices_from_zero():
                return compiled(signature)

        dispatcher.compile = compile_remembering
        return dispatcher

    return decorate


class RecordType(types.Type):
    """A view of words by name (record.py): in machine code the address of the first."""

    def __init__(self, record: type[Record]) -> None:
        self.record = record
        super().__init__(name=record.__name__)


@register_model(RecordType)
class _RecordModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.IntType(64).as_pointer())


def _type_of(field: Field) -> Any:
    """What a field is in a kernel: a number, an array, or a record."""
    if isinstance(field, Part):
        return RecordType(field.of)
    if isinstance(field, Several):
        return INTEGERS if field.kind == INTEGER else REALS
    return types.int64 if field.kind == INTEGER else types.float64


@infer_getattr
class _RecordAttributes(AttributeTemplate):
    key = RecordType

    def generic_resolve(self, record: Any, name: str) -> Any:  # type: ignore[override]
        field = record.record.FIELDS.get(name)
        return None if field is None else _type_of(field)


def _place_of(builder: Any, address: Any, field: Field) -> Any:
    """Address of a field's first word."""
    place = builder.gep(address, [ir.Constant(ir.IntType(64), field.word)])
    if field.kind == INTEGER or isinstance(field, Part):
        return place
    return builder.bitcast(place, ir.DoubleType().as_pointer())


@lower_getattr_generic(RecordType)
def _get_field(context: Any, builder: Any, kind: Any, address: Any, name: str) -> Any:
    field = kind.record.FIELDS[name]
    place = _place_of(builder, address, field)
    if isinstance(field, Part):
        return place
    if isinstance(field, Several):
        return _array_at(context, builder, _type_of(field), place, field.words)
    return builder.load(place)


@lower_setattr_generic(RecordType)
def _set_field(context: Any, builder: Any, signature: Any, values: Any, name: str) -> None:
    builder.store(values[1], _place_of(builder, values[0], signature.args[0].record.FIELDS[name]))


def _array_at(context: Any, builder: Any, kind: Any, data: Any, count: Any) -> Any:
    """An array of so many words from an address on."""
    array = make_array(kind)(context, builder)
    word = context.get_constant(types.intp, 8)
    if isinstance(count, int):
        count = context.get_constant(types.intp, count)
    populate_array(
        array,
        data=data,
        shape=cgutils.pack_array(builder, [count]),
        strides=cgutils.pack_array(builder, [word]),
        itemsize=word,
        meminfo=None,
    )
    return array._getvalue()


def _address(context: Any, builder: Any, kind: Any, words: Any, word: Any) -> Any:
    """Address of a word of an array."""
    data = make_array(kind)(context, builder, words).data
    return builder.bitcast(builder.gep(data, [word]), ir.IntType(64).as_pointer())


def record_in(record: type[Record]) -> Any:
    """Kernel f(words): the record at its own place in a block's words, without a copy."""

    @_intrinsic
    def named(typing_context: Any, words: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            word = ir.Constant(ir.IntType(64), record.FIRST)
            return _address(context, builder, signature.args[0], values[0], word)

        return RecordType(record)(words), generate

    return named


def record_at(record: type[Record]) -> Any:
    """Kernel f(words, word): the record at a word of an array, without a copy."""

    @_intrinsic
    def named(typing_context: Any, words: Any, word: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return _address(context, builder, signature.args[0], *values)

        return RecordType(record)(words, types.int64), generate

    return named


def _own_words(builder: Any, count: int) -> Any:
    """Address of so many words, zeros, that last until the kernel returns."""
    words = ir.ArrayType(ir.IntType(64), count)
    place = cgutils.alloca_once(builder, words)
    cgutils.memset(builder, place, ir.Constant(ir.IntType(64), 8 * count), 0)
    return builder.bitcast(place, ir.IntType(64).as_pointer())


def own_record(record: type[Record]) -> Any:
    """Kernel f(): a record of the caller's own, zeros, which lasts until the caller returns.

    On the stack, and where it can be in registers. One call has one record: in a loop it is the
    same, cleared.
    """

    @_intrinsic
    def own(typing_context: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return _own_words(builder, record.WORDS)

        return RecordType(record)(), generate

    return own


def own_numbers(count: int) -> Any:
    """Kernel f(): so many zeros of the caller's own; see `own_record`."""

    @_intrinsic
    def own(typing_context: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            words = _own_words(builder, count)
            place = builder.bitcast(words, ir.DoubleType().as_pointer())
            return _array_at(context, builder, REALS, place, count)

        return REALS(), generate

    return own


_VIEWED: dict[int, type[Record]] = {}


def row_of(record: type[Record], table: Field) -> Any:
    """Kernel f(I, M, n): row n of the table of records that starts at the header's word `table`.

    Raises:
        TypeError: another record is there, and one of them does not say that it shares the place.
    """
    other = _VIEWED.setdefault(table.place, record)
    if other is not record and not record.WITHIN == other.WITHIN == table.place:
        names = f"{record.__name__} and {other.__name__}"
        raise TypeError(f"{names} are both at `{table.name}`: declare them within={table.name}")

    @_intrinsic
    def named(typing_context: Any, header: Any, words: Any, row: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            integer = ir.IntType(64)
            data = make_array(signature.args[0])(context, builder, values[0]).data
            start = builder.load(builder.gep(data, [ir.Constant(integer, table.__index__())]))
            offset = builder.mul(values[2], ir.Constant(integer, record.WORDS))
            word = builder.add(start, offset)
            return _address(context, builder, signature.args[1], values[1], word)

        return RecordType(record)(header, words, types.int64), generate

    return named


@_intrinsic
def word_of(typing_context: Any, words: Any, record: Any) -> Any:
    """word_of(words, record): the word of an array at which a record in it begins."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        integer = ir.IntType(64)
        data = make_array(signature.args[0])(context, builder, values[0]).data
        start, end = (builder.ptrtoint(place, integer) for place in (data, values[1]))
        return builder.ashr(builder.sub(end, start), ir.Constant(integer, 3), flags=["exact"])

    return types.int64(words, record), generate


@_intrinsic
def view(typing_context: Any, array: Any, start: Any, count: Any) -> Any:
    """``array[start : start + count]`` without the checks of a Python slice: 0 <= start.

    A slice clips its ends and, like every index that the compiler cannot prove to be positive,
    counts from the end when negative: a dozen instructions that keep loops from being vectorised.
    """
    signature = array(array, types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = signature.args[0]
        data = make_array(kind)(context, builder, values[0]).data
        return _array_at(context, builder, kind, builder.gep(data, [values[1]]), values[2])

    return signature, generate


@_intrinsic
def copy_words(typing_context: Any, array: Any, to: Any, start: Any, count: Any) -> Any:
    """``array[to : to + count] = array[start : start + count]``, two places that do not meet."""
    signature = types.void(array, types.int64, types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = make_array(signature.args[0])(context, builder, values[0]).data
        to, start, count = values[1:]
        cgutils.raw_memcpy(builder, builder.gep(data, [to]), builder.gep(data, [start]), count, 8)
        return context.get_dummy_value()

    return signature, generate
