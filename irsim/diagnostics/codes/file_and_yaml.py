"""Codes of problems with the file and its YAML."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["FILE_AND_YAML"]

FILE_AND_YAML: dict[str, Code] = {
    # the file
    "file-not-found": Code(
        "scenario file not found",
        "No file of that name is in the places searched: as given, below sys.path[0], below the current directory, "
        "beside the running script. The message lists them and files with similar names.",
    ),
    "not-a-file": Code(
        "not a regular file", "The path names a directory, a device or a pipe. Name the YAML file itself."
    ),
    "image-not-found": Code(
        "image named by 'description' not found",
        "`description` names an image that is drawn instead of the shape: a file beside the scenario or the script,"
        " or a bundled one. Without it the shape is drawn. Addresses such as http: are not fetched.",
    ),
    "unreadable": Code(
        "file cannot be read",
        "The system refuses to read the file. Check the permissions and the path.",
    ),
    "not-text": Code("not a text file", "The file holds bytes that are not UTF-8 text. Save the scenario as UTF-8."),
    "file-too-large": Code(
        "file too large",
        "A scenario may have 16 MiB (servers may allow less). Write groups of objects with 'number' and "
        "'distribution' instead of one entry each.",
    ),
    "path-outside-workspace": Code(
        "path leads out of the workspace",
        "The program is confined to a folder, as irsim-mcp is to its --workspace. Scenarios, and the maps and "
        "pictures they name, must be in that folder, and paths must be relative to it (or to the scenario): no "
        "'..', no absolute path, no link that leads out, no device.",
    ),
    # YAML
    "yaml-syntax": Code(
        "not valid YAML",
        "The text breaks the grammar of YAML at this place. The cause is often a line earlier: a missing ':', an "
        "unclosed bracket or quote, a tab, or uneven indentation.",
    ),
    "empty-document": Code(
        "nothing in the file",
        "The file has only blanks or comments. A scenario is a mapping.",
    ),
    "multiple-documents": Code(
        "more than one YAML document", "A line '---' starts a second document. One file holds one scenario."
    ),
    "not-a-scenario": Code(
        "not a scenario",
        "The file is valid YAML, but its content is a list or a single value, or it is a file of another kind, such as"
        " a task or a suite. A scenario is a mapping with the keys world, robot, obstacle, gui, bridges, custom.",
    ),
    "duplicate-key": Code(
        "key given twice",
        "A mapping has the same key twice. YAML keeps the last value; remove one of them.",
    ),
    "bad-key": Code(
        "not usable as a key",
        "Keys must be words. Lists and mappings cannot be keys; '<<' merges mappings.",
    ),
    "unsupported-tag": Code(
        "YAML tag not supported",
        "Tags such as !!python/object construct program objects, and other programs would run them. Here a scenario"
        " is plain data: tags are reported and never executed. Remove the tag, and its value too if that makes no "
        "sense alone.",
    ),
    "recursive-alias": Code(
        "alias inside its own anchor",
        "The value would contain itself endlessly. Write it out instead.",
    ),
    "alias-expansion": Code(
        "aliases expand to too much",
        "Aliases (*name) and merge keys (<<) repeat so much that the scenario would not fit into memory.",
    ),
    "too-many-events": Code(
        "too many values",
        "The file has more values and brackets than the limit of 2 million.",
    ),
    "too-deep": Code("nested too deeply", "Lists and mappings are nested more than 64 levels deep."),
    "yaml-number-text": Code(
        "number that YAML 1.1 reads as text",
        "In YAML 1.1 a float needs a decimal point, a sign in its exponent, and a digit before the point if it has "
        "a sign: 1e3 and -.5 are text; 1.0e+3, 1000 and -0.5 are numbers.",
    ),
    "yaml-boolean": Code(
        "word that YAML 1.1 reads as a boolean",
        "yes, no, on, off, true and false are booleans unless quoted. Quote the word to keep it as text.",
    ),
    "yaml-sexagesimal": Code(
        "number in base 60",
        "YAML 1.1 reads 12:30:45 as 45045, in base 60. Quote it to keep it as text, or write the number.",
    ),
    "yaml-octal": Code(
        "octal number", "YAML 1.1 reads a number that starts with 0, such as 010, in base 8. Drop the leading zero."
    ),
}
"""Codes of a file that cannot be read, and of text that is not plain YAML data."""
