"""``irsim convert`` and ``irsim export-policy``: make a policy file of weights, or of a training."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irsim.cli.output import existing, show_written
from irsim.common.files import check_new
from irsim.policies.converters.convert import convert_policy, parse_options

__all__ = ["convert", "export_policy"]


def convert(
    kind: Annotated[
        str,
        typer.Argument(metavar="KIND", help="Kind of weights, such as rl_rvo; irsim describe convert explains all."),
    ],
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="File that torch.save wrote: a state dictionary, or a whole module.")
    ],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Policy file to write, .npz.")],
    options: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Set KEY to VALUE, an option of the kind, such as license=MIT (irsim describe convert). Repeatable.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")] = False,
) -> None:
    """Make a policy file of weights that others trained with PyTorch; no code of their file runs, and no torch.

    The file may be a state dictionary or a whole module, in both formats of torch.save. Tensors are found by their
    names and shapes; the message names what is missing.
    """
    check_new(out, overwrite=force)
    before = existing(out)
    network = convert_policy(kind, file, out, parse_options(options or []))
    parameters = sum(array.size for array in network.arrays.values())
    show_written(out, f"{parameters:,} parameters", before=before)
    typer.echo(f"try it: irsim run SCENARIO --policy {out}")


def export_policy(
    training: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder of the training.")],
    out: Annotated[
        Path,
        typer.Option(
            "-o", "--out", metavar="FILE", help="File to write, .npz or .onnx; its card and curve get .md and .png."
        ),
    ],
    license: Annotated[str, typer.Option("--license", help="Licence of the weights, such as MIT.")] = "",
    description: Annotated[
        str, typer.Option("--description", help="A sentence about the policy; default: the title.")
    ] = "",
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file and its card if they exist.")] = False,
) -> None:
    """Make a policy file of a training, with its model card and curve; needs the extra `learn`.

    irsim runs .npz files with NumPy alone, without torch. An .onnx file is for other programs and takes the extra
    `onnx`.
    """
    for made in (out, out.with_suffix(".md")):
        check_new(made, overwrite=force)
    before = existing(out)
    from irsim.learning.training.export import export_policy as export

    file = export(training, out, license=license, description=description)
    card, curve = file.with_suffix(".md"), file.with_suffix(".png")
    show_written([str(one) for one in (file, card, curve)], before=before)
    typer.echo(f"try it: irsim run SCENARIO --policy {file}")
