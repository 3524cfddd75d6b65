"""The closed list of codes of diagnostics and errors, by subject; ``irsim describe CODE`` explains a code."""

from irsim.diagnostics.codes.audits import AUDITS
from irsim.diagnostics.codes.code import Code
from irsim.diagnostics.codes.drives import DRIVES
from irsim.diagnostics.codes.files_and_keys import FILE_AND_YAML, KEYS_AND_VALUES, MAPS_AND_LIMITS
from irsim.diagnostics.codes.objects import OBJECTS
from irsim.diagnostics.codes.tools import BRIDGES, TOOLS

__all__ = ["CODES", "TOOL_CODES", "Code"]

CODES: dict[str, Code] = {**FILE_AND_YAML, **KEYS_AND_VALUES, **OBJECTS, **DRIVES, **MAPS_AND_LIMITS}
"""Codes of findings about a scenario."""

TOOL_CODES: dict[str, Code] = {**TOOLS, **BRIDGES, **AUDITS}
"""Codes of errors outside scenarios: of the command line and other tools."""
