"""``irsim describe``: explain keys, components, templates, metrics and codes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from irsim.cli.options import Json
from irsim.cli.output import console, print_json
from irsim.lookup import Answer, Answers, as_brief_text, lookup, lookup_several, topics_of
from irsim.lookup.answer import facts, said_once, title_of

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from irsim.lookup import Key, TopicError

__all__ = ["describe"]


def describe(
    topic: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[TOPIC]...",
            help="A key such as vel_max or robot.sensors.lidar2d.range_max, a component such as behavior dash, a "
            "template, a metric, or an error code. Several, separated by commas, are answered briefly.",
            show_default=False,
        ),
    ] = None,
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", help="Also print all details of a suite: policies with options, sources.")
    ] = False,
    json_output: Json = False,
) -> None:
    """Explain a key, a component, a template, a metric or an error code. Without a topic, list all topics."""
    asked = " ".join(topic or ())
    if len(topics := topics_of(asked)) > 1:
        answers = lookup_several(topics)
        _show_several(answers if json_output else said_once(topics, answers), json_output)
        return
    answer = lookup(asked)
    if json_output:
        print_json(answer)
    elif answer.kind == "suite" and answer.groups and not verbose:
        _show_suite(answer, console())
    else:
        _show(answer, console())


def _show_several(answers: list[Answer | TopicError], json_output: bool) -> None:
    """Print the answers to several topics briefly, or all of them as a JSON list; errors go to standard error."""
    known = [one for one in answers if isinstance(one, Answer)]
    for one in answers:
        if not isinstance(one, Answer):
            typer.echo(f"{one.message}. Fix: {one.fix}.", err=True)
    if json_output:
        print_json(Answers(answers=known))
        return
    for place, answer in enumerate(known):
        title, _, rest = as_brief_text(answer).partition("\n")
        console().print(*([""] if place else []), Text(title, style="bold"), Text(rest), sep="\n")


def _show_suite(answer: Answer, out: Console) -> None:
    """Print what decides whether a suite is the right one, and the command that runs it."""
    title, _, text = as_brief_text(answer.model_copy(update={"groups": {}, "example": None})).partition("\n")
    out.print(Text(title, style="bold"), Text(text), sep="\n")
    for heading, keys in answer.groups.items():
        if heading == "fixed":
            out.print("; ".join(f"{key.name}: {key.text}" for key in keys))
        elif heading != "sources":
            out.print(f"{heading}: {', '.join(key.name for key in keys)}")
    if answer.example:
        out.print(Text.assemble("run it: ", (answer.example, "cyan")), soft_wrap=True)
    out.print(f"all of it: irsim describe {answer.topic} -v", soft_wrap=True)


def _show(answer: Answer, out: Console) -> None:

    def line(*parts: RenderableType) -> None:
        out.print(*parts)

    if answer.best is not None:  # what was probably meant comes before the other topics
        title, _, rest = as_brief_text(answer.best).partition("\n")
        out.print(Text(title, style="bold"), Text(rest), "", sep="\n")
    line(Text(title_of(answer), style="bold"))
    if answer.text:
        line(answer.text)
    if answer.about is not None:
        line(Text(facts(answer.about), style="green"))
    for heading, keys in answer.groups.items():
        if keys:
            line()
            line(Text(heading, style="dim"))
            line(_table(keys))
    if answer.example:
        line()
        line(Text("example", style="dim"))
        line(Text(answer.example, style="cyan"))
    if answer.see:
        line()
        line(Text.assemble(("see also: ", "dim"), ", ".join(answer.see)))


def _table(keys: list[Key]) -> RenderableType:
    table = Table(box=None, pad_edge=False, show_header=False, padding=(0, 2, 0, 2))
    table.add_column(style="bold cyan", no_wrap=True)
    table.add_column()
    for key in keys:
        text = Text(key.text)
        if key_facts := facts(key):
            text.append(("\n" if key.text else "") + key_facts, style="green")
        table.add_row(key.name, text)
    return table
