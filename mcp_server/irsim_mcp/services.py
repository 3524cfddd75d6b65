"""Services that tools and resources share: workspace, limits, workers, jobs, and the texts of recent calls."""

from __future__ import annotations

import json
import re
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import Field

from irsim.common.hashing import digest
from irsim.common.text import clean, plural
from irsim_mcp.answers import WorkerResult, failure
from irsim_mcp.jobs import Jobs
from irsim_mcp.limits import ServerLimits
from irsim_mcp.once import Once
from irsim_mcp.sandbox import Workspace
from irsim_mcp.suites import suite_of
from irsim_mcp.worker import Progress, Workers

__all__ = ["RecentTexts", "RunId", "ScenarioPath", "ScenarioYaml", "Services", "as_failure"]


ScenarioPath = Annotated[str | None, Field(description="Workspace file, or id of a text.")]
ScenarioYaml = Annotated[str | None, Field(description="Or its YAML text.")]

RunId = Annotated[str, Field(max_length=100, description="Of run_episode, or a job_id.")]


_MAX_TEXTS = 64
"""Number of texts that are kept."""
_MAX_CHARACTERS = 4 * 1024**2
"""Number of characters of all kept texts together."""
_ID = re.compile(r"text-[0-9a-f]{6}")


class RecentTexts:
    """Scenario texts of one server, the least recently used of which are forgotten first."""

    def __init__(self) -> None:
        self._texts: OrderedDict[str, str] = OrderedDict()

    def remember(self, text: str) -> str:
        """Keep a text and return its id, which depends on the text alone."""
        name = f"text-{digest(text)[:6]}"
        self._texts[name] = text
        self._texts.move_to_end(name)
        while len(self._texts) > 1 and (
            len(self._texts) > _MAX_TEXTS or sum(map(len, self._texts.values())) > _MAX_CHARACTERS
        ):
            self._texts.popitem(last=False)
        return name

    def find(self, name: str) -> str | None:
        """Return the text with an id; None if it was forgotten or never given."""
        text = self._texts.get(name)
        if text is not None:
            self._texts.move_to_end(name)
        return text

    @staticmethod
    def is_id(name: str) -> bool:
        """Whether a name has the form of an id."""
        return _ID.fullmatch(name) is not None


@dataclass(frozen=True)
class Services:
    """Workspace, limits, workers and jobs of one server."""

    workspace: Workspace
    limits: ServerLimits
    workers: Workers
    jobs: Jobs
    known: Once[WorkerResult] = field(default_factory=Once)
    """Answers about the scenario language and bundled suites, which do not change while the server runs."""
    texts: RecentTexts = field(default_factory=RecentTexts)
    """Texts of scenarios that calls have given."""
    done: dict[tuple[str, str, object], None] = field(default_factory=dict)
    """Steps that were done with scenarios as they were then, so that no answer advises them again."""

    def note(self, step: str, given: str) -> None:
        """Remember that a step was done with a scenario as it is now.

        Args:
            step: The step, such as ``looked``.
            given: From :meth:`given`.
        """
        self.done[self._step(step, given)] = None
        while len(self.done) > _MAX_TEXTS:
            del self.done[next(iter(self.done))]

    def was_done(self, step: str, given: str) -> bool:
        """Whether a step was done with a scenario that has not changed since."""
        return self._step(step, given) in self.done

    def _step(self, step: str, given: str) -> tuple[str, str, object]:
        name = given.removeprefix("scenario_path=")
        return step, name, self.workspace.stamp(name)

    def is_there(self, name: str) -> bool:
        """Whether a scenario can still be given: a file of the workspace, a text that is kept, or of a suite."""
        return suite_of(name) is not None or self.texts.find(name) is not None or self.workspace.has_file(name)

    async def reference(self, task: str, argument: str, **arguments: Any) -> str:
        """Have a worker answer a question about the scenario language, unless the answer is known.

        Args:
            task: Name of the task.
            argument: Name of the tool's argument, for errors.
            **arguments: Arguments of the task.

        Raises:
            ToolError: There is no answer.
        """
        return str((await self._read(task, arguments, argument))["text"])

    async def scenario_job(
        self,
        task: str,
        scenario_path: str | None,
        scenario_yaml: str | None,
        *,
        seconds: float,
        progress: Progress | None = None,
        **arguments: Any,
    ) -> WorkerResult:
        """Have a worker do a task with a scenario that is given as a file or as text.

        Args:
            task: Name of the task.
            scenario_path: Path of the file.
            scenario_yaml: Text of the scenario, instead of ``scenario_path``; an empty text counts as None.
            seconds: Wall-clock time that it may take [s].
            progress: Callback ``(steps_done, steps_total)``.
            **arguments: Further arguments of the task.

        Raises:
            ToolError: Neither or both are given, the path is refused, or the work failed.
        """
        source = await self._source(scenario_path, scenario_yaml)
        answer = await self.workers.call(task, {**source, **arguments}, seconds=seconds, progress=progress)
        return _result(answer, next(iter(source)))

    async def text_job(
        self, task: str, text: str, argument: str, *, path: str, seconds: float, **arguments: Any
    ) -> WorkerResult:
        """Have a worker do a task with the text of a file that is not written yet.

        Args:
            task: Name of the task.
            text: The YAML text.
            argument: Name of the tool's argument, for errors.
            path: Path to which the text will be written, relative to the workspace.
            seconds: Wall-clock time that it may take [s].
            **arguments: Further arguments of the task.

        Raises:
            ToolError: The text is too large, or the work failed.
        """
        given = {"text": self._text(text, argument), "path": path, **arguments}
        answer = await self.workers.call(task, given, seconds=seconds)
        return _result(answer, argument)

    async def run_job(
        self, task: str, run_id: str, *, seconds: float, progress: Progress | None = None, **arguments: Any
    ) -> WorkerResult:
        """Have a worker do a task with a recorded run.

        Args:
            task: Name of the task.
            run_id: Id of a run of the workspace.
            seconds: Wall-clock time that it may take [s].
            progress: Callback ``(steps_done, steps_total)``.
            **arguments: Further arguments of the task.

        Raises:
            ToolError: There is no such run, or the work failed.
        """
        self.workspace.check_run(run_id)
        answer = await self.workers.call(task, {"run_id": run_id, **arguments}, seconds=seconds, progress=progress)
        return _result(answer, "run_id")

    def base(self, base: str | None) -> dict[str, Any]:
        """Arguments of a task for the scenario to compare with; empty without one.

        Args:
            base: A file in the workspace, or YAML text (with several lines, or a mapping).

        Raises:
            ToolError: The path is refused, or the text is too long.
        """
        if base is None:
            return {}
        if "\n" in base or base.lstrip().startswith("{") or ": " in base:
            return {"base_text": self._text(base, "base")}
        if (known := self._known_text(base, "base")) is not None:
            return {"base_text": known}
        self._refuse_run(base, "base")
        return {"base": self.workspace.scenario(base, "base")}

    async def _source(self, scenario_path: str | None, scenario_yaml: str | None) -> dict[str, str]:
        if bool(scenario_path) == bool(scenario_yaml):
            given = "both scenario_path and scenario_yaml are" if scenario_path else "no scenario is"
            fix = "give scenario_yaml (the YAML text) or scenario_path (a file in the workspace), and only one of them"
            raise failure("bad-argument", f"{given} given", fix=fix)
        if scenario_path:
            if (known := self._known_text(scenario_path, "scenario_path")) is not None:
                return {"text": known}
            self._refuse_run(scenario_path, "scenario_path")
            text = await self._suite_scene(scenario_path, "scenario_path")
            return {"path": self.workspace.scenario(scenario_path)} if text is None else {"text": text}
        assert scenario_yaml
        text = self._text(scenario_yaml, "scenario_yaml")
        self.texts.remember(text)
        return {"text": text}

    def given(self, scenario_path: str | None, scenario_yaml: str | None) -> str:
        """The shortest argument that gives a scenario again: ``scenario_path=`` with the file or the id of the text."""
        name = self.texts.remember(scenario_yaml) if scenario_yaml else clean(scenario_path or "", 200)
        return f"scenario_path={name}"

    def _known_text(self, given: str, argument: str) -> str | None:
        """The text that an id stands for; None if a file is meant.

        Raises:
            ToolError: The server does not know the id any more.
        """
        if not self.texts.is_id(given) or self.workspace.has_file(given):
            return None
        text = self.texts.find(given)
        if text is None:
            what = f"no text with the id {given!r} is kept; the last ones are, until the server ends"
            raise failure("file-not-found", what, where=argument, fix="give the text again, as scenario_yaml")
        return text

    def _refuse_run(self, given: str, argument: str) -> None:
        """Refuse the id of a run where a scenario is expected, and name what gives its scenario.

        Raises:
            ToolError: It is the id of a run.
        """
        if not self.workspace.is_run(given) or self.workspace.has_file(given):
            return
        file, text = self.workspace.scenario_of_run(given)
        known = file is None and text is not None and len(text.encode()) <= self.limits.yaml_bytes
        name = clean(file, 200) if file is not None else self.texts.remember(text) if known and text else None
        fix = "give the text-... id that a call with its text has named" if name is None else f"give {argument}={name}"
        if name is not None and argument == "scenarios":
            fix = f"give scenarios=[{name!r}]"
        what = f"there is no file {clean(given)!r}: that is a run id"
        raise failure("file-not-found", what, where=argument, fix=f"{fix}, which gives the scenario of that run")

    async def _suite_scene(self, given: str, argument: str) -> str | None:
        """The text of ``SUITE/SCENARIO``; None if no bundled suite is named.

        Raises:
            ToolError: The suite has no such scenario.
        """
        if suite_of(given) is None:
            return None
        arguments = {"given": given, "argument": argument}
        return str((await self._read("suite_scene", arguments, argument))["text"])

    async def suite_policy(self, given: str | None, policy: str | None) -> str | None:
        """The text of a policy, which may be one that the suite knows if ``given`` is a scenario of a suite."""
        if given is None or suite_of(given) is None:
            return policy
        arguments = {"name": given, "policy": policy or "as-written"}
        text = str((await self._read("suite_policy", arguments, "policy"))["text"])
        return None if policy is None and text == "as-written" else text

    async def suite_rules(self, given: str | None) -> dict[str, Any]:
        """Perturbations and ``until`` of the suite that ``given`` names a scenario of; empty for other scenarios."""
        if given is None or suite_of(given) is None:
            return {}
        return dict(await self._read("suite_rules", {"name": given}, "scenario_path"))

    async def suite_plan(self, **arguments: Any) -> dict[str, Any]:
        """The plan of a benchmark of a suite, as data; arguments as of :func:`irsim_mcp.suites.plan_of`.

        Raises:
            ToolError: A scenario is not of the suite, or a policy is not valid.
        """
        answer = await self.workers.read("suite_plan", arguments, seconds=self.limits.check_seconds)
        return dict(_result(answer, "policies"))  # policies may be files, which change

    async def _read(self, task: str, arguments: dict[str, Any], argument: str) -> WorkerResult:
        """Have a worker do short work that is about no file; errors name ``argument``."""

        async def work() -> WorkerResult:
            return _result(await self.workers.read(task, arguments, seconds=self.limits.check_seconds), argument)

        return await self.known.get(json.dumps([task, argument, arguments], sort_keys=True), work)

    def scenario_source(self, given: str, argument: str = "scenarios") -> str:
        """Check a scenario given as a file of the workspace or, with a line break, as text.

        Raises:
            ToolError: The path is refused, or the text too large.
        """
        if "\n" in given:
            return self._text(given, argument)
        if (known := self._known_text(given, argument)) is not None:
            return known if "\n" in known else f"{known}\n"  # a text of one line would be taken for a path
        self._refuse_run(given, argument)
        return self.workspace.scenario(given, argument)

    def _text(self, text: str, argument: str) -> str:
        size = len(text.encode("utf-8", "replace"))
        if size > self.limits.yaml_bytes:
            raise failure(
                "file-too-large",
                f"a scenario must have at most {self.limits.yaml_bytes:,} bytes, got {size:,}",
                where=argument,
                fix="write groups of objects with 'number' and 'distribution' instead of one by one",
            )
        return text


def _result(answer: dict[str, Any], argument: str) -> WorkerResult:
    """The result in a worker's answer.

    Raises:
        ToolError: The answer is an error, which names ``argument`` as its cause unless it names another.
    """
    if "error" in answer:
        raise as_failure(answer["error"], argument)
    result = WorkerResult(answer["result"])
    result.text = answer["text"]
    return result


def as_failure(error: dict[str, Any], source: str | None) -> Exception:
    """The error of a worker as the error of a call.

    Args:
        error: Code, words and fix.
        source: Part of the task that names the scenario; None if there are several, so that each error names its file.
    """
    argument = {"path": "scenario_path", "text": "scenario_yaml", None: "scenarios"}.get(source, source)
    if error["code"] == "invalid-scenario":
        each = []
        for item in error["first"]:
            file = "" if source is not None else f"{item.get('file') or '(text)'} "
            line = "" if item["line"] is None else f" line {item['line']}"
            each.append(f"{file}{item['where']}{line} {item['code']}: {item['what']}")
            each[-1] += f" ({item['fix']})" if item.get("fix") else ""
        count = error["errors"]
        what = f"{plural(count, 'error')}: {'; '.join(each)}"
        return failure(
            "invalid-scenario", what, where=argument, fix="validate_scenario lists every problem with its fix"
        )
    nobody = source is None or error["code"] == "internal-error"  # no argument is wrong by itself
    where = error.get("where") or (None if nobody else argument)
    return failure(error["code"], error["what"], where=where, fix=error.get("fix"))
