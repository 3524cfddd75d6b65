"""From a training to a policy: a file that irsim runs without torch, and its model card."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from irsim.common.extras import require
from irsim.common.files import check_suffix, replace_bytes, write_atomically
from irsim.common.hashing import file_digest
from irsim.common.installed import version
from irsim.common.text import markdown_code, markdown_text
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.draws import observed_names
from irsim.learning.tasks.files import open_task
from irsim.learning.tasks.scene import task_scenario
from irsim.learning.tasks.task import Task
from irsim.learning.tasks.team import team_of
from irsim.learning.training.extractor import GruExtractor, PartColumns, columns_of
from irsim.learning.training.run_folder import RunFolder, loading, merit
from irsim.learning.training.settings import SarlSettings
from irsim.learning.worlds import Worlds
from irsim.policies.networks.document import PolicyDocument
from irsim.policies.networks.files import save_network
from irsim.policies.networks.network import Network, check_network, read_document
from irsim.policies.networks.values import Array

require("learn", "torch", "stable_baselines3")
import torch
from matplotlib.figure import Figure
from stable_baselines3 import PPO
from torch import nn

from irsim.learning.training.sarl.train import sarl_network_of

__all__ = ["export_policy", "network_of"]


_ACTIVATIONS = {nn.ReLU: "relu", nn.Tanh: "tanh", nn.ELU: "elu", nn.SiLU: "silu", nn.GELU: "gelu"}


def export_policy(folder: str | Path, out: str | Path, *, license: str = "", description: str = "") -> Path:
    """Write the best policy of a training to a file, and beside it its card (``.md``) and learning curve (``.png``).

    Args:
        folder: Folder of the training.
        out: The file, ``.npz``; or ``.onnx``, which other programs run, too.
        license: Licence of the weights, such as an SPDX identifier.
        description: Description of the policy; by default the title of the task.

    Returns:
        The file.

    Raises:
        ArgumentError: The folder holds no finished round of a training.
        TargetError: The file has another suffix.
        ExtraError: An ``.onnx`` file is asked for, and onnx is not installed.
    """
    target = Path(out)
    check_suffix(target, [".npz", ".onnx"])
    run = RunFolder(Path(folder))
    rounds = run.rounds()
    if not rounds or not run.best.is_file():
        raise ArgumentError(
            f"{folder} holds no finished round of a training", "train first: irsim train TASK -o FOLDER"
        )
    settings = run.settings()
    file = run.path / "task.yaml"
    task, _ = open_task(file)
    best = max(rounds, key=merit)
    card = {
        "description": description or task.title,
        "license": license,
        "source": f"irsim {version()}, {settings.algo}" + (" of Stable-Baselines3" if settings.algo == "ppo" else ""),
        "task": f"{task.task} version {task.version}, SHA-256 {file_digest(file)}",
        "protocol": task.protocol,
        "seeds": [settings.seed, task.seeds.train],
        "steps": best["steps"],
        "notes": {
            "validation_success": best["learners"],
            "validation_collided": best["collided"],
            "validation_first_seed": task.seeds.validation,
            "validation_episodes": task.seeds.validation_count,
            "training_seconds": best["seconds"],
        },
    }
    if isinstance(settings, SarlSettings):
        network = sarl_network_of(run.best, file, settings, card)
    else:
        with loading(run.best):
            model = PPO.load(run.best, device="cpu")
        network = network_of(model.policy, file, card)
    if target.suffix == ".onnx":
        from irsim.policies.networks.onnx.writing import save_onnx  # of another extra

        save_onnx(target, network)
    else:
        save_network(target, network)
    write_atomically(target.with_suffix(".md"), _card_text(target, task, card))
    draw_curve(rounds, task.title or task.task, target.with_suffix(".png"))
    return target


def network_of(policy: Any, source: Any, card: Mapping[str, Any] | None = None) -> Network:
    """The network of a policy of Stable-Baselines3 as layers of irsim; it decides without exploration.

    Args:
        policy: The policy.
        source: The task that it was trained on.
        card: Where it comes from.
    """
    task, folder = open_task(source)
    if observed_names(task):
        what = "the policy observes what is drawn for each episode, which only a simulation knows"
        raise ArgumentError(what, "train without randomize.observed")
    team = team_of(task, task_scenario(task, folder))
    columns = columns_of(Worlds(source, 1).eyes, task.observation)
    made = _Layers()
    last = made.read(policy, columns)
    meaning = task.action.meaning().model_dump(mode="json", exclude={"input"})
    data = {
        "layout": task.layout.model_dump(mode="json"),
        "network": made.layers,
        "output": {**meaning, "input": last},
        "drives": [team.drive] if task.action.returns == "control" else None,
        "card": dict(card or {}),
    }
    network = Network(read_document(PolicyDocument, data, "export"), made.arrays)
    check_network(network, "export")
    return network


class _Layers:
    """Collects layers and their arrays."""

    def __init__(self) -> None:
        self.layers: list[dict[str, Any]] = []
        self.arrays: dict[str, Array] = {}

    def read(self, policy: Any, columns: Sequence[PartColumns]) -> str:
        """Add the layers of a policy, and return the label of the last one."""
        features = self._read_features(policy.features_extractor, columns)
        hidden = self._perceptron(policy.mlp_extractor.policy_net, features, "hidden")
        return self._perceptron(nn.Sequential(policy.action_net), hidden, "decision")

    def _read_features(self, extractor: Any, columns: Sequence[PartColumns]) -> str:
        vectors = [part.label for part in columns if part.members is None]
        if isinstance(extractor, GruExtractor):
            read = [
                self._gru(extractor.readers[part.label], part.label) for part in columns if part.members is not None
            ]
            joined = self._add("concat", "joined", [*vectors, *read])
            features = self._add("layer_norm", "features", [joined], epsilon=float(extractor.norm.eps))
            self.arrays["features.scale"] = _numbers(extractor.norm.weight)
            self.arrays["features.shift"] = _numbers(extractor.norm.bias)
            return features
        pooled = []
        for part in columns:
            if part.members is not None:
                each = self._add("concat", f"each_{part.label}", [part.label, *vectors])
                hidden = self._perceptron(extractor.members[part.label], each, f"member_{part.label}")
                pooled.append(self._add("pool", f"pool_{part.label}", [hidden], method="max"))
        return self._add("concat", "features", [*vectors, *pooled])

    def _gru(self, reader: nn.GRU, label: str) -> str:
        made = self._add("gru", f"read_{label}", [label], units=reader.hidden_size, direction="both", merge="sum")
        for ending, suffix in (("", ""), ("_back", "_reverse")):
            for ours, theirs in (("wx", "weight_ih"), ("bx", "bias_ih"), ("wh", "weight_hh"), ("bh", "bias_hh")):
                self.arrays[f"{made}.{ours}{ending}"] = _numbers(getattr(reader, f"{theirs}_l0{suffix}"))
        return made

    def _add(self, name: str, label: str, inputs: list[str], **options: Any) -> str:
        self.layers.append({"name": name, "label": label, "inputs": inputs, **options})
        return label

    def _perceptron(self, modules: nn.Sequential, before: str, stem: str) -> str:
        linear = [(k, module) for k, module in enumerate(modules) if isinstance(module, nn.Linear)]
        for number, (k, module) in enumerate(linear):
            following = modules[k + 1] if k + 1 < len(modules) else None
            activation = "none" if following is None else _ACTIVATIONS[type(following)]
            before = self._add("dense", f"{stem}_{number}", [before], units=module.out_features, activation=activation)
            self.arrays[f"{before}.w"] = _numbers(module.weight)
            self.arrays[f"{before}.b"] = _numbers(module.bias)
        return before


def _numbers(tensor: torch.Tensor) -> Array:
    """Weights as an array; matrices are transposed, because layers of irsim have a column for each output."""
    array: Array = tensor.detach().T.contiguous().numpy() if tensor.ndim == 2 else tensor.detach().numpy()
    return array.astype("float32")


def _card_text(file: Path, task: Task, card: Mapping[str, Any]) -> str:
    """The card as Markdown."""
    notes = card["notes"]
    rows = {
        "task": card["task"],
        "observes": ", ".join(part.key for part in task.observation) + f" (layout version {task.layout.version})",
        "protocol": card["protocol"],
        "trained for": f"{card['steps']:,} decisions, {notes['training_seconds']:.0f} s",
        "seeds": f"training {card['seeds'][0]}, scenes from {card['seeds'][1]}",
        "success": f"{100 * notes['validation_success']:.1f} % of {notes['validation_episodes']} episodes on the seeds "
        f"from {notes['validation_first_seed']}, which were not trained on",
        "made with": card["source"],
        "licence": card["license"] or "not said",
        "SHA-256": file_digest(file),
    }
    table = "\n".join(f"| {key} | {markdown_text(value)} |" for key, value in rows.items())
    use = f"Use it: {markdown_code(f'irsim run SCENARIO --policy {file.name}')}"
    curve = f"![learning curve]({quote(file.stem)}.png)"
    head = f"# {markdown_text(file.stem)}\n\n{markdown_text(card['description'])}"
    return f"{head}\n\n| | |\n|---|---|\n{table}\n\n{use}\n\n{curve}\n"


def draw_curve(rounds: Sequence[Mapping[str, Any]], title: str, file: Path) -> None:
    """Draw success and collisions on the validation seeds against the decisions of the training.

    With one learner its success is the success of the episode, so one line shows both.

    Args:
        rounds: Facts of the rounds, in order.
        title: Title of the picture.
        file: The PNG to write.
    """
    figure = Figure(figsize=(6.4, 3.6), dpi=100, layout="constrained")
    axes = figure.add_subplot()
    decisions = [one["steps"] / 1e6 for one in rounds]
    for key, label, color in (
        ("learners", "robots that arrive without a collision", "#0072B2"),
        ("worlds", "episodes in which all of them do", "#009E73"),
        ("collided", "robots that collide", "#D55E00"),
    ):
        if key == "worlds" and all(one["worlds"] == one["learners"] for one in rounds):
            continue
        axes.plot(decisions, [100 * one[key] for one in rounds], color=color, label=label, marker=".", markersize=4)
    axes.set(xlabel="decisions [million]", ylabel="on validation seeds [%]", ylim=(-2, 102))
    axes.set_title(title, parse_math=False)
    axes.grid(alpha=0.3)
    axes.legend(loc="center right", fontsize="small")
    content = io.BytesIO()
    figure.savefig(content, format="png", metadata={"Software": None})
    replace_bytes(file, content.getvalue(), mode=None)
