"""From what someone typed to an :class:`Answer`."""

from __future__ import annotations

import difflib
import functools
import re
from collections.abc import Sequence

from irsim.bundled import templates
from irsim.bundled.templates import Template
from irsim.common.text import clean
from irsim.compat import DIFFERENCES
from irsim.diagnostics.codes import CODES, TOOL_CODES, Code
from irsim.diagnostics.examples import EXAMPLES
from irsim.lookup import full_text
from irsim.lookup.answer import Answer, Key, TopicError
from irsim.lookup.examples import example_of
from irsim.lookup.guides import GUIDES
from irsim.lookup.metrics import METRIC_TOPICS, all_metrics, metric_answer, metric_line, metric_topic
from irsim.lookup.schema_walk import (
    COLOR,
    Node,
    alternatives,
    component_name,
    components,
    definitions_of,
    key,
    mappings,
    paths,
    step,
    yaml_text,
)
from irsim.lookup.synonyms import EVERYDAY, named
from irsim.options.registry import REGISTRIES, Registry
from irsim.scenario.model.json_schema import json_schema

__all__ = ["lookup", "schema_part"]

_PLACES = {
    "behavior": ("robot", "behavior"),
    "distribution": ("robot", "distribution"),
    "kinematics": ("robot", "kinematics"),
    "map": ("world", "obstacle_map"),
    "planner": ("robot", "behavior", "follow", "planner"),
    "sensor": ("robot", "sensors"),
    "shape": ("robot", "shape"),
}
"""Where components of a kind stand in a scenario."""
_MOST_NAMESAKES = 20
_MOST_HITS, _MOST_CALLED = 5, 3
"""Lines of a search, and how many of them at most are there for their everyday names."""
_NEAR = 0.8
"""How similar a name must be to be suggested, or to end a search."""
_MOST_CHOICES = 12
"""Longer lists of allowed words (colours) are no topics."""


def lookup(topic: str = "", *, schema: Node | None = None) -> Answer:
    """What is known about a topic.

    Args:
        topic: A path (``robot.sensors.lidar2d.range_max``), a component (``behavior rvo``, ``rvo``), a kind of
            component (``sensors``), a key, a template, a metric, a code, or a word to search for; empty for an index.
        schema: That of the language, if it is at hand; making it is most of the work.

    Raises:
        TopicError: Nothing goes by that name; the message names similar topics.
    """
    words = _words(topic)
    name = " ".join(words)
    if not topic.strip():
        return _index()
    lists = {"codes": _codes, "guides": _guides, "metric": all_metrics, "metrics": all_metrics, "templates": _templates}
    if name in lists:
        return lists[name]()
    metric = _metric_named(words)
    if metric is not None:
        answer = metric_answer(metric)
        return answer.model_copy(update={"see": [*answer.see, *named(name)]}) if name.isalpha() else answer
    if topic.strip() in _all_codes():
        return _code(topic.strip())
    if name in templates.names():
        return _template(templates.load(name))
    if topic.strip() in DIFFERENCES:
        return _difference(topic.strip())
    schema = json_schema() if schema is None else schema
    found = _find(schema, words) if words else None
    if found:
        return _part(schema, *found)
    guide = next((known for known, guide in GUIDES.items() if topic.strip().lower() in (known, *guide.words)), None)
    if guide is not None:
        asked = f"metric {name}"
        return _guide(guide, ([asked] if asked in METRIC_TOPICS else []) + named(topic)[:_MOST_HITS])
    return _search(schema, topic.strip(), words or topic.split())


def schema_part(topic: str) -> Node:
    """The JSON Schema of a part of the language, with all definitions it refers to.

    Args:
        topic: As :func:`lookup` takes it: ``robot``, ``world.plot``, ``sensors.lidar2d``, ``behavior``; empty for all.

    Raises:
        TopicError: No part of the language goes by that name.
    """
    words, schema = _words(topic), json_schema()
    if not words:
        return schema
    found = _find(schema, words)
    if found is None:
        raise TopicError(" ".join(words), _near(_topics(schema), words))
    path, nodes = found
    body = nodes[0] if len(nodes) == 1 else {"anyOf": nodes}
    return {"$schema": schema["$schema"], "title": ".".join(path), **body, "$defs": definitions_of(schema, body)}


def _words(topic: str) -> list[str]:
    return [word for word in re.split(r"[\s.\[\]:]+", topic.strip()) if word and not word.isdigit()]


def _metric_named(words: list[str]) -> str | None:
    """The topic of a metric that is asked for as ``spl``, ``metric spl`` or ``metrics.spl``."""
    key = words[1] if len(words) == 2 and words[0] in ("metric", "metrics") else None
    topic = metric_topic(key) if key is not None else " ".join(words)
    return topic if topic in METRIC_TOPICS else None


def _find(schema: Node, words: list[str]) -> tuple[tuple[str, ...], list[Node]] | None:
    """The part of the language that the words name."""
    for path in _readings(schema, tuple(words)):
        nodes = [schema]
        for word in path:
            nodes = step(schema, nodes, word)
        if nodes:
            return path, nodes
    return None


def _readings(schema: Node, words: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Paths that the words may stand for, the most literal first."""
    found = [words, ("robot", *words), ("world", *words)]
    kind = _kind(words[0])
    if kind is not None:
        found += [(*_PLACES[kind], *words[1:])]
    for place, registry in ((_PLACES[registry.kind], registry) for registry in REGISTRIES.values()):
        if words[0] in registry.names():
            found.append((*place, *words))
    if len(words) == 1:
        same = [path for path, _ in paths(schema) if path[-1] == words[0]]
        if len({path[1:] for path in same}) == 1:  # robots and obstacles have the same keys
            found += same
    return found


def _kind(word: str) -> str | None:
    singular = word[:-1] if word.endswith("s") and word[:-1] in REGISTRIES else word
    return singular if singular in REGISTRIES else None


def _part(schema: Node, path: tuple[str, ...], nodes: list[Node]) -> Answer:
    node = nodes[0]
    about = key(schema, path[-1], node)
    names = components(schema, node)
    registry, feature_name = _registry_of(path)
    if len(names) > 1 and registry is not None and not feature_name:
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
            text += f" Brought by {feature.origin}."
    return Answer(
        topic=".".join(path),
        kind="component" if feature_name else "key",
        title=title,
        text=text,
        about=None if feature_name or path in (("world",), ("robot",), ("obstacle",)) else about,
        groups=groups,
        example=example_of(path, feature_name) or _bare_example(path, node, feature_name),
        see=_related(path, registry, feature_name),
    )


def _keys(schema: Node, node: Node, siblings: list[Node]) -> dict[str, list[Key]]:
    """The keys of a mapping; those it has in common with all its siblings come last."""
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
    """The keys of each component that may be chosen; those of all come last."""
    found = {name: _keys(schema, option, list(names.values())) for name, option in names.items()}
    own = {f"keys of {name}": groups["keys"] for name, groups in found.items()}
    return {**own, "keys of all": next(iter(found.values()))["keys it has in common with the others"]}


def _siblings(schema: Node, path: tuple[str, ...]) -> list[Node]:
    """The components one may choose instead."""
    nodes = [schema]
    for word in path[:-1]:
        nodes = step(schema, nodes, word)
    return [option for node in nodes for option in components(schema, node).values()]


def _registry_of(path: tuple[str, ...]) -> tuple[Registry | None, str | None]:
    """The registry a path leads into, and the component if it names one."""
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


def _bare_example(path: tuple[str, ...], node: Node, name: str | None) -> str | None:
    """A component by its name alone, if it needs no other key."""
    if name is None or set(node.get("required", [])) - {"name"}:
        return None
    return f"{path[-2]}: [{{name: {name}}}]" if path[-2] == "sensors" else f"{path[-2]}: {{name: {name}}}"


def _related(path: tuple[str, ...], registry: Registry | None, name: str | None) -> list[str]:
    if registry is not None and name is not None:
        return [".".join(path[:-1]), *(f"{registry.kind} {other}" for other in registry.names() if other != name)][:6]
    return [".".join(path[:-1])] if len(path) > 1 else []


def _search(schema: Node, topic: str, words: list[str]) -> Answer:
    """Several keys of one name, else what fits the words best."""
    wanted = " ".join(words).lower()
    keys = [(_hit(path, node), node) for path, node in paths(schema) if path[0] != "obstacle"]  # robots have the same
    keys.sort(key=lambda found: len(found[0].name))
    same = [hit for hit, _ in keys if _last(hit) == wanted]
    if same:
        return _hits(wanted, same[:_MOST_NAMESAKES], f"{len(same)} keys are called '{clean(wanted)}'")
    code = next(
        (name for name in _all_codes() if sorted(name.split("-")) == sorted(re.split(r"[\s_-]+", wanted))), None
    )
    if code is not None:
        return _code(code)
    topics, (documents, lines) = _topics(schema), _documents(schema, keys)
    metrics = [full_text.Document(name, f"{m.key} metric", m.text) for name, m in METRIC_TOPICS.items()]
    lines |= {name: Key(name=name, text=metric_line(metric)) for name, metric in METRIC_TOPICS.items()}
    found, unknown = full_text.best(documents, topic)
    if not found or not full_text.best(metrics, topic)[1]:  # metrics are meant only by words of theirs
        found, unknown = full_text.best(documents + metrics, topic)
    called = named(topic)
    unknown = [word for word in unknown if not any(word in full_text.words_of(EVERYDAY[name]) for name in called)]
    if not (called or found) or (unknown and difflib.get_close_matches(".".join(words), topics, 1, _NEAR)):
        raise TopicError(topic, _near(topics, words))
    lines |= {name: _line_of(schema, name) for name in called}
    hits = [lines[name] for name in dict.fromkeys([*called[:_MOST_CALLED], *found])][:_MOST_HITS]
    return _hits(
        wanted,
        hits,
        f"{len(hits)} topics fit '{clean(wanted)}' best" if len(hits) > 1 else f"About '{clean(wanted)}'",
        unknown,
    )


def _hits(wanted: str, hits: list[Key], title: str, unknown: Sequence[str] = ()) -> Answer:
    text = f"Nothing about {', '.join(map(repr, map(clean, unknown)))}." if unknown else ""
    return Answer(topic=clean(wanted), kind="search", title=title, text=text, groups={"topics": hits})


def _documents(schema: Node, keys: list[tuple[Key, Node]]) -> tuple[list[full_text.Document], dict[str, Key]]:
    """All that can be searched, and the line that is shown of each."""
    documents, lines = [], {}

    def add(name: str, line: str, heads: str, text: str) -> None:
        documents.append(full_text.Document(name, heads, text))
        lines[name] = Key(name=name, text=_one_sentence(line))

    for name, guide in GUIDES.items():
        add(name, guide.title, f"{name} {guide.title} {' '.join(guide.words)}", guide.text)
    for template in templates.load_all():
        add(
            template.name,
            template.purpose,
            f"{template.name} {template.title} {' '.join(template.tags)}",
            template.purpose,
        )
    for name, code in _all_codes().items():
        add(name, code.title, f"{name} {code.title}", code.explanation)
    known: set[tuple[str, str]] = set()
    for hit, node in keys:
        if (_last(hit), hit.text) not in known:
            known.add((_last(hit), hit.text))
            choices = " ".join(map(str, _choices(schema, node)))
            add(hit.name, hit.text, _last(hit), f"{hit.text} {choices} {hit.name}")
    return documents, lines


def _one_sentence(text: str) -> str:
    return re.split(r"(?<=[.])\s", text, maxsplit=1)[0]


def _choices(schema: Node, node: Node) -> list[object]:
    """Words a key takes, where there are few."""
    values = [value for option in alternatives(schema, node) for value in option.get("enum", [])]
    return values if len(values) <= _MOST_CHOICES else []


def _hit(path: tuple[str, ...], node: Node) -> Key:
    return Key(name=".".join(path), text=" ".join(str(node.get("description", "")).split()))


def _line_of(schema: Node, name: str) -> Key:
    """What is shown of a guide, or of a path of the language, whether or not another path has the same text."""
    if name in GUIDES:
        return Key(name=name, text=GUIDES[name].title)
    [node, *_] = functools.reduce(lambda nodes, word: step(schema, nodes, word), name.split("."), [schema])
    return Key(name=name, text=_one_sentence(_hit((), node).text))


def _last(hit: Key) -> str:
    return hit.name.rpartition(".")[2].lower()


def _near(topics: set[str], words: list[str]) -> list[str]:
    """Topics with similar names: the wrong word of a path mended, or the nearest of all names."""
    near = difflib.get_close_matches(".".join(words), topics, 3, _NEAR)
    if not near:
        by_last: dict[str, str] = {}
        for topic in sorted(topics, key=len):
            by_last.setdefault(topic.rpartition(".")[2], topic)
        near = [by_last[name] for name in difflib.get_close_matches(words[-1], by_last, 3, 0.75)]
    return near


def _topics(schema: Node) -> set[str]:
    """The names of everything there is."""
    return {
        *(".".join(path) for path, _ in paths(schema)),
        *_all_codes(),
        *templates.names(),
        *GUIDES,
        *METRIC_TOPICS,
        *(f"{r.kind}.{n}" for r in REGISTRIES.values() for n in r.names()),
    }


def _index() -> Answer:
    schema = json_schema()
    language = max(mappings(schema, schema), key=lambda option: len(option["properties"]))
    sections = Key(name="scenario", text=", ".join(language["properties"]))
    kinds = [Key(name=kind, text=_overview(registry)) for kind, registry in sorted(REGISTRIES.items())]
    return Answer(
        topic="",
        kind="index",
        title="What irsim describe knows",
        groups={
            "the scenario and its components": [sections, *kinds],
            "templates": [Key(name="templates", text=", ".join(templates.names()))],
            "more": [
                Key(name="guides", text=", ".join(GUIDES)),
                Key(name="metrics", text=f"the {len(METRIC_TOPICS)} numbers that tell how good an episode was"),
                Key(name="codes", text=f"the {len(_all_codes())} codes of errors and warnings"),
            ],
        },
        example="irsim describe robot.sensors.lidar2d",
    )


def _overview(registry: Registry) -> str:
    """The names of a kind of component, those that are not simulated last."""
    features = registry.features()
    later = [feature.name for feature in features if not feature.simulated]
    names = [", ".join(feature.name for feature in features if feature.simulated)]
    names += [f"not simulated yet: {', '.join(later)}"] if later else []
    return "; ".join(part for part in names if part)


def _guides() -> Answer:
    lines = [Key(name=name, text=guide.title) for name, guide in GUIDES.items()]
    return Answer(topic="guides", kind="index", title="Guides", groups={"guides": lines})


def _guide(name: str, see: list[str]) -> Answer:
    guide = GUIDES[name]
    title = f"{name}: {guide.title}"
    return Answer(topic=name, kind="guide", title=title, text=guide.text, example=guide.example, see=see)


def _difference(name: str) -> Answer:
    one = DIFFERENCES[name]
    text = f"IR-SIM 2.12: {one.theirs}. irsim: {one.ours}. Why: {one.why}."
    return Answer(topic=name, kind="guide", title=f"{name}: an intended difference from IR-SIM 2.12", text=text)


def _code(name: str) -> Answer:
    code = _all_codes()[name]
    example = None
    if name in EXAMPLES:
        wrong, right = EXAMPLES[name]
        example = "\n".join([f"# not  {line}" for line in wrong.splitlines()] + right.splitlines())
    return Answer(
        topic=name, kind="code", title=f"{name}: {code.title}", text=code.explanation, example=example, see=["codes"]
    )


def _all_codes() -> dict[str, Code]:
    return {**CODES, **TOOL_CODES}


def _codes() -> Answer:
    lines = [Key(name=name, text=code.title) for name, code in _all_codes().items()]
    return Answer(topic="codes", kind="index", title="Codes of errors and warnings", groups={"codes": lines})


def _templates() -> Answer:
    lines = [Key(name=template.name, text=template.purpose) for template in templates.load_all()]
    return Answer(topic="templates", kind="index", title="Templates", groups={"templates": lines})


def _template(template: Template) -> Answer:
    keys = [
        Key(
            name=name,
            type="a name" if parameter.choices else "",
            unit=parameter.unit,
            default=yaml_text(parameter.default),
            allowed=parameter.allowed(),
            text=parameter.description,
        )
        for name, parameter in template.parameters.items()
    ]
    first = keys[0] if keys else None
    setting = f" --set {first.name}={first.default}" if first else ""
    return Answer(
        topic=template.name,
        kind="template",
        title=f"template {template.name}: {template.title}",
        text=f"{template.purpose} With the default parameters it ends in {' or '.join(template.outcomes)}.",
        groups={"parameters": keys},
        example=f"irsim new {template.name}{setting}",
        see=["templates"],
    )
