"""BM25: how well documents fit a query by the words that they share."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence

__all__ = ["scores", "words"]

_K1 = 1.2
"""How soon further occurrences of a word stop counting."""
_B = 0.75
"""How much long documents are discounted."""
_WORD = re.compile(r"[^\W\d_]+")
_SILENT = (
    "a an and are as at be by each every for from has have in into is it its not of on one or so than that the their "
    "them then they this to up use want which who with without you i me my make"
)
_STOP = frozenset(_SILENT.split())


def words(text: str) -> list[str]:
    """The words of a text in lower case, plural endings removed, without words that say nothing."""
    return [_stem(word) for word in _WORD.findall(text.lower()) if word not in _STOP and len(word) > 1]


def scores(query: str, documents: Sequence[str]) -> list[float]:
    """The score of each document for a query.

    References:
        Robertson, Zaragoza: The Probabilistic Relevance Framework: BM25 and Beyond (2009).
    """
    counts = [Counter(words(document)) for document in documents]
    lengths = [sum(count.values()) for count in counts]
    mean = sum(lengths) / max(1, len(lengths)) or 1.0
    wanted = Counter(words(query))
    found = [0.0] * len(documents)
    for word in wanted:
        holding = sum(word in count for count in counts)
        rarity = math.log(1 + (len(documents) - holding + 0.5) / (holding + 0.5))
        for i, count in enumerate(counts):
            often = count[word]
            found[i] += rarity * often * (_K1 + 1) / (often + _K1 * (1 - _B + _B * lengths[i] / mean))
    return found


def _stem(word: str) -> str:
    for ending, short in (
        ("ies", "y"),
        ("xes", "x"),
        ("sses", "ss"),
        ("ches", "ch"),
        ("ing", ""),
        ("ss", "ss"),
        ("s", ""),
    ):
        if word.endswith(ending) and len(word) - len(ending) >= 2:
            return word[: -len(ending)] + short
    return word
