"""The objects of an environment as a list; changes of the list change the world."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NoReturn

from irsim.objects.view import ObjectView

__all__ = ["ObjectList"]


class ObjectList(list[ObjectView]):
    """The present objects of an environment.

    ``append`` calls ``env.add_object``, and ``remove`` calls ``env.delete_object``.

    Args:
        env: The environment.
    """

    def __init__(self, env: Any) -> None:
        super().__init__(env._objects)
        self._env = env

    def _reread(self) -> None:
        super().__init__(self._env._objects)

    def append(self, obj: ObjectView) -> None:
        """Put an object into the world."""
        self.extend([obj])

    def extend(self, objs: Iterable[ObjectView]) -> None:
        """Put objects into the world; if one is not valid, none is added."""
        self._env.add_objects(objs)
        self._reread()

    def __iadd__(self, objs: Iterable[ObjectView]) -> ObjectList:  # type: ignore[misc,override]
        self.extend(objs)
        return self

    def remove(self, obj: ObjectView) -> None:
        """Take an object out of the world.

        Raises:
            ValueError: The object is not in the world.
        """
        del self[self.index(obj)]

    def pop(self, index: Any = -1) -> ObjectView:
        """Take the object at an index out of the world and return it; it remains usable."""
        found: ObjectView = self[index]
        del self[index]
        return found

    def clear(self) -> None:
        """Take all objects out of the world."""
        del self[:]

    def __delitem__(self, index: Any) -> None:
        chosen = self[index] if isinstance(index, slice) else [self[index]]
        self._env.delete_objects([view.id for view in chosen])
        self._reread()

    def _refused(self, *args: Any, **kwargs: Any) -> NoReturn:
        raise TypeError("the order of `env.objects` is that of the world: objects can only be appended or removed")

    insert = sort = reverse = __setitem__ = __imul__ = _refused

    def __reduce__(self) -> Any:
        return list, (list(self),)
