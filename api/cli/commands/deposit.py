"""`sunatlas deposit`: the bundle an archive takes."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError
from api.deposit import against_record
from api.deposit import bundle as deposit
from api.deposit.archives.metadata import description
from api.deposit.archives.server import SANDBOX, ZENODO, Server, server_at
from api.deposit.verification import UNSEEN
from api.deposit.verification import verify as verified
from benchmark.progress import console_progress

app = typer.Typer(add_completion=False, rich_markup_mode=None)


BuiltBundle = Annotated[Path, typer.Option("--bundle", help="Directory of the bundle.")]
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
    code: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Source archive of this version, where this is no checkout."
        ),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Do not show progress.")] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Build the bundle for an archive: facts, published results, their samples and the code.

    A Data Package with RO-Crate metadata, licences, CITATION.cff and checksums, as a directory and
    as a zip file. The same sources give the same bytes.
    """
    with console_progress("building the bundle", quiet=quiet) as progress:
        bundle = deposit.build(out, code=code, progress=progress)
    rows = [
        {"file": name, "bytes": (bundle.directory / name).stat().st_size} for name in bundle.files
    ]
    document = {"directory": str(bundle.directory), "archive": str(bundle.archive), "files": rows}
    emit(rows, ("file", "bytes"), form, document=document, title=str(bundle.directory))
    total = sum((bundle.directory / name).stat().st_size for name in bundle.files)
    typer.echo(f"built {bundle.directory} ({total / 1e6:.0f} MB) and {bundle.archive}", err=True)
    for field in description(bundle.directory).unfilled:
        typer.echo(f"to fill in before an upload, in CITATION.cff: {field}", err=True)


@app.command()
def verify(
    directory: Annotated[Path, typer.Argument(help="Directory of the bundle.")],
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="Do not generate the samples again.")
    ] = False,
    alone: Annotated[
        bool, typer.Option("--alone", help="Check the bundle without this version's data.")
    ] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Verify a bundle against its checksums, the survey's tables and the published results.

    Checks every checksum and every table, then compares the bundle with the one that this version
    builds and its samples with the data sets, which takes minutes (--quick compares hashes
    instead). Differences are listed with their file, and the exit code is 1. No network is needed.

    --alone checks the bundle without this version's data: Parquet files and database are compared
    with the tables. It cannot detect a number that was changed in every form of its table.
    """
    if alone and quick:
        raise WrongCallError("--quick is of the comparison that --alone leaves out: give one")
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
def rescore(
    directory: Annotated[Path, typer.Argument(help="Directory of the bundle.")],
    *,
    cells: Annotated[int, typer.Option(help="Number of scores to measure.", min=1)] = 20,
    seed: Annotated[int, typer.Option(help="Draws them.")] = 1,
    form: FormatOption = Format.TABLE,
) -> None:
    """Measure scores of a bundle again from its own samples, and compare them to the last digit.

    Scores are drawn by the seed from those whose samples are in the bundle. Nothing is simulated.
    The exit code is 1 where a number differs. `rescore.py` in the bundle installs its code first.
    """
    from api.deposit import rescoring  # noqa: PLC0415 - a second: the simulator

    scores = rescoring.read_scores(directory)
    possible = rescoring.repeatable(directory, scores)
    typer.echo(
        f"{len(possible)} of {len(scores)} scores can be measured from the samples of the bundle; "
        f"seed {seed} draws {cells}",
        err=True,
    )
    rows = []
    for one in rescoring.rescore(directory, rescoring.draw(possible, cells, seed)):
        told = [f"{name} is {one.found[name]}, not {one.stated[name]}" for name in one.differing]
        found = {name: one.found[name] for name in ("status", "rms_deg")}
        took = {"seconds": round(one.seconds, 1), "differs": "; ".join(told)}
        rows.append({"cell": str(one.cell), **found, **took})
        typer.echo(f"{'differs' if told else 'same'}: {one.cell}", err=True)
    emit(rows, ("cell", "status", "rms_deg", "seconds", "differs"), form)
    differing = sum(bool(row["differs"]) for row in rows)
    same = len(rows) - differing
    typer.echo(f"{same} of {len(rows)} scores are the same to the last digit", err=True)
    if differing:
        raise typer.Exit(1)


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
    production: ProductionOption = False,
    server: ServerOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Upload a bundle as a draft; nothing becomes public.

    Requires authors with valid ORCID iDs and a repository in CITATION.cff.

    The default is Zenodo's sandbox; --production selects zenodo.org. The token is read from
    ZENODO_SANDBOX_TOKEN, with --production from ZENODO_TOKEN, with --server from ARCHIVE_TOKEN. An
    interrupted upload continues; files with the right checksum are not sent again.
    """
    from api.deposit.archives import uploading  # noqa: PLC0415 - a tenth of a second: HTTP
    from api.deposit.archives.archive import Archive  # noqa: PLC0415

    if new_version is not None and draft is not None:
        raise WrongCallError("--draft goes on with a draft, --new-version opens one: give one")
    place = _server(production=production, server=server)
    with closing(Archive(place, place.token())) as archive:
        done = uploading.upload(
            archive,
            bundle,
            version_of=new_version,
            draft=draft,
            tell=lambda name, state: typer.echo(f"{state}: {name}", err=True),
        )
    page = f"{place.address}/uploads/{done.draft.id}"
    rows = [{"file": name, "state": state} for name, state in done.files.items()]
    document = {
        "record": done.draft.id,
        "page": page,
        "published": False,
        "files": rows,
        "left": list(done.remaining_files),
    }
    emit(rows, ("file", "state"), form, document=document, title=f"draft {done.draft.id}")
    for name in done.remaining_files:
        typer.echo(f"left as it was, though not of the bundle: {name}", err=True)
    where = "" if place.address.endswith("sandbox.zenodo.org") else _where(place, production)
    typer.echo(
        f"draft {done.draft.id}: {page}\n"
        "nothing is public; look at the draft, then: "
        f"sunatlas deposit publish {done.draft.id} --bundle {bundle}{where}",
        err=True,
    )


@app.command()
def publish(
    record_id: Annotated[str, typer.Argument(help="Identifier of the draft, printed by upload.")],
    *,
    bundle: BuiltBundle = _BUILT,
    production: ProductionOption = False,
    server: ServerOption = None,
) -> None:
    """Publish a draft. This cannot be undone.

    Requires CITATION.cff as for upload, the same authors in the draft, and a draft with exactly the
    files of the bundle. Server and token as for upload.
    """
    from api.deposit.archives import uploading  # noqa: PLC0415 - as above
    from api.deposit.archives.archive import Archive  # noqa: PLC0415

    place = _server(production=production, server=server)
    with closing(Archive(place, place.token())) as archive:
        done = uploading.publish(archive, record_id, bundle)
    doi = f", DOI {done.pids['doi'].identifier}" if "doi" in done.pids else ""
    typer.echo(f"published {place.address}/records/{done.id}{doi}")


def _where(place: Server, production: bool) -> str:
    return " --production" if production else f" --server {place.address}"


def _server(*, production: bool, server: str | None) -> Server:
    if production and server is not None:
        raise WrongCallError("--production is zenodo.org, --server another archive: give one")
    if server is not None:
        return server_at(server)
    return ZENODO if production else SANDBOX
