"""Turns the name of a topic into an :class:`Answer`: parts of the language here, others in `index` and `search`."""

from __future__ import annotations

import re

from irsim.benchmarks.suite import SUITES, WRITTEN_SUITES
from irsim.bundled import templates
from irsim.common.event_kinds import EVENTS
from irsim.common.json_output import schema_of_file
from irsim.compat import DIFFERENCES
from irsim.diagnostics.errors import InputError
from irsim.lookup.answer import Answer, Key, TopicError
from irsim.lookup.full_text import words_of
from irsim.lookup.index import (
    all_codes,
    code_answer,
    codes_answer,
    difference_answer,
    differences_answer,
    event_answer,
    events_answer,
    guide_answer,
    guides_answer,
    index_answer,
    template_answer,
    templates_answer,
)
from irsim.lookup.language import language_schema
from irsim.lookup.metrics import METRIC_TOPICS, all_metrics, metric_answer, metric_topic, task_answer
from irsim.lookup.policies import (
    advice_among_people,
    convert_answer,
    policies_answer,
    policy_answer,
    suite_answer,
    suite_key_answer,
    suites_answer,
)
from irsim.lookup.schema_walk import COLOR, Node, component_name, components, definitions_of, key, mappings, paths, step
from irsim.lookup.search import (
    MAX_HITS,
    all_topics,
    mended_text,
    near_topics,
    nearest_name,
    nearest_topic,
    search_answer,
)
from irsim.lookup.shared_keys import every_name, meanings
from irsim.lookup.small_examples import BETTER, example_of, small_example
from irsim.lookup.synonyms import named
from irsim.lookup.things import ALL_GUIDES, THINGS
from irsim.lookup.units import unit_answer
from irsim.options.registry import REGISTRIES, Registry
from irsim.scenario.model.json_schema import json_schema

__all__ = ["MAX_TOPICS", "lookup", "lookup_several", "schema_part", "topics_of"]


_PLACES = {
    "behavior": ("robot", "behavior"),
    "bridge": ("bridges",),
    "distribution": ("robot", "distribution"),
    "kinematics": ("robot", "kinematics"),
    "map": ("world", "obstacle_map"),
    "planner": ("robot", "behavior", "follow", "planner"),
    "sensor": ("robot", "sensors"),
    "shape": ("robot", "shape"),
}
"""Path of each kind of component in a scenario."""


def lookup(topic: str = "", *, schema: Node | None = None) -> Answer:
    """Return the answer to a topic.

    Args:
        topic: A path (``robot.sensors.lidar2d.range_max``), a component (``behavior rvo``, ``rvo``), a kind of
            component (``sensors``), a key, a template, a metric, a code, or a word to search for; empty for an index.
            A misspelt word gives the answer to the name that is clearly nearest.
        schema: JSON Schema of the language, if the caller has another one.

    Raises:
        TopicError: No topic has that name; the message names similar ones.
    """
    words = _words(topic)
    name = " ".join(words)
    if not topic.strip():
        return index_answer()
    lists = {
        "2.12": differences_answer,
        "codes": codes_answer,
        "differences": differences_answer,
        "events": events_answer,
        "guides": guides_answer,
        "ir-sim": differences_answer,
        "metric": all_metrics,
        "metrics": all_metrics,
        "policies": policies_answer,
        "policy": policies_answer,
        "suite": suites_answer,
        "suites": suites_answer,
        "template": templates_answer,
        "templates": templates_answer,
    }
    if (listed := next((word for word in (name.lower(), topic.strip()) if word in lists), None)) is not None:
        return lists[listed]()
    metric = _metric_named(words)
    if metric is not None:
        answer = metric_answer(metric)
        return answer.model_copy(update={"see": [*answer.see, *named(name)]}) if name.isalpha() else answer
    if topic.strip() in all_codes():
        return code_answer(topic.strip())
    if name in templates.names():
        return template_answer(templates.load(name))
    if topic.strip() in (*SUITES.names(), *WRITTEN_SUITES):
        return suite_answer(topic.strip())
    if words[:1] == ["suites"] and (found_key := suite_key_answer(words[1:])) is not None:
        return found_key
    if words[:1] == ["convert"] and (found_kind := convert_answer(" ".join(words[1:]))) is not None:
        return found_kind
    if words[:1] == ["policy"] and (found_policy := policy_answer(" ".join(words[1:]))) is not None:
        return found_policy
    if words[:1] in (["task"], ["tasks"]) and (found_task := task_answer(words[1:])) is not None:
        return found_task
    if topic.strip() in DIFFERENCES:
        return difference_answer(topic.strip())
    schema = language_schema() if schema is None else schema
    match = _find(schema, words) if words else None
    if match:
        return _part(schema, *match)
    if (in_units := unit_answer(topic)) is not None:
        return in_units
    guide = _guide_called(topic)
    if guide is not None:
        asked = f"metric {name}"
        return guide_answer(guide, ([asked] if asked in METRIC_TOPICS else []) + named(topic)[:MAX_HITS])
    if name in EVENTS:
        return event_answer(name)
    policy = policy_answer(topic)
    if policy is not None:
        return policy
    component = _component_called(topic)
    if component is not None:
        return lookup(component, schema=schema)
    try:
        hits = search_answer(schema, topic.strip(), words or topic.split(), lambda hit: lookup(hit, schema=schema))
    except TopicError as error:
        nearest = nearest_name(schema, topic.strip()) if len(topic.split()) == 1 else None
        nearest = nearest or nearest_topic(error.near, words)
        if nearest is None:
            raise
        return _neighbour(schema, nearest)
    mended = mended_text(schema, topic, hits.unknown)
    return hits if mended is None else _neighbour(schema, mended)


def _neighbour(schema: Node, name: str) -> Answer:
    """The answer to a question that was misspelt: of a search, the topic that it finds first."""
    answer = lookup(name, schema=schema)
    if answer.best is not None:
        others = [key.name for keys in answer.groups.values() for key in keys][1:]
        answer = answer.best.model_copy(update={"see": list(dict.fromkeys([*answer.best.see, *others]))})
    return answer.model_copy(update={"read_as": name})


def schema_part(topic: str) -> Node:
    """Return the JSON Schema of a part of the language, with all definitions it refers to.

    Args:
        topic: As in :func:`lookup`: ``robot``, ``world.plot``, ``sensors.lidar2d``, ``behavior``; empty for all.

    Raises:
        TopicError: No part of the language has that name.
    """
    words, schema = _words(topic), json_schema()
    if not words:
        return schema
    match = _find(schema, words)
    if match is None:
        raise TopicError(" ".join(words), near_topics(all_topics(schema), words))
    path, nodes = match
    body = nodes[0] if len(nodes) == 1 else {"anyOf": nodes}
    return schema_of_file({"title": ".".join(path), **body, "$defs": definitions_of(schema, body)})


def _words(topic: str) -> list[str]:
    return [word for word in re.split(r"[\s.\[\]:]+", topic.strip()) if word and not word.isdigit()]


def _metric_named(words: list[str]) -> str | None:
    """Find the topic of a metric that is requested as ``spl``, ``metric spl`` or ``metrics.spl``."""
    key = words[1] if len(words) == 2 and words[0] in ("metric", "metrics") else None
    topic = metric_topic(key) if key is not None else " ".join(words)
    return topic if topic in METRIC_TOPICS else None


def _component_called(topic: str) -> str | None:
    """Find the component whose name begins with a topic that is an everyday name of no other: ``fmcw lidar``."""
    called, start = named(topic), "_".join(words_of(topic))
    name = called[0].rpartition(".")[2] if len(called) == 1 else ""
    known = name.startswith(start) and any(name in registry.names() for registry in REGISTRIES.values())
    return called[0] if known else None


def _guide_called(topic: str) -> str | None:
    """Find the guide that has a topic among its words; the plurals of things count, too."""
    asked, singular = topic.strip().lower(), words_of(topic)
    exact = (name for name, guide in ALL_GUIDES.items() if asked in (name, *guide.words))
    alike = (name for name, thing in THINGS.items() if singular in map(words_of, (name, *thing.words)))
    return next(exact, None) or next(alike, None)


def _find(schema: Node, words: list[str]) -> tuple[tuple[str, ...], list[Node]] | None:
    """Find the part of the language that the words name."""
    for path in _readings(schema, tuple(words)):
        nodes = [schema]
        for word in path:
            nodes = step(schema, nodes, word)
        if nodes:
            return path, nodes
    return None


def _readings(schema: Node, words: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Return the paths that the words may mean, the most literal first."""
    readings = [words, ("robot", *words), ("world", *words)]
    kind = _kind(words[0])
    if kind is not None:
        readings += [(*_PLACES[kind], *words[1:])]
    for place, registry in ((_PLACES[registry.kind], registry) for registry in REGISTRIES.values()):
        if words[0] in registry.names():
            readings.append((*place, *words))
    if len(words) == 1:
        same = [path for path, _ in paths(schema) if path[-1] == words[0] and path[0] != "bridges"]
        if len({path[1:] for path in same}) == 1:  # robots and obstacles have the same keys
            readings += same
    return readings


def _kind(word: str) -> str | None:
    singular = word[:-1] if word.endswith("s") and word[:-1] in REGISTRIES else word
    return singular if singular in REGISTRIES else None


def _part(schema: Node, path: tuple[str, ...], nodes: list[Node]) -> Answer:
    node = nodes[0]
    about = every_name(schema, path) or key(schema, path[-1], node)
    names, several = components(schema, node), meanings(schema, path)
    registry, feature_name = _registry_of(path)
    if several:
        about, groups = Key(name=path[-1]), {"meanings": several}
    elif len(names) > 1 and registry is not None and not feature_name:
        groups = {f"{registry.kind}, one of": [_component_line(registry, name) for name in names]}
    elif len(names) > 1 and not feature_name:
        groups = _keys_by_component(schema, names)
    else:
        groups = _keys(schema, node, _siblings(schema, path) if feature_name and registry is not None else [])
    text, title = about.text + (f" {COLOR}" if about.type.startswith("a color") else ""), ".".join(path)
    if registry is not None and feature_name:
        title = f"{registry.kind} {feature_name}"
        feature = registry.get(feature_name)
        if feature is not None and not feature.simulated:
            text += " Part of the language, but not simulated by this version."
        if feature is not None and feature.origin != "built-in":
            text += f" Provided by {feature.origin}."
        if registry.kind == "behavior" and (advice := advice_among_people(feature_name)):
            text += f" {advice}"
    return Answer(
        topic=".".join(path),
        kind="component" if feature_name else "key",
        title=title,
        text=text,
        about=None if several or feature_name or path in (("world",), ("robot",), ("obstacle",)) else about,
        groups=groups,
        example=_example(schema, path, node, feature_name),
        see=_related(path, registry, feature_name),
    )


def _keys(schema: Node, node: Node, siblings: list[Node]) -> dict[str, list[Key]]:
    """Return the keys of a mapping; keys that all its siblings have come last."""
    common = set.intersection(*(set(option["properties"]) for option in siblings)) if len(siblings) > 1 else set()
    own: dict[str, Key] = {}
    shared: dict[str, Key] = {}
    for option in mappings(schema, node):
        required = option.get("required", [])
        for name, child in option["properties"].items():
            if name != "name" or component_name(option) is None:
                (shared if name in common else own).setdefault(name, key(schema, name, child, name in required))
    return {"keys": list(own.values()), "keys it has in common with the others": list(shared.values())}


def _keys_by_component(schema: Node, names: dict[str, Node]) -> dict[str, list[Key]]:
    """Return the keys of each component that may be chosen; keys of all components come last."""
    keys = {name: _keys(schema, option, list(names.values())) for name, option in names.items()}
    own = {f"keys of {name}": groups["keys"] for name, groups in keys.items()}
    return {**own, "keys of all": next(iter(keys.values()))["keys it has in common with the others"]}


def _siblings(schema: Node, path: tuple[str, ...]) -> list[Node]:
    """Return the components that may be chosen instead."""
    nodes = [schema]
    for word in path[:-1]:
        nodes = step(schema, nodes, word)
    return [option for node in nodes for option in components(schema, node).values()]


def _registry_of(path: tuple[str, ...]) -> tuple[Registry | None, str | None]:
    """Return the registry that a path leads into, and the component if the path names one."""
    for kind, place in _PLACES.items():
        section = ("obstacle", *place[1:]) if place[0] == "robot" else place
        for start in (place, section):
            if path == start:
                return REGISTRIES[kind], None
            if path[:-1] == start and path[-1] in REGISTRIES[kind].names():
                return REGISTRIES[kind], path[-1]
    return None, None


def _component_line(registry: Registry, name: str) -> Key:
    feature = registry.get(name)
    doc = " ".join((feature.options.__doc__ or "").split()) if feature is not None else ""
    later = "" if feature is None or feature.simulated else " (not simulated yet)"
    return Key(name=name, text=doc + later)


def _example(schema: Node, path: tuple[str, ...], node: Node, name: str | None) -> str | None:
    """Return YAML for a part of the language: from a template, or made of values that say what the key is for."""
    small = None if name else small_example(schema, path)
    if small is not None and path[-1] in BETTER:
        return small
    return example_of(path, name) or small or _bare_example(path, node, name)


def _bare_example(path: tuple[str, ...], node: Node, name: str | None) -> str | None:
    """Write a component with its name alone, if it needs no other key."""
    if name is None or set(node.get("required", [])) - {"name"}:
        return None
    return f"{path[-2]}: [{{name: {name}}}]" if path[-2] in ("sensors", "bridges") else f"{path[-2]}: {{name: {name}}}"


def _related(path: tuple[str, ...], registry: Registry | None, name: str | None) -> list[str]:
    if registry is not None and name is not None:
        return [".".join(path[:-1]), *(f"{registry.kind} {other}" for other in registry.names() if other != name)][:6]
    return [".".join(path[:-1])] if len(path) > 1 else []


MAX_TOPICS = 12
"""Number of topics that one question may have."""


def topics_of(text: str) -> list[str]:
    """Return the topics of a question: the parts between commas, semicolons and line breaks, without empty ones.

    A part of several names, such as ``crowd lidar2d``, is several topics unless it is one as it stands.
    """
    parts = (part.strip() for part in re.split(r"[,;\n]", text))
    return list(dict.fromkeys(topic for part in parts if part for topic in _names_in(part)))


def _names_in(part: str) -> list[str]:
    """The names of which a part of a question consists; the part itself if it has another word, or is a topic."""
    words = part.split()
    written = [word for word in words if not word.isalpha()]  # no words of a sentence
    if len(words) < 2 or not (written or set(words) <= set(templates.names())):
        return [part]
    schema = language_schema()
    names = all_topics(schema)
    if not set(words) <= {*names, *(name.rpartition(".")[2] for name in names)}:
        return [part]
    try:
        whole = lookup(part, schema=schema).kind != "search"
    except TopicError:
        whole = False
    return [part] if whole else words


def lookup_several(topics: list[str]) -> list[Answer | TopicError]:
    """Answer several topics; the error of a topic that is not known stands in its place.

    Args:
        topics: At most :data:`MAX_TOPICS`, as in :func:`irsim.lookup.lookup`.

    Raises:
        InputError: There are too many topics.
        TopicError: None of the topics is known.
    """
    if len(topics) > MAX_TOPICS:
        raise InputError(f"{len(topics)} topics are too many", f"ask for at most {MAX_TOPICS} at once")
    schema, answers = language_schema(), list[Answer | TopicError]()
    for topic in topics:
        try:
            answers.append(lookup(topic, schema=schema))
        except TopicError as error:
            answers.append(error)
    if all(isinstance(one, TopicError) for one in answers):
        raise next(one for one in answers if isinstance(one, TopicError))
    return answers
