"""Reading another table's cells: taxonomy values by their spellings, angles with their units."""

from __future__ import annotations

import re
import unicodedata
from difflib import SequenceMatcher
from itertools import chain

from survey_data.accuracy_classes import accuracy_class
from survey_data.nearest import nearest_name
from survey_data.tables import SurveyTables

_NOT_STATED = {
    *("", "none", "na", "n a", "nan", "unknown"),
    *("not stated", "not reported", "tbd", "null"),
}
_DEGREES = {"deg": 1.0, "arcmin": 1 / 60, "arcsec": 1 / 3600}
_MARKS = {"'": "arcmin", '"': "arcsec", "''": "arcsec"}
_UNIT = r"deg(?:ree)?s?|°|arc-?\s?min(?:ute)?s?|'|′|arc-?\s?sec(?:ond)?s?|\"|″|''"
_ANGLE = re.compile(
    rf"[~≈=]{{0,2}}\s*(?P<half>±|\+/-|\+-)?\s*(?P<number>[0-9]+(?:[.,][0-9]+)?(?:e-?[0-9]+)?)"
    rf"\s*(?P<unit>{_UNIT})?"
    rf"(?:\s*[x×]\s*(?P<second>[0-9]+(?:[.,][0-9]+)?)\s*(?:{_UNIT})?)?",
    re.IGNORECASE,
)
_INEQUALITY = re.compile(r"[<≤>≥]|[<>]=")
#: Longer texts list no values: a cell of all 137 of them is shorter.
_LONGEST = 5000
_SHOWN = 80


def normalise(text: str) -> str:
    """Return a label in lower case, without accents, punctuation and plural endings."""
    decomposed = unicodedata.normalize("NFKD", text)
    plain = "".join(letter for letter in decomposed if not unicodedata.combining(letter))
    words = re.findall(r"[^\W_]+", plain.casefold())
    return " ".join(re.sub(r"(?<=..[^s])s$", "", word) for word in words)


def similarity(one: str, other: str) -> float:
    """Return how alike two normalised labels are, from 0 to 1."""
    return 1.0 if one == other else SequenceMatcher(None, one, other, autojunk=False).ratio()


def states_nothing(text: str) -> bool:
    """Say whether a text is one of the words for a value that a study does not state."""
    return normalise(text) in _NOT_STATED


class UnreadableValueError(ValueError):
    """A cell's text is no value of the attribute."""


class ValueReader:
    """Reads cells of a categorical or numeric attribute."""

    def __init__(self, tables: SurveyTables) -> None:
        self._tables = tables
        rows = tables.attribute_definitions.to_dict("records")
        self._definitions = {str(row["attribute"]): row for row in rows}
        kinds = tables.statistics
        spelt: list[tuple[str, str, str]] = [
            *zip(*(tables.aliases[name] for name in ("attribute", "alias", "value")), strict=True),
            *zip(*(tables.taxonomy[name] for name in ("attribute", "name", "value")), strict=True),
        ]
        for attribute, definition in self._definitions.items():
            if definition["kind"] == "statistic":
                for kind, name in zip(kinds["kind"], kinds["name"], strict=True):
                    spelt += [(attribute, name, kind), (attribute, kind, kind)]
        # attribute -> normalised spelling -> values it may stand for
        self._spellings: dict[str, dict[str, set[str]]] = {}
        for attribute, spelling, value in spelt:
            of_attribute = self._spellings.setdefault(str(attribute), {})
            of_attribute.setdefault(normalise(str(spelling)), set()).add(str(value))
        for row in tables.taxonomy.to_dict("records"):
            # a value's own label means that value and no other
            self._spellings[row["attribute"]][normalise(row["value"])] = {row["value"]}

    def is_numeric(self, attribute: str) -> bool:
        """Say whether the attribute holds numbers."""
        return bool(self._definitions[attribute]["kind"] == "numeric")

    def read(self, attribute: str, text: str, unit: str = "deg") -> list[str]:
        """Return the values a cell states, in their order; an empty list where it states none.

        Several values are parted by comma, semicolon, bar or line break, or by slash, ampersand,
        plus or 'and' where the whole is not itself a value (ECM/Noise is). `unit` is that of a
        number without one: deg, arcmin or arcsec. UnreadableValueError where a piece is no value,
        or could be several.
        """
        if len(text) > _LONGEST:
            raise UnreadableValueError(
                f"expected at most {_LONGEST} characters for {attribute}, got {len(text)}: "
                f"{text[:_SHOWN]!r} ..."
            )
        if not self._states_something(attribute, text):
            return []
        if self.is_numeric(attribute):
            return [self._read_number(attribute, text, unit)]
        if self._lookup(attribute, text):
            return [self._read_piece(attribute, text)]
        pieces = _split(text, r"[,;|\n\r]+")
        stated = [piece for piece in pieces if self._states_something(attribute, piece)]
        values = (self._read_compound(attribute, piece, unit) for piece in stated)
        return list(dict.fromkeys(chain.from_iterable(values)))

    def _states_something(self, attribute: str, text: str) -> bool:
        is_value = normalise(text) == "none" and "none" in self._spellings.get(attribute, {})
        return is_value or not states_nothing(text)

    def _lookup(self, attribute: str, text: str) -> set[str]:
        return self._spellings[attribute].get(normalise(text), set())

    def _read_compound(self, attribute: str, piece: str, unit: str) -> list[str]:
        if attribute == "accuracy" and (_ANGLE.fullmatch(piece) or _INEQUALITY.match(piece)):
            degrees = self._degrees(attribute, piece, unit)
            return [accuracy_class(self._tables.taxonomy, degrees)]
        try:
            return [self._read_piece(attribute, piece)]
        except UnreadableValueError:
            parts = _split(piece, r"[/&+]|\band\b")
            if len(parts) < 2 or self._lookup(attribute, piece):
                raise
        return [self._read_piece(attribute, part) for part in parts]

    def _read_piece(self, attribute: str, piece: str) -> str:
        values = sorted(self._lookup(attribute, piece))
        if len(values) == 1:
            return values[0]
        if values:
            raise UnreadableValueError(
                f"{piece!r} may stand for {' or '.join(values)} of {attribute}"
            )
        spellings = self._spellings[attribute]
        near = nearest_name(normalise(piece), spellings, cutoff=0.6)
        hint = f"; the nearest is {' or '.join(sorted(spellings[near]))!r}" if near else ""
        raise UnreadableValueError(f"{piece!r} is no value of {attribute}{hint}")

    def _read_number(self, attribute: str, text: str, unit: str) -> str:
        degrees = self._degrees(attribute, text, unit)
        least, most = (float(self._definitions[attribute][name]) for name in ("min", "max"))
        if not least <= degrees <= most:
            raise UnreadableValueError(
                f"{text!r} is out of range: expected {attribute} from {least:g} to {most:g} deg"
            )
        return f"{degrees:.6g}"

    def _degrees(self, attribute: str, text: str, unit: str) -> float:
        if _INEQUALITY.match(text.strip()):
            raise UnreadableValueError(
                f"{text[:_SHOWN]!r} is a limit and no angle: {attribute} takes the angle itself"
            )
        match = _ANGLE.fullmatch(text.strip())
        if match is None:
            raise UnreadableValueError(f"expected an angle for {attribute}, got {text[:_SHOWN]!r}")
        number = float(match["number"].replace(",", "."))
        second = match["second"]
        if second is not None and float(second.replace(",", ".")) != number:
            raise UnreadableValueError(f"two different angles in {text!r}: {attribute} takes one")
        said = match["unit"] or unit
        degrees = number * _DEGREES[_MARKS.get(said) or column_unit(said)]
        if match["half"] and self.is_numeric(attribute):
            degrees *= float(self._definitions[attribute]["plus_minus_factor"])
        return degrees


def column_unit(column: str) -> str:
    """Return the unit a column's name gives its numbers, deg where it gives none."""
    if re.search(r"arc-?\s?_?sec|″", column, re.IGNORECASE):
        return "arcsec"
    if re.search(r"arc-?\s?_?min|′", column, re.IGNORECASE):
        return "arcmin"
    return "deg"


def _split(text: str, mark: str) -> list[str]:
    """Split at a mark outside parentheses; one that is never closed encloses nothing."""
    cut = re.sub(rf"(\([^()]*\))|{mark}", lambda found: found[1] or "\x00", text)
    return [piece.strip() for piece in cut.split("\x00") if piece.strip()]
