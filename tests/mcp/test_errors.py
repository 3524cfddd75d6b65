"""Errors of calls: one line with code, reason and fix."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from mcp import MCPError

from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim_mcp.answers import failure
from tests.mcp.conftest import ERAS, ROOM, Caller, error_of

pytestmark = pytest.mark.anyio

NO_CODES = {"irsim-mcp"}
"""Looks like one: the name of the program before what it says."""


REFUSED = {
    "unknown-argument: there is no argument 'scenario_yml' (run_episode). Fix: did you mean scenario_yaml?": (
        "run_episode",
        {"scenario_yml": ROOM},
    ),
    "there is no argument 'scenario' (run_episode). Fix: did you mean scenario_path?": (
        "run_episode",
        {"scenario": "rooms/hall.yaml"},
    ),
    "there is no argument 'scenario' (validate_scenario). Fix: did you mean scenario_yaml?": (
        "validate_scenario",
        {"scenario": ROOM},
    ),
    "unknown-argument: there is no argument 'behavior' (lookup). Fix: lookup takes topic, parameters.": (
        "lookup",
        {"behavior": "rvo"},
    ),
    "unknown-tool: there is no tool 'run_episodes'. Fix: did you mean run_episode?": ("run_episodes", {}),
    "unknown-tool: there is no tool 'delete_everything'. Fix: the tools are lookup, validate_": (
        "delete_everything",
        {},
    ),
    "(max_steps). Fix: give an integer from 1 to 5000.": ("run_episode", {"scenario_yaml": ROOM, "max_steps": 0}),
    "bad-argument: -1 is not accepted": ("run_episode", {"scenario_yaml": ROOM, "seed": -1}),
    "(max_wall_s). Fix: give an integer from 1 to 45.": ("run_episode", {"scenario_yaml": ROOM, "max_wall_s": 46}),
    "Fix: give an integer from 200 to 1024.": ("render_snapshot", {"scenario_yaml": ROOM, "size_px": 2000}),
    "(step). Fix: give an integer from -1 to 5000.": ("render_snapshot", {"scenario_yaml": ROOM, "step": 5001}),
    "Fix: give one of concise, detailed, json.": (
        "validate_scenario",
        {"scenario_yaml": ROOM, "response_format": "short"},
    ),
    "(scenario_yaml). Fix: give text.": ("validate_scenario", {"scenario_yaml": {"world": {}}}),
    "-1 is not accepted (from_step). Fix: give an integer from 0 on": ("inspect_run", {"run_id": "a", "from_step": -1}),
    "bad-argument: run_id must be given (inspect_run). Fix: run_id: give text of at most 100 ": ("inspect_run", {}),
    "bad-argument: run_id must be given": ("inspect_run", {"run_id": None}),
    "(every). Fix: give an integer from 1 on.": ("inspect_run", {"run_id": "a", "every": 0}),
    "(run_id). Fix: give text of at most 100 characters.": ("inspect_run", {"run_id": "x" * 101}),
    'bad-argument: "speeed" is not accepted (fields[1]). Fix: did you mean speed?': (
        "inspect_run",
        {"run_id": "a", "fields": ["x", "speeed"]},
    ),
    "3 is not accepted (fields[1]). Fix: give one of x, y, ": ("inspect_run", {"run_id": "a", "fields": ["x", 3]}),
    '"row" is not accepted (view). Fix: did you mean rows?': ("inspect_run", {"run_id": "a", "view": "row"}),
    "(region). Fix: give a list of 4 numbers.": ("render_snapshot", {"scenario_yaml": ROOM, "region": [1, 2]}),
    "[1] is not accepted (parameters.beams). Fix: give text or true or false or an integer or a number.": (
        "lookup",
        {"topic": "crossing", "parameters": {"beams": [1]}},
    ),
    "bad-argument: true is not accepted (seed).": ("run_episode", {"scenario_yaml": ROOM, "seed": True}),
    'bad-argument: "10" is not accepted (max_steps).': ("run_episode", {"scenario_yaml": ROOM, "max_steps": "10"}),
    'step does not accept -2; return_image does not accept "no"': (
        "render_snapshot",
        {"scenario_yaml": ROOM, "return_image": "no", "step": -2},
    ),
    "bad-argument: no scenario is given. Fix: give scenario_yaml": ("validate_scenario", {}),
    "bad-argument: no scenario is given.": ("run_episode", {"scenario_path": "", "scenario_yaml": ""}),
    "bad-argument: both scenario_path and ": ("render_snapshot", {"scenario_path": "a.yaml", "scenario_yaml": ROOM}),
    "(scenario_path). Fix: did you mean 'room.yaml'?": ("validate_scenario", {"scenario_path": "room.yml"}),
    "file-not-found: there is no file 'nothing-like-it' ": ("validate_scenario", {"scenario_path": "nothing-like-it"}),
    "Fix: 'doorway' is a template: lookup topic='doorway' returns its YAML; pass the text as scenario_yaml": (
        "run_episode",
        {"scenario_path": "doorway"},
    ),
    "Fix: 'maze' is a template: lookup topic='maze' returns its YAML; give its text": (
        "benchmark",
        {"scenarios": ["templates/maze.yaml"]},
    ),
    "not-a-file: 'folder' is a folder": ("validate_scenario", {"scenario_path": "folder"}),
    "file-too-large: a scenario must have at most 262,144 bytes, got 262,145": (
        "validate_scenario",
        {"scenario_yaml": "#" * 262_145},
    ),
}
"""Part of the line of an error -> the call that is refused with it."""


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with a scenario and a folder."""
    workspace = tmp_path_factory.mktemp("furnished")
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    (workspace / "folder").mkdir()
    return workspace


@pytest.mark.parametrize("era", ERAS)
@pytest.mark.parametrize("error", REFUSED)
async def test_one_line_with_a_fix(client: Caller, workspace: Path, error: str) -> None:
    tool, arguments = REFUSED[error]
    told = await client.error(tool, **arguments)
    assert error in told
    code = told.partition(":")[0]
    assert code in CODES or code in TOOL_CODES
    assert re.search(r"\. Fix: .*[.?]$", told)


@pytest.mark.parametrize(("tool", "step"), [("run_episode", None), ("render_snapshot", 5)])
async def test_an_invalid_scenario_names_its_first_problems(client: Caller, tool: str, step: int | None) -> None:
    wrong = ROOM.replace("dash", "dahs").replace("world: {", "world: {foo: 1, ").replace("goal:", "gaol:")
    told = await client.error(tool, **({"scenario_yaml": wrong} | ({"step": step} if step else {})))
    assert told.startswith("invalid-scenario: 3 errors: world.foo line 1 unknown-key: ")
    assert "robot[0].behavior.name line 8 unknown-behavior" in told
    assert told.endswith("Fix: validate_scenario lists every problem with its fix.")


async def test_a_scenario_may_be_written_as_json(client: Caller) -> None:
    good = await client.call("validate_scenario", scenario_yaml='{"world": {"width": 10, "height": 6}}')
    lists = await client.call("validate_scenario", scenario_yaml="[1, 2]")
    packed = await client.call("render_snapshot", scenario_yaml=ROOM, overlays='["names"]')
    assert good.structured_content is not None
    assert good.structured_content["valid"]
    assert lists.structured_content is not None
    assert lists.structured_content["issues"][0]["code"] == "not-a-scenario"
    assert not packed.is_error


async def test_no_room_for_random_objects(client: Caller) -> None:
    crowd = ROOM + "  - {number: 45, kinematics: {name: diff}, distribution: {name: random}, shape: {name: circle}}\n"
    told = await client.error("run_episode", scenario_yaml=crowd, seed=1)
    assert told.startswith("placement-crowded: no room for ")
    assert "with seed 1" in told
    assert "Fix: lower `number`" in told


def test_errors_are_short_and_documented() -> None:
    told = str(failure("busy", "x" * 1000 + "\n\x1b[31m", where="y" * 300, fix="wait"))
    assert len(told) <= 400
    assert told.isprintable()
    assert told.endswith("Fix: wait.")
    with pytest.raises(LookupError, match="undocumented"):
        failure("no-such-code", "what")


def test_every_code_that_is_told_anywhere_is_in_the_list() -> None:
    """Read off the sources: codes at the beginning of texts, as ``code``, and given to whatever takes known codes."""
    known = {*CODES, *TOOL_CODES}
    told: dict[str, str] = {}
    given: dict[str, dict[str, str]] = {}  # by the name of what is called
    root = Path(__file__).resolve().parents[2]
    for path in (*(root / "irsim").rglob("*.py"), *(root / "mcp_server").rglob("*.py")):
        source, name_of_file = path.read_text(encoding="utf-8"), path.relative_to(root)
        if not re.search("[\"'][a-z]+(-[a-z0-9]+)+(: |[\"'])", source):
            continue
        for node in ast.walk(ast.parse(source)):
            place = f"{name_of_file}:{getattr(node, 'lineno', 0)}"
            text = text_in(node)
            if text is not None and (match := re.match(r"([a-z]+(?:-[a-z0-9]+)+): \S", text)):
                told[match[1]] = place
            if isinstance(node, ast.Call):
                name = getattr(node.func, "id", getattr(node.func, "attr", ""))
                if node.args and (text := text_in(node.args[0])) is not None:
                    given.setdefault(name, {})[text] = place
                told |= {text_in(one.value) or "": place for one in node.keywords if one.arg == "code"}
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "code":
                told[text_in(node.value) or ""] = place
            if isinstance(node, ast.Dict):
                pairs = zip(node.keys, node.values, strict=True)
                told |= {text_in(value) or "": place for key, value in pairs if key and text_in(key) == "code"}
    for taken in given.values():
        if known & taken.keys():
            told |= {text: place for text, place in taken.items() if re.fullmatch(r"[a-z]+(-[a-z0-9]+)+", text)}
    assert len(known & told.keys()) > 120
    assert {code: place for code, place in told.items() if code and code not in known | NO_CODES} == {}


def text_in(node: ast.AST) -> str | None:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None


async def test_other_refusals_have_a_code_too(client: Caller) -> None:
    fix = "Fix: the prompts are design_scen"
    with pytest.raises(MCPError, match=rf"^unknown-prompt: there is no prompt 'nope'\. {fix}"):
        await client.get_prompt("nope")
    assert (await client.text("lookup", topic="unknown-prompt")).startswith("unknown-prompt: unknown prompt")


async def test_what_was_let_go_can_be_made_again(client: Caller, workspace: Path) -> None:
    for name, argument, code in (("inspect_run", "run_id", "run"), ("get_job", "job_id", "job")):
        told = error_of(await client.call_tool(name, {argument: "room-123456"}))
        assert told.startswith(
            f"unknown-{code}: there is no {code} 'room-123456' ({argument}). Fix: there are no {code}s here"
        )
        assert "are deleted" in told
        assert "24 h" in told
        assert "the same" in told


def test_a_fault_of_ours_points_at_no_argument() -> None:
    from irsim_mcp.job_errors import error_data
    from irsim_mcp.services import as_failure

    with pytest.raises(ZeroDivisionError) as crash:
        _ = 1 / 0
    told = str(as_failure(error_data(crash.value), "path"))
    assert told.startswith("internal-error: ZeroDivisionError: division by zero")
    assert "scenario_path" not in told
    assert "a fault of the simulator" in told
