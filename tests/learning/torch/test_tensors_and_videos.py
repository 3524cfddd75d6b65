"""Tensors of torch that share memory with observations, files of ``torch.save``, and videos of Gymnasium's wrapper."""

from __future__ import annotations

import io
import subprocess
from pathlib import Path
from typing import Any

import gymnasium
import imageio_ffmpeg
import numpy as np
import pytest
import torch
from gymnasium.wrappers import RecordVideo
from PIL import Image
from torch import nn

from irsim.learning import VectorEnv
from irsim.policies.converters.torch_files.reader import parse_torch
from tests.learning.tasks import lidar_among_boxes, task

pytestmark = pytest.mark.learn


def test_torch_reads_observations_without_a_copy() -> None:
    env = VectorEnv(lidar_among_boxes(), 8, copy=False)
    seen, _ = env.reset(seed=3)
    tensor = torch.from_dlpack(seen)
    assert tensor.data_ptr() == seen.ctypes.data
    before = tensor.clone()
    env.step(torch.ones((8, 2)))
    assert not torch.equal(tensor, before)
    assert np.array_equal(tensor.numpy(), seen)


def test_actions_may_be_tensors() -> None:
    numbers, tensors = (VectorEnv(lidar_among_boxes(), 4) for _ in range(2))
    for env in (numbers, tensors):
        env.reset(seed=5)
    actions = np.random.default_rng(0).uniform(-1, 1, (20, 4, 2)).astype(np.float32)
    for given in actions:
        a, b = numbers.step(given)[0], tensors.step(torch.from_numpy(given))[0]
        assert np.array_equal(a, b)


def test_the_wrapper_of_gymnasium_writes_a_video_of_each_episode(tmp_path: Path) -> None:
    short = task({"state": [8, 5, 0]}, horizon=4)
    plain = gymnasium.make("irsim/Task-v0", task=short, render_mode="rgb_array")
    env = RecordVideo(plain, str(tmp_path / "videos"), episode_trigger=lambda _: True)
    steps = []
    for _ in range(2):
        env.reset(seed=1)
        over, count = False, 0
        while not over:
            _, _, terminated, truncated, _ = env.step(np.array([1, 0], dtype=np.float32))
            over, count = terminated or truncated, count + 1
        steps.append(count)
    env.close()
    videos = sorted((tmp_path / "videos").glob("*.mp4"))
    assert len(videos) == 2
    for video, count in zip(videos, steps, strict=True):
        folder = tmp_path / video.stem
        folder.mkdir()
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-i", str(video), str(folder / "%03d.png")]
        subprocess.run(command, check=True)
        files = sorted(folder.iterdir())
        assert len(files) == count + 1
        first, last = (np.asarray(Image.open(file), dtype=int) for file in (files[0], files[-1]))
        assert (np.abs(first - last) > 60).any(), "the robot has moved"


class Net(nn.Module):
    def __init__(self) -> None:
        super().__init__()
        self.rnn = nn.GRU(8, 4, bidirectional=True)
        self.pi = nn.Sequential(nn.Linear(4, 3), nn.ReLU(), nn.LayerNorm(3))
        self.log_std = nn.Parameter(torch.zeros(2))


@pytest.mark.parametrize("zipped", [True, False])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64, torch.float16, torch.bfloat16])
def test_weights_are_read_as_they_were_saved(zipped: bool, dtype: torch.dtype) -> None:
    torch.manual_seed(1)
    net = Net().to(dtype)
    adam = torch.optim.Adam(net.parameters())
    forms: list[tuple[Any, str]] = [
        (net.state_dict(), ""),
        (net, ""),
        ({"model": net.state_dict(), "optimizer": adam.state_dict(), "epoch": 3}, "model."),
    ]
    for saved, before in forms:
        target = io.BytesIO()
        torch.save(saved, target, _use_new_zipfile_serialization=zipped)
        arrays = parse_torch(target.getvalue(), "net.pth")
        assert arrays.keys() == {before + name for name in net.state_dict()}
        for name, tensor in net.state_dict().items():
            assert (arrays[before + name] == tensor.float().numpy()).all()
