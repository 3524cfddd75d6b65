"""Read-only attributes that a plain function computes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

__all__ = ["computed"]

Value = TypeVar("Value")


class computed(property, Generic[Value]):
    """A read-only attribute whose value a function computes from the instance: ``robot = computed(queries.robot)``.

    It is a :class:`property` whose type is that of the function, so that type checkers and editors know it.
    """

    if TYPE_CHECKING:

        def __init__(self, fget: Callable[[Any], Value]) -> None: ...

        @overload
        def __get__(self, instance: None, owner: type | None = None) -> computed[Value]: ...

        @overload
        def __get__(self, instance: Any, owner: type | None = None) -> Value: ...

        def __get__(self, instance: Any, owner: type | None = None) -> Any: ...
