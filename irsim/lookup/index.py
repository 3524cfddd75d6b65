"""Answers that need no search: the index, and lists of codes, events, guides and templates with their entries."""

from __future__ import annotations

from irsim.benchmarks.suite import SUITES
from irsim.bundled import templates
from irsim.bundled.templates import Template
from irsim.common.event_kinds import BETWEEN_STEPS, EVENTS
from irsim.compat import DIFFERENCES
from irsim.diagnostics.codes import CODES, TOOL_CODES, Code
from irsim.diagnostics.examples import EXAMPLES
from irsim.lookup.answer import Answer, Key, first_sentence
from irsim.lookup.language import language_schema
from irsim.lookup.metrics import METRIC_TOPICS
from irsim.lookup.schema_walk import mappings, yaml_text
from irsim.lookup.sizes import settings_asked
from irsim.lookup.things import ALL_GUIDES, NO
from irsim.options.registry import REGISTRIES, Registry

__all__ = [
    "PICTURE",
    "all_codes",
    "code_answer",
    "codes_answer",
    "difference_answer",
    "differences_answer",
    "event_answer",
    "events_answer",
    "guide_answer",
    "guides_answer",
    "index_answer",
    "template_answer",
    "templates_answer",
]

PICTURE = "Picture of its start:"
"""Words before the path of the picture of a template."""


def index_answer() -> Answer:
    """Answer an empty topic: the components, templates, guides, metrics and codes."""
    schema = language_schema()
    language = max(mappings(schema, schema), key=lambda option: len(option["properties"]))
    sections = Key(name="scenario", text=", ".join(language["properties"]))
    kinds = [Key(name=kind, text=_overview(registry)) for kind, registry in sorted(REGISTRIES.items())]
    return Answer(
        topic="",
        kind="index",
        title="Topics that irsim describe explains",
        groups={
            "the scenario and its components": [sections, *kinds],
            "templates": [Key(name="templates", text=", ".join(templates.names()))],
            "more": [
                Key(name="guides", text=", ".join(ALL_GUIDES)),
                Key(name="suites", text=f"benchmarks with a fixed protocol: {', '.join(SUITES.names())}"),
                Key(name="metrics", text=f"the {len(METRIC_TOPICS)} numbers that measure how good an episode was"),
                Key(name="codes", text=f"the {len(all_codes())} codes of errors and warnings"),
            ],
        },
        example="irsim describe robot.sensors.lidar2d",
    )


def _overview(registry: Registry) -> str:
    """List the components of a kind; the ones that are not simulated come last."""
    features = registry.features()
    later = [feature.name for feature in features if not feature.simulated]
    names = [", ".join(feature.name for feature in features if feature.simulated)]
    names += [f"not simulated yet: {', '.join(later)}"] if later else []
    return "; ".join(part for part in names if part)


def guides_answer() -> Answer:
    """List the guides."""
    lines = [Key(name=name, text=guide.title) for name, guide in ALL_GUIDES.items()]
    return Answer(topic="guides", kind="index", title="Guides", groups={"guides": lines})


def guide_answer(name: str, see: list[str]) -> Answer:
    """Show a guide.

    Args:
        name: Name of the guide.
        see: Related topics.
    """
    guide = ALL_GUIDES[name]
    if guide.text.startswith(NO) and "limits" not in see:
        see = [*see, "limits"]
    title = f"{name}: {guide.title}"
    return Answer(topic=name, kind="guide", title=title, text=guide.text, example=guide.example, see=see)


def difference_answer(name: str) -> Answer:
    """Explain an intended difference from IR-SIM 2.12.

    Args:
        name: Number of the difference.
    """
    one = DIFFERENCES[name]
    text = f"IR-SIM 2.12: {one.theirs}. irsim: {one.ours}. Why: {one.why}."
    return Answer(topic=name, kind="guide", title=f"{name}: an intended difference from IR-SIM 2.12", text=text)


def differences_answer() -> Answer:
    """List the intended differences from IR-SIM 2.12."""
    lines = [Key(name=name, text=one.theirs) for name, one in DIFFERENCES.items()]
    return Answer(
        topic="differences",
        kind="index",
        title="Differences from IR-SIM 2.12",
        text="Files and programs for IR-SIM 2.12 run without changes, but for these intended differences; "
        f"`irsim describe {lines[0].name}` says what irsim does instead, and why.",
        groups={"what IR-SIM 2.12 does": lines},
    )


def all_codes() -> dict[str, Code]:
    """Return the codes of findings and of errors outside scenarios."""
    return {**CODES, **TOOL_CODES}


def code_answer(name: str) -> Answer:
    """Explain a code, with an example if it has one.

    Args:
        name: The code.
    """
    code = all_codes()[name]
    example = None
    if name in EXAMPLES:
        wrong, right = EXAMPLES[name]
        example = "\n".join([f"# not  {line}" for line in wrong.splitlines()] + right.splitlines())
    return Answer(
        topic=name, kind="code", title=f"{name}: {code.title}", text=code.explanation, example=example, see=["codes"]
    )


def codes_answer() -> Answer:
    """List the codes."""
    lines = [Key(name=name, text=code.title) for name, code in all_codes().items()]
    return Answer(topic="codes", kind="index", title="Codes of errors and warnings", groups={"codes": lines})


def templates_answer() -> Answer:
    """List the templates, each with the first sentence of its purpose; the answer about one has the rest."""
    lines = [
        Key(name=template.name, text=first_sentence(template.purpose).rstrip(".")) for template in templates.load_all()
    ]
    return Answer(topic="templates", kind="index", title="Templates: whole scenarios", groups={"templates": lines})


def template_answer(template: Template, question: str = "") -> Answer:
    """Show a template and its parameters.

    Args:
        template: The template.
        question: Free text that it answers, whose numbers the example sets.
    """
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
    asked, misfits = settings_asked(template, question)
    shown = asked or ({} if first is None else {first.name: str(first.default)})
    setting = "".join(f" --set {name}={value}" for name, value in shown.items())
    return Answer(
        topic=template.name,
        kind="template",
        title=f"template {template.name}: {template.title}",
        text=" ".join(
            [*misfits, template.purpose, template.prospect(), PICTURE, str(templates.picture_file(template.name))]
        ),
        groups={"parameters": keys},
        example=f"irsim new {template.name}{setting} -o -  # prints it; without -o - it writes {template.name}.yaml",
        see=["templates"],
    )


def event_answer(kind: str) -> Answer:
    """Describe a kind of event."""
    more = ["world.contacts", "contacts_between_steps", "jumps-through", "outcomes"] if kind in BETWEEN_STEPS else []
    return Answer(
        topic=kind,
        kind="event",
        title=f"event {kind}",
        text=EVENTS[kind],
        example="irsim run scenario.yaml --json  # events have kind, time, step, object, partner, x, y",
        see=[*more, "events"],
    )


def events_answer() -> Answer:
    """List the kinds of events."""
    lines = [Key(name=name, text=text) for name, text in EVENTS.items()]
    return Answer(topic="events", kind="index", title="Kinds of events", groups={"events": lines})
