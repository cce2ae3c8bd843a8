"""`python -m benchmark.suites.manifest_renewal`: manifests of facts and record brought up to date.

For a change by hand that is meant, and after a merge of two records: what is there is taken over
once every file can be read and the facts are valid. With ``--check`` it only names what differs.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmark.processes import call_to_end
from benchmark.results import record_manifest, samples
from benchmark.results.store import PUBLISHED, PUBLISHED_STUDIES, Store
from benchmark.running.experiment import RecordedExperiment, experiments
from files import manifest
from survey_data import facts_manifest
from survey_data.problems import SurveyDataError


def main(arguments: Sequence[str] | None = None) -> int:
    """Take changes by hand into the manifests of facts and record, or name them (exit code 1)."""
    parser = argparse.ArgumentParser(prog=record_manifest.COMMAND, description=main.__doc__)
    parser.add_argument("--directory", type=Path, help="of one record; the published ones if none")
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args(arguments)
    records = (options.directory,) if options.directory else (PUBLISHED, PUBLISHED_STUDIES)
    if options.check:
        found = facts_manifest.changes()
        for record in records:
            required = record in (PUBLISHED, PUBLISHED_STUDIES)
            found += record_manifest.changes(record, required=required)
        for problem in found:
            sys.stderr.write(f"{problem}\n")
        return 1 if found else 0
    try:
        renewed = [*facts_manifest.renew(), *(name for record in records for name in renew(record))]
    except (SurveyDataError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 1
    for name in renewed:
        sys.stderr.write(f"{name} taken over\n")
    return 0


def renew(directory: Path) -> list[str]:
    """Take a record as it is into its manifest; return the files that were not in it so."""
    store = Store(directory)
    store.rows(unit=None)
    for name in samples.datasets(directory):
        samples.read_samples(name, directory)
        samples.read_directions(name, directory)
    for kind in experiments().values():
        if issubclass(kind, RecordedExperiment):
            kind.record.read(directory)
    return manifest.rewrite_manifest(directory, record_manifest.names(directory))


if __name__ == "__main__":
    call_to_end(main)
