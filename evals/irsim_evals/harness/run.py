"""Run one arm: a model, or a recording of one, answers the cases.

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

from irsim.diagnostics.errors import ArgumentError, IrsimError
from irsim_evals.cases.store import PUBLISHED, Instance, Store, cases_hash
from irsim_evals.harness.arms import MODEL_ARMS
from irsim_evals.harness.prices import Price, set_price
from irsim_evals.harness.recording import (
    Attempt,
    Header,
    Recording,
    find_recording,
    grade_recording,
    matched,
    write_recording,
)  # fmt: skip
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
_INSTALL = "pip install 'irsim-mcp[evals]'"
_KEYS = ("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN")


class RunError(IrsimError):
    """An arm that could not be run at all."""


def run_arm(
    arm: str,
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
    """Let a model answer instances of cases, and grade what it leaves.

    Args:
        arm: One of ``MODEL_ARMS``.
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

    Returns:
        One trial for each attempt, in the order of the instances. An attempt that an error ended is a failed one that
        says why.

    Raises:
        KeyboardInterrupt: Ctrl-C; the recording has the attempts that were done.
        ArgumentError: The arm, the recording or the model cannot be used; something is missing.
        RunError: No attempt could be made.
    """
    _check(arm, instances, epochs)
    recording = find_recording(replay, arm) if replay is not None else None
    if recording is not None:
        if replay_mode == "grade":
            return grade_recording(recording, instances)
        model, base_url, price = recording.header.model, None, None
        epochs = max(len(attempts) for _, attempts in matched(recording, instances))
        token_limit = cost_limit = time_limit = message_limit = None
    _require_harness()
    if model is None:
        raise ArgumentError(f"the arm {arm} needs a model", "give one such as anthropic/claude-opus-5")
    if recording is None:
        _require_key(model)
        set_price(model, price, needed=cost_limit is not None)
    seconds = math.ceil(time_limit) if time_limit is not None else None
    limits = {
        "token_limit": token_limit, "cost_limit": cost_limit, "time_limit": seconds, "message_limit": message_limit,
    }  # fmt: skip
    return _evaluate(arm, instances, model, epochs, limits, log_dir, recording, base_url, progress, store)


def _check(arm: str, instances: Sequence[Instance], epochs: int) -> None:
    if arm not in MODEL_ARMS:
        raise ArgumentError(f"no model answers in the arm {arm!r}", f"choose one of {', '.join(MODEL_ARMS)}")
    if not instances:
        raise ArgumentError("there is no case to answer", "choose some; irsim-evals cases lists them")
    if epochs < 1:
        raise ArgumentError("there must be at least one attempt at each case", "give 1 or more")


def _require_harness() -> None:
    for name in ("inspect_ai", "anthropic"):
        try:
            import_module(name)
        except ImportError:
            raise ArgumentError(
                f"the package {name} is not installed, or needs a newer Python than this", f"{_INSTALL}, on Python 3.11"
            ) from None


def _require_key(model: str) -> None:
    provider, _, name = model.partition("/")
    if not name:
        raise ArgumentError(f"{model!r} names no model", "give one such as anthropic/claude-opus-5")
    if provider == "anthropic" and "/" not in name and not any(os.environ.get(key) for key in _KEYS):
        raise ArgumentError("there is no key for Anthropic's service", f"set the environment variable {_KEYS[0]}")


def _evaluate(
    arm: str,
    instances: Sequence[Instance],
    model: str,
    epochs: int,
    limits: dict[str, Any],
    log_dir: Path,
    recording: Recording | None,
    base_url: str | None,
    progress: Callable[[int, int], None] | None,
    store: Store,
) -> list[Trial]:
    from irsim_evals.harness.attempts import attempt_of, drift_of, replayed_model, trial_from, unfinished
    from irsim_evals.harness.task import Session, build_task, by_name

    session = Session(arm, by_name(instances), len(instances) * epochs, progress)
    recorded: dict[tuple[str, int], Attempt] = {}
    if recording is not None:
        for name, instance in session.instances.items():
            for number, attempt in enumerate(recording.find(instance.case.id, instance.name), 1):
                recorded[name, number] = attempt
        session.model_of = lambda name, number, folder: replayed_model(recorded[name, number], model, folder)
    try:
        log, place = _eval(
            build_task(session, epochs), model, base_url, limits, log_dir, replayed=recording is not None
        )
    finally:
        session.close()
    samples = {(str(sample.id), sample.epoch): sample for sample in log.samples or []}
    trials, attempts = [], []
    for name, instance in session.instances.items():
        for number in range(1, epochs + 1):
            if recording is not None and (name, number) not in recorded:
                continue
            sample = samples.get((name, number))
            if sample is None:
                trials.append(unfinished(instance, arm, number, model, "the evaluation ended before this attempt"))
                continue
            attempt = attempt_of(sample, arm, instance, session.works.get((name, number)))
            if log.status == "cancelled" and attempt.failed:
                continue
            trial = trial_from(attempt, sample, instance, model)
            if recording is not None:
                trial.drift = drift_of(recorded[name, number], attempt)
            attempts.append(attempt)
            trials.append(trial)
    if recording is None:
        header = Header(
            arm=arm, model=model, date=datetime.now(timezone.utc).isoformat(timespec="seconds"), sdk=_versions(),
            skills=_skills(arm), cases=cases_hash(store),
            sampling={name: value for name, value in limits.items() if value},
        )  # fmt: skip
        write_recording(Recording(header=header, attempts=attempts), place.with_suffix(".jsonl"))
    if log.status == "cancelled":
        raise KeyboardInterrupt
    return trials


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


def _versions() -> dict[str, str]:
    return {name: metadata.version(name) for name in ("inspect_ai", "anthropic")}


def _skills(arm: str) -> str:
    from irsim_evals.harness.arms import skills_hash

    return skills_hash() if arm.startswith("skill") else ""
