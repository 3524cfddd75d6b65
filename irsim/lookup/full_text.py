"""Full-text search: which documents fit some words best."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

__all__ = ["Document", "best", "words_of"]

_MOST = 5
_LEAST_SHARE = 0.4
"""Documents that fit less than this share of the best one are not shown."""
_HEAD = 3
"""How many times a word in the heads counts."""
_PREFIX = 0.5
"""How much a word counts that only begins with the one wanted."""
_SHORTEST = 4
"""Letters that a beginning of words has."""
_SATURATION, _LENGTH = 1.2, 0.75
_EMPTY = re.compile(
    "a|about|an|and|any|are|as|at|be|by|can|cannot|do|does|for|from|get|has|have|how|i|if|in|into|is|it|its|make|me|my|"
    "no|not|of|on|or|should|so|something|than|that|the|their|them|there|this|to|use|using|want|what|when|where|which|"
    "who|why|will|with|without"
)
"""Words that say nothing."""


class Document(NamedTuple):
    """Something that can be found."""

    name: str
    heads: str
    """Names, titles and key words, which count more."""
    text: str


def best(documents: Sequence[Document], query: str) -> tuple[list[str], list[str]]:
    """The few documents that fit a query best, ranked by Okapi BM25 (Robertson, Zaragoza 2009).

    A word of the query also fits words that begin with it. Documents with more of the words come first.

    Returns:
        Names, best first, and the words of the query that are in no document.
    """
    wanted = list(dict.fromkeys(word for word in words_of(query) if not _EMPTY.fullmatch(word))) or words_of(query)
    counts = [Counter(words_of(document.text)) for document in documents]
    for document, count in zip(documents, counts, strict=True):
        for word in words_of(document.heads):
            count[word] += _HEAD
    mean = sum(count.total() for count in counts) / max(len(counts), 1)
    scores, matched = [0.0] * len(counts), [0] * len(counts)
    unknown = []
    for word in wanted:
        often = [_times(word, count) for count in counts]
        holding = sum(times > 0 for times in often)
        if not holding:
            unknown.append(word)
        rarity = math.log(1 + (len(counts) - holding + 0.5) / (holding + 0.5))
        for k, times in enumerate(often):
            if times:
                size = 1 - _LENGTH + _LENGTH * counts[k].total() / mean
                scores[k] += rarity * times * (_SATURATION + 1) / (times + _SATURATION * size)
                matched[k] += 1
    scores = [score * found / max(len(wanted), 1) for score, found in zip(scores, matched, strict=True)]
    order = sorted(range(len(scores)), key=lambda k: -scores[k])[:_MOST]
    return [documents[k].name for k in order if scores[k] > 0 and scores[k] >= _LEAST_SHARE * scores[order[0]]], unknown


def words_of(text: str) -> list[str]:
    """Lower case, without the s of the plural; parts of names with _ and - are words of their own."""
    return [
        word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word
        for word in re.findall(r"[^\W_]+(?:'[^\W_]+)*", text.lower())
    ]


def _times(word: str, count: Counter[str]) -> float:
    if word in count:
        return float(count[word])
    if len(word) < _SHORTEST:
        return 0.0
    return _PREFIX * sum(times for other, times in count.items() if other.startswith(word))
