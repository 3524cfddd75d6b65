"""Completions: values that clients can offer while a user types an argument of a prompt or a resource."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

from mcp.server import MCPServer
from mcp.types import Completion, CompletionArgument, CompletionContext, PromptReference, ResourceTemplateReference

from irsim.common.text import clean
from irsim.runs.store import ARTIFACTS
from irsim_mcp.prompts import DIFFICULTIES, drives, template_names
from irsim_mcp.resources import DOC, RUN, SCHEMA, SECTIONS, TEMPLATE, topics
from irsim_mcp.services import Services

__all__ = ["add_completions"]

_MAX_VALUES = 100
"""Number of values that one completion offers."""


def add_completions(server: MCPServer, services: Services) -> None:
    """Register the completions with a server."""
    workspace = services.workspace
    choices: dict[tuple[str, str], Callable[[], Iterable[str]]] = {
        ("design_scenario", "kinematics"): drives,
        ("design_scenario", "difficulty"): lambda: DIFFICULTIES,
        ("debug_run", "run_id"): workspace.runs,
        ("compare_policies", "scenario"): lambda: (*workspace.scenarios(), *template_names()),
        (SCHEMA, "section"): lambda: SECTIONS,
        (TEMPLATE, "name"): template_names,
        (DOC, "topic"): topics,
        (RUN, "run_id"): workspace.runs,
        (RUN, "artifact"): lambda: ARTIFACTS,
    }

    async def complete(
        ref: PromptReference | ResourceTemplateReference,
        argument: CompletionArgument,
        context: CompletionContext | None,
    ) -> Completion:
        of = ref.name if isinstance(ref, PromptReference) else ref.uri
        known: Iterable[str] = ()
        if (of, argument.name) in choices:
            with suppress(OSError):
                known = choices[of, argument.name]()
        found = [choice for choice in known if choice.startswith(argument.value) and clean(choice, 1000) == choice]
        return Completion(values=found[:_MAX_VALUES], total=len(found), has_more=len(found) > _MAX_VALUES)

    completing: Callable[[], Callable[..., Any]] = server.completion  # the SDK declares no types for it
    completing()(complete)
