"""Run one arm, or two in turn: a model, or a recording of one, answers the cases.

The logs of inspect_ai stay in the folder ``log_dir``, each with a recording beside it (``.jsonl``), which can be
replayed without network.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from datetime import datetime, timezone
from importlib import import_module, metadata
from pathlib import Path
from typing import Any, Literal

from irsim.bundled.skills import find_skills
from irsim.diagnostics.errors import ArgumentError, IrsimError
from irsim_evals.cases.store import PUBLISHED, Instance, Store, cases_hash
from irsim_evals.grader.outcome import name_of
from irsim_evals.harness.arms import MODEL_ARMS, Side, skills_hash
from irsim_evals.harness.prices import Price, set_price
from irsim_evals.harness.recording import Header, Recording, find_recording, grade_recording, matched, write_recording
from irsim_evals.results import Trial

__all__ = ["MESSAGE_LIMIT", "RunError", "run_arm"]

MESSAGE_LIMIT = 200
"""Messages of an attempt, if no other limit is given."""
MAX_PARALLEL = 4
"""Attempts at the same time; each of some arms has servers of its own."""
MAX_RETRIES = 6
"""How often a request is sent again after an error that may pass, at growing intervals of 3 s and more."""
ATTEMPT_TIMEOUT_S = 600
"""Time after which one request is given up and sent again."""
MAX_TOOL_OUTPUT_BYTES = 64 * 1024
"""Length from which on the answer of a tool is cut."""
_KEYS = ("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN")


class RunError(IrsimError):
    """An arm that could not be run at all."""


def run_arm(
    arm: str | Sequence[Side],
    instances: Sequence[Instance],
    *,
    model: str | None,
    epochs: int = 1,
    token_limit: int | None = None,
    cost_limit: float | None = None,
    time_limit: float | None = None,
    log_dir: Path,
    replay: Path | None = None,
    base_url: str | None = None,
    progress: Callable[[int, int], None] | None = None,
    message_limit: int | None = MESSAGE_LIMIT,
    price: Price | None = None,
    replay_mode: Literal["full", "grade"] = "full",
    store: Store = PUBLISHED,
) -> list[Trial]:
    """Let a model answer instances of cases, and grade what it leaves: one trial for each attempt, in their order.

    An attempt that an error ended is a failed one that says why.

    Args:
        arm: One of ``MODEL_ARMS``; or sides, which answer each case one right after the other, so that what changes at
            the model's service meanwhile affects them alike.
        instances: The cases to answer.
        model: Name with its provider, such as ``anthropic/claude-opus-5``; with ``replay`` the recording's.
        epochs: Attempts at each instance.
        token_limit: Tokens of one attempt.
        cost_limit: Cost of one attempt [US dollar].
        time_limit: Duration of one attempt [s].
        log_dir: Folder for logs and recordings; it is made.
        replay: Recording (``.jsonl``) whose answers are played again, without network, or the folder with the logs of
            a run; ``epochs`` and limits are then the recording's.
        base_url: Address of the model's service; default: its provider's.
        progress: Called with the number of attempts that are done, and of all.
        message_limit: Messages of one attempt.
        price: US dollars for a million tokens that are read and written, for a model whose price is not known.
        replay_mode: ``full`` calls the tools again and reports what they answer otherwise; ``grade`` only grades the
            recorded files, for which nothing needs to be installed.
        store: The folder of the cases, whose digest the recording has.

    Raises:
        KeyboardInterrupt: Ctrl-C; the recording has the attempts that were done.
        ArgumentError: The arm, the recording or the model cannot be used; something is missing.
        RunError: No attempt could be made.
    """
    sides = [Side(arm)] if isinstance(arm, str) else list(arm)
    _check(sides, instances, epochs)
    recordings = [] if replay is None else [find_recording(replay, side.label) for side in sides]
    if recordings:
        if replay_mode == "grade":
            return [trial for recording in recordings for trial in grade_recording(recording, instances)]
        model, base_url, price = recordings[0].header.model, None, None
        epochs = max(len(attempts) for one in recordings for _, attempts in matched(one, instances))
        token_limit = cost_limit = time_limit = message_limit = None
    if model is None:
        why = f"the arm {sides[0].label} needs a model"
        raise ArgumentError(why, "add --model anthropic/NAME, or --replay RECORDING")
    _require_harness()
    if not recordings:
        _require_key(model)
        set_price(model, price, needed=cost_limit is not None)
    seconds = math.ceil(time_limit) if time_limit is not None else None
    limits = {
        "token_limit": token_limit, "cost_limit": cost_limit, "time_limit": seconds, "message_limit": message_limit,
    }  # fmt: skip
    return _evaluate(sides, instances, model, epochs, limits, log_dir, recordings, base_url, progress, store)


def _check(sides: Sequence[Side], instances: Sequence[Instance], epochs: int) -> None:
    for side in sides:
        if side.arm not in MODEL_ARMS:
            raise ArgumentError(f"no model answers in the arm {side.arm!r}", f"choose one of {', '.join(MODEL_ARMS)}")
        if side.skills is not None and not (side.arm.startswith("skill") and find_skills(place=side.skills)):
            why = f"{side.skills} holds no skill that the arm {side.arm} would read"
            raise ArgumentError(why, "give a folder with NAME/SKILL.md, and an arm with skills")
        if side.instructions is not None and "+mcp" not in side.arm:
            raise ArgumentError(f"the arm {side.arm} reads no instructions of the server", "choose one with mcp")
    if len({side.label for side in sides}) < len(sides):
        fix = "give one of them another arm, --skills or --instructions"
        raise ArgumentError(f"both sides are {sides[0].label}", fix)
    if not instances:
        raise ArgumentError("there is no case to answer", "choose some; irsim-evals cases lists them")
    if epochs < 1:
        raise ArgumentError("there must be at least one attempt at each case", "give 1 or more")


def _require_harness() -> None:
    for name in ("inspect_ai", "anthropic"):
        try:
            import_module(name)
        except ImportError:
            why = f"the package {name} is not installed, or needs a newer Python than this"
            raise ArgumentError(why, "pip install 'irsim-mcp[evals]', on Python 3.11") from None


def _require_key(model: str) -> None:
    provider, _, name = model.partition("/")
    if not name:
        raise ArgumentError(f"{model!r} names no model", "give one such as anthropic/claude-opus-5")
    if provider == "anthropic" and "/" not in name and not any(os.environ.get(key) for key in _KEYS):
        raise ArgumentError("there is no key for Anthropic's service", f"set the environment variable {_KEYS[0]}")


def _evaluate(
    sides: Sequence[Side],
    instances: Sequence[Instance],
    model: str,
    epochs: int,
    limits: dict[str, Any],
    log_dir: Path,
    recordings: Sequence[Recording],
    base_url: str | None,
    progress: Callable[[int, int], None] | None,
    store: Store,
) -> list[Trial]:
    from irsim_evals.harness.attempts import attempt_of, drift_of, replayed_model, trial_from, unfinished
    from irsim_evals.harness.task import Session, build_task

    samples = {
        " ".join([name_of(instance.case.id, instance.name), *([side.label] * (len(sides) > 1))]): (side, instance)
        for instance in instances
        for side in sides
    }
    session = Session(samples, len(samples) * epochs, progress)
    of_side = dict(zip(sides, recordings, strict=False))
    recorded = {
        (name, number): attempt
        for name, (side, instance) in (samples if recordings else {}).items()
        for number, attempt in enumerate(of_side[side].find(instance.case.id, instance.name), 1)
    }
    if recordings:
        session.model_of = lambda name, number, folder: replayed_model(recorded[name, number], model, folder)
    try:
        log, place = _eval(build_task(session, epochs), model, base_url, limits, log_dir, replayed=bool(recordings))
    finally:
        session.close()
    done = {(str(sample.id), sample.epoch): sample for sample in log.samples or []}
    trials: dict[Side, list[Trial]] = {side: [] for side in sides}
    made = {side: Recording(header=_header(side, model, limits, store), attempts=[]) for side in sides}
    for name, (side, instance) in samples.items():
        for number in range(1, epochs + 1):
            if recordings and (name, number) not in recorded:
                continue
            sample = done.get((name, number))
            if sample is None:
                trials[side].append(unfinished(instance, side.label, number, model))
                continue
            attempt = attempt_of(sample, side.label, instance, session.works.get((name, number)))
            if log.status == "cancelled" and attempt.failed:
                continue
            trial = trial_from(attempt, sample, instance, model)
            if recordings:
                trial.drift = drift_of(recorded[name, number], attempt)
            made[side].attempts.append(attempt)
            trials[side].append(trial)
    for number, recording in enumerate([] if recordings else made.values(), 1):
        file = place.with_suffix(".jsonl") if len(sides) == 1 else place.with_name(f"{place.stem}-{number}.jsonl")
        write_recording(recording, file)
    if log.status == "cancelled":
        raise KeyboardInterrupt
    return [trial for side in sides for trial in trials[side]]


def _header(side: Side, model: str, limits: dict[str, Any], store: Store) -> Header:
    return Header(
        arm=side.label, model=model, date=datetime.now(timezone.utc).isoformat(timespec="seconds"),
        sdk={name: metadata.version(name) for name in ("inspect_ai", "anthropic")},
        skills=skills_hash(side.skills) if side.arm.startswith("skill") else "", cases=cases_hash(store),
        sampling={name: value for name, value in limits.items() if value},
    )  # fmt: skip


def _eval(task: Any, model: str, base_url: str | None, limits: dict[str, Any], log_dir: Path, *, replayed: bool) -> Any:
    """Let inspect_ai run a task, with everything off that needs a network, a terminal or another process."""
    from inspect_ai import eval as evaluate
    from inspect_ai.log import read_eval_log
    from inspect_ai.model import get_model

    log_dir.mkdir(parents=True, exist_ok=True)
    before = set(log_dir.glob("*.eval"))
    try:
        chosen = get_model("mockllm/replay" if replayed else model, base_url=base_url, memoize=False)
        evaluate(
            task, model=chosen, display="none", log_dir=str(log_dir), log_format="eval", log_realtime=False,
            log_images=False, log_model_api=False, score_display=False, ctl_server=False, fail_on_error=False,
            max_samples=MAX_PARALLEL, max_retries=MAX_RETRIES, attempt_timeout=ATTEMPT_TIMEOUT_S,
            max_tool_output=MAX_TOOL_OUTPUT_BYTES, **limits,
        )  # fmt: skip
    except IrsimError:
        raise
    except Exception as error:  # errors of attempts are in the log; this is one of the whole
        text = " ".join(str(error).split())
        raise RunError(f"{model} could not be run: {text or type(error).__name__}") from error
    made = sorted(set(log_dir.glob("*.eval")) - before, key=lambda path: path.stat().st_mtime)
    if not made:
        raise RunError(f"{model} could not be run: inspect_ai wrote no log")
    log = read_eval_log(str(made[-1]), resolve_attachments=True)
    if log.status != "cancelled" and not log.samples:
        why = log.error.message if log.error is not None else f"the evaluation ended as {log.status}"
        raise RunError(f"{model} could not be run: {why}")
    return log, made[-1]
