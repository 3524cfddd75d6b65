"""Files that ``torch.save`` writes today are read without torch."""

from __future__ import annotations

import io
from typing import Any

import pytest
import torch
from torch import nn

from irsim.policies.converters.torch_files.reader import parse_torch

pytestmark = pytest.mark.learn


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
