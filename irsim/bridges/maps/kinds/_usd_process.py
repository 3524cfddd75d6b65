"""The process that reads a stage of OpenUSD: JSON as a request and as an answer, triangles to a file."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.maps.kinds._usd_shapes import Collector, Refused
from irsim.common.child import limit

__all__ = ["main"]

_MEMORY = 12 * 1024**3
"""Address space of the process [bytes]."""
_MAX_LAYERS = 5_000


def main() -> None:
    """Read the request, answer it."""
    request = json.loads(sys.stdin.read())
    limit(memory=_MEMORY)
    try:
        answer = _read(request)
    except Refused as refused:
        answer = dict(zip(("error", "fix"), refused.args, strict=False))
    except MemoryError:
        answer = {"error": "it does not fit into memory", "fix": "give a smaller stage"}
    except Exception as error:  # whatever the library stumbles over is the file's fault
        answer = {"error": f"it is damaged ({type(error).__name__}: {str(error).strip().splitlines()[-1][:150]})"}
    print("\n" + json.dumps(answer), flush=True)
    os._exit(0)  # what the library does at its end can fail, and nothing is left to do


def _read(request: dict[str, Any]) -> dict[str, Any]:
    from pxr import Usd, UsdGeom

    path = Path(request["file"])

    missing = _check_layers(path)
    stage = Usd.Stage.Open(str(path))
    if stage is None:
        raise Refused("it is damaged: no stage can be opened from it")
    up = str(UsdGeom.GetStageUpAxis(stage)) if request["up"] == "auto" else request["up"].upper()
    scale = float(request["unit"] or UsdGeom.GetStageMetersPerUnit(stage))
    if not 1e-6 <= scale <= 1e6:
        raise Refused(f"its metersPerUnit is {scale:g}", "set metersPerUnit of the stage")
    collector = Collector(int(request["triangles"]))
    triangles = collector.stage(stage) * scale
    if up == "Y":
        triangles = np.stack([triangles[..., 0], -triangles[..., 2], triangles[..., 1]], axis=-1)
    np.savez(request["out"], triangles=triangles)
    left_out = ", ".join(sorted(collector.left_out))
    notes = [f"prims of these types were left out: {left_out}"] if left_out else []
    if request["unit"] is None and not UsdGeom.StageHasAuthoredMetersPerUnit(stage):
        notes.append(f"it does not say its unit, which is then {scale:g} m; --meters-per-unit gives another")
    if len(missing) == 1:
        notes.append(f"one of its layers was not found: '{missing[0][:150]}'")
    elif missing:
        notes.append(f"{len(missing)} of its layers were not found, such as '{missing[0][:150]}'")
    return {"meters_per_unit": scale, "frame": "usd_yup" if up == "Y" else "usd", "notes": notes}


def _check_layers(path: Path) -> list[str]:
    """All layers that the stage is made of lie in the folder of the file, or inside of it; those that are missing."""
    from pxr import Sdf

    root = path.resolve().parent
    waiting, met = [str(path)], set[str]()
    missing = []
    while waiting:
        name = waiting.pop()
        if name in met:
            continue
        met.add(name)
        if len(met) > _MAX_LAYERS:
            raise Refused(f"it is made of more than {_MAX_LAYERS:,} layers")
        layer = Sdf.Layer.FindOrOpen(name)
        if layer is None:
            if name == str(path):
                raise Refused("it is damaged: it cannot be opened")
            missing.append(os.path.basename(name))
            continue  # the stage is composed without it
        for asset in filter(None, layer.GetCompositionAssetDependencies()):  # no name stands for the layer itself
            target = layer.ComputeAbsolutePath(asset)
            _check_reference(asset, target, root, path)
            waiting.append(target)
    return missing


def _check_reference(asset: str, target: str, root: Path, path: Path) -> None:
    file = target.partition("[")[0]
    inside = os.path.isabs(file) and "://" not in target and Path(file).resolve().is_relative_to(root)
    if os.path.isabs(asset) or "://" in asset or not inside:
        shown = asset[:150]
        fix = "put all its files into one folder, or flatten the stage: usdcat --flatten"
        raise Refused(f"it refers to '{shown}', which is outside of its folder and is not read", fix)


if __name__ == "__main__":
    main()
