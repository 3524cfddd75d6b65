"""A reader of pickles that imports nothing and calls nothing.

Classes and functions stay names, and objects of foreign classes become :class:`Stored`, which does nothing. Only
dictionaries, lists, numbers and texts are made, and the tensors of PyTorch are described (:class:`Tensor`).
"""

from __future__ import annotations

import pickletools
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import IO, Any

from irsim.common.records import ContentError

__all__ = ["MAX_OPERATIONS", "Name", "Storage", "Stored", "Tensor", "read_pickle"]

MAX_OPERATIONS = 1_000_000
"""Largest number of operations of a pickle."""
_MAX_KEY = 16
"""Largest number of items of a tuple that is a key."""
_BROKEN = (ValueError, IndexError, KeyError, TypeError, OverflowError, MemoryError, EOFError, RecursionError)
"""Errors of :mod:`pickletools` and of operations on a stack on broken pickles."""


@dataclass(frozen=True, eq=False)
class Name:
    """A class or a function that a pickle names; it is never looked up."""

    module: str
    name: str

    def __str__(self) -> str:
        return f"{self.module}.{self.name}"


@dataclass(eq=False)
class Stored:
    """An object of a foreign class, as a pickle describes it.

    Attributes:
        kind: Its class, or the function that would make it.
        state: Its attributes.
        entries: Its items, if it is a mapping.
    """

    kind: Name
    state: Any = None
    entries: dict[Any, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Storage:
    """Numbers in another place of the file.

    Attributes:
        kind: Type of the numbers, such as ``FloatStorage``.
        key: Where they are.
        count: Number of them.
        offset: First one that counts, of those at ``key``.
    """

    kind: str
    key: str
    count: int
    offset: int = 0


@dataclass(frozen=True, eq=False)
class Tensor:
    """A tensor that refers to a storage.

    Attributes:
        storage: Its numbers.
        offset: First one.
        size: Sides, as the pickle has them.
        stride: Steps along each side, as the pickle has them.
    """

    storage: Storage
    offset: Any
    size: Any
    stride: Any


def read_pickle(stream: IO[bytes], storages: dict[str, str] | None = None) -> Any:
    """The object of the pickle at the position of a stream, which is then behind its end.

    Args:
        stream: The stream.
        storages: Filled with the type of each storage that the pickle refers to, by its key.

    Raises:
        ContentError: It is broken, too long, or uses what files of PyTorch do not use.
    """
    machine = _Machine({} if storages is None else storages)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about escape sequences of broken texts
            for count, (operation, argument, _) in enumerate(pickletools.genops(stream)):
                if count > MAX_OPERATIONS:
                    raise ContentError(f"a pickle has more than {MAX_OPERATIONS:,} operations")
                if operation.name == "STOP":
                    return machine.stack.pop()
                machine.run(operation.name, argument)
    except ContentError:
        raise
    except _BROKEN as error:
        raise ContentError(f"a pickle is broken ({type(error).__name__})") from None
    raise ContentError("a pickle has no end")


class _Machine:
    """The stack and the memo of a pickle."""

    def __init__(self, storages: dict[str, str]) -> None:
        self.stack: list[Any] = []
        self._storages = storages
        self._outer: list[list[Any]] = []
        self._memo: dict[int, Any] = {}

    def run(self, name: str, argument: Any) -> None:
        """One operation."""
        if name in _CONSTANTS:
            self.stack.append(_CONSTANTS[name])
        elif name in _LITERALS:
            self.stack.append(argument)
        elif name in _MADE:
            self.stack.append(_MADE[name]())
        elif name in _TUPLES:
            self._tuple(_TUPLES[name])
        elif name in ("GET", "BINGET", "LONG_BINGET"):
            self.stack.append(self._memo[int(argument)])
        elif name in ("PUT", "BINPUT", "LONG_BINPUT"):
            self._memo[int(argument)] = self.stack[-1]
        elif name not in _NOTHING:
            act = _ACTS.get(name)
            if act is None:
                raise ContentError(f"a pickle uses the operation {name}, which files of PyTorch do not")
            act(self, argument)

    def _tuple(self, size: int) -> None:
        items = tuple(self.stack[-size:])
        if len(items) != size:
            raise ContentError("a pickle is broken (too few items)")
        del self.stack[-size:]
        self.stack.append(items)

    def _mark(self, _: Any) -> None:
        self._outer.append(self.stack)
        self.stack = []

    def _marked(self) -> list[Any]:
        items, self.stack = self.stack, self._outer.pop()
        return items

    def _marked_tuple(self, _: Any) -> None:
        items = self._marked()
        self.stack.append(tuple(items))

    def _marked_list(self, _: Any) -> None:
        items = self._marked()
        self.stack.append(items)

    def _marked_dict(self, _: Any) -> None:
        items = self._marked()
        self.stack.append({})
        self._put(items)

    def _pop(self, _: Any) -> None:
        if self.stack:
            self.stack.pop()
        else:
            self._marked()

    def _pop_mark(self, _: Any) -> None:
        self._marked()

    def _duplicate(self, _: Any) -> None:
        self.stack.append(self.stack[-1])

    def _memoize(self, _: Any) -> None:
        self._memo[len(self._memo)] = self.stack[-1]

    def _append(self, _: Any) -> None:
        item = self.stack.pop()
        self._extend([item])

    def _appends(self, _: Any) -> None:
        self._extend(self._marked())

    def _extend(self, items: list[Any]) -> None:
        if isinstance(self.stack[-1], list):
            self.stack[-1].extend(items)
        elif not isinstance(self.stack[-1], Stored):  # items of a foreign list are never looked at
            raise ContentError("a pickle appends to something that is not a list")

    def _set_item(self, _: Any) -> None:
        value, key = self.stack.pop(), self.stack.pop()
        self._put([key, value])

    def _set_items(self, _: Any) -> None:
        self._put(self._marked())

    def _put(self, items: list[Any]) -> None:
        target = self.stack[-1].entries if isinstance(self.stack[-1], Stored) else self.stack[-1]
        if not isinstance(target, dict) or len(items) % 2:
            raise ContentError("a pickle sets items of something that is not a dictionary")
        for key, value in zip(items[::2], items[1::2], strict=True):
            target[_key(key)] = value

    def _global(self, argument: Any) -> None:
        module, _, name = str(argument).partition(" ")
        self.stack.append(Name(module, name))

    def _stack_global(self, _: Any) -> None:
        name, module = self.stack.pop(), self.stack.pop()
        if not (isinstance(name, str) and isinstance(module, str)):
            raise ContentError("a pickle names a class without text")
        self.stack.append(Name(module, name))

    def _reduce(self, _: Any) -> None:
        arguments, function = self.stack.pop(), self.stack.pop()
        self.stack.append(_described(function, arguments))

    def _new_object(self, _: Any) -> None:
        self.stack.pop()
        self.stack.append(Stored(_name(self.stack.pop())))

    def _new_object_with_keys(self, _: Any) -> None:
        self.stack.pop()
        self._new_object(None)

    def _build(self, _: Any) -> None:
        state = self.stack.pop()
        if isinstance(self.stack[-1], Stored):
            self.stack[-1].state = state
        elif not isinstance(self.stack[-1], (dict, Tensor)):  # what these have besides is never looked at
            raise ContentError("a pickle gives attributes to something without attributes")

    def _persistent(self, _: Any) -> None:
        result = _from_elsewhere(self.stack.pop())
        self.stack.append(result)
        if isinstance(result, Storage) and self._storages.setdefault(result.key, result.kind) != result.kind:
            raise ContentError("a storage has two types")


def _key(key: Any) -> Any:
    """The key of an item; hashing nested tuples could take forever."""
    simple = (str, int, float, bytes, type(None), Name)
    items = key if isinstance(key, tuple) and len(key) <= _MAX_KEY else (key,)
    if not all(isinstance(item, simple) for item in items):
        raise ContentError("a pickle has a dictionary with other keys than numbers and texts")
    return key


def _name(value: Any) -> Name:
    if not isinstance(value, Name):
        raise ContentError("a pickle makes an object of something that is not a class")
    return value


def _described(function: Any, arguments: Any) -> Any:
    """The result that a function would return, as far as it is known here; nothing is called."""
    name = _name(function)
    if not isinstance(arguments, tuple):
        raise ContentError("a pickle calls a function without a tuple of arguments")
    what = str(name)
    if what in ("torch._utils._rebuild_tensor_v2", "torch._utils._rebuild_tensor"):
        if len(arguments) < 4 or not isinstance(arguments[0], Storage):
            raise ContentError("a tensor has no storage")
        return Tensor(*arguments[:4])
    if what in ("torch._utils._rebuild_parameter", "torch._utils._rebuild_parameter_with_state"):
        if not arguments or not isinstance(arguments[0], Tensor):
            raise ContentError("a parameter is not a tensor")
        return arguments[0]
    if what == "collections.OrderedDict":
        return _ordered(arguments)
    return Stored(name)


def _ordered(arguments: tuple[Any, ...]) -> dict[Any, Any]:
    result: dict[Any, Any] = {}
    for pair in arguments[0] if arguments and isinstance(arguments[0], list) else ():
        if not (isinstance(pair, (list, tuple)) and len(pair) == 2):
            raise ContentError("an ordered dictionary is made of something else than pairs")
        result[_key(pair[0])] = pair[1]
    return result


def _from_elsewhere(place: Any) -> Any:
    """A storage, or the class of a module whose source text was saved with it."""
    if isinstance(place, tuple) and len(place) >= 2 and place[0] == "module":
        return _name(place[1])
    if not (isinstance(place, tuple) and len(place) in (5, 6) and place[0] == "storage"):
        raise ContentError("a pickle refers to something that is not a storage")
    kind, key, count = _name(place[1]), place[2], place[4]
    if not isinstance(key, (str, int)) or not isinstance(count, int) or not 0 <= count < 2**62:
        raise ContentError("a storage has no key or no size")
    offset = 0
    if len(place) == 6 and place[5] is not None:
        view = place[5]
        if not (
            isinstance(view, tuple) and len(view) == 3 and all(isinstance(n, int) and 0 <= n < 2**62 for n in view[1:])
        ):
            raise ContentError("a view of a storage has no place")
        offset, count = view[1], view[2]
    return Storage(kind.name, str(key)[:200], count, offset)


_CONSTANTS = {"NONE": None, "NEWTRUE": True, "NEWFALSE": False}
_LITERALS = frozenset({
    "INT", "BININT", "BININT1", "BININT2", "LONG", "LONG1", "LONG4", "FLOAT", "BINFLOAT", "STRING", "BINSTRING",
    "SHORT_BINSTRING", "UNICODE", "BINUNICODE", "SHORT_BINUNICODE", "BINUNICODE8", "BINBYTES", "SHORT_BINBYTES",
    "BINBYTES8", "BYTEARRAY8",
})  # fmt: skip
_MADE: dict[str, Callable[[], Any]] = {
    "EMPTY_TUPLE": tuple, "EMPTY_LIST": list, "EMPTY_DICT": dict, "EMPTY_SET": list,
}  # fmt: skip
_TUPLES = {"TUPLE1": 1, "TUPLE2": 2, "TUPLE3": 3}
_NOTHING = frozenset({"PROTO", "FRAME"})
_ACTS: dict[str, Callable[[_Machine, Any], None]] = {
    "MARK": _Machine._mark, "TUPLE": _Machine._marked_tuple, "LIST": _Machine._marked_list,
    "FROZENSET": _Machine._marked_list, "DICT": _Machine._marked_dict, "POP": _Machine._pop,
    "POP_MARK": _Machine._pop_mark, "DUP": _Machine._duplicate, "MEMOIZE": _Machine._memoize,
    "APPEND": _Machine._append, "APPENDS": _Machine._appends, "ADDITEMS": _Machine._appends,
    "SETITEM": _Machine._set_item, "SETITEMS": _Machine._set_items, "GLOBAL": _Machine._global,
    "STACK_GLOBAL": _Machine._stack_global, "REDUCE": _Machine._reduce, "NEWOBJ": _Machine._new_object,
    "NEWOBJ_EX": _Machine._new_object_with_keys, "BUILD": _Machine._build, "BINPERSID": _Machine._persistent,
}  # fmt: skip
