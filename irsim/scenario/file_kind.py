"""A kind of YAML file: its bundled examples, how it is recognized, read, checked and described by a schema."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import BaseModel, ValidationError

from irsim.common.json_output import schema_of_file
from irsim.diagnostics.diagnostic import Diagnostic, is_slip_of
from irsim.scenario.messages.translate import Special, located, translate
from irsim.scenario.yaml.document import Document, load_text, text_of

__all__ = ["MOST_PROBLEMS", "FileKind", "explained", "schema_text"]

MOST_PROBLEMS = 10
"""Largest number of problems of a file that are listed."""
Model = TypeVar("Model", bound=BaseModel)


def explained(
    failure: ValidationError,
    document: Document,
    model: type[BaseModel],
    special: Special = lambda _: None,
) -> list[Diagnostic]:
    """The errors of a validation in the words of scenarios, without their lines; arguments as for ``translate``."""
    findings = translate(failure, document.data, document, MOST_PROBLEMS, model, special)
    return [item.diagnostic for item in findings]


def schema_text(schema: dict[str, Any]) -> str:
    """A JSON Schema as the text of a file."""
    return json.dumps(schema_of_file(schema), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


@dataclass(frozen=True)
class FileKind(Generic[Model]):
    """A kind of file whose content one model describes.

    Attributes:
        key: Top-level key that every such file has, and no other file.
        model: Model of its content.
        folder: Folder of the bundled ones, ``<name>.yaml`` each.
        error: Makes the exception of a document with problems.
        explain: Says what a validation found wrong.
    """

    key: str
    model: type[Model]
    folder: Path
    error: Callable[[Document, Sequence[Diagnostic]], Exception]
    explain: Callable[[ValidationError, Document, type[BaseModel]], list[Diagnostic]] = explained

    def names(self) -> list[str]:
        """Names of the bundled ones, sorted."""
        return sorted(path.stem for path in self.folder.glob("*.yaml"))

    def bundled(self, name: str) -> Path:
        """The file of a bundled one."""
        return self.folder / f"{name}.yaml"

    def is_document(self, document: Document) -> bool:
        """Whether a document is of this kind."""
        return isinstance(document.data, dict) and self.key in document.data

    def is_text(self, text: str) -> bool:
        """Whether a YAML text is of this kind."""
        return self.is_document(load_text(text))

    def is_file(self, word: str) -> bool:
        """Whether a word is the path of a file of this kind."""
        path = Path(word)
        if path.suffix not in (".yaml", ".yml") or not path.is_file():
            return False
        text = text_of(word)
        # Most files are scenarios, and large ones take seconds to parse.
        return isinstance(text, str) and (self.key in text or "\\" in text) and self.is_text(text)

    def is_named(self, word: str) -> bool:
        """Whether a word names a bundled one, perhaps misspelt."""
        path = Path(word)
        known = self.names()
        return word in known or (not path.suffix and not path.exists() and any(is_slip_of(word, one) for one in known))

    def read(self, document: Document, context: Any = None) -> Model:
        """Check a document; all of its problems are in the exception that ``error`` makes.

        Args:
            document: The document.
            context: Further data that pydantic passes to the validators of the model.
        """
        errors = [item for item in document.problems if item.severity == "error"]
        if errors and (document.fatal or document.data is None):
            raise self.error(document, errors)
        try:
            content = self.model.model_validate(document.data, context=context)
        except ValidationError as failure:
            wrong = [located(item, document) for item in self.explain(failure, document, self.model)]
            raise self.error(document, [*errors, *wrong]) from None
        if errors:
            raise self.error(document, errors)
        return content

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the files."""
        return schema_of_file(self.model.model_json_schema())

    def schema_text(self) -> str:
        """The JSON Schema as the text of a file."""
        return schema_text(self.model.model_json_schema())
