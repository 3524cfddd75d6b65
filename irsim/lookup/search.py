"""Answers to free text: the keys of one name, otherwise the topics whose names and texts fit the words best."""

from __future__ import annotations

import difflib
import functools
import re
from collections.abc import Callable, Sequence

from irsim.bundled import templates
from irsim.common.text import clean
from irsim.learning.tasks.files import TASKS
from irsim.lookup import full_text
from irsim.lookup.answer import Answer, Key, TopicError, first_sentence
from irsim.lookup.index import all_codes, code_answer, template_answer
from irsim.lookup.metrics import METRIC_TOPICS, metric_line
from irsim.lookup.schema_walk import Node, alternatives, paths, step
from irsim.lookup.shared_keys import same_key_of
from irsim.lookup.sizes import without_sizes
from irsim.lookup.small_examples import example_of
from irsim.lookup.synonyms import EVERYDAY, named
from irsim.lookup.things import ALL_GUIDES
from irsim.options.registry import REGISTRIES, reading_order

__all__ = ["MAX_HITS", "all_topics", "mended_text", "near_topics", "nearest_name", "nearest_topic", "search_answer"]

MAX_HITS = 5
"""Topics that a search shows."""
_MAX_EVERYDAY = 3
"""Topics among them that are found by their everyday names."""
_MAX_NAMESAKES = 20
"""Keys of one name that are shown."""
_MIN_LIKENESS = 0.8
"""Similarity (0 to 1) from which on a name is suggested, or ends a search."""
_MIN_SIMILAR = 0.75
"""Similarity from which on a topic that is the only similar one is taken for what was meant."""
_MIN_LEAD = 0.03
"""Similarity by which the nearest name must be nearer than the next."""
_MAX_CHOICES = 12
"""Number of allowed words up to which they can be searched; longer lists (colours) cannot."""


def search_answer(schema: Node, topic: str, words: list[str], explain: Callable[[str], Answer]) -> Answer:
    """Answer free text: with all keys of that name if there are any, otherwise with what fits the words best.

    Topics that are called by all words come first, then a guide that has all words, then topics called by some of them.

    Args:
        schema: JSON Schema of the language.
        topic: The text.
        words: Its words.
        explain: Returns the answer to the name of a topic.

    Raises:
        TopicError: Nothing fits, or a name is so similar that the text is probably a misspelling of it.
    """
    wanted = " ".join(words).lower()
    keys = [(_hit(path, node), node) for path, node in paths(schema) if _is_searched(path)]
    keys.sort(key=lambda match: reading_order(match[0].name))
    same = [hit for hit, _ in keys if _last(hit) == wanted]
    if same:
        return _namesakes_answer(clean(wanted), same)
    code = next((name for name in all_codes() if sorted(name.split("-")) == sorted(re.split(r"[\s_-]+", wanted))), None)
    if code is not None:
        return code_answer(code)
    query = without_sizes(topic)
    topics, (documents, lines) = all_topics(schema), _documents(schema, keys)
    metrics = [full_text.Document(name, f"{m.key} metric", m.text) for name, m in METRIC_TOPICS.items()]
    lines |= {name: Key(name=name, text=metric_line(metric)) for name, metric in METRIC_TOPICS.items()}
    names, unknown = full_text.best(documents, query)
    if not names or not full_text.best(metrics, query)[1]:  # without a word of their own, metrics are not meant
        names, unknown = full_text.best(documents + metrics, query)
    called = named(topic)
    unknown = [word for word in unknown if not any(word in full_text.words_of(EVERYDAY[name]) for name in called)]
    of_bridges = [] if called else [_hit(path, node) for path, node in paths(schema) if path[-1].lower() == wanted]
    if of_bridges:
        return explain(of_bridges[0].name) if len(of_bridges) == 1 else _namesakes_answer(clean(wanted), of_bridges)
    if not (called or names) or (unknown and difflib.get_close_matches(".".join(words), topics, 1, _MIN_LIKENESS)):
        raise TopicError(topic, near_topics(topics, words))
    lines |= {name: _line_of(schema, name) for name in called}
    guides = {document.name: document for document in documents if document.name in ALL_GUIDES}
    whole = [name for name in names if name in guides and full_text.has_all(guides[name], query)]
    first = [] if _is_named_whole(topic, called) else whole[:1]
    hits = [lines[name] for name in dict.fromkeys([*first, *called[:_MAX_EVERYDAY], *names])][:MAX_HITS]
    said = clean(" ".join(topic.lower().split()))
    title = f"{len(hits)} topics fit '{said}' best" if len(hits) > 1 else f"About '{said}'"
    top = hits[0].name
    best = template_answer(templates.load(top), topic) if top in templates.names() else explain(top)
    return _hits_answer(said, hits, title, unknown).model_copy(update={"best": best})


def _is_searched(path: tuple[str, ...]) -> bool:
    """Whether free text may mean a key: robots have the keys of obstacles, and few mean the keys of a single bridge."""
    return path[0] != "obstacle" and (path[0] != "bridges" or len(path) == 2)


def _is_named_whole(topic: str, called: Sequence[str]) -> bool:
    """Whether a text has the telling words of an everyday name of a topic, and no others."""
    words = full_text.telling_words(topic)
    return any(words == full_text.telling_words(name) for one in called for name in EVERYDAY[one].split(", "))


def _namesakes_answer(wanted: str, same: list[Key]) -> Answer:
    """Answer with the keys of one name: one line for each meaning, and the example of the first."""
    meanings: dict[str, list[str]] = {}
    for hit in same:
        meanings.setdefault(hit.text, []).append(hit.name)
    lines, examples = [], []
    for text, names in meanings.items():
        used = {name: example_of(tuple(name.split("."))) for name in names}
        known = [name for name in names if used[name] and name.startswith("robot.")]
        first = next((name for name in names if name in EVERYDAY), next(iter(known), names[0]))
        lines.append(Key(name=first, text=f"{text}{same_key_of(first, names)}"))
        examples += [example for example in [used[first]] if example]
    count = f"{len(lines)} meanings, {len(same)} places" if len(lines) > 1 else f"{len(same)} places"
    return Answer(
        topic=wanted,
        kind="search",
        title=f"key '{wanted}': {count}",
        groups={"topics": lines[:_MAX_NAMESAKES]},
        example=examples[0] if examples else None,
    )


def _hits_answer(wanted: str, hits: list[Key], title: str, unknown: Sequence[str] = ()) -> Answer:
    text = f"Nothing about {', '.join(map(repr, map(clean, unknown)))}." if unknown else ""
    return Answer(
        topic=clean(wanted), kind="search", title=title, text=text, groups={"topics": hits}, unknown=list(unknown)
    )


def _documents(schema: Node, keys: list[tuple[Key, Node]]) -> tuple[list[full_text.Document], dict[str, Key]]:
    """Return everything that can be searched, and the line that is shown of each."""
    documents, lines = [], {}

    def add(name: str, line: str, heads: str, text: str) -> None:
        documents.append(full_text.Document(name, heads, text))
        lines[name] = Key(name=name, text=first_sentence(line))

    for name, guide in ALL_GUIDES.items():
        add(name, guide.title, f"{name} {guide.title} {' '.join(guide.words)}", guide.text)
    for template in templates.load_all():
        add(
            template.name,
            template.purpose,
            f"{template.name} {template.title} {' '.join(template.tags)}",
            template.purpose,
        )
    for name, code in all_codes().items():
        add(name, code.title, f"{name} {code.title}", code.explanation)
    known: set[tuple[str, str]] = set()
    for hit, node in keys:
        if (_last(hit), hit.text) not in known:
            known.add((_last(hit), hit.text))
            choices = " ".join(map(str, _choices(schema, node)))
            add(hit.name, hit.text, _last(hit), f"{hit.text} {choices} {hit.name}")
    return documents, lines


def _choices(schema: Node, node: Node) -> list[object]:
    """Return the allowed words of a key; none if they are many."""
    values = [value for option in alternatives(schema, node) for value in option.get("enum", [])]
    return values if len(values) <= _MAX_CHOICES else []


def _hit(path: tuple[str, ...], node: Node) -> Key:
    return Key(name=".".join(path), text=" ".join(str(node.get("description", "")).split()))


def _line_of(schema: Node, name: str) -> Key:
    """Return the line of a code, a guide, a template or a path, even if another path has the same text."""
    if name in all_codes():
        return Key(name=name, text=all_codes()[name].title)
    if name in ALL_GUIDES:
        return Key(name=name, text=ALL_GUIDES[name].title)
    if name in templates.names():
        return Key(name=name, text=first_sentence(templates.load(name).purpose))
    [node, *_] = functools.reduce(lambda nodes, word: step(schema, nodes, word), name.split("."), [schema])
    return Key(name=name, text=first_sentence(_hit((), node).text))


def _last(hit: Key) -> str:
    return hit.name.rpartition(".")[2].lower()


def near_topics(topics: set[str], words: list[str]) -> list[str]:
    """Return topics with similar names: paths with one word corrected, otherwise the most similar last words."""
    near = difflib.get_close_matches(".".join(words), topics, 3, _MIN_LIKENESS)
    if not near:
        by_last: dict[str, str] = {}
        for topic in sorted(topics, key=len):
            by_last.setdefault(topic.rpartition(".")[2], topic)
        near = [by_last[name] for name in difflib.get_close_matches(words[-1], by_last, 3, 0.75)]
    return near


def nearest_name(schema: Node, word: str) -> str | None:
    """Return the name or everyday word that a misspelt word is clearly nearest to; None without such a name."""
    words = {word for guide in ALL_GUIDES.values() for word in guide.words}
    words |= {name for names in EVERYDAY.values() for name in names.split(", ")}
    names = {name for name in words if name.isalpha()} | {re.split(r"[. ]", name)[-1] for name in all_topics(schema)}
    near = difflib.get_close_matches(word.lower(), sorted(names), 2, _MIN_LIKENESS)
    likeness = [difflib.SequenceMatcher(None, name, word.lower()).ratio() for name in near]
    clear = len(near) == 1 or (len(near) == 2 and likeness[0] - likeness[1] >= _MIN_LEAD)
    return near[0] if clear else None


def nearest_topic(near: Sequence[str], words: Sequence[str]) -> str | None:
    """Return the first of some similar topics, if it is clearly nearer to the words than the second."""
    spelt = ((name, ".".join(words)) for name in near[:2])
    pairs = (((name, text), (name.rpartition(".")[2], text)) for name, text in spelt)
    likeness = [max(difflib.SequenceMatcher(None, *pair).ratio() for pair in both) for both in pairs]
    clear = near and likeness[0] >= _MIN_SIMILAR and (len(near) == 1 or likeness[0] - likeness[1] >= _MIN_LEAD)
    return near[0] if clear else None


def mended_text(schema: Node, topic: str, unknown: Sequence[str]) -> str | None:
    """Return a text with the nearest name in place of each unknown word; None if a word has no such name."""
    mended = [
        nearest_name(schema, word) if set(full_text.words_of(word)) & set(unknown) else word for word in topic.split()
    ]
    return " ".join(filter(None, mended)) if unknown and all(mended) and mended != topic.split() else None


def all_topics(schema: Node) -> set[str]:
    """Return the names of all topics."""
    return {
        *(".".join(path) for path, _ in paths(schema)),
        *all_codes(),
        *templates.names(),
        *ALL_GUIDES,
        *METRIC_TOPICS,
        *("task", "policies", "suites"),
        *(f"task.{name}" for name in TASKS.names()),
        *(f"{r.kind}.{n}" for r in REGISTRIES.values() for n in r.names()),
    }
