"""``irsim policies``: list what can drive robots, or describe one."""

from __future__ import annotations

import json
import shlex
from dataclasses import asdict
from typing import Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from irsim.api.read_input import read_scenario
from irsim.cli.findings import import_user_modules
from irsim.cli.options import Imports, Json
from irsim.cli.output import console
from irsim.common.text import clean
from irsim.diagnostics.errors import InputError
from irsim.episodes.suitability import suited_policies
from irsim.policies.description import describe_policy, list_policies
from irsim.policies.scene_cards import SCENE_CARDS
from irsim.scenario.yaml.rewrite import yaml_flow

__all__ = ["policies"]

_WIDE = 110
"""Width of a terminal from which on all columns fit [characters]."""


def policies(
    name: Annotated[
        str | None, typer.Argument(help="Describe this policy: a name, or a file (model.npz).", show_default=False)
    ] = None,
    scene: Annotated[
        str | None,
        typer.Option("--for", metavar="FILE", help="Rank policies by how well they suit FILE, a scenario."),
    ] = None,
    imports: Imports = None,
    json_output: Json = False,
) -> None:
    """List the policies that can drive robots, describe one, or say which of them suit a scenario (--for)."""
    import_user_modules(imports)
    if scene is not None:
        if name is not None:
            raise InputError("--for ranks all policies, so it takes no name", f"irsim policies --for {scene}")
        _rank(scene, json_output)
        return
    listed = list_policies() if name is None else [describe_policy(name)]
    if json_output:
        data = [asdict(one) for one in listed]
        typer.echo(json.dumps(data if name is None else data[0], indent=2, ensure_ascii=False))
        return

    out = console()
    table = Table(box=None, pad_edge=False, header_style="dim", show_header=name is None)
    if name is None:
        narrow = out.is_terminal and out.width < _WIDE
        for heading in ("policy", *(() if narrow else ("kind", "returns")), "knows", "drives", "what it does"):
            table.add_column(heading, overflow="fold", no_wrap=heading == "policy")
        for one in listed:
            knows = (one.knows or ", ".join(one.needs) or "-").replace("+", " +")  # lines break there
            kinds = () if narrow else (one.kind, one.output)
            row = (clean(knows, 100), clean(", ".join(one.drives), 100), clean(one.about, 200))
            table.add_row(Text(clean(one.name), "bold cyan"), *kinds, *row)
        out.print(table)
        out.print("a file is a policy, too: irsim policies model.npz; irsim run SCENARIO --policy NAME uses one")
        return
    one = listed[0]
    period = "every step" if one.decision_dt is None else f"every {one.decision_dt:g} s"
    facts = {
        "kind": one.kind, "returns": one.output, "class": one.knows, "knows": one.facts_known,
        "needs": ", ".join(one.needs) or "nothing else", "scenes": _scenes(one.name),
        "does not see": one.unseen, "drives": ", ".join(one.drives), "decides": period, "sha256": one.digest or "",
        "not installed": one.install or "",
        "options": "" if one.meanings else "; ".join(f"{key}: {value}" for key, value in one.options.items()),
    }  # fmt: skip
    facts |= _network(one.facts)
    out.print(Text.assemble((clean(one.name, 200), "bold cyan"), ": ", clean(one.about, 1000)))
    for key, value in facts.items():
        if value:
            table.add_row(key, clean(value, 1000))
    for key, text in one.meanings.items():
        table.add_row(key, clean(f"{_default(one.options[key])}. {text}", 1000))
    out.print(table)


def _scenes(name: str) -> str:
    """The scenes on the card of a policy; empty without a card."""
    card = SCENE_CARDS.get(name)
    if card is None or card.origin != "trained":
        return ""
    return yaml_flow(card.model_dump(mode="json", exclude_defaults=True, exclude={"origin", "order", "cost"}))[1:-1]


def _rank(file: str, json_output: bool) -> None:
    """Print how well each policy suits a scenario, the best one first."""
    ranked = suited_policies(read_scenario(file, strict=False)[0])
    if json_output:
        typer.echo(json.dumps([asdict(one) for one in ranked], indent=2, ensure_ascii=False))
        return
    out = console()
    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("policy", "fits", "why"):
        table.add_column(heading, overflow="fold", no_wrap=heading != "why")
    for one in ranked:
        style = "bold cyan" if one.fits in ("yes", "partly") else "dim"
        table.add_row(Text(one.policy, style), one.fits, clean(one.reason, 300))
    out.print(table)
    out.print(Text.assemble("\nbest: ", (clean(ranked[0].line, 300), "bold cyan")))
    names = ",".join(one.policy for one in ranked[:3])
    out.print(f"compare them: irsim benchmark {shlex.quote(clean(file, 300))} --policies {names}", soft_wrap=True)


def _default(value: str) -> str:
    return value if value == "required" else f"default {value}"


def _network(facts: dict[str, Any]) -> dict[str, str]:
    """The description of a network in its own words, as lines; empty for other policies."""
    if not facts:
        return {}
    parts = [
        f"{part['label']}: {', '.join(map(str, part.get('features') or [part['shape']]))}" for part in facts["observes"]
    ]
    output, card = facts["output"], facts["card"]
    words = [f"{key} {value}" for key, value in output.items() if key != "input"]
    card_words = {key: card[key] for key in ("license", "seeds", "protocol", "task") if card.get(key)}
    return {
        "observes": "; ".join(parts),
        "output": ", ".join(words),
        "lookahead": _lookahead(facts.get("lookahead")),
        "layers": "; ".join(map(str, facts.get("layers", ()))),
        "size": f"{facts['parameters']:,} parameters" if "parameters" in facts else "",
        "card": ", ".join(f"{key}: {value}" for key, value in card_words.items()),
    }


def _lookahead(options: dict[str, Any] | None) -> str:
    """How moves are compared, in words; empty for networks that decide themselves."""
    if options is None:
        return ""
    moves, reward = options["moves"], options["reward"]
    count = 1 + moves["speeds"] * moves["headings"]
    kind = "velocities" if moves["kind"] == "holonomic" else "speeds and changes of the heading"
    rewards = f"goal {reward['goal']:g}, collision {reward['collision']:g}, discomfort below {reward['distance']:g} m"
    returns = f"reward ({rewards}) + {options['gamma']:g}^(time x speed) x value"
    return f"the best of {count} {kind}, {options['dt']:g} s ahead, by {returns}"
