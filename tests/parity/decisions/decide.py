"""One step of a scene with whichever `irsim` is installed; imported by the recorder and by the test."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import yaml

DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)  # of libyaml, where there is one


def decide(irsim: ModuleType, document: dict[str, Any], ids: list[int], folder: Path) -> np.ndarray:
    """(K, 3) executed commands of the objects `ids` in the first step, filled up with zeros."""
    path = folder / "scene.yaml"
    path.write_text(yaml.dump(document, Dumper=DUMPER), encoding="utf-8")
    env = irsim.make(str(path), headless=True, log_level="ERROR", seed=0)
    env.step()
    out = np.zeros((len(ids), 3))
    for k, i in enumerate(ids):
        velocity = np.asarray(env.robot_list[i].velocity, dtype=float).ravel()
        out[k, : velocity.size] = velocity
    env.end()
    return out
