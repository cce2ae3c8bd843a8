"""`sunatlas deposit`: the bundle an archive takes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError
from api.deposit import against_record
from api.deposit import bundle as deposit
from api.deposit.verification import UNSEEN
from api.deposit.verification import verify as verified
from benchmark.progress import console_progress

if TYPE_CHECKING:
    from api.deposit.archives.archive import Archive
    from api.deposit.archives.server import Server

app = typer.Typer(
    help="Build, verify, upload or publish the archive bundle.",
    add_completion=False,
    rich_markup_mode=None,
)


class Interface(StrEnum):
    """Of Zenodo's two."""

    RECORDS = "records"
    LEGACY = "legacy"


BuiltBundle = Annotated[Path, typer.Option("--bundle", help="Directory of the bundle.")]
InterfaceOption = Annotated[
    Interface, typer.Option("--api", help="InvenioRDM records API, or the legacy API.")
]
ProductionOption = Annotated[
    bool, typer.Option("--production", help="Use zenodo.org instead of its sandbox.")
]
ServerOption = Annotated[
    str | None, typer.Option("--server", help="Address of another InvenioRDM archive.")
]
_BUILT = Path("out/deposit")


@app.command()
def build(
    *,
    out: Annotated[
        Path, typer.Option(help="Output directory; an earlier bundle is replaced.")
    ] = _BUILT,
    quiet: Annotated[bool, typer.Option("--quiet", help="Do not show progress.")] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Build the bundle for an archive: the survey's tables and the published results.

    A Data Package with RO-Crate metadata, licences, CITATION.cff and checksums, as a directory and
    as a zip file. The same sources give the same bytes.
    """
    with console_progress("building the bundle", quiet=quiet) as progress:
        bundle = deposit.build(out, progress=progress)
    rows = [
        {"file": name, "bytes": (bundle.directory / name).stat().st_size} for name in bundle.files
    ]
    document = {
        "directory": str(bundle.directory),
        "archive": str(bundle.archive),
        "files": rows,
    }
    emit(rows, ("file", "bytes"), form, document=document, title=str(bundle.directory))
    typer.echo(f"built {bundle.directory} and {bundle.archive}", err=True)


@app.command()
def verify(
    directory: Annotated[Path, typer.Argument(help="Directory of the bundle.", show_default=False)],
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="Do not generate the samples again.")
    ] = False,
    alone: Annotated[
        bool,
        typer.Option("--alone", help="Check the bundle without this version's data."),
    ] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Verify a bundle against its checksums, the survey's tables and the published results.

    Checks every checksum and every table, then compares the bundle with the one that this version
    builds and its samples with the data sets, which takes minutes (--quick compares hashes
    instead). Differences are listed with their file, and the exit code is 1. No network is needed.

    --alone checks the bundle without this version's data: Parquet files, database and licences are
    compared with the tables. It cannot detect a number that was changed in every form of its table.
    """
    wrong = verified(directory)
    if not (wrong or alone):
        with console_progress("verifying the bundle") as progress:
            wrong = against_record.differences(directory, anew=not quick, progress=progress)
    rows = [{"file": name, "problem": problem} for name, problem in wrong]
    if rows or form is not Format.TABLE:
        emit(rows, ("file", "problem"), form, title=f"{directory}: {len(rows)} problems")
    if rows:
        raise typer.Exit(1)
    held = "; it was held against itself alone" if alone else ", and is what the record makes"
    typer.echo(f"{directory}: every checksum and every table holds{held}", err=True)
    if alone:
        typer.echo(UNSEEN, err=True)


@app.command()
def upload(
    *,
    bundle: BuiltBundle = _BUILT,
    new_version: Annotated[
        str | None,
        typer.Option(metavar="RECORD_ID", help="Published record of which this is a new version."),
    ] = None,
    draft: Annotated[
        str | None,
        typer.Option(metavar="RECORD_ID", help="Draft to continue; by default the last one."),
    ] = None,
    api: InterfaceOption = Interface.RECORDS,
    production: ProductionOption = False,
    server: ServerOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Upload a bundle as a draft; nothing becomes public.

    The default is Zenodo's sandbox; --production selects zenodo.org. The token is read from
    ZENODO_SANDBOX_TOKEN, with --production from ZENODO_TOKEN, with --server from ARCHIVE_TOKEN. An
    interrupted upload continues; files with the right checksum are not sent again.
    """
    from api.deposit.archives import uploading  # noqa: PLC0415 - a tenth of a second: HTTP

    if new_version is not None and draft is not None:
        raise WrongCallError("--draft goes on with a draft, --new-version opens one: give one")
    place = _server(production=production, server=server)
    with _archive(place, api) as archive:
        done = uploading.upload(
            archive,
            place.address,
            bundle,
            version_of=new_version,
            draft=draft,
            tell=lambda name, state: typer.echo(f"{state}: {name}", err=True),
        )
    rows = [{"file": name, "state": state} for name, state in done.files.items()]
    document = {
        "record": done.draft.id,
        "page": done.draft.page,
        "published": False,
        "files": rows,
        "left": list(done.remaining_files),
    }
    emit(rows, ("file", "state"), form, document=document, title=f"draft {done.draft.id}")
    for name in done.remaining_files:
        typer.echo(f"left as it was, though not of the bundle: {name}", err=True)
    where = "" if place.address.endswith("sandbox.zenodo.org") else _where(place, production)
    interface = "" if api is Interface.RECORDS else f" --api {api.value}"
    typer.echo(
        f"draft {done.draft.id}: {done.draft.page}\n"
        "nothing is public; look at the draft, then: "
        f"sunatlas deposit publish {done.draft.id} --bundle {bundle}{interface}{where}",
        err=True,
    )


@app.command()
def publish(
    record_id: Annotated[
        str, typer.Argument(help="Identifier of the draft, printed by upload.", show_default=False)
    ],
    *,
    bundle: BuiltBundle = _BUILT,
    api: InterfaceOption = Interface.RECORDS,
    production: ProductionOption = False,
    server: ServerOption = None,
) -> None:
    """Publish a draft. This cannot be undone.

    Requires authors with valid ORCID iDs in CITATION.cff and in the draft, and a draft with exactly
    the files of the bundle. Server and token as for upload.
    """
    from api.deposit.archives import publishing  # noqa: PLC0415 - as above

    with _archive(_server(production=production, server=server), api) as archive:
        done = publishing.publish(archive, record_id, bundle)
    typer.echo(f"published {done.page}" + (f", DOI {done.doi}" if done.doi else ""))


def _where(place: Server, production: bool) -> str:
    return " --production" if production else f" --server {place.address}"


def _server(*, production: bool, server: str | None) -> Server:
    from api.deposit.archives.server import SANDBOX, ZENODO, server_at  # noqa: PLC0415

    if production and server is not None:
        raise WrongCallError("--production is zenodo.org, --server another archive: give one")
    if server is not None:
        return server_at(server)
    return ZENODO if production else SANDBOX


@contextmanager
def _archive(place: Server, api: Interface) -> Iterator[Archive]:
    from api.deposit.archives.depositions import DepositionsArchive  # noqa: PLC0415
    from api.deposit.archives.records import RecordsArchive  # noqa: PLC0415
    from api.deposit.archives.server import token_of  # noqa: PLC0415
    from api.deposit.archives.transport import Transport  # noqa: PLC0415

    kind = RecordsArchive if api is Interface.RECORDS else DepositionsArchive
    with Transport(place, token_of(place)) as transport:
        yield kind(transport)
