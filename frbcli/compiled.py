"""The compiler of the kernels: numba's, with a cache on disk that follows all sources that a kernel is made of.

numba keys its cache by the file of the function alone. A kernel holds the machine code of those that it calls as well,
so that one of another file could change and not be seen.

What the compiler of the kernels does while other code runs: counted, with its CPU time apart from that code's.
"""

from __future__ import annotations

import hashlib
import logging
import os
import pickle
import re
import time
from collections.abc import Callable, Iterator, Set
from contextlib import contextmanager, suppress
from functools import cache, partial, update_wrapper
from glob import escape
from inspect import signature
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from llvmlite import binding, ir
from numba import __version__, njit, types
from numba.core import codegen, config, dispatcher, runtime
from numba.core.caching import NullCache
from numba.core.ccallback import CFunc
from numba.core.compiler import Compiler
from numba.core.entrypoints import init_all
from numba.core.event import Listener, install_listener, register
from numba.core.serialize import dumps
from numba.core.sigutils import normalize_signature
from numba.extending import overload
from numpy.typing import NDArray

from frbcli.caches import KERNELS, is_trusted, store, stored, take_shipped_kernels, temporary_cache
from frbcli.libraries import without_settings_here

COMPILE = "numba:compile"  # the event of numba


class Compilations(Listener):
    """The compilations so far. functions: how many were compiled, with those that they call; cpu_s, wall_s: time.

    observe: called at the beginning and the end of each.
    """

    def __init__(self, observe: Callable[[], None] | None = None) -> None:
        self.functions, self.cpu_s, self.wall_s = 0, 0.0, 0.0
        self._observe, self._depth, self._began = observe, 0, (0.0, 0.0)

    @property
    def spent_s(self) -> float:
        """CPU time so far, also while one is going on."""
        return self.cpu_s + (time.process_time() - self._began[0] if self._depth else 0.0)

    def on_start(self, _event: Any) -> None:
        """A function is about to be compiled, maybe within another one."""
        if not self._depth:
            self._began = time.process_time(), time.perf_counter()
        self._depth += 1
        self._notify()

    def on_end(self, _event: Any) -> None:
        """A function is compiled."""
        self.functions, self._depth = self.functions + 1, self._depth - 1
        if not self._depth:
            self.cpu_s += time.process_time() - self._began[0]
            self.wall_s += time.perf_counter() - self._began[1]
        self._notify()

    def _notify(self) -> None:
        if self._observe is not None:
            self._observe()


@contextmanager
def counted(observe: Callable[[], None] | None = None) -> Iterator[Compilations]:
    """Within it compilations are counted."""
    compilations = Compilations(observe)
    with install_listener(COMPILE, compilations):
        yield compilations


class CompilationNeededError(Exception):
    """A kernel is not on disk where nothing is to be compiled."""


class _Refusing(Listener):
    def on_start(self, _event: Any) -> None:
        raise CompilationNeededError

    def on_end(self, _event: Any) -> None:
        """Nothing was compiled."""


@contextmanager
def without_compiling() -> Iterator[None]:
    """Within it kernels come from disk.

    Raises:
        CompilationNeededError: one is not there.
    """
    with install_listener(COMPILE, _Refusing()):
        yield


class Clock(NamedTuple):
    """Times in s of this process, in which it did not compile."""

    cpu_s: float
    wall_s: float


_SO_FAR = Compilations()  # of this process


_register: Any = register  # numba gives no types of it


def working_time() -> Clock:
    """The time now, without what was compiled so far: what a first start computes takes as long as a later one."""
    return Clock(time.process_time() - _SO_FAR.cpu_s, time.perf_counter() - _SO_FAR.wall_s)


def compiled_s() -> float:
    """CPU time in s that this process has compiled so far."""
    return _SO_FAR.cpu_s


_PACKAGE = Path(__file__).parent
_BRINGS_KERNELS = (_PACKAGE / KERNELS).exists()
_FOLDER = "__init__.py"
_IMPORTS = re.compile(r"from frbcli((?:\.\w+)*) import (\([^)]*\)|[^\n]*)")
# How numba reads a kernel alone, and its functions in C for the memory of arrays, by their names: neither is public
READ = "_load_overload"
_MEMORY: Any = getattr(getattr(runtime, "_nrt_python", None), "c_helpers", None)
# A library of machine code of numba, and what compiles the functions that Python calls; private as well. A numba
# without them compiles each kernel by itself, which takes half as long again.
_LIBRARY: Any = getattr(codegen, "JITCodeLibrary", object)
_PARTS = hasattr(_LIBRARY, "_optimize_final_module") and hasattr(_LIBRARY, "_finalize_final_module")
_PARTS = _PARTS and hasattr(getattr(dispatcher, "_FunctionCompiler", None), "_get_implementation")

Indices = NDArray[np.int64]
Kernel = TypeVar("Kernel", bound=Callable[..., Any])

# numba looks for settings in the current folder whenever it compiles: there are none
config.reload_config = partial(without_settings_here, config.reload_config)
take_shipped_kernels(_PACKAGE)  # before the first kernel, for which numba chooses a kind of processor


class _Part(_LIBRARY):  # type: ignore[misc]
    """Code of a kernel that others call: it is optimised and turned to machine code within theirs, not by itself."""

    @property
    def codegen(self) -> Any:
        """The library for `set_env`, which numba calls for a function that Python calls."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing: Python does not call it."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalized = True


class _PartCompiler(Compiler):
    """numba's compiler for a _Part."""

    def compile_extra(self, func: Any) -> Any:
        """As numba's, with the code of a _Part."""
        part, compile_extra = cast("Any", _Part), cast("Any", super()).compile_extra  # numba gives no types of them
        if _PARTS:
            self.state.library = part(self.state.targetctx.codegen(), func.__qualname__)
        return compile_extra(func)


# Of numba.extending.overload, for functions chosen by the types of their arguments: what `compiled` has. Those that are
# put into their callers need it as well: numba compiles them by themselves, too, to know what they return.
AS_KERNELS: Any = {
    "error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False,
    "pipeline_class": _PartCompiler,
}  # fmt: skip


def compiled(
    inline: bool = False,
    internal: bool = False,
    makes_arrays: bool = False,
    fastmath: Set[str] = frozenset(),
) -> Callable[[Kernel], Kernel]:
    """Decorates a function that is compiled, once for each set of types, and kept on disk; numbers that are not finite
    follow IEEE 754 and raise nothing.

    A kernel is a part of those that call it: LLVM optimises it once, within the outermost one, which alone becomes
    machine code. Each kernel by itself, with all that it calls, took half as long again to compile. Python calls a
    part through a function that does nothing else. Literal numbers are numbers as others are: LLVM sees their values,
    and numba compiles no part for each of them.

    inline: put into the machine code of the functions that call it, however long it is. internal: for kernels that
    only kernels call, Python cannot. makes_arrays: for kernels that make arrays, or use those that another one made
    and returned. All others work in arrays that their caller holds, and return numbers: they count no references to
    arrays, which took a third of the time of a run with tabulated films. fastmath: LLVM's flags, e.g. {"contract"}.
    """

    def decorated(function: Kernel) -> Kernel:
        options: Any = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": makes_arrays}  # numba gives no types
        options |= {"forceinline": inline, "fastmath": set(fastmath) or False}
        if internal:
            return cast("Kernel", _part(function, options))
        kernel: Any = njit(**options)(function)
        kernel._cache = _Cache(kernel, Path(function.__code__.co_filename))
        if not _PARTS:
            return cast("Kernel", kernel)
        part = cache(partial(_part, function, options))  # made when something is compiled: most starts compile nothing
        kernel._compiler._get_implementation = lambda _, __: _call_of_part(function, part())
        kernel.get_call_template = lambda args, named: part().get_call_template(args, named)
        kernel.get_overload = lambda kinds: part().get_overload(kinds)
        return cast("Kernel", kernel)

    return decorated


def compiled_for(kind: type, otherwise: object = None) -> Callable[[Kernel], Kernel]:
    """Decorates a kernel of a machine that has something, its first argument, of the type `kind`: of any other one
    the functions that call it have `otherwise` in its place, and compute nothing."""

    def decorated(function: Kernel) -> Kernel:
        has, has_not = _call_of_part(function, compiled()(function)), _composed(function, "part", otherwise)
        return cast("Kernel", by_types(lambda *given: has if type_of(given[0]) is kind else None)(has_not))

    return decorated


def by_types(choose: Callable[..., Any], inline: bool = True, **options: Any) -> Callable[[Kernel], Kernel]:
    """Decorates a function that kernels call, and Python may: the types of its arguments choose the function that is
    meant, when the kernel is compiled.

    choose: a function for these arguments, or for types that the compiler knows; None: the decorated one. inline: put
    into the code of its callers as numba reads it; options: further ones of the compiler.
    """

    def decorated(function: Kernel) -> Kernel:
        def chosen(*given: Any) -> Any:
            return choose(*given) or function

        def asked(*given: Any) -> Any:
            return chosen(*given)(*given)

        how: Any = {"inline": "always"} if inline else {}
        overload(asked, jit_options=AS_KERNELS | options, strict=False, **how)(chosen)
        return cast("Kernel", update_wrapper(asked, function))

    return decorated


def type_of(given: Any) -> type:
    """The class of an argument, or of a type of tuples that the compiler knows."""
    return cast("type", getattr(given, "instance_class", type(given)))


def of_several(function: Callable[..., Any], inline: bool = False) -> Callable[..., Any]:
    """A function (items, i, a, b, c, d, e) for kernels: `function` of item i of a tuple and five more arguments. What
    the compiler knows of items of several types stands at fixed places of the tuple."""

    def first(items, i, a, b, c, d, e):  # type: ignore[no-untyped-def]  # noqa: ARG001
        return function(items[0], a, b, c, d, e)

    def later(items, i, a, b, c, d, e):  # type: ignore[no-untyped-def]
        return function(items[0], a, b, c, d, e) if i == 0 else one_of(items[1:], i - 1, a, b, c, d, e)

    def choose(items: Any, *_: Any) -> Any:
        if isinstance(items, tuple | types.UniTuple):
            return None
        return first if len(items) == 1 else later

    @by_types(choose, inline)
    def one_of(items: Any, i: int, a: float, b: float, c: float, d: float, e: float) -> Any:
        return function(items[i], a, b, c, d, e)

    return one_of


def _part(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """A function as a part of the kernels that call it."""
    options = {**options, "no_cpython_wrapper": True, "pipeline_class": _PartCompiler}
    part: Any = njit(**options)(function)
    ask, plain = part.get_call_template, cast("Any", types.unliteral)
    part.get_call_template = lambda args, named: ask([plain(kind) for kind in args], named)
    return part


def _call_of_part(function: Callable[..., Any], part: Any) -> Callable[..., Any]:
    """A function that calls the part of a kernel: what Python calls."""
    return _composed(function, "part({names})", part)


def _composed(function: Callable[..., Any], body: str, part: Any) -> Callable[..., Any]:
    """A function with the parameters of another one, {names}, that evaluates the expression `body` of them and
    `part`."""
    names = ", ".join(signature(function).parameters)
    call: Callable[..., Any] = eval(f"lambda {names}: {body.format(names=names)}", {"part": part})
    return update_wrapper(call, function)


class _Cache:
    """The cache on disk of a kernel, found when it is first asked. Most kernels are within others, and never are: for
    each of them numba would try whether its folder can be written."""

    def __init__(self, kernel: Any, source: Path) -> None:
        self._kernel, self._source = kernel, source

    def __getattr__(self, name: str) -> Any:
        if self._kernel._cache is self:
            _keep(self._kernel, self._source)
        return getattr(self._kernel._cache, name)


def c_function(function: Callable[..., Any], signature: Any, *sources: Path) -> Any:
    """A function compiled for one signature, to be called by its address; kept on disk if it is made of `sources`.
    Others are functions of a user, which may use extensions of numba."""
    normalize: Any = normalize_signature  # numba gives it no types
    load_extensions: Any = init_all  # likewise
    made: Any = CFunc(function, normalize(signature), locals={}, options={"error_model": "numpy"})
    if sources:
        _keep(made, *sources)
    else:
        load_extensions()
    made.compile()
    return made


def address_of(function: Any) -> int:
    """Address of a C function made by c_function."""
    return int(function.address)


def call_of(numbers: int) -> Callable[..., Any]:
    """Code that calls an address with some whole numbers and then with the data of arrays or records."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        pointer = ir.DoubleType().as_pointer()
        given = list(arguments[1 : 1 + numbers])
        kinds = [value.type for value in given]
        for kind, array in zip(signature.args[1 + numbers :], arguments[1 + numbers :], strict=True):
            a_record = isinstance(kind, types.Record)
            data = array if a_record else context.make_array(kind)(context, builder, array).data
            given.append(builder.bitcast(data, pointer))
            kinds.append(pointer)
        function = ir.FunctionType(ir.VoidType(), kinds)
        builder.call(builder.inttoptr(arguments[0], function.as_pointer()), given)
        return context.get_dummy_value()

    return generate


def jitted(function: Any, force_inline: bool = False) -> Any:
    """A plain function as numba takes it, with every plain function of its module that it calls; others as they are.

    force_inline: put into the machine code of its callers, so that a loop over it can run on the vector units.
    """
    if not _is_plain(function):
        return function
    known = function.__globals__
    called = {
        name: jitted(known[name], force_inline)
        for name in function.__code__.co_names
        if _is_plain(known.get(name)) and known[name] is not function
    }
    names = {**known, **called}
    made = FunctionType(function.__code__, names, function.__name__, function.__defaults__, function.__closure__)
    return njit(error_model="numpy", forceinline=force_inline)(made)


def _is_plain(value: Any) -> bool:
    return isinstance(value, FunctionType)


def folder_of(kernel: Callable[..., object]) -> Path | None:
    """The folder in which a kernel is kept, None if it is not."""
    cached: Any = kernel
    return None if cached._cache.cache_path is None else Path(cached._cache.cache_path)


def _keep(made: Any, *sources: Path) -> None:
    """Have a kernel kept on disk, in files that follow its sources: where numba puts it if nobody else can write there,
    else in a temporary directory; without any place, or with a numba that has other files, in memory.

    Next to its sources it is trusted as they are: Python runs what it finds there, too.
    """
    own_folder = sources[0].parent / "__pycache__"
    for use_another_place in (_use_temporary_cache, _say_that_nothing_is_kept):
        with suppress(RuntimeError, OSError):  # numba has no place for it
            made.enable_caching()
            index = _index_of(made._cache)
            if index is not None and (index.parent == own_folder or _is_own_place(index)):
                break
        use_another_place()
    else:
        made._cache = NullCache()
        return
    kept, places = made._cache, [index]
    if _BRINGS_KERNELS and index.parent != own_folder:
        places.append(own_folder / index.name)
    kept._cache_file = _Files(places, f"{__version__} {sources_digest(*sources)}")
    quick = hasattr(kept, READ) and _MEMORY is not None  # else numba prepares itself first
    kept.load_overload = partial(_read, getattr(kept, READ) if quick else kept.load_overload)
    kept.save_overload = partial(_write, kept.save_overload)


def _index_of(cache: Any) -> Path | None:
    """Where numba has the index of a kernel, to which it has no public way; None if it is elsewhere."""
    path = getattr(getattr(cache, "_cache_file", None), "_index_path", None)
    return None if path is None else Path(path)


def _is_own_place(index: Path) -> bool:
    """Whether an index lies where only this user can write. Without a name for its cache, numba takes the current
    folder, which may have come from somewhere else."""
    settings: Any = config  # numba gives no types of it
    return bool(index.is_absolute() or settings.CACHE_DIR) and is_trusted(index.parent)


def _use_temporary_cache() -> None:
    """Raises OSError if there is none."""
    with suppress(OSError):
        place = str(temporary_cache())
        os.environ["NUMBA_CACHE_DIR"] = place  # also of the processes of a sweep
        settings: Any = config  # numba gives no types of it
        settings.CACHE_DIR = place
        logging.getLogger("frbcli").warning(
            "Compiled kernels are kept in %s, for neither the installation nor NUMBA_CACHE_DIR or the home directory "
            "is a place where this user can write and others cannot. "
            "Set NUMBA_CACHE_DIR to a directory of your own to keep them longer.", place,
        )  # fmt: skip


@cache
def _say_that_nothing_is_kept(cause: str = "there is no place for them") -> None:
    message = "Compiled kernels are not kept on disk: %s. The next start compiles them again."
    logging.getLogger("frbcli").warning(message, cause)


class _Files:
    """The files of a kernel, instead of numba's: an index, and a file for each set of types, all with checksums.

    Neither is read where the sources were others: an older index may name types that are no longer there.
    """

    def __init__(self, indexes: list[Path], made_for: str) -> None:
        self._indexes, self._made_for = indexes, made_for

    def load(self, key: object) -> Any:
        """The parts of a compiled kernel, None if they are not there, or damaged."""
        for index in self._indexes:
            name = self._names(index).get(key)
            content = None if name is None else stored(index.with_name(name), self._made_for)
            if content is not None:
                return pickle.loads(content)
        return None

    def save(self, key: object, parts: object) -> None:
        """Keep a compiled kernel in the first place. Its file is named by what it holds, so that two processes never
        take it for another one. Raises OSError."""
        index, write = self._indexes[0], cast("Any", dumps)  # numba gives no types of it
        content = write(parts)
        name = f"{index.stem}.{hashlib.sha256(content).hexdigest()[:16]}.nbc"
        store(index.with_name(name), content, self._made_for)
        names = {**self._names(index), key: name}
        store(index, write(names), self._made_for)
        for other in index.parent.glob(f"{escape(index.stem)}.*.nbc"):  # of older sources
            if other.name not in names.values():
                other.unlink(missing_ok=True)

    def _names(self, index: Path) -> dict[object, str]:
        content = stored(index, self._made_for)
        return {} if content is None else pickle.loads(content)


def _read(read: Callable[[Any, Any], Any], signature: Any, target: Any) -> Any:
    """A kernel from the disk, None if it is not there or cannot be read, without what numba needs to compile: its
    preparation takes half as long as importing numba. numba prepares itself where a kernel has to be compiled.

    Machine code calls functions in C: numba names all of them when it starts, except those for the memory of arrays,
    and for the hashes of sets and dictionaries, which kernels do not have.
    """
    _name_memory()
    with suppress(Exception):  # of numba, for types of another version of a library, say: it is compiled again
        return read(signature, target)
    return None


def _write(write: Callable[[Any, Any], None], signature: Any, made: Any) -> None:
    """Keep a kernel on disk; where it cannot be written, the process goes on without. One that calls a kernel whose
    compilation was interrupted in this process, as in a notebook, cannot be kept by numba: a RuntimeError."""
    try:
        with suppress(RuntimeError):
            write(signature, made)
    except OSError as error:
        _say_that_nothing_is_kept(error.strerror or str(error))


@cache
def _name_memory() -> None:
    """Let machine code find numba's functions for the memory of arrays."""
    for name, address in (_MEMORY or {}).items():
        binding.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


@cache
def sources_digest(*files: Path) -> str:
    """Digest of source files of this package and of all that they import from it, directly or not."""
    sources, waiting = set[Path](), list(files)
    while waiting:
        sources.add(one := waiting.pop())
        waiting += [other for other in _source(one)[1] if other not in sources]
    return hashlib.sha256("".join(_source(one)[0] for one in sorted(sources)).encode()).hexdigest()


@cache
def _source(file: Path) -> tuple[str, tuple[Path, ...]]:
    """(digest of a file, the files of this package that it imports)."""
    text, places = file.read_text(encoding="utf-8"), list[Path | None]()
    for module, names in _IMPORTS.findall(text):
        places.append(place := _file_of(module))
        if place is not None and place.name == _FOLDER:  # what is imported from a folder may be a file of it
            places += [_file_of(f"{module}.{name}") for name in re.findall(r"\w+", names)]
    return hashlib.sha256(text.encode()).hexdigest(), tuple(place for place in places if place is not None)


@cache
def _file_of(module: str) -> Path | None:
    """The file of a module of this package, named from a point on; None if there is no such module."""
    place = _PACKAGE.joinpath(*module.split("."))
    return next((file for file in (place / _FOLDER, place.with_suffix(".py")) if file.is_file()), None)


_register(COMPILE, _SO_FAR)
