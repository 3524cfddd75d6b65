"""Codes of errors outside scenarios: of the command line, the MCP server and other tools."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["BRIDGES", "TOOLS"]


TOOLS: dict[str, Code] = {
    "unknown-template": Code("unknown template", "No bundled template has that name; irsim templates lists them."),
    "unknown-parameter": Code(
        "unknown parameter", "The template has no parameter of that name; irsim describe NAME lists them."
    ),
    "bad-parameter": Code(
        "parameter not accepted", "The value has the wrong type or is out of range; the message says what is accepted."
    ),
    "unknown-skill": Code(
        "unknown skill", "This package has no agent skill of that name; irsim skills list shows them."
    ),
    "unknown-topic": Code(
        "unknown topic",
        "The language has no key or component of that name, and no template, metric, guide or code has it.",
    ),
    "unknown-format": Code(
        "unknown file format", "The suffix of the file selects the format; the message lists the known suffixes."
    ),
    "file-exists": Code("file exists", "An existing file is overwritten only with --force."),
    "import-failed": Code(
        "module cannot be imported", "A module named by --import raised an error; the message has it."
    ),
    "missing-extra": Code(
        "library not installed",
        "This needs a library that irsim does not install by itself; the message has the command that installs it.",
    ),
    "policy-file": Code(
        "file of a policy not usable",
        "Networks are read from .npz (format irsim-policy: arrays and one JSON document) and .onnx files within limits "
        "of size and work. The message names the place, what was given and what is allowed. No code of a file is run.",
    ),
    "policy-input": Code(
        "robots do not observe what a policy needs",
        "The policy was made for other observations, such as more beams. The message says what is missing.",
    ),
    "behavior-failed": Code(
        "behavior in Python failed",
        "A behavior written in Python raised an error, or did not return finite numbers, one per control component.",
    ),
    "policy-failed": Code(
        "policy failed",
        "A policy raised an error, or did not return one row of finite numbers for each robot that decides; the "
        "message names the robot and what to return.",
    ),
    "policy-lost": Code(
        "policy in another process lost",
        "The process of a policy cannot be started or reached, did not answer in time, has ended, or answered "
        "something else than irsim describe process says. The episode ends there; the next one starts the process "
        "again.",
    ),
    "policy-mismatch": Code(
        "policy does not fit the robots",
        "The policy controls other drives than the robots have, or needs something that they lack, such as a lidar "
        "with as many beams as it was made for.",
    ),
    "unknown-policy": Code(
        "unknown policy",
        "There is no policy of that name: no behavior, plug-in or file. The message names the nearest ones; irsim "
        "policies lists all.",
    ),
    "invalid-input": Code("input not usable", "The input is not usable; the message says what is wrong with it."),
    "file-access": Code(
        "file cannot be read or written",
        "The system refuses access. Check the path, the permissions and the free disk space.",
    ),
    "disk-full": Code(
        "no space left on the disk",
        "The disk, or the quota of the user, has no space left for the file; nothing incomplete is left of it. Free "
        "some space, or write to another disk.",
    ),
    "out-of-memory": Code(
        "not enough memory", "The work needs more memory than there is. Use fewer objects, beams or frames."
    ),
    "unknown-run": Code(
        "unknown run",
        "The workspace has no recorded run of that id. Runs are deleted 24 hours after their last use, and the "
        "least recently used ones when all together exceed 500 MB; the message names recent ones.",
    ),
    "unknown-job": Code(
        "unknown job",
        "The workspace has no job of that id. Jobs are deleted after 24 hours; the message names recent ones.",
    ),
    "unreadable-run": Code(
        "run cannot be read", "A file of the recorded run was changed, removed or truncated; record the run again."
    ),
    "bad-task": Code(
        "task cannot be used",
        "Keys or values of the learning task are not allowed, or do not fit its scenario; the message lists all.",
    ),
    "bad-suite": Code(
        "suite cannot be used",
        "Keys or values of the suite file are not allowed, or its scenarios cannot be made; the message lists all.",
    ),
    "unknown-suite": Code(
        "unknown suite", "There is no suite of that name, and no such file; irsim suites lists them."
    ),
    "results-exist": Code(
        "folder holds episodes",
        "A benchmark was started in this folder; --resume goes on with it, -o names another folder.",
    ),
    "other-benchmark": Code(
        "folder of another benchmark",
        "The folder holds a benchmark of other scenarios, policies, seeds or version; results do not mix.",
    ),
    "no-benchmark": Code("nothing to resume", "The folder holds no benchmark; start one, or name its folder with -o."),
    "benchmark-running": Code(
        "folder in use", "Another process is running the benchmark in this folder; wait for its end, or name another."
    ),
    "not-writable": Code("folder cannot be written", "The result could not be written; make room, then give --resume."),
    "no-cluster": Code(
        "no cluster answers",
        "No Ray cluster can be used at that address; the message has the reason. Without --cluster, benchmarks run "
        "on this machine.",
    ),
    "cluster-differs": Code(
        "cluster cannot run this",
        "The machines of the cluster have another version of irsim, or lack a module; results would differ or fail.",
    ),
    "step-out-of-range": Code(
        "step outside the run", "The recorded run has no such step; the message has the range of its steps."
    ),
    "unknown-tool": Code("unknown tool", "The server has no tool of that name; the message names the nearest."),
    "unknown-prompt": Code("unknown prompt", "The server has no prompt of that name; the message lists those it has."),
    "unknown-argument": Code(
        "unknown argument", "The tool has no argument of that name; the message names the nearest one, or all of them."
    ),
    "bad-argument": Code(
        "argument not accepted",
        "An argument of the call has the wrong type, is out of range, or does not fit the others.",
    ),
    "invalid-scenario": Code(
        "scenario with errors",
        "Nothing was run or drawn. The message has the first problems; validate_scenario (irsim validate) lists all, "
        "with a fix for each.",
    ),
    "over-limit": Code(
        "more work than is allowed", "The message has the limit and what was requested. Use fewer steps or objects."
    ),
    "out-of-time": Code(
        "computing time is over",
        "The work was stopped. A run is recorded up to that moment, see inspect_run; other work leaves no result. "
        "Use fewer steps, objects or lidar beams.",
    ),
    "busy": Code(
        "too many calls at once",
        "The server is already working on as many calls as it allows. Call again a little later.",
    ),
    "worker-failed": Code(
        "worker process died", "The process that did the work ended without a result; the server itself continues."
    ),
    "workspace-gone": Code(
        "workspace deleted or replaced",
        "The folder with which the MCP server was started was deleted, renamed or replaced. It is not made anew.",
    ),
    "internal-error": Code(
        "unexpected error",
        "There is a mistake in irsim or in user code; IRSIM_TRACEBACK=1 shows where. Please report it if it is in "
        "irsim.",
    ),
}
"""Codes of errors outside scenarios: of the command line and other tools."""


BRIDGES: dict[str, Code] = {
    "bridge-file": Code(
        "file of another program not usable",
        "A file that another program has written is truncated, too large, or not what its name says. The message has "
        "the place in the file. Nothing was written.",
    ),
    "bridge-mismatch": Code(
        "scenario does not fit a bridge",
        "A bridge cannot represent something of the scenario, or its options name an object that there is none of.",
    ),
    "bridge-lost": Code(
        "program at the other end lost",
        "The program that a bridge talks to cannot be reached, has ended, or did not answer in time. Robots that were "
        "driven by the bridge have got the command to stand still.",
    ),
    "bridge-failed": Code(
        "bridge failed",
        "A bridge raised an error, or the program at its other end sent values that are not usable, such as NaN.",
    ),
    "bridges-disabled": Code(
        "bridges are not opened here",
        "The scenario has bridges to other programs, which open connections. The MCP server opens them only if it was "
        "started with --enable-bridges; without that, leave out the key bridges.",
    ),
}
