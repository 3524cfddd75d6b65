"""Trains a value network for a task, in rounds that can be resumed.

The first round imitates the behaviors of the scenario. A round depends only on the previous model and
memory and on its own number, from which every seed is derived. A resumed training therefore equals one that was never
interrupted.
"""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.common.extras import require
from irsim.learning.tasks.files import TaskSource, open_task
from irsim.learning.training.run_folder import RunFolder, loading, merit
from irsim.learning.training.sarl.play import Driver, Experience, Memory, play
from irsim.learning.training.sarl.task import Plan, plan_of
from irsim.learning.training.settings import SarlSettings
from irsim.learning.training.success import Round, Success
from irsim.learning.worlds import Worlds
from irsim.policies.networks.network import Network
from irsim.policies.networks.sarl import sarl_network

require("learn", "torch")
import torch

from irsim.learning.training.sarl.net import ValueNet

__all__ = ["sarl_network_of", "train_sarl"]

_LOWEST_RATE = 0.1
"""Share of the learning rate that is left at the end."""
_SCENES_PER_ROUND = 1_000_003
"""Distance between the seeds of two rounds: more than there are worlds."""
_LARGEST_GRADIENT = 1.0
"""Norm to which gradients are cut."""


class _Model:
    """The network, the target network, the optimizer and the memory.

    Args:
        settings: The settings.
        width: Numbers of a state.
    """

    def __init__(self, settings: SarlSettings, width: int) -> None:
        torch.manual_seed(settings.seed)
        self.settings = settings
        self.net, self.target = ValueNet(settings), ValueNet(settings)
        self.optimizer = torch.optim.AdamW(self.net.parameters(), lr=settings.rate, weight_decay=settings.decay)
        self.memory = Memory(settings.memory, width)
        self.updates = 0
        self.copy()

    def copy(self) -> None:
        """Copy the present network into the target network."""
        self.target.load_state_dict(self.net.state_dict())

    def values(self, states: NDArray[np.float32]) -> Floats:
        """(N,) values of the present network."""
        with torch.no_grad():
            values: Floats = self.net(torch.from_numpy(states)).numpy().astype(np.float64)
        return values

    def rate(self, share: float) -> None:
        """Set the learning rate after a share of the training."""
        for group in self.optimizer.param_groups:
            group["lr"] = self.settings.rate * (1.0 - (1.0 - _LOWEST_RATE) * min(share, 1.0))

    def fit(self, states: NDArray[np.float32], wanted: NDArray[np.float32]) -> None:
        """One step toward values of states."""
        loss = torch.nn.functional.mse_loss(self.net(torch.from_numpy(states)), torch.from_numpy(wanted))
        self.optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.net.parameters(), _LARGEST_GRADIENT)
        self.optimizer.step()

    def update(self, rng: np.random.Generator) -> None:
        """One step toward reward and value of what followed."""
        memory = self.memory
        some = rng.integers(len(memory), size=self.settings.batch)
        with torch.no_grad():
            later = self.target(torch.from_numpy(memory.following[some])).numpy()
        self.fit(memory.state[some], memory.reward[some] + memory.discount[some] * later)
        self.updates += 1
        if self.updates % self.settings.target_updates == 0:
            self.copy()

    def save(self, file: IO[bytes]) -> None:
        """Write everything that a training needs to go on."""
        memory = {
            key: torch.from_numpy(x) if isinstance(x, np.ndarray) else x for key, x in self.memory.contents().items()
        }
        nets = {"net": self.net.state_dict(), "target": self.target.state_dict()}
        content = io.BytesIO()
        torch.save(
            {**nets, "optimizer": self.optimizer.state_dict(), "memory": memory, "updates": self.updates}, content
        )
        file.write(content.getvalue())

    def load(self, file: Path) -> None:
        """Read what :meth:`save` has written."""
        with loading(file):
            self._load(torch.load(file, weights_only=True))

    def _load(self, stored: dict[str, Any]) -> None:
        self.net.load_state_dict(stored["net"])
        self.target.load_state_dict(stored["target"])
        self.optimizer.load_state_dict(stored["optimizer"])
        memory = stored["memory"]
        self.memory.restore({key: x.numpy() if isinstance(x, torch.Tensor) else x for key, x in memory.items()})
        self.updates = int(stored["updates"])


def train_sarl(
    task: TaskSource,
    folder: str | Path,
    settings: SarlSettings | None = None,
    *,
    resume: bool = False,
    steps: int | None = None,
    max_time: float | None = None,
    threads: int = 1,
    on_round: Callable[[Round], None] | None = None,
) -> Path:
    """Train a value network.

    Args:
        task: The task; its observation, action and reward are as in ``sarl_circle``.
        folder: Where the training is kept.
        settings: Settings; a resumed training has its own.
        resume: Go on with the training in the folder.
        steps: Decisions of all learners after the demonstrations at most, instead of the settings'.
        max_time: Wall-clock time after which no further round begins, over all parts of the training [s].
        threads: Number of threads of the simulation and of torch. Rounds are the same with the same number.
        on_round: Called after each round.

    Returns:
        The best model.

    Raises:
        ArgumentError: The folder holds a training that is not to be resumed, or no training to resume.
        TaskError: The task is invalid, does not fit its scenario, or cannot be learned with a value network.
        ScenarioError: The scenario cannot be used.
    """
    run = RunFolder(Path(folder))
    settings = run.settings_for(SarlSettings, settings, steps, resume=resume)
    task = run.path / "task.yaml" if resume else task
    opened, where = open_task(task)
    plan = plan_of(opened, settings)
    one = Worlds(task, 1)
    if not resume:
        run.begin(opened, where, one.scenario.map_files, settings)
    torch.set_num_threads(threads)
    trainer = _Trainer(task, plan, settings, threads, max(1, -(-settings.slots // one.learners)), one.eyes.size)
    done = run.rounds()
    if done:
        trainer.model.load(run.settle())
    best = max(map(merit, done), default=(-1.0, 0.0))
    counted, before = (done[-1]["steps"], done[-1]["seconds"]) if done else (0, 0.0)
    while not done or counted < settings.steps:
        if done and settings.stop_at is not None and best[0] >= settings.stop_at:
            break
        if done and max_time is not None and before >= max_time:
            break
        begin, number = time.perf_counter(), len(done) + 1
        rng = np.random.default_rng([settings.seed, number])
        if number == 1:
            trainer.demonstrate(rng)
        else:
            counted += trainer.explore(number, counted, rng)
        success = trainer.measure()
        before += time.perf_counter() - begin
        facts = {"round": number, "steps": counted, "seconds": round(before, 2), **asdict(success)}
        better = merit(facts) > best
        best = max(best, merit(facts))
        run.save(trainer.model, facts, best=better)
        done.append(facts)
        if on_round is not None:
            left = max(0, settings.steps - counted) / max(1, counted / max(1, number - 1)) if counted else 1
            on_round(Round(number, counted, before, success, better, number + int(np.ceil(left))))
    return run.best


class _Trainer:
    """The worlds of a training, and its model."""

    def __init__(
        self, task: TaskSource, plan: Plan, settings: SarlSettings, threads: int, worlds: int, width: int
    ) -> None:
        self._task, self._plan, self._settings, self._threads = task, plan, settings, threads
        self.model = _Model(settings, width)
        self._worlds = Worlds(task, worlds, threads=threads)
        self._first = self._worlds.task.seeds.train

    def demonstrate(self, rng: np.random.Generator) -> None:
        """Learn values from episodes that the behaviors of the scenario drive."""
        settings, worlds, model = self._settings, self._worlds, self.model
        worlds.reset(seeds=self._seeds(1))
        experiences: list[Experience] = []
        for number in range(-(-settings.demonstrations // worlds.n)):
            if number:
                worlds.reset()
            experiences.append(play(worlds, self._plan, None, 0.0, rng).experience)
            model.memory.add(experiences[-1])
        state, gain = (np.concatenate([getattr(one, name) for one in experiences]) for name in ("state", "gain"))
        for epoch in range(settings.demonstration_epochs):
            model.rate(epoch / settings.demonstration_epochs)
            order = rng.permutation(len(state))
            for first in range(0, len(order), settings.batch):
                some = order[first : first + settings.batch]
                model.fit(state[some], gain[some])
        model.copy()

    def explore(self, number: int, counted: int, rng: np.random.Generator) -> int:
        """Play and learn for a round, and return the number of decisions."""
        settings, worlds, model = self._settings, self._worlds, self.model
        worlds.reset(seeds=self._seeds(number))
        driver = Driver(worlds, self._plan, model.values)
        made = 0
        for episode in range(settings.round_episodes):
            if episode:
                worlds.reset()
            share = (counted + made) / settings.steps
            model.rate(share)
            fallen = min(1.0, share / max(settings.explore_until, 1e-9))
            chance = settings.explore + (settings.explore_end - settings.explore) * fallen
            experience = play(worlds, self._plan, driver, chance, rng).experience
            made += len(experience)
            model.memory.add(experience)
            for _ in range(settings.updates):
                model.update(rng)
        return made

    def measure(self) -> Success:
        """Success of the network on the validation seeds, without random moves."""
        seeds = self._worlds.task.seeds
        last = len(self._worlds.task.levels) - 1
        worlds = Worlds(self._task, seeds.validation_count, seed=seeds.validation, threads=self._threads, level=last)
        driver = Driver(worlds, self._plan, self.model.values)
        return play(worlds, self._plan, driver, 0.0, np.random.default_rng(0)).success

    def _seeds(self, number: int) -> list[int]:
        first = self._first + number * _SCENES_PER_ROUND
        return [first + i for i in range(self._worlds.n)]


def sarl_network_of(file: Path, source: Any, settings: SarlSettings, card: dict[str, Any] | None = None) -> Network:
    """The value network of a training as layers of irsim.

    Args:
        file: The model.
        source: The task that it was trained on.
        settings: The settings of the training.
        card: Where it comes from.
    """
    task, _ = open_task(source)
    plan = plan_of(task, settings)
    with loading(file):
        weights = {name: x.numpy() for name, x in torch.load(file, weights_only=True)["net"].items()}
    ahead = plan.lookahead.model_dump(mode="json")
    return sarl_network(
        weights, lookahead=ahead, neighbors=plan.people, range=plan.range, heading=plan.heading,
        decision_dt=settings.dt, card=card,
    )  # fmt: skip
