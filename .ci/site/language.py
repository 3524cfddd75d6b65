"""Reference of the scenario language: keys, components, codes, metrics, events, things, policies and tasks."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from answers import keys_table, section
from pages import Page, anchor, contents, link, plain

from irsim.bundled import templates
from irsim.common.event_kinds import EVENTS
from irsim.compat import DIFFERENCES
from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.lookup import Answer, lookup
from irsim.lookup.language import language_schema
from irsim.lookup.metrics import METRIC_TOPICS
from irsim.lookup.schema_walk import mappings, paths
from irsim.lookup.things import ALL_GUIDES
from irsim.options.registry import REGISTRIES
from irsim_mcp.reference import explanation

__all__ = ["PLACES", "language_pages", "policy_names", "schema_anchor", "task_names", "whereabouts"]

PLACES = {
    "behavior": ("robot", "behavior"),
    "kinematics": ("robot", "kinematics"),
    "shape": ("robot", "shape"),
    "sensor": ("robot", "sensors"),
    "distribution": ("robot", "distribution"),
    "map": ("world", "obstacle_map"),
    "planner": ("robot", "behavior", "follow", "planner"),
    "bridge": ("bridges",),
}
"""Kind of component -> its path in a scenario."""
_KINDS = {
    "behavior": "Behaviors",
    "kinematics": "Drives",
    "shape": "Shapes",
    "sensor": "Sensors",
    "distribution": "Distributions",
    "map": "Maps",
    "planner": "Planners",
    "bridge": "Bridges as keys",
}
_PICTURES = {
    ("behavior", "orca"): "circle-swap",
    ("behavior", "rvo"): "crowd",
    ("behavior", "sfm"): "room-evacuation",
    ("behavior", "dash"): "crossing",
    ("behavior", "follow"): "warehouse",
    ("behavior", "replay"): "recorded-crowd",
    ("kinematics", "acker"): "car-park",
    ("sensor", "lidar2d"): "lidar-explorer",
    ("sensor", "fmcw_lidar2d"): "fmcw-watch",
    ("sensor", "contact2d"): "box-pushing",
}
"""Templates that come first where several have the component."""


@cache
def _answer(topic: str) -> Answer:
    return lookup(topic)


@cache
def _mappings() -> tuple[tuple[str, ...], ...]:
    """Paths of the language that lead to mappings; obstacles, groups and local behaviors repeat keys."""
    schema = language_schema()
    return tuple(
        path
        for path, node in paths(schema)
        if path[0] != "obstacle" and not {"group_behavior", "local"} & set(path) and mappings(schema, node)
    )


def _component_of(path: tuple[str, ...]) -> tuple[str, str, tuple[str, ...]] | None:
    """Kind, name and rest of a path that leads into a component; the innermost one counts."""
    result = None
    for kind, place in PLACES.items():
        size = len(place)
        if path[:size] == place and len(path) > size and path[size] in REGISTRIES[kind].names():
            result = (kind, path[size], path[size + 1 :])
    return result


def schema_anchor(path: tuple[str, ...]) -> str:
    """Page and anchor of a path of the language, such as ``reference/behavior/rvo#behavior.rvo.mode``."""
    if path[0] == "obstacle":
        path = ("robot", *path[1:])
    path = tuple("behavior" if word == "group_behavior" else word for word in path)
    if "local" in path[:-1]:
        path = ("robot", "behavior", *path[path.index("local") + 1 :])
    if path[:4] == ("robot", "shape", "compound", "parts") and path[-1] == "pose":
        return "reference/shape/compound#shape.compound.parts.pose"
    if path[:4] == ("robot", "shape", "compound", "parts") and len(path) > 4:
        path = ("robot", "shape", *path[4:])
    component = _component_of(path)
    if component is None:
        page = {"world": "world", "robot": "robot", "bridges": "bridge/index"}.get(path[0], "sections")
        return f"reference/{page}#{'.'.join(path)}"
    kind, name, rest = component
    return f"reference/{kind}/{name}#{'.'.join((kind, name, *rest))}"


@cache
def policy_names() -> tuple[str, ...]:
    """Topics of the policies that ship with irsim, without the behaviors."""
    listed = [key.name for key in _answer("policies").groups["policies"]]
    return tuple(name for name in listed if name not in REGISTRIES["behavior"].names())


@cache
def task_names() -> tuple[str, ...]:
    """Topics of bundled tasks."""
    return tuple(key.name for key in _answer("tasks").groups["bundled tasks"])


def whereabouts() -> dict[str, str]:
    """Topic -> page, with an anchor where the page is about several topics."""
    where = {name: f"gallery/{name}" for name in templates.names()}
    where |= {"templates": "gallery/index", "codes": "reference/codes", "metrics": "reference/metrics"}
    where |= {"events": "reference/events", "guides": "reference/things", "policies": "reference/policies"}
    where |= {"suites": "suites/index", "tasks": "reference/tasks"}
    where |= {name: f"reference/codes#{name}" for name in (*CODES, *TOOL_CODES)}
    where |= {name: f"reference/metrics#{name}" for name in METRIC_TOPICS}
    where |= {name: f"reference/events#{name}" for name in EVENTS}
    where |= {name: f"reference/things#{name}" for name in ALL_GUIDES}
    where |= {f"policy {name}": f"reference/policies#{name}" for name in policy_names()}
    where |= {name: f"reference/tasks#{name}" for name in task_names()}
    where |= {name: f"irsim/compat/README#{name}" for name in DIFFERENCES}
    for kind, registry in REGISTRIES.items():
        where[".".join(PLACES[kind])] = f"reference/{kind}/index"
        for name in registry.names():
            for topic in (f"{kind} {name}", f"{kind}.{name}", ".".join((*PLACES[kind], name))):
                where[topic] = f"reference/{kind}/{name}"
    for path in _mappings():
        where.setdefault(".".join(path), schema_anchor(path))
    return where


def language_pages(where: dict[str, str]) -> Iterator[Page]:
    """All pages of the reference that ``irsim describe`` answers."""
    yield from _sections(where)
    for kind in PLACES:
        yield from _kind(kind, where)
    codes = {"Findings about a scenario": tuple(CODES), "Errors of commands and tools": tuple(TOOL_CODES)}
    yield _topics("reference/codes", "Codes", "codes", codes, where)
    yield _topics("reference/metrics", "Metrics", "metrics", {"": tuple(METRIC_TOPICS)}, where)
    yield _topics("reference/events", "Events", "events", {"": tuple(EVENTS)}, where)
    yield _topics("reference/things", "How to write it", "guides", {"": tuple(ALL_GUIDES)}, where)
    policies = tuple(f"policy {name}" for name in policy_names())
    yield _topics("reference/policies", "Policies", "policies", {"": policies}, where)
    yield _topics("reference/tasks", "Tasks for learning", "tasks", {"": task_names()}, where)


def _sections(where: dict[str, str]) -> Iterator[Page]:
    titles = {
        "world": ("World", ("world",)),
        "robot": ("Robots and obstacles", ("robot",)),
        "sections": ("Other sections", ("gui", "custom", "irsim")),
    }
    for start, (title, sections) in titles.items():
        page = f"reference/{start}"
        inside = [".".join(path) for path in _mappings() if path[0] in sections and _component_of(path) is None]
        own = [*inside, *(one for one in sections if one not in inside)]
        parts = [f"# {title}"]
        if start == "robot":
            parts.append("Entries of `robot:` and of `obstacle:` take the same keys.")
        kinds = {".".join(place) for place in PLACES.values()}
        shown = [topic for topic in own if topic not in kinds]
        parts += [section(_answer(topic), page, topic, where, title=f"`{topic}`") for topic in shown]
        yield Page(page, "\n\n".join(parts), _twin(title, shown), title, f"Keys of {', '.join(sections)}.")


def _kind(kind: str, where: dict[str, str]) -> Iterator[Page]:
    place, registry = ".".join(PLACES[kind]), REGISTRIES[kind]
    answer, page, title = _answer(place), f"reference/{kind}/index", _KINDS[kind]
    names = [f"reference/{kind}/{feature.name}" for feature in registry.features()]
    rows = [key for keys in answer.groups.values() for key in keys]
    linked = {key.name: f"reference/{kind}/{key.name}" for key in rows if key.name in registry.names()}
    body = [f"# {title}", anchor(place), f"Values of the key `{place}`."]
    body += [plain(answer.text)] * bool(answer.text)
    if linked:
        body.append(keys_table([key for key in rows if key.name in linked], page, place, linked))
    body.append(contents(names, hidden=True))
    yield Page(page, "\n\n".join(body), explanation(place, None), title, f"Values of the key `{place}`.")
    for feature in registry.features():
        yield _component(kind, feature.name, where)


def _component(kind: str, name: str, where: dict[str, str]) -> Page:
    page, topic, start = f"reference/{kind}/{name}", f"{kind}.{name}", (*PLACES[kind], name)
    answer = _answer(topic)
    inner = [path for path in _mappings() if path[: len(start)] == start and len(path) > len(start)]
    inner = [path for path in inner if (result := _component_of(path)) and result[:2] == (kind, name)]
    parts = [section(answer, page, topic, where, level=1, title=f"{name}")]
    if kind == "shape" and name == "compound":
        inner = [path for path in inner if path[-1] == "parts"]
    for path in inner:
        rest = ".".join(path[len(start) :])
        parts.append(section(_answer(".".join(path)), page, f"{topic}.{rest}", where, title=f"`{rest}`"))
    picture = _template_with(kind, name)
    if picture:
        words = f"The template {picture}, in which something has the {kind} {name}"
        shown = (
            f"![{words}](/pictures/template-{picture}.png)\n\n{link('Play this scene', page, f'gallery/{picture}')}."
        )
        head, _, tail = parts[0].partition("\n\n| ")
        parts[0] = f"{head}\n\n{shown}\n\n| {tail}" if tail else f"{head}\n\n{shown}"
    twin = "\n\n".join(explanation(".".join(one), None) for one in (start, *inner))
    return Page(page, "\n\n".join(parts), twin, name, f"{kind.capitalize()} `{name}`: {_first(answer.text)}")


@cache
def _texts() -> dict[str, str]:
    return {template.name: templates.load(template.name).text for template in templates.load_all()}


def _template_with(kind: str, name: str) -> str | None:
    """A template whose picture shows a component."""
    if (kind, name) in _PICTURES:
        return _PICTURES[kind, name]
    if kind in ("bridge", "planner"):
        return None
    return next((one for one, text in _texts().items() if f"name: {name}," in text or f"name: {name}}}" in text), None)


def _topics(page: str, title: str, index: str, groups: dict[str, tuple[str, ...]], where: dict[str, str]) -> Page:
    """A page with a section for each of many topics."""
    head = _answer(index)
    parts = [f"# {title}", plain(head.text)] if head.text else [f"# {title}"]
    if index in ("policies", "tasks"):  # what the list says besides the topics
        rest = head.model_copy(update={"groups": {k: v for k, v in head.groups.items() if k != "bundled tasks"}})
        parts.append(
            section(rest, page, index, where, title="All of them" if index == "policies" else "Keys of a task")
        )
    for heading, topics in groups.items():
        level = 3 if heading else 2
        parts += [f"## {heading}"] * bool(heading)
        for topic in topics:
            name = where[topic].partition("#")[2]
            parts.append(section(_answer(topic), page, name, where, level=level, title=_heading(_answer(topic), topic)))
    shown = [topic for topics in groups.values() for topic in topics]
    return Page(page, "\n\n".join(parts), _twin(title, [index, *shown]), title, _first(head.text) or head.title)


def _heading(answer: Answer, topic: str) -> str:
    return answer.title if answer.kind in ("code", "guide") else topic.removeprefix("metric ").removeprefix("policy ")


def _twin(title: str, topics: list[str]) -> str:
    """The answers of the tool ``lookup`` to each topic."""
    return "\n\n".join([f"# {title}", *(explanation(topic, None) for topic in topics)])


def _first(text: str) -> str:
    end = text.find(". ")
    return text if end < 0 else text[: end + 1]
