"""Scenario templates: ready-made files with named parameters.

A template is a folder with a picture of its start and two files. ``scenario.yaml`` is a complete scenario, usable as it
is; ``template.yaml`` gives its purpose, its parameters, and the values of the scenario that follow from them (see
:mod:`.store`). Filling a template replaces only those values in the text, so comments and layout stay.
"""

from irsim.bundled.templates.fill import fill, parse_settings
from irsim.bundled.templates.store import (
    Parameter,
    Template,
    TemplateError,
    find,
    load,
    load_all,
    meant,
    names,
    picture_file,
    scenario_file,
)

__all__ = [
    "Parameter",
    "Template",
    "TemplateError",
    "fill",
    "find",
    "load",
    "load_all",
    "meant",
    "names",
    "parse_settings",
    "picture_file",
    "scenario_file",
]
