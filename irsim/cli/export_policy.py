"""``irsim export-policy``: make a policy file of a training."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["export_policy"]


def export_policy(
    training: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder of the training.")],
    out: Annotated[
        Path, typer.Argument(metavar="FILE", help="File to write, .npz or .onnx; its card and curve get .md and .png.")
    ],
    license: Annotated[str, typer.Option("--license", help="Licence of the weights, such as MIT.")] = "",
    description: Annotated[str, typer.Option("--description", help="What the policy does; default: the title.")] = "",
) -> None:
    """Make a policy file of a training, with its model card and curve; needs the extra `learn`.

    irsim runs .npz files with NumPy alone, without torch. An .onnx file is for other programs and takes the extra
    `onnx`.
    """
    from irsim.learning.training.export import export_policy as export

    file = export(training, out, license=license, description=description)
    card, curve = file.with_suffix(".md"), file.with_suffix(".png")
    typer.echo(f"wrote {file}, {card} and {curve}; try it: irsim run SCENARIO --policy {file}")
