"""Everything that gradings import, loaded once in the server from which their processes are forked."""

from __future__ import annotations

import importlib
import pkgutil

import matplotlib.colors  # noqa: F401
import shapely.affinity  # noqa: F401

import irsim.components
import irsim.env
import irsim.validation.diff.compare
import irsim_evals.grader.grade  # noqa: F401

for _module in pkgutil.walk_packages(irsim.components.__path__, "irsim.components."):
    importlib.import_module(_module.name)
