"""Reading another table's cells: taxonomy values by similarity, and angles with their units."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import pandas as pd

from survey_data.accuracy_classes import accuracy_class
from survey_data.importing.text_similarity import normalise, similarity
from survey_data.tables import SurveyTables

_LEAST_SCORE = 0.85
_LEAST_LEAD = 0.05  # over the second-best value: a coin toss is no match
_LEAST_LENGTH = 6  # abbreviations one letter apart are different things
_NOT_STATED = {
    *("", "none", "na", "n a", "nan", "unknown"),
    *("not stated", "not reported", "tbd", "null"),
}
_DEGREES = {"deg": 1.0, "arcmin": 1 / 60, "arcsec": 1 / 3600}
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


def states_nothing(text: str) -> bool:
    """Say whether a text is one of the words for a value that a study does not state."""
    return normalise(text) in _NOT_STATED


class UnreadableValueError(ValueError):
    """A cell's text is no value of the attribute."""


@dataclass(frozen=True)
class ValueMatch:
    """A piece of a cell and the value it was read as; score 1 is a known spelling."""

    attribute: str
    text: str
    value: str
    score: float


class ValueReader:
    """Reads cells of a categorical or numeric attribute."""

    def __init__(self, tables: SurveyTables) -> None:
        self._tables = tables
        self._definitions = tables.attribute_definitions.set_index("attribute")
        # attribute -> normalised spelling -> values it may stand for
        self._spellings: dict[str, dict[str, set[str]]] = {}
        spelt = [(row["attribute"], row["alias"], row["value"]) for row in _rows(tables.aliases)]
        spelt += [(row["attribute"], row["name"], row["value"]) for row in _rows(tables.taxonomy)]
        statistics = _rows(tables.statistics)
        for attribute, kind in self._definitions["kind"].items():
            if kind == "statistic":
                spelt += [(str(attribute), row["name"], row["kind"]) for row in statistics]
                spelt += [(str(attribute), row["kind"], row["kind"]) for row in statistics]
        for attribute, spelling, value in spelt:
            of_attribute = self._spellings.setdefault(attribute, {})
            of_attribute.setdefault(normalise(spelling), set()).add(value)
        for row in _rows(tables.taxonomy):  # a value's own label means that value and no other
            self._spellings[row["attribute"]][normalise(row["value"])] = {row["value"]}

    def is_numeric(self, attribute: str) -> bool:
        """Say whether the attribute holds numbers."""
        return bool(self._definitions.loc[attribute, "kind"] == "numeric")

    def read(self, attribute: str, text: str, unit: str = "deg") -> list[ValueMatch]:
        """Return the values a cell states, in their order; an empty list where it states none.

        Parameters
        ----------
        attribute : str
            Attribute of attribute_definitions.csv.
        text : str
            The cell. Several values are parted by comma, semicolon, bar or line break, or by
            slash, ampersand, plus or 'and' where the whole is not itself a value (ECM/Noise is).
        unit : str
            Unit of a number without one: deg, arcmin or arcsec.

        Raises
        ------
        UnreadableValueError
            A piece is no value of the attribute, or could be several.
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
        matches: dict[str, ValueMatch] = {}
        for piece in _split(text, r"[,;|\n\r]+"):
            if self._states_something(attribute, piece):
                for match in self._read_compound(attribute, piece, unit):
                    matches.setdefault(match.value, match)
        return list(matches.values())

    def _states_something(self, attribute: str, text: str) -> bool:
        plain = normalise(text)
        is_value = plain == "none" and "none" in self._spellings.get(attribute, {})
        return is_value or not states_nothing(text)

    def _lookup(self, attribute: str, text: str) -> set[str]:
        return self._spellings[attribute].get(normalise(text), set())

    def _read_compound(self, attribute: str, piece: str, unit: str) -> list[ValueMatch]:
        if attribute == "accuracy" and (_ANGLE.fullmatch(piece) or _INEQUALITY.match(piece)):
            degrees = self._degrees(attribute, piece, unit)
            return [
                ValueMatch(attribute, piece, accuracy_class(self._tables.taxonomy, degrees), 1.0)
            ]
        parts = _split(piece, r"[/&+]|\band\b")
        if len(parts) > 1 and not self._lookup(attribute, piece):
            try:
                return [self._read_piece(attribute, piece)]
            except UnreadableValueError:
                return [self._read_piece(attribute, part) for part in parts]
        return [self._read_piece(attribute, piece)]

    def _read_piece(self, attribute: str, piece: str) -> ValueMatch:
        exact = self._lookup(attribute, piece)
        if len(exact) == 1:
            return ValueMatch(attribute, piece, next(iter(exact)), 1.0)
        if exact:
            raise UnreadableValueError(
                f"{piece!r} may stand for {' or '.join(sorted(exact))} of {attribute}"
            )
        ranked = self._rank(attribute, normalise(piece))
        if ranked:
            score, value = ranked[0]
            lead = score - ranked[1][0] if len(ranked) > 1 else score
            if score >= _LEAST_SCORE and lead >= _LEAST_LEAD:
                return ValueMatch(attribute, piece, value, round(score, 3))
        nearest = f"; the nearest is {ranked[0][1]!r} ({ranked[0][0]:.2f})" if ranked else ""
        raise UnreadableValueError(f"{piece!r} is no value of {attribute}{nearest}")

    def _rank(self, attribute: str, plain: str) -> list[tuple[float, str]]:
        best: dict[str, float] = {}
        for spelling, values in self._spellings[attribute].items():
            shorter, longer = sorted((len(plain), len(spelling)))
            if shorter < max(_LEAST_LENGTH, longer / 3) or len(values) > 1:
                continue
            value = next(iter(values))
            best[value] = max(best.get(value, 0.0), similarity(plain, spelling))
        return sorted(
            ((score, value) for value, score in best.items()), key=lambda e: (-e[0], e[1])
        )

    def _read_number(self, attribute: str, text: str, unit: str) -> ValueMatch:
        degrees = self._degrees(attribute, text, unit)
        definition = self._definitions.loc[attribute]
        if not definition["min"] <= degrees <= definition["max"]:
            raise UnreadableValueError(
                f"{text!r} is out of range: expected {attribute} from {definition['min']:g} to "
                f"{definition['max']:g} deg"
            )
        return ValueMatch(attribute, text, f"{degrees:.6g}", 1.0)

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
        degrees = number * _DEGREES[_unit_name(match["unit"]) or unit]
        if match["half"] and self.is_numeric(attribute):
            degrees *= float(str(self._definitions.loc[attribute, "plus_minus_factor"]))
        return degrees


def column_unit(column: str) -> str:
    """Return the unit a column's name gives its numbers, deg where it gives none."""
    if re.search(r"arc-?\s?_?sec|″", column, re.IGNORECASE):
        return "arcsec"
    if re.search(r"arc-?\s?_?min|′", column, re.IGNORECASE):
        return "arcmin"
    return "deg"


def _unit_name(unit: str | None) -> str | None:
    if unit is None:
        return None
    plain = unit.casefold()
    if "sec" in plain or plain in {'"', "″", "''"}:
        return "arcsec"
    if "min" in plain or plain in {"'", "′"}:
        return "arcmin"
    return "deg"


def _split(text: str, mark: str) -> list[str]:
    """Split at a mark that stands outside parentheses, in one pass over the text."""
    pieces = [""]
    for inside, part in _parenthesise(text):
        if inside:
            pieces[-1] += part
            continue
        first, *rest = re.split(f"(?:{mark})", part)
        pieces[-1] += first
        pieces += rest
    return [piece.strip() for piece in pieces if piece.strip()]


def _parenthesise(text: str) -> Iterator[tuple[bool, str]]:
    """Yield (whether in parentheses, part); a parenthesis that is never closed encloses nothing."""
    at = 0
    for found in re.finditer(r"\([^()]*\)", text):
        yield False, text[at : found.start()]
        yield True, found[0]
        at = found.end()
    yield False, text[at:]


def _rows(frame: pd.DataFrame) -> list[dict[str, str]]:
    return [
        {str(name): str(cell) for name, cell in record.items()}
        for record in frame.to_dict("records")
    ]
