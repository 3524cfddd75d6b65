"""What went wrong with messages from outside: counted, said once for each reason, and summed up at the end."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable

from irsim.common.text import clean

__all__ = ["Reports"]

_MAX_KINDS = 100
"""Reasons that are told apart; what a peer sends must not fill the memory."""


def _print(text: str) -> None:
    print(text, file=sys.stderr)


class Reports:
    """Counts problems of messages.

    Args:
        name: Name of the bridge.
        say: Shows a line; default: on standard error.

    Attributes:
        counts: Topic and problem -> how often it occurred.
        heard: What the other program has said -> how often.
    """

    def __init__(self, name: str, say: Callable[[str], None] = _print) -> None:
        self.counts: Counter[tuple[str, str]] = Counter()
        self.heard: Counter[str] = Counter()
        self._name, self._say = name, say

    def add(self, topic: str, problem: str) -> None:
        """Count a problem; the first one of each kind is shown."""
        key = (topic, clean(problem, 200))
        if key not in self.counts:
            if len(self.counts) >= _MAX_KINDS:
                key = ("", "further problems")
            self._say(f"{self._name}: {topic}: {key[1]}; the message is ignored")
        self.counts[key] += 1

    def hear(self, sentence: str) -> None:
        """Count what the other program says; the first time it is shown."""
        text = clean(sentence, 300)
        if text not in self.heard:
            if len(self.heard) >= _MAX_KINDS:
                return
            self._say(f"{self._name}: {text}")
        self.heard[text] += 1

    def finish(self) -> None:
        """Say how often repeated problems occurred."""
        for (topic, problem), count in self.counts.items():
            if count > 1:
                self._say(f"{self._name}: {topic}: {count} times: {problem}")
