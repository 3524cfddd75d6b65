"""Trains a policy for a task with Stable-Baselines3, in rounds that can be resumed.

A round depends only on the previous model and on its own number, from which every seed is derived. A resumed
training therefore equals one that was never interrupted.
"""

from __future__ import annotations

import random
import time
import warnings
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from irsim.common.extras import require
from irsim.learning.sb3_env import SB3VecEnv
from irsim.learning.tasks.files import TaskSource, open_task
from irsim.learning.tasks.task import Task
from irsim.learning.training.extractor import READERS, columns_of
from irsim.learning.training.run_folder import RunFolder, loading, merit
from irsim.learning.training.settings import TrainingSettings
from irsim.learning.training.success import Round, measure_success
from irsim.learning.worlds import Worlds

require("learn", "torch", "stable_baselines3")
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer, RolloutBufferSamples
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import configure

__all__ = ["MaskedRolloutBuffer", "Round", "train"]


_LOWEST_RATE = 0.1
"""Share of the learning rate that is left at the end."""
_SCENES_PER_ROUND = 1_000_003
"""Distance between the seeds of two rounds: more than there are worlds."""


class _Active(BaseCallback):  # type: ignore[misc] # types of an extra are not read
    """Tells the memory which slots a step counted for."""

    def __init__(self) -> None:
        super().__init__()
        self.counted = 0

    def _on_step(self) -> bool:
        active = self.training_env.active
        self.model.rollout_buffer.now = active
        self.counted += int(active.sum())
        return True


def train(
    task: TaskSource,
    folder: str | Path,
    settings: TrainingSettings | None = None,
    *,
    resume: bool = False,
    steps: int | None = None,
    max_time: float | None = None,
    threads: int = 1,
    workers: int = 1,
    on_round: Callable[[Round], None] | None = None,
) -> Path:
    """Train a policy.

    Args:
        task: The task.
        folder: Where the training is kept.
        settings: Settings; a resumed training has its own.
        resume: Go on with the training in the folder.
        steps: Decisions of all learners at most, instead of the settings': a finished training goes on with
            more. The learning rate then falls to its end over all of them.
        max_time: Wall-clock time after which no further round begins, over all parts of the training [s].
        threads: Number of threads of torch, and of the simulation. Rounds are the same with the same number.
        workers: Number of processes that the simulation is divided among, this one included, with that many threads
            together; rounds do not depend on it.
        on_round: Called after each round.

    Returns:
        The best model.

    Raises:
        ArgumentError: The folder holds a training that is not to be resumed, or no training to resume; or the number
            of workers is not possible.
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
    """
    run = RunFolder(Path(folder))
    settings = run.settings_for(TrainingSettings, settings, steps, resume=resume)
    task = run.path / "task.yaml" if resume else task
    opened, where = open_task(task)
    one = Worlds(task, 1)
    torch.set_num_threads(threads)
    worlds = max(1, -(-settings.slots // one.learners))
    with closing(SB3VecEnv(task, worlds=worlds, threads=threads, workers=workers)) as env:
        if not resume:
            run.begin(opened, where, one.scenario.map_files, settings)
        _run_rounds(run, env, task, opened, settings, max_time=max_time, threads=threads, on_round=on_round)
    return run.best


def _run_rounds(
    run: RunFolder,
    env: SB3VecEnv,
    task: TaskSource,
    opened: Task,
    settings: TrainingSettings,
    *,
    max_time: float | None,
    threads: int,
    on_round: Callable[[Round], None] | None,
) -> None:
    """Train from the first round that is not done."""
    done = run.rounds()
    with warnings.catch_warnings():  # minibatches are of nearly equal sizes, whatever their number
        warnings.filterwarnings("ignore", message=".*mini-batch size.*")
        if not done:
            model = _model(env, opened, settings)
        else:
            with loading(run.latest):
                model = PPO.load(run.settle(), env, device="cpu")
    model.set_logger(configure(str(run.path / "tensorboard"), ["tensorboard"]))
    per_round = settings.rollout * env.num_envs * settings.round_updates
    rounds = max(1, -(-settings.steps // per_round))
    if env.ladder is not None and done:
        env.ladder.restore(done[-1])
    best = max(map(merit, done), default=(-1.0, 0.0))
    steps, before = (done[-1]["steps"], done[-1]["seconds"]) if done else (0, 0.0)
    for number in range(len(done) + 1, rounds + 1):
        if done and settings.stop_at is not None and best[0] >= settings.stop_at:
            break
        if done and max_time is not None and before >= max_time:
            break
        begin = time.perf_counter()
        counter = _begin_round(model, env, settings, number, rounds)
        model.learn(per_round, callback=counter, reset_num_timesteps=False, progress_bar=False)
        seeds = opened.seeds
        success = measure_success(
            task, lambda seen: model.predict(seen, deterministic=True)[0],
            seed=seeds.validation, count=seeds.validation_count, threads=threads,
        )  # fmt: skip
        steps += counter.counted
        before += time.perf_counter() - begin
        facts = {"round": number, "steps": steps, "seconds": round(before, 2), **asdict(success)}
        better = merit(facts) > best
        best = max(best, merit(facts))
        if env.ladder is not None:
            facts |= env.ladder.facts()
            model.logger.record("curriculum/level", env.ladder.level)
        run.save(model, facts, best=better)
        done.append(facts)
        for name, value in asdict(success).items():
            model.logger.record(f"validation/{name}", value)
        model.logger.dump(steps)
        if on_round is not None:
            on_round(Round(number, steps, before, success, better, rounds))


def _begin_round(model: Any, env: SB3VecEnv, settings: TrainingSettings, number: int, rounds: int) -> _Active:
    """Set seeds, scenes and learning rate of a round."""
    stream = np.random.SeedSequence([settings.seed, number]).generate_state(3)
    torch.manual_seed(int(stream[0]))
    np.random.seed(int(stream[1]))  # noqa: NPY002 - Stable-Baselines3 shuffles with this generator
    random.seed(int(stream[2]))
    env.seed(env.worlds.task.seeds.train + number * _SCENES_PER_ROUND)
    model._last_obs = None  # so that learn() begins with new episodes
    share = (number - 1) / max(1, rounds - 1)
    model.learning_rate = settings.rate * (1.0 - (1.0 - _LOWEST_RATE) * share)
    model._setup_lr_schedule()
    return _Active()


def _model(env: SB3VecEnv, task: Any, settings: TrainingSettings) -> Any:
    columns = columns_of(env.worlds.eyes, task.observation)
    sets = any(part.members is not None for part in columns)
    extractor = {
        "features_extractor_class": READERS[settings.set_reader],
        "features_extractor_kwargs": {"columns": columns, "units": tuple(settings.set_units)},
    }
    layers = list(settings.units)
    return PPO(
        "MlpPolicy",
        env,
        n_steps=settings.rollout,
        batch_size=settings.batch,
        n_epochs=settings.epochs,
        learning_rate=settings.rate,
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        clip_range=settings.clip,
        ent_coef=settings.entropy,
        rollout_buffer_class=MaskedRolloutBuffer,
        policy_kwargs={
            "net_arch": {"pi": layers, "vf": layers},
            "activation_fn": torch.nn.ReLU,
            "log_std_init": settings.log_std,
            **(extractor if sets else {}),
        },
        seed=settings.seed,
        device="cpu",
    )


class MaskedRolloutBuffer(RolloutBuffer):  # type: ignore[misc] # types of an extra are not read
    """Keeps which steps counted (``active``), and samples from those only.

    Attributes:
        active: (steps, slots) set by the environment's owner before each :meth:`add`.
        now: (slots,) whether the step that is added next counts.
    """

    now: Any = None
    generator_ready: bool

    def reset(self) -> None:
        """Forget everything."""
        super().reset()
        self.active = np.ones((self.buffer_size, self.n_envs), dtype=bool)

    def add(self, *args: Any, **kwargs: Any) -> None:
        """Add a step of all slots."""
        if self.now is not None:
            self.active[self.pos] = self.now
        super().add(*args, **kwargs)

    def get(self, batch_size: int | None = None) -> Generator[RolloutBufferSamples, None, None]:
        """Minibatches of the steps that counted, in random order and of nearly equal sizes."""
        assert self.full, "the buffer is sampled when it is full"
        if not self.generator_ready:
            for name in ("observations", "actions", "values", "log_probs", "advantages", "returns"):
                self.__dict__[name] = self.swap_and_flatten(self.__dict__[name])
            self.active = self.swap_and_flatten(self.active[..., None])[:, 0]
            self.generator_ready = True
        chosen = np.random.permutation(np.flatnonzero(self.active))  # noqa: NPY002 - the stream that SB3 seeds
        count = max(1, -(-len(chosen) // (batch_size or len(chosen) or 1)))
        for indices in np.array_split(chosen, count):
            if len(indices) > 1:  # the advantage of a single step has no deviation to divide by
                yield self._get_samples(indices)
