"""Makes the reference pages of the agent skill ``irsim-scenario``: one Markdown page per part of the language."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from irsim.bundled import templates
from irsim.components.sensors._devices import DEPTH_CAMERAS, DEVICES, INFRARED, SONARS, Device
from irsim.components.sensors._gauges import GaugeOptions
from irsim.components.sensors._realism import LidarRealism
from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.lookup.answer import Answer, Key, key_list, key_table, plain_table
from irsim.lookup.guides import GUIDES
from irsim.lookup.language import language_schema
from irsim.lookup.schema_walk import COLOR, Node, alternatives, mappings, yaml_text
from irsim.lookup.schema_walk import components as options_of
from irsim.lookup.topics import lookup
from irsim.options.registry import KINEMATICS, REGISTRIES
from irsim.scenario.model.actuation import Actuation
from irsim.scenario.model.zones import Zone
from irsim.scenario.read import read

__all__ = ["PAGES", "Gap", "components", "find_gaps", "pages"]


_STAR = "A key with \\* also takes a list with one value for each object of the entry."
_NOT_SIMULATED = " (not simulated by this version)"


class _Source:
    """Schema and gaps of the language, computed once for all pages."""

    def __init__(self, schema: Node) -> None:
        self.schema, self.gaps = schema, find_gaps(schema)

    def about(self, topic: str) -> Answer:
        return lookup(topic, schema=self.schema)


def pages() -> dict[str, str]:
    """Return the text of each page by its file name without suffix."""
    source = _Source(language_schema())
    note = "<!-- Written by `python -m irsim.lookup.reference`: do not edit. -->\n"
    return {name: f"# {title}\n\n{note}\n{make(source).strip()}\n" for name, (title, make) in PAGES.items()}


def _world(source: _Source) -> str:
    parts = [
        "The section `world`: extent, time, modes. Lengths in meters, times in seconds.",
        _keys(source, "world"),
        "`plot` is in [plot.md](plot.md).",
        "## Lines and areas that are watched, and slippery ones: `world.zones`\n\n" + _zones(source),
        f"## Grid maps: `world.obstacle_map`\n\n{_components(source, 'map', '###')}",
        "## The section `gui`\n\n### `gui.keyboard`\n\n" + _keys(source, "gui.keyboard"),
        "### `gui.mouse`\n\n" + _keys(source, "gui.mouse"),
        "## The section `custom`\n\n" + source.about("custom").text,
    ]
    return "\n\n".join(parts)


def _zones(source: _Source) -> str:
    examples = "\n".join(f"- `{yaml_text(example)}`" for example in Zone.schema_extra["examples"])
    guide = (
        "Events say who enters (`zone_entry`), leaves (`zone_exit`) and crosses (`line_crossing`, with its direction), "
        "with step and time; `irsim inspect RUN --view zones` and the tool `inspect_run` list them. The metrics "
        "`time_in_zone` and `zone_crossings` are in results of runs and benchmarks."
    )
    return f"{' '.join((Zone.__doc__ or '').split())}\n\n{_keys(source, 'world.zones')}\n\n{guide}\n\n{examples}"


def _objects(source: _Source) -> str:
    kinds = ("kinematics", "shapes", "behaviors", "sensors", "distributions", "plot")
    intro = (
        "One entry of `robot:` or `obstacle:`, which take the same keys: a mapping, or a list of mappings. An "
        f"obstacle with `kinematics` and `behavior` moves like a robot. {_STAR}"
    )
    pages_of = ", ".join(f"[{name}]({name}.md)" for name in kinds)
    order = " ".join((Actuation.__doc__ or "").split())
    examples = "\n".join(f"- `actuation: {yaml_text(one)}`" for one in Actuation.schema_extra["examples"])
    actuators = f"## `actuation`\n\n{order}\n\n{_keys(source, 'robot.actuation')}\n\n{examples}"
    return f"{intro}\n\n{_keys(source, 'robot')}\n\nComponents: {pages_of}. {COLOR}\n\n{actuators}"


def _kinematics(source: _Source) -> str:
    rows = []
    for feature in KINEMATICS.features():
        names = getattr(feature.options, "control_rows", ())
        units = getattr(feature.options, "control_units", ())
        controls = (
            "" if feature.name == "static" else ", ".join(f"{n} [{u}]" for n, u in zip(names, units, strict=True))
        )
        state = ", ".join(getattr(feature.options, "state_rows", ()))
        rows.append((f"`{feature.name}`", controls or "none: it never moves", state))
    orders = plain_table(("name", "controls, in this order", "rows of `state`"), rows)
    intro = (
        "`vel_min`, `vel_max`, `acce` and `velocity` have one number per control, as do the actions that a program "
        "passes to `env.step`. `world.integration` says how a drive moves within a step, and how accurate that is."
    )
    return (
        f"`kinematics: {{name: …}}`, how an object moves.\n\n{orders}\n{intro}\n\n{_components(source, 'kinematics')}"
    )


def _behaviors(source: _Source) -> str:
    return (
        "`behavior: {name: …}`, what an object does when no program commands it. All behaviors need `kinematics`.\n\n"
        f"{_components(source, 'behavior')}\n\n## Planners\n\nValues of the key `planner` of `follow`.\n\n"
        + _components(source, "planner", "###")
    )


def _shapes(source: _Source) -> str:
    return (
        "`shape: {name: …}`, the footprint, in the body frame: the origin is the `state` of the object, x its heading."
        " Without `shape` an object is a circle of radius 1 m.\n\n" + _components(source, "shape")
    )


def _sensors(source: _Source) -> str:
    return (
        "`sensors: [{name: …}, …]`, a list. Lidars see all robots and obstacles that are not `unobstructed`.\n\n"
        + _components(source, "sensor", among=lambda options: not _locates(options))
        + "\n\nSensors that tell a robot where it is, how it moves and where others are have a page of their own: "
        "[perception.md](perception.md)."
        + "\n\nErrors of lidars beyond Gaussian noise, and range sensors that one can buy, are in "
        f"[lidars.md](lidars.md).\n\n{COLOR}"
    )


def _locates(options: Any) -> bool:
    return issubclass(options, GaugeOptions) and options.locates


def _perception(source: _Source) -> str:
    return (
        "Sensors that tell a robot where it is, how it moves and where others are, each with its errors. A program "
        "reads them by name (`sensor.read()`); with `perceives` the behavior or policy of the robot goes by them. "
        "Records keep what they report; `irsim inspect --fields readings`, exports and messages of ROS have it.\n\n"
        f"{_components(source, 'sensor', among=_locates)}"
    )


def _lidars(source: _Source) -> str:
    return (
        f"## Errors: `realism`\n\n{' '.join((LidarRealism.__doc__ or '').split())}\n\n"
        + _keys(source, "robot.sensors.lidar2d.realism")
        + f"\n\n## Lidars that one can buy: `device`\n\n{_devices(DEVICES)}"
        + "\n\n## Other range sensors that one can buy: `device`\n\n"
        + _devices({**DEPTH_CAMERAS, **SONARS, **INFRARED})
    )


def _devices(cards: Mapping[str, Device]) -> str:
    """The cards of devices as a table, and their sources."""
    sources = list(dict.fromkeys(source for card in cards.values() for source in card.sources.values()))
    unread = sum(source.read is None for source in sources)
    number = {source: index for index, source in enumerate(sources, 1)}
    rows = [
        [f"`{name}`", card.title, ", ".join(f"`{key}: {value}` [{number[card.sources[key]]}]".replace("True", "true")
         .replace("False", "false") for key, value in card.keys.items())]
        for name, card in cards.items()
    ]  # fmt: skip
    told = "\n".join(
        f"{number[source]}. {source.text}" + (f" (read {source.read})" if source.read else " (**unverified**)")
        for source in sources
    )
    what = (
        f"Keys beside `device` win. Each number has a source, by its index below; {unread} of {len(sources)} sources "
        "were not opened yet, and their numbers are unverified. A tolerance of a maker is taken for two standard "
        "deviations."
    )
    return f"{what}\n\n{plain_table(('device', 'maker and type', 'keys'), rows)}\n\n{told}"


def _distributions(source: _Source) -> str:
    return (
        "`distribution: {name: …}`, how the `number` objects of an entry are placed. `manual` is the default.\n\n"
        + _components(source, "distribution")
    )


def _plot(source: _Source) -> str:
    parts = [
        f"How things are drawn; nothing here changes the simulation. {COLOR}",
        "## `plot` of an object\n\n" + _keys(source, "robot.plot"),
        "## `world.plot`\n\n" + _keys(source, "world.plot"),
        "## `world.plot.saved_figure`\n\n" + _keys(source, "world.plot.saved_figure"),
    ]
    return "\n\n".join(parts)


def _templates(source: _Source) -> str:
    intro = (
        "Scenarios to start from; each runs without changes. `irsim new NAME --set KEY=VALUE` writes one to a file. "
        "With default parameters the outcome is success, unless an entry gives another. Each parameter is followed by "
        "its values and its default."
    )
    parts = [intro]
    for template in templates.load_all():
        answer = source.about(template.name)
        usual = list(template.outcomes) == ["success"]
        about = template.purpose if usual else f"{template.purpose} Outcome: {' or '.join(template.outcomes)}."
        said = f"{template.name.replace('-', ' ')} {template.purpose}".lower()
        words = f"Tags: {', '.join(tag for tag in template.tags if tag.lower() not in said)}."
        parts.append(f"## {template.name}\n\n{about}\n{words}\n\n{key_list(_all_keys(answer))}")
    return "\n\n".join(parts)


def _diagnostics(source: _Source) -> str:
    intro = (
        "Every finding has a code, a path, a line, a reason and in most cases a fix, which is more specific than this "
        "table. `irsim describe CODE`, or the tool `lookup` with the code, explains a code."
    )
    parts = [intro]
    for title, codes in (("Findings about a scenario", CODES), ("Errors of commands and tools", TOOL_CODES)):
        rows = [(f"`{name}`", code.title) for name, code in codes.items()]
        parts.append(f"## {title}\n\n{plain_table(('code', 'meaning'), rows)}")
    return "\n\n".join(parts)


def _not_simulated(source: _Source) -> str:
    guide = GUIDES["limits"]
    rows = [
        (f"`{gap.section}`" + (", `obstacle`" if gap.section == "robot" else ""), f"`{gap.example}`", gap.message)
        for gap in source.gaps
    ]
    table = plain_table(("section", "for example", "what the validator says"), rows)
    language = (
        "Keys and values that are valid but that this version does not simulate. They are never ignored: validating, "
        "drawing and running fail with the code `not-yet-simulated`. The list is the result of validating each key and "
        "component alone; for combinations, ask the validator, which is always right.\n\n" + table
        if rows
        else "Every key and component is simulated at present. One that is not would be refused with the code "
        "`not-yet-simulated`."
    )
    return f"{language}\n\n## Beyond the language: {guide.title}\n\n{guide.text}"


def _keys(source: _Source, topic: str) -> str:
    """Return the table of the keys of a mapping."""
    answer = source.about(topic)
    missing: dict[str, list[str]] = {}
    for gap in source.gaps:
        if gap.section == topic:
            missing.setdefault(gap.key, []).append(gap.value)
    return key_table(_all_keys(answer), missing).strip()


def _components(
    source: _Source, kind: str, level: str = "##", among: Callable[[Any], bool] = lambda options: True
) -> str:
    """Return a section for each component of a kind, after a table of the keys that all of them have."""
    features = [feature for feature in REGISTRIES[kind].features() if among(feature.options)]
    answers = {feature.name: source.about(f"{kind}.{feature.name}") for feature in features}
    common = [key for key in _all_keys(answers[features[0].name]) if all(key in _all_keys(a) for a in answers.values())]
    parts = [f"Keys that all of them have:\n\n{key_table(common)}"] if common else []
    for feature in features:
        mark = "" if feature.simulated else _NOT_SIMULATED
        own = [key for key in _all_keys(answers[feature.name]) if key not in common]
        example = answers[feature.name].example or ""
        if example == f"{kind}: {{name: {feature.name}}}":  # the heading and the introduction say as much
            example = ""
        body = [
            " ".join((feature.options.__doc__ or "").split()),
            key_table(own) if own else "",
            f"`{example}`" if example and "\n" not in example else "",
        ]
        parts.append(f"{level} {feature.name}{mark}\n\n" + "\n\n".join(part.strip() for part in body if part))
    return "\n\n".join(part.strip() for part in parts)


def components(kind: str) -> str:
    """Return sections for the components of a kind, for pages of other skills."""
    return _components(_Source(language_schema()), kind)


def _all_keys(answer: Answer) -> list[Key]:
    return [key for keys in answer.groups.values() for key in keys]


PAGES: dict[str, tuple[str, Callable[[_Source], str]]] = {
    "world": ("World", _world),
    "objects": ("Robots and obstacles", _objects),
    "shapes": ("Shapes", _shapes),
    "kinematics": ("Kinematics", _kinematics),
    "behaviors": ("Behaviors", _behaviors),
    "sensors": ("Sensors", _sensors),
    "lidars": ("Lidars as they are", _lidars),
    "perception": ("Knowing where one is, and where others are", _perception),
    "distributions": ("Distributions", _distributions),
    "plot": ("Plot", _plot),
    "templates": ("Templates", _templates),
    "diagnostics": ("Diagnostics", _diagnostics),
    "not-simulated": ("Not simulated by this version", _not_simulated),
}
"""File name without suffix -> title of the page, and the function that returns its text."""


_WORLD: dict[str, Any] = {"width": 10, "height": 10}
_ROBOT: dict[str, Any] = {
    "kinematics": {"name": "diff"},
    "shape": {"name": "circle", "radius": 0.2},
    "state": [1, 1, 0],
    "goal": [8, 8],
    "behavior": {"name": "dash"},
}


@dataclass(frozen=True)
class Gap:
    """A key with a value that the validator rejects as not simulated yet.

    Attributes:
        section: ``world``, or ``robot`` (obstacles have the same keys).
        key: Key of that section.
        value: The value, or the name of the component.
        example: Key and value as YAML.
        message: Message of the validator.
    """

    section: str
    key: str
    value: str
    example: str
    message: str


def find_gaps(schema: Node) -> list[Gap]:
    """Return the keys and values of ``world``, ``robot`` and ``obstacle`` that are not simulated, in schema order.

    Each word, switch and component is validated in a small scenario of its own; combinations are not tried.

    Args:
        schema: JSON Schema of the language.
    """
    language = max(mappings(schema, schema), key=lambda option: len(option["properties"]))["properties"]
    gaps = []
    for section, base in (("world", _WORLD), ("robot", _ROBOT)):
        [keys] = [option["properties"] for option in mappings(schema, language[section])]
        for key, node in keys.items():
            for name, value in _values(schema, key, node):
                message = _find_refusal({"world": _WORLD, "robot": _ROBOT, section: {**base, key: value}})
                if message is not None:
                    gaps.append(Gap(section, key, name, f"{key}: {yaml_text(_name_first(value))}", message))
    return gaps


def _values(schema: Node, key: str, node: Node) -> Iterator[tuple[str, Any]]:
    """Iterate over the values to try: each component, each word, and true for a switch."""
    for name, option in options_of(schema, node).items():
        value = option.get("examples", [{"name": name}])[0]
        yield name, [value] if key == "sensors" else value
    for option in alternatives(schema, node):
        for word in [option["const"]] if "const" in option else option.get("enum", []):
            if isinstance(word, str) and not key.endswith("color"):
                yield word, word
        if option.get("type") == "boolean":
            yield "true", True


def _name_first(value: Any) -> Any:
    if isinstance(value, list):
        return [_name_first(item) for item in value]
    return {"name": value["name"], **value} if isinstance(value, dict) else value


def _find_refusal(data: dict[str, Any]) -> str | None:
    """Return the message of the validator about something that is not simulated yet, or None."""
    for item in read(data, strict=True).diagnostics:
        if item.code == "not-yet-simulated":
            return item.message
    return None
