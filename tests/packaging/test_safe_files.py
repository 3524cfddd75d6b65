"""YAML, JSON, archives, arrays and pictures of users are read by the safe readers: others are listed, with reasons."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
OWN, PEER = "what irsim wrote itself", "lines of a process of irsim"
KNOWN = {
    "irsim/benchmarks/cluster.py": PEER,
    "irsim/benchmarks/controlled.py": PEER,
    "irsim/benchmarks/pool.py": PEER,
    "irsim/bridges/export/formats/npz.py": OWN,
    "irsim/bridges/maps/apart.py": PEER,
    "irsim/bridges/ros/guard.py": PEER,
    "irsim/common/archives.py": "the reader of archives and arrays",
    "irsim/common/data_files.py": "files of the package",
    "irsim/common/pictures.py": "the reader of pictures",
    "irsim/common/records.py": "the reader of JSON",
    "irsim/compat/names.py": "a file of the package",
    "irsim/graphics/encoding/animation.py": OWN,
    "irsim/graphics/encoding/contact_sheet.py": OWN,
    "irsim/core/backend/irsim_build.py": "the wheel that it has just built",
    "irsim/learning/training/sarl/train.py": "weights_only, and whatever it raises is an error of the folder",
    "irsim/learning/workers/process.py": PEER,
    "irsim/rendering/saving.py": OWN,
    "irsim/studio/worker.py": PEER,
    "irsim/studio/workers.py": PEER,
    "irsim/runs/replay/drawing.py": OWN,
    "mcp_server/irsim_mcp/frames.py": "says which part of a message is not JSON",
    "mcp_server/irsim_mcp/job.py": PEER,
    "mcp_server/irsim_mcp/jobs.py": PEER,
    "mcp_server/irsim_mcp/tool.py": "a text that stays a text if it is not JSON",
    "mcp_server/irsim_mcp/worker.py": PEER,
    "evals/irsim_evals/baselines/repair.py": "texts of the package",
    "evals/irsim_evals/baselines/server.py": PEER,
    "evals/irsim_evals/grader/run_program.py": "the log of a process of irsim_evals",
    "evals/irsim_evals/proof/mutants.py": "texts of the package",
    "evals/irsim_evals/proof/oracle/opinions.py": "texts of the package",
    "evals/irsim_evals/proof/rewrites.py": "texts of the package",
    "evals/irsim_evals/proof/trials.py": "texts of the package",
}
"""Files that may read otherwise, and why."""
READING = {
    "yaml.load", "yaml.safe_load", "yaml.full_load", "yaml.unsafe_load", "json.load", "json.loads", "zipfile.ZipFile",
    "ZipFile", "tarfile.open", "gzip.open", "np.load", "np.loadtxt", "np.genfromtxt", "torch.load", "pickle.load",
    "pickle.loads", "Image.open",
}  # fmt: skip
"""Calls that read a file or a text without limits, or raise what only their library knows."""


def readers() -> dict[str, set[str]]:
    """File -> calls that read, for all Python of the three packages."""
    matches: dict[str, set[str]] = {}
    for package in ("irsim", "mcp_server", "evals"):
        for path in sorted((ROOT / package).rglob("*.py")):
            try:
                tree = ast.parse(path.read_text(encoding="utf-8"))
            except SyntaxError:  # a template of a program
                continue
            names = {ast.unparse(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
            if reading := names & READING:
                matches[path.relative_to(ROOT).as_posix()] = reading
    return matches


@pytest.mark.one_python
def test_files_of_users_have_one_reader_for_each_kind() -> None:
    matches = readers()
    others = {file: sorted(calls) for file, calls in matches.items() if file not in KNOWN}
    assert not others, "use irsim.common.records, irsim.common.yaml.plain, irsim.common.archives or .pictures"
    assert set(KNOWN) <= set(matches), "a file that reads nothing any more"
