"""The survey's future directions, decided by the record or on paper."""

from __future__ import annotations

from collections import Counter

import survey_data
from api.schema.directions import DirectionRow
from api.schema.table import columns_of
from api.service.documents import Document
from api.service.knowledge import Knowledge


def directions(known: Knowledge) -> Document:
    """Decide the survey's twelve future directions (tab:finalsummary), each by a rule.

    Rules were written down before their outcomes. Families of methods meet on the data sets of the
    record; some directions are decided by a calculation. CSV: a row per direction.
    """
    table = survey_data.load().approaches.set_index("specific")
    items = [
        {
            **one,
            "general": str(table.loc[one["specific"], "general"]),
            "future_directions": str(table.loc[one["specific"], "future_directions"]),
        }
        for one in known.measurements.directions
    ]
    counts = Counter(one["verdict"] for one in items)
    words = ", ".join(f"{name}: {count}" for name, count in counts.most_common())
    return Document({"words": words, "items": items}, columns_of(DirectionRow), lambda: items)
