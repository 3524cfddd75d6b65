"""Equal questions at the same time are answered by one piece of work, whose answer is kept."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import anyio
from mcp.server.mcpserver.exceptions import ToolError

__all__ = ["Once"]

_MOST = 100
"""Number of answers that are kept."""
Answer = TypeVar("Answer")


@dataclass
class _Work(Generic[Answer]):
    """Work under way; it ends with an answer, with an error, or, if its call was cancelled, with neither."""

    done: anyio.Event = field(default_factory=anyio.Event)
    answers: list[Answer] = field(default_factory=list)
    error: ToolError | None = None


class Once(Generic[Answer]):
    """Answers that do not change while the server runs; errors are told to all who wait, and not kept."""

    def __init__(self) -> None:
        self._known: dict[str, Answer] = {}
        self._under_way: dict[str, _Work[Answer]] = {}

    async def get(self, question: str, work: Callable[[], Awaitable[Answer]]) -> Answer:
        """The answer to a question.

        Args:
            question: The question, as one text.
            work: Finds the answer.

        Raises:
            ToolError: There is no answer.
        """
        while question not in self._known:
            other = self._under_way.get(question)
            if other is None:
                return await self._find(question, work)
            await other.done.wait()
            if other.error is not None:
                raise ToolError(str(other.error))
            if other.answers:
                return other.answers[0]
        return self._known[question]

    async def _find(self, question: str, work: Callable[[], Awaitable[Answer]]) -> Answer:
        mine = self._under_way[question] = _Work[Answer]()
        try:
            answer = await work()
        except ToolError as error:
            mine.error = error
            raise
        finally:
            del self._under_way[question]
            mine.done.set()
        mine.answers.append(answer)
        if len(self._known) >= _MOST:
            del self._known[next(iter(self._known))]
        self._known[question] = answer
        return answer
