"""Tools that refuse unknown arguments and whose errors are one line each.

Every host puts the list of tools before its model, so all of them together stay below 14,000 bytes: prefer an argument
of an existing tool to a new tool.
"""

from __future__ import annotations

import inspect
import json
import time
from collections.abc import Callable, Mapping
from typing import Any

from mcp.server.mcpserver import Context
from mcp.server.mcpserver.exceptions import ToolError, UnexpectedToolError
from mcp.server.mcpserver.tools import Tool
from mcp.server.mcpserver.utilities.func_metadata import FuncMetadata
from mcp.types import CallToolResult, TextContent, ToolAnnotations
from pydantic import Field, ValidationError

from irsim.common.text import clean, escape_marks
from irsim.diagnostics.diagnostic import format_path, suggestion
from irsim_mcp.answers import failure
from irsim_mcp.worker import Progress

__all__ = ["StrictTool", "reporter", "strict"]


_MAX_SHOWN = 60
"""Number of characters of a wrong value that a message shows."""
_KINDS = {
    "integer": "an integer",
    "number": "a number",
    "string": "text",
    "boolean": "true or false",
    "object": "an object",
}
_PLURALS = {"integer": "integers", "number": "numbers", "string": "texts"}


class StrictTool(Tool):
    """A tool that refuses unknown arguments instead of ignoring them, and says which values are valid.

    Attributes:
        former_names: Name that an argument had before → its name; it is still accepted, and not listed.
    """

    former_names: dict[str, str] = Field(default_factory=dict)

    async def run(self, arguments: dict[str, Any], context: Context[Any, Any], convert_result: bool = False) -> Any:
        """Check the arguments and call the function."""
        arguments = self._renamed(arguments)
        known = list(self.parameters["properties"])
        for name, value in arguments.items():
            if name not in known:
                meant = [one for one in known if not _is_other(one, value)]
                fix = suggestion(name, meant, f"{self.name} takes {', '.join(known)}")
                raise failure("unknown-argument", f"there is no argument {clean(name)!r}", where=self.name, fix=fix)
        given = {name: _unpack(value, self.parameters["properties"][name]) for name, value in arguments.items()}
        self._check(given)
        try:
            return _shown_as_text(await super().run(given, context, convert_result))
        except UnexpectedToolError as error:
            what = f"{self.name} failed unexpectedly; the server's log says why"
            crash = failure("internal-error", what, fix="please report it with the arguments of this call")
            raise UnexpectedToolError(str(crash)) from error.__cause__
        except ToolError as error:
            if isinstance(error.__cause__, ValidationError):
                raise self._refused(error.__cause__, arguments) from None
            raise ToolError(str(error).removeprefix(f"Error executing tool {self.name}: ")) from None

    def _renamed(self, arguments: dict[str, Any]) -> dict[str, Any]:
        """The arguments under their present names."""
        for old, new in self.former_names.items():
            if arguments.get(old) is not None and arguments.get(new) is not None:
                what = f"{new} and {old} are two names of one argument"
                raise failure("bad-argument", what, where=self.name, fix=f"give only {new}")
        return {
            self.former_names.get(name, name): value
            for name, value in arguments.items()
            if name not in self.former_names or value is not None
        }

    def _check(self, arguments: Mapping[str, Any]) -> None:
        """Check all arguments against the schema as strictly as JSON: true is not 1, and "10" is not 10."""
        from jsonschema import Draft202012Validator

        given = {name: value for name, value in arguments.items() if value is not None}
        missing = [name for name in self.parameters.get("required", ()) if name not in given]
        if missing:
            fix = "; ".join(f"{name}: {_accepted(self.parameters['properties'][name])}" for name in missing)
            raise failure("bad-argument", f"{' and '.join(missing)} must be given", where=self.name, fix=fix)
        wrong: dict[str, Any] = {}  # the first error of each argument
        for error in Draft202012Validator(self.parameters).iter_errors(given):
            wrong.setdefault(str(error.absolute_path[0]), error)
        if not wrong:
            return
        errors = {format_path(tuple(error.absolute_path)): error for error in wrong.values()}
        accepted = {place: _accepted(error.schema, error.instance) for place, error in errors.items()}
        if len(errors) == 1:
            ((where, error),) = errors.items()
            what, fix = f"{_shown(error.instance)} is not accepted", accepted[where]
        else:
            what = "; ".join(f"{place} does not accept {_shown(error.instance)}" for place, error in errors.items())
            where, fix = self.name, "; ".join(f"{place}: {text}" for place, text in accepted.items())
        raise failure("bad-argument", what, where=where, fix=fix)

    def _refused(self, error: ValidationError, arguments: Mapping[str, Any]) -> ToolError:
        from irsim.scenario.messages.translate import option_problems  # needs NumPy, which the server starts without

        first = option_problems(error, arguments, self.fn_metadata.arg_model)[0]
        name = str(first.path[0]) if first.path else self.name
        return failure(
            "bad-argument",
            f"{_shown(arguments.get(name))} is not accepted: {first.message}",
            where=format_path(first.path) or self.name,
            fix=_accepted(self.parameters["properties"].get(name, {})),
        )


class _AsGiven(FuncMetadata):
    """Metadata that leaves arguments unchanged: the SDK would parse a scenario that is written as JSON text."""

    def pre_parse_json(self, data: dict[str, Any]) -> dict[str, Any]:
        """Return the arguments unchanged."""
        return data


def _is_other(name: str, value: Any) -> bool:
    """Whether a value is the name of a file where an argument takes its text, or a text where it takes a name."""
    if not isinstance(value, str):
        return False
    if "\n" in value:
        return name.endswith("path")
    return name.endswith("yaml") and value.strip().lower().endswith((".yaml", ".yml"))


def _unpack(value: Any, schema: Mapping[str, Any]) -> Any:
    """Parse a list or object that is given as JSON text, as some hosts do."""
    if isinstance(value, str) and schema.get("type") in ("array", "object"):
        try:
            return json.loads(value)
        except (ValueError, RecursionError):
            return value
    return value


def _shown_as_text(answer: Any) -> Any:
    """An answer whose texts have no marks that change the direction of what a reader sees; JSON stays the same."""
    blocks = answer.content if isinstance(answer, CallToolResult) else answer if isinstance(answer, list) else ()
    for block in blocks:
        if isinstance(block, TextContent):
            block.text = escape_marks(block.text)
    return answer


def _shown(value: Any) -> str:
    return clean(json.dumps(value, ensure_ascii=False, default=str), _MAX_SHOWN)


def strict(
    function: Callable[..., Any],
    *,
    title: str,
    description: str,
    read_only: bool,
    idempotent: bool,
    destructive: bool = False,
    open_world: bool = False,
    page: str | None = None,
    former_names: Mapping[str, str] | None = None,
) -> StrictTool:
    """Make a tool of a function.

    Args:
        function: The function, whose parameters become the arguments of the tool.
        title: Title for users.
        description: Description for models: what it does, when to use it, what it returns, what to do next.
        read_only: Whether the tool changes nothing.
        idempotent: Whether repeating a call has no further effect.
        destructive: Whether it may overwrite or delete something.
        open_world: Whether it reaches beyond this machine.
        page: Resource that shows its results, for hosts of MCP Apps.
        former_names: Former names of arguments that are still accepted → the present ones.
    """
    hints = ToolAnnotations(
        read_only_hint=read_only, destructive_hint=destructive, idempotent_hint=idempotent, open_world_hint=open_world
    )
    tool = StrictTool.from_function(
        function,
        title=title,
        description=" ".join(inspect.cleandoc(description).split()),
        annotations=hints,
        meta=None if page is None else {"ui": {"resourceUri": page}},
    )
    meta = tool.fn_metadata
    tool.fn_metadata = _AsGiven(**{name: getattr(meta, name) for name in type(meta).model_fields})
    tool.parameters = {**_slim(tool.parameters), "additionalProperties": False}
    if tool.fn_metadata.output_schema is not None:
        output = _slim(tool.fn_metadata.output_schema)
        output.pop("description", None)  # the description of the tool says more
        tool.fn_metadata.output_schema = output
    assert isinstance(tool, StrictTool)
    tool.former_names = dict(former_names or {})
    return tool


def _slim(schema: Any) -> Any:
    """A schema without parts that do not help a model: titles, empty defaults, null as type of optional arguments."""
    if isinstance(schema, list):
        return [_slim(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    slim = {key: _slim(value) for key, value in schema.items() if key not in ("title", "properties", "$defs")}
    for key in ("properties", "$defs"):  # names in here are not keywords
        if key in schema:
            slim[key] = {name: _slim(value) for name, value in schema[key].items()}
    if slim.get("additionalProperties") is True:
        del slim["additionalProperties"]
    if slim.get("default") in ([], {}):
        del slim["default"]
    if slim.get("default", ...) is None:
        del slim["default"]
        options = [option for option in slim.get("anyOf", []) if option != {"type": "null"}]
        if len(options) == 1:
            del slim["anyOf"]
            slim = {**options[0], **slim}
    return slim


def _accepted(schema: Mapping[str, Any], given: Any = None) -> str:
    """The values that an argument accepts, in words; for many names only the one most similar to the given value."""
    if "enum" in schema:
        all_names = f"give one of {', '.join(map(str, schema['enum']))}"
        is_name = isinstance(given, str) and len(schema["enum"]) > 2
        return suggestion(given, schema["enum"], all_names) if is_name else all_names
    if "items" in schema and "enum" in schema["items"]:
        return f"give a list of some of {', '.join(map(str, schema['items']['enum']))}"
    if "items" in schema:
        low, high = schema.get("minItems"), schema.get("maxItems")
        count = f"{low} " if low is not None and low == high else ""
        return f"give a list of {count}{_PLURALS.get(schema['items'].get('type', ''), 'values')}"
    if "anyOf" in schema:
        return f"give {' or '.join(_accepted(option).removeprefix('give ') for option in schema['anyOf'])}"
    if isinstance(schema.get("type"), list):
        return f"give {' or '.join(_KINDS.get(kind, f'a {kind}') for kind in schema['type'])}"
    low, high = schema.get("minimum"), schema.get("maximum")
    kind = _KINDS.get(schema.get("type", ""), "what the schema says")
    if "maxLength" in schema:
        return f"give {kind} of at most {schema['maxLength']} characters"
    if low is not None and high is not None:
        return f"give {kind} from {low} to {high}"
    if low is not None:
        return f"give {kind} from {low} on"
    return f"give {kind}"


_PERIOD_S = 1.0
"""Least time between two notifications [s]."""


def reporter(context: Context[Any, Any], unit: str) -> Progress:
    """A callback that reports progress to the client.

    Args:
        context: Context of the call.
        unit: Unit of the counted work, such as ``steps``.
    """
    last, due = -1, 0.0

    async def report(done: int, total: int) -> None:
        nonlocal last, due
        now = time.monotonic()
        if done > last and (now >= due or done == total):  # a count ends at its total
            last, due = done, now + _PERIOD_S
            await context.report_progress(done, total, f"{done:,} of {'at most ' * (done < total)}{total:,} {unit}")

    return report
