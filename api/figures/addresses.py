"""Where a mark leads: the studies behind it, as a list of theirs if there is one."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from urllib.parse import urlencode

from api.addresses import study_page
from registry.flows import Where
from registry.studies import Facts
from registry.taxonomy import attribute_of
from survey_data.editions import SURVEY


class Addresses:
    """Addresses of the marks of a figure.

    Parameters
    ----------
    facts : the studies
    page : address of the figure's own page, with its query
    where : the figure's filters
    """

    def __init__(self, facts: Facts, page: str, where: Where) -> None:
        self.facts = facts
        self.page = page
        self.where = {level: _several(wanted) for level, wanted in where.items()}

    def of(
        self,
        keys: Collection[str],
        given: Mapping[str, str],
        row: int,
        years: tuple[int, int] | None = None,
    ) -> str:
        """Return the address of exactly these studies.

        That is the page of the only one; else the list of studies with the values `given` by
        level (and of the `years`, first and last), if filters can say it; else the figure's row.
        """
        if len(keys) == 1:
            return study_page(next(iter(keys)))
        wanted = self._wanted(given)
        if self._found(wanted, years) == set(keys):
            asked = [(name, value) for name, values in wanted.items() for value in values]
            if years is not None:
                asked += [("year_min", str(years[0])), ("year_max", str(years[1]))]
            if any(study.edition != SURVEY for study in self.facts.studies.values()):
                asked.append(("edition", "all"))
            return f"/studies?{urlencode(asked)}"
        return f"{self.page}#row-{row}"

    def _wanted(self, given: Mapping[str, str]) -> dict[str, list[str]]:
        """Return attribute -> values, one of which a study must have."""
        wanted = dict(self.where)
        for level, value in given.items():
            ((base, implied),) = self.implied(level, value).items()
            allowed = wanted.get(base)
            wanted[base] = [v for v in implied if allowed is None or v in allowed]
        return wanted

    def implied(self, level: str, value: str) -> dict[str, list[str]]:
        """Return the attribute of a level, and its values with this value at the level."""
        taxonomy, base = self.facts.taxonomy, attribute_of(level)
        return {
            base: [v for v in taxonomy.values(base) if taxonomy.derived_values(level, v) == value]
        }

    def _found(
        self, wanted: Mapping[str, Collection[str]], years: tuple[int, int] | None
    ) -> set[str]:
        """Return the studies that the list of studies shows for these filters."""
        kinds = self.facts.taxonomy.kinds
        meant = {a: {k for v in values for k in kinds(a, v)} for a, values in wanted.items()}
        return {
            key
            for key, study in self.facts.studies.items()
            if all(not values.isdisjoint(study.of(a)) for a, values in meant.items())
            and (years is None or (study.year is not None and years[0] <= study.year <= years[1]))
        }


def _several(wanted: str | Collection[str]) -> list[str]:
    return [wanted] if isinstance(wanted, str) else list(wanted)
