"""What could not be translated, told once."""

from __future__ import annotations


class Notes:
    """Sentences in the order in which they came up, without repetition."""

    def __init__(self) -> None:
        self._told: dict[str, None] = {}

    def tell(self, about: str, sentence: str) -> None:
        """Notes a sentence about a thing of the scene."""
        self._told.setdefault(f"{about}: {sentence}")

    def take(self, other: Notes) -> None:
        """Notes all sentences of others as well."""
        self._told |= other._told

    def all(self) -> tuple[str, ...]:
        return tuple(self._told)
