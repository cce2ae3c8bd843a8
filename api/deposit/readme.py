"""README.md of the bundle: what lies in it, how to check it, on what terms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from api.deposit.identity import Identity
from benchmark.datasets.checksums import CHECKSUMS


def readme(who: Identity, descriptor: Mapping[str, Any]) -> str:
    """Write the bundle's README from its datapackage.json."""
    tables = "".join(
        f"| `{r['path']}` | {r['title']} | {_cell(r['description'])} |\n"
        for r in descriptor["resources"]
    )
    return f"""# {who.title} {who.version}

{who.summary}

Released {who.released.isoformat()}.

## Tables

Types, units, keys and the meaning of every column are in `datapackage.json`
([Data Package v2](https://datapackage.org)); an empty cell means that nothing is known.

| file | table | what it holds |
|---|---|---|
{tables}
The other files: `ro-crate-metadata.json` ([RO-Crate 1.1](https://w3id.org/ro/crate/1.1)) says the
same in the words of schema.org, `CITATION.cff` says how to cite, `{CHECKSUMS}` lists the SHA-256 of
every other file.

## Checking

```sh
sha256sum --check {CHECKSUMS}
frictionless validate datapackage.json
```

## Terms

`survey/`: CC BY 4.0 (`survey/LICENSE`). Everything else: MIT (`LICENSE`).
"""


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
