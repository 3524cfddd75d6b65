"""Full-text search: ranks documents by how well they match the words of a query."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Container, Iterable, Sequence
from typing import NamedTuple

__all__ = ["STOP_WORDS", "Document", "best", "bm25", "has_all", "telling_words", "words_of"]

MAX_RESULTS = 5
"""Largest number of documents in a result."""
MIN_SCORE_SHARE = 0.4
"""Documents with a lower score than this share of the best score are left out."""
_HEAD_WEIGHT = 3
"""Number of times that a word in the heads of a document counts."""
_PREFIX_WEIGHT = 0.5
"""Weight of a word that only begins with a word of the query."""
MIN_PREFIX_LETTERS = 4
"""Shorter words of a query match whole words only."""
_SATURATION = 1.2
"""Parameter k1 of Okapi BM25."""
_LENGTH_WEIGHT = 0.75
"""Parameter b of Okapi BM25."""
MIN_PLURAL_LETTERS = 4
"""Shorter words keep a final s."""


def _singular(word: str) -> str:
    return word[:-1] if len(word) >= MIN_PLURAL_LETTERS and word.endswith("s") and not word.endswith("ss") else word


STOP_WORDS = frozenset(
    _singular(word)
    for word in (
        "a", "about", "an", "and", "any", "are", "as", "at", "be", "by", "can", "cannot", "do", "does", "for", "from",
        "get", "has", "have", "how", "i", "if", "in", "into", "is", "it", "its", "make", "me", "my", "no", "not", "of",
        "on", "or", "should", "so", "something", "than", "that", "the", "their", "them", "there", "this", "to", "use",
        "using", "want", "what", "when", "where", "which", "who", "why", "will", "with", "without",
    )
)  # fmt: skip
"""Words of a query that are ignored, because they do not identify a topic, as :func:`words_of` returns them."""


class Document(NamedTuple):
    """A document that the search can find."""

    name: str
    heads: str
    """Names, titles and keywords, which count more than the text."""
    text: str


def best(documents: Sequence[Document], query: str) -> tuple[list[str], list[str]]:
    """Find the documents that match a query best.

    A word of the query also matches words that begin with it. Documents that match more words of the query come first.

    Returns:
        Names of the documents, best first, and the words of the query that occur in no document.
    """
    wanted = telling_words(query)
    counts = [_counts(document) for document in documents]
    frequencies = {word: [_frequency(word, count) for count in counts] for word in wanted}
    scores = bm25(frequencies.values(), [count.total() for count in counts])
    matched = [sum(times[k] > 0 for times in frequencies.values()) for k in range(len(counts))]
    unknown = [word for word, times in frequencies.items() if not any(times)]
    scores = [score * hits / max(len(wanted), 1) for score, hits in zip(scores, matched, strict=True)]
    order = sorted(range(len(scores)), key=lambda k: -scores[k])[:MAX_RESULTS]
    shown = [k for k in order if scores[k] > 0 and scores[k] >= MIN_SCORE_SHARE * scores[order[0]]]
    return [documents[k].name for k in shown], unknown


def bm25(frequencies: Iterable[Sequence[float]], sizes: Sequence[int]) -> list[float]:
    """Score documents by Okapi BM25.

    Args:
        frequencies: For each word of a query, how often each document has it.
        sizes: Number of words of each document.

    References:
        Robertson, Zaragoza: The Probabilistic Relevance Framework: BM25 and Beyond (2009).
    """
    mean = sum(sizes) / max(len(sizes), 1)
    scores = [0.0] * len(sizes)
    for times in frequencies:
        matching = sum(value > 0 for value in times)
        rarity = math.log(1 + (len(sizes) - matching + 0.5) / (matching + 0.5))
        for k, value in enumerate(times):
            if value:
                size = 1 - _LENGTH_WEIGHT + _LENGTH_WEIGHT * sizes[k] / mean
                scores[k] += rarity * value * (_SATURATION + 1) / (value + _SATURATION * size)
    return scores


def has_all(document: Document, query: str) -> bool:
    """Whether every word of a query that identifies a topic occurs in a document."""
    counts = _counts(document)
    return all(_frequency(word, counts) for word in telling_words(query))


def telling_words(query: str) -> list[str]:
    """Return the words of a query that identify a topic, or all of them if none does."""
    meaningful = list(dict.fromkeys(words_of(query, STOP_WORDS)))
    return meaningful or words_of(query)


def _counts(document: Document) -> Counter[str]:
    counts = Counter(words_of(document.text))
    for word in words_of(document.heads):
        counts[word] += _HEAD_WEIGHT
    return counts


def words_of(text: str, stop_words: Container[str] = ()) -> list[str]:
    """Split a text into words: lower case, without the s of a plural, names split at _ and -.

    Args:
        text: The text.
        stop_words: Words that are left out.
    """
    words = map(_singular, re.findall(r"[^\W_]+(?:'[^\W_]+)*", text.lower()))
    return [word for word in words if word not in stop_words]


def _frequency(word: str, count: Counter[str]) -> float:
    if word in count:
        return float(count[word])
    if len(word) < MIN_PREFIX_LETTERS:
        return 0.0
    return _PREFIX_WEIGHT * sum(times for other, times in count.items() if other.startswith(word))
