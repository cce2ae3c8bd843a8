"""Names for the labels of the survey's LaTeX source: what a reader sees in place of them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from survey_data.texts import load_texts

#: A label within a text; `label_of` leaves alone what only looks like one.
LABEL = re.compile(r"\b(?:sec|tab|fig|eq|fe|model|alg|rq|rqsum):\w+")
_WORDS = {"question": "Research question"}


@dataclass(frozen=True)
class Label:
    """What a label names.

    ``kind`` is section, subsection, subsubsection, paragraph, question, equation, algorithm, table
    or figure; ``number`` is of the section that it stands in, where a heading has none.
    """

    label: str
    kind: str
    number: str
    title: str

    @property
    def is_heading(self) -> bool:
        """Whether it labels a heading, whose number alone says too little of it."""
        return self.kind in {"section", "subsection", "subsubsection", "paragraph"}

    @property
    def place(self) -> str:
        """Return where it is in print, such as "Section 5.3" or "Table 2"."""
        if self.is_heading:
            return f"{'Section' if self.number[0].isdigit() else 'Appendix'} {self.number}"
        return f"{_WORDS.get(self.kind, self.kind.capitalize())} {self.number}"

    @property
    def name(self) -> str:
        """Return place and title, such as Section 5.1 “Lookup table model”."""
        return f"{self.place} “{self.title}”"


@cache
def labels() -> Mapping[str, Label]:
    """Return the survey's labels by id; SurveyDataError where the table cannot be read."""
    return {row["label"]: Label(**row) for row in load_texts(("labels",)).labels}


def name(label: str) -> str:
    """Return the name of a label; a text that is no label of the survey stays as it is."""
    known = labels().get(label)
    return label if known is None else known.name


def label_of(text: str) -> str:
    """Return a text with what each label in it names in the label's place.

    Within a sentence an equation, a table and the like are named by their number alone.
    """
    if text in labels():
        return name(text)
    return LABEL.sub(lambda found: mention(found.group()), text)


def mention(label: str) -> str:
    """Return what names a label within a sentence; a text that is no label stays as it is."""
    known = labels().get(label)
    if known is None:
        return label
    return known.name if known.is_heading else known.place
