"""Codes of errors outside scenarios: of the command line, the MCP server and other tools."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["TOOLS"]

TOOLS: dict[str, Code] = {
    "unknown-template": Code("unknown template", "No template of that name is bundled; irsim templates lists them."),
    "unknown-parameter": Code(
        "unknown parameter", "The template has no parameter of that name; irsim describe NAME lists them."
    ),
    "bad-parameter": Code(
        "parameter not accepted", "The value is of the wrong type or out of range; the message says what is accepted."
    ),
    "unknown-skill": Code(
        "unknown skill", "This package has no skill for agents of that name; irsim skills list shows them."
    ),
    "unknown-topic": Code(
        "unknown topic", "Neither the language nor its components, templates and codes have that name."
    ),
    "unknown-format": Code(
        "unknown file format", "The suffix of the file says what to write; the message lists the suffixes known."
    ),
    "file-exists": Code("file exists", "Nothing is overwritten unless asked to with --force."),
    "import-failed": Code(
        "module cannot be imported", "A module named by --import raised an error; the message has it."
    ),
    "behavior-failed": Code(
        "behavior of your own failed",
        "A behavior written in Python raised an error, or did not return finite numbers, one per control component.",
    ),
    "invalid-input": Code("input not usable", "The message says what is wrong with it."),
    "file-access": Code(
        "file cannot be read or written", "The system refuses: check the path, the permissions and the space left."
    ),
    "out-of-memory": Code("not enough memory", "Fewer objects, beams or frames need less."),
    "unknown-run": Code(
        "unknown run",
        "No recorded run of that id is kept in the workspace. Runs are let go 24 hours after their last use, and the "
        "least recently used ones when all together exceed 500 MB; the message names recent ones.",
    ),
    "unknown-job": Code(
        "unknown job",
        "No job of that id is kept in the workspace. Jobs are let go after 24 hours; the message names recent ones.",
    ),
    "unreadable-run": Code(
        "run cannot be read", "A file of the recorded run has been changed, removed or cut; record the run again."
    ),
    "step-out-of-range": Code(
        "step outside the run", "The recorded run has no such step; the message has the steps it does have."
    ),
    "unknown-tool": Code("unknown tool", "The server has no tool of that name; the message names the nearest."),
    "unknown-prompt": Code("unknown prompt", "The server has no prompt of that name; the message lists those it has."),
    "unknown-argument": Code(
        "unknown argument", "The tool has no argument of that name; the message names the nearest, or all there are."
    ),
    "bad-argument": Code(
        "argument not accepted",
        "An argument of the call is of the wrong type, out of range, or does not fit the others.",
    ),
    "invalid-scenario": Code(
        "scenario with errors",
        "Nothing was run or drawn. The message has the first problems; validate_scenario (irsim validate) lists all, "
        "with a fix for each.",
    ),
    "over-limit": Code(
        "more work than is allowed",
        "The message has the limit and what was asked for. Fewer steps or objects need less.",
    ),
    "out-of-time": Code(
        "time of computation is over",
        "The work was stopped. A run is recorded until then, see inspect_run; of other work nothing is kept. Fewer "
        "steps, objects or lidar beams take less time.",
    ),
    "busy": Code(
        "too much at once", "As many calls are being worked on as the server allows. Call again a little later."
    ),
    "worker-failed": Code(
        "worker process died", "The process that did the work ended without a result; the server itself goes on."
    ),
    "internal-error": Code(
        "unexpected error",
        "A mistake in irsim or in user code; IRSIM_TRACEBACK=1 shows where. Please report it if it is ours.",
    ),
}
"""Codes of errors outside scenarios: of the command line and other tools."""
