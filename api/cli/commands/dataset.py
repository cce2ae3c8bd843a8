"""`sunatlas dataset`: the standard data sets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError, given, only_beside

if TYPE_CHECKING:
    from api.real.sets import RealSet


from api.cli import spreadsheets
from api.cli.asking import ask, knowledge
from api.cli.measuring import AVAILABLE_WORKERS, ManyWorkersOption
from api.cli.options import Asked, asked_by, complete
from api.cli.table_output import emit_answer, say
from api.schema import words
from api.schema.datasets import Data, Dataset, RealismQuery
from api.schema.samples import SampleError, SampleErrorsQuery
from api.schema.scores import ScoresQuery
from api.schema.table import columns_of, csv_of
from api.service.datasets import as_sold, choose, rows_of
from api.service.datasets import errors as dataset_errors
from api.service.datasets import realism as besides_built
from benchmark import datasets
from benchmark.contract import UnknownNameError
from benchmark.datasets import coverage as covered
from benchmark.datasets import export as dataset_export
from benchmark.datasets import export_verification
from benchmark.plan.parts import installed_parts
from benchmark.progress import console_progress, terminal_progress
from benchmark.results import samples
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import pinning
from files.atomic import replace_file

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = ("name", "version", "detector", "mask", "observation", "conditions", "follows")
CONDITIONS = ("condition", "bound_deg", "description")
PAIRS = ("detector", "mask", "studies", "datasets", "reason")
FILES = ("file", "bytes")
BUILT = ("dataset", "rms_deg", "id", "name", "accuracy_rms_deg", "accuracy_ratio", "explanation")
SOLD = ("hardware", "name", "depth", "stated_deg", "simulated_deg", "ratio")

NameArgument = Annotated[
    str, typer.Argument(autocompletion=complete(words.DatasetName), help="Name of the data set.")
]


@app.command("list")
def listing(form: FormatOption = Format.TABLE) -> None:
    """List the data sets with sensor and conditions."""
    cards = knowledge().measurements.cards
    emit(
        cards,
        COLUMNS if form is Format.TABLE else columns_of(Dataset),
        form,
        title=f"{len(cards)} data sets",
    )
    if form is Format.TABLE:
        typer.echo(f"{covered.coverage().sentence()} See `sunatlas dataset coverage`.", err=True)


@app.command()
def describe(name: NameArgument, form: FormatOption = Format.TABLE) -> None:
    """Describe a data set, with the published Cramer-Rao bound of each condition.

    JSON has every parameter of the simulation.
    """
    datasets.get(name)  # refuses an unknown name with the nearest one
    card = knowledge().measurements.card(name)
    if form is Format.TABLE:
        say(f"{card['name']} (version {card['version']}): {card['description']}")
        say(f"{card['detector']}, {card['mask']}; gives {card['observation']}")
        say(f"follows {', '.join(card['follows']) or 'no study'}")
        typer.echo()
    if form is Format.CSV:
        emit(card["data"], columns_of(Data), form)
        return
    rows = [
        {"condition": key, "bound_deg": card["bounds"].get(key), **setup}
        for key, setup in card["setups"].items()
    ]
    emit(rows, CONDITIONS, form, document=card)


@app.command()
@asked_by(ScoresQuery, "condition")
def export(
    name: NameArgument,
    *,
    out: Annotated[Path, typer.Option(help="Output directory.")],
    asked: Asked,
    split: Annotated[
        list[str] | None, typer.Option(help="Only calibration or test; may be repeated.")
    ] = None,
    n: Annotated[
        int | None, typer.Option("--n", min=1, help="Only the first N samples of each split.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier export.")] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Export a data set as files: arrays, description, checksums, picture.

    Each condition is a directory with preview.png and, for each split, an .npz file for numpy.load;
    low-dimensional samples also as .csv. card.json describes every array, the studies the data set
    is based on, the bound and the hashes. The same call gives the same bytes.
    """
    with console_progress("writing the data set") as progress:
        made = dataset_export.export(
            name,
            out,
            conditions=asked.get("condition"),
            splits=split,
            n=n,
            force=force,
            progress=progress,
            pins=Store(PUBLISHED).pins(),
        )
    rows = [{"file": f, "bytes": (made.directory / f).stat().st_size} for f in made.files]
    document = {"directory": str(made.directory), "files": rows}
    emit(rows, FILES, form, document=document, title=str(made.directory))
    for file in made.card["files"]:
        pinned = file.get("published_data_hash")
        if file["kind"] == "arrays" and pinned not in (None, file["data_hash"]):
            typer.echo(f"note: {file['path']} differs from the published data {pinned}", err=True)
    typer.echo(f"wrote {made.directory}", err=True)


@app.command()
@asked_by(SampleErrorsQuery, "extractor", "model", "unit")
def errors(
    context: typer.Context,
    name: NameArgument,
    *,
    asked: Asked,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Output file: CSV, or .parquet for the published file with all pipelines and "
            "units."
        ),
    ] = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show the published errors of each sample, nominal condition.

    By extractor, model, unit and sample, with the true Sun direction; `outcome` gives the reason
    for a missing answer. A data set has up to a million rows: choose a pipeline, or write to a
    file.
    """
    if out is not None and "--format" in given(context) and (form, out.suffix) != ("csv", ".csv"):
        raise WrongCallError("--out writes CSV or Parquet by the file's name, not by --format")
    ask(dataset_errors, {**asked, "limit": 1}, name=name)  # refuses what does not fit
    measured = knowledge().measurements
    if out is not None and out.suffix == ".parquet":
        if asked:
            raise WrongCallError("a .parquet has all pipelines and units; give a .csv for some")
        try:
            replace_file(out, measured.file(samples.path_of(name)))
        except FileNotFoundError:
            raise WrongCallError(f"no errors of {name} are published") from None
    rows = rows_of(choose(measured, name, SampleErrorsQuery.model_validate(asked)))
    if out is None:
        emit(rows, columns_of(SampleError), form, title=f"{len(rows)} errors")
        return
    if out.suffix != ".parquet":
        replace_file(out, spreadsheets.as_asked(csv_of(columns_of(SampleError), rows)))
    typer.echo(f"wrote {out}", err=True)


@app.command()
def verify(
    directory: Annotated[Path, typer.Argument(help="Directory of the export.")],
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="Do not generate the export again.")
    ] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Verify an export against its checksums and the data set.

    Compares checksums, card and arrays with the data set and its published hashes, then generates
    the export again and compares it, which takes as long as exporting. --quick skips this; of a
    shortened export only the first four samples are then compared with published data. Differences
    are listed with their file, and the exit code is 1.
    """
    pins = Store(PUBLISHED).pins()
    with terminal_progress() as progress:
        wrong = export_verification.verify(directory, pins=pins, anew=not quick, progress=progress)
    rows = [{"file": name, "problem": problem} for name, problem in wrong]
    if rows or form is not Format.TABLE:
        emit(rows, ("file", "problem"), form, title=f"{directory}: {len(rows)} problems")
    if rows:
        raise typer.Exit(1)
    typer.echo(
        f"{directory}: every checksum and every array holds"
        + ("; it was not made again" if quick else ", as made again"),
        err=True,
    )


@app.command()
def coverage(form: FormatOption = Format.TABLE) -> None:
    """Show which detector-mask pairs of the studies are simulated.

    Gives the reason for each pair that is not simulated, and lists simulated pairs without a study.
    """
    found = covered.coverage()
    rows = [
        {**pair.to_dict(), "studies": len(pair.studies) if form is Format.TABLE else pair.studies}
        for pair in found.pairs
    ]
    emit(rows, PAIRS, form, document=found.to_dict(), title="Detector-mask pairs")
    if form is Format.TABLE:
        typer.echo(found.sentence(), err=True)


@app.command()
@asked_by(RealismQuery, "dataset")
def realism(*, asked: Asked, form: FormatOption = Format.TABLE) -> None:
    """Compare each data set with built sensors and their published figures.

    rms_deg is the RMS of unit 0 of the best pipeline under nominal conditions; its repeatability is
    our precision. Published accuracies are converted to RMS. Differences of more than a factor of
    two are explained; data sets without a built sensor are called idealised.
    """
    emit_answer(ask(besides_built, asked), form, BUILT, title="Data sets and built sensors")


@app.command()
def sold(form: FormatOption = Format.TABLE) -> None:
    """Simulate built sensors as they are sold, beside their published accuracy.

    The depth of calibration and the bench are those that a sensor states, or assumed by its class;
    both errors are of the statistic that it states. Where they differ by more than a factor of two,
    the reason names the depth or bench that agrees.
    """
    answer = ask(as_sold)
    emit_answer(answer, form, SOLD, title="Built sensors as sold")
    if form is Format.TABLE:
        say(answer.document["words"])


@app.command()
def preview(
    name: NameArgument,
    *,
    out: Annotated[Path, typer.Option(help="PNG file to write.")],
    condition: Annotated[
        str | None,
        typer.Option(
            autocompletion=complete(words.Condition), help="Condition; by default the first."
        ),
    ] = None,
    overlay: Annotated[
        str | None,
        typer.Option(
            metavar="EXTRACTOR",
            autocompletion=complete(words.ExtractorName),
            help="Draw the positions found by this extractor.",
        ),
    ] = None,
) -> None:
    """Draw samples of a data set.

    With --overlay: frames around the Sun spot, with a cross at the position found by the extractor
    and a ring at the true position.
    """
    preset = datasets.get(name)
    chosen = condition or preset.conditions[0]
    if chosen not in preset.conditions:
        raise UnknownNameError("condition", chosen, preset.conditions)
    if overlay is None:
        from benchmark.datasets.preview import preview_png  # noqa: PLC0415 - renders, so on demand

        picture = preview_png(preset, chosen)
    else:
        from benchmark.datasets.preview_overlay import overlay_png  # noqa: PLC0415 - as above

        picture = overlay_png(preset, installed_parts().extractor(overlay), [chosen])
    replace_file(out, picture)
    typer.echo(f"wrote {out}", err=True)


@app.command()
def albedo(
    name: NameArgument,
    *,
    n: Annotated[
        int | None, typer.Option("--n", min=1, help="Only the first N samples of the test split.")
    ] = 100,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show the error that Earth albedo causes, without noise.

    For a cube of bare photodiodes, or an aperture above a pixel array with a window that follows
    the Sun, with the Cramer-Rao bound for comparison. Most masked data sets omit albedo for this
    reason.
    """
    from benchmark.sweeps.albedo_influence import influence  # noqa: PLC0415 - renders, so on demand

    found = influence(name, n)
    row = {
        "dataset": name,
        "samples": len(found.moved_deg),
        "rms_deg": found.rms_deg,
        "worst_deg": found.worst_deg,
        "rms_over_bound": found.rms_over_bound,
        "share_above_a_tenth": found.share_above_a_tenth,
    }
    title = f"{name}: light from the Earth moves the estimate"
    emit([row], tuple(row), form, document=row, title=title)


@app.command()
def pin(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            autocompletion=complete(words.DatasetName),
            metavar="[NAME]...",
            help="Data sets; by default all.",
        ),
    ] = None,
    *,
    check: Annotated[
        bool, typer.Option("--check", help="Generate the data again and compare; write nothing.")
    ] = False,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
) -> None:
    """Record the hashes and bounds of changed data, or check them.

    `sunatlas leaderboard update` does this too. Data that changed without a new version of their
    data set are refused. With --check, missing or wrong hashes are named, and the exit code is 1.
    """
    store = Store(PUBLISHED)
    if check:
        _check(store, names, workers)
        return
    with terminal_progress() as progress:
        done = pinning.update(store, workers, progress, datasets=names or None)
    for warning in done.warnings:
        typer.echo(f"warning: {warning}", err=True)
    typer.echo(
        f"{done.renewed} conditions pinned in {done.seconds:.1f} s, {done.kept} pinned before; "
        f"in {done.store}",
        err=True,
    )


def _check(store: Store, names: list[str] | None, workers: int) -> None:
    with terminal_progress() as progress:
        wrong = pinning.differences(store, workers, progress, datasets=names or None)
    for line in wrong:
        typer.echo(line)
    if wrong:
        typer.echo(f"sunatlas: {len(wrong)} pins do not hold, the first: {wrong[0]}", err=True)
        raise typer.Exit(1)
    typer.echo("every pin holds: generated again", err=True)


@app.command()
def fetch(
    context: typer.Context,
    name: Annotated[
        str | None, typer.Argument(help="Name of the set; without one they are listed.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output directory; by default the set's name.")
    ] = None,
    scores: Annotated[
        bool,
        typer.Option(
            "--scores",
            help="Download nothing; print the errors of models on the set, beside those on the "
            "standard data set where models rank most alike.",
        ),
    ] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Download real readings from their public source, checked by SHA-256.

    Nothing is bundled: licence and citation are written beside the readings.
    `sunatlas calibrate` reads the files.
    """
    from api.real.fetching import fetch as run  # noqa: PLC0415 - of this command
    from api.real.sets import SETS  # noqa: PLC0415 - as above

    if name is None:
        if options := given(context):
            raise WrongCallError(
                f"{', '.join(options)}: name a set of real readings: {', '.join(SETS)}"
            )
        for one in SETS.values():
            typer.echo(f"{one.name}: {one.about} ({one.licence})")
        return
    if name not in SETS:
        raise WrongCallError(
            f"there is no set of real readings {name!r} (there are {', '.join(SETS)})"
        )
    if scores:
        only_beside(context, "--scores", "--format", "--safe")
        _print_scores(SETS[name], form)
        return
    only_beside(context, "a download", "--out")
    written = run(SETS[name], out or Path(name))
    typer.echo(f"wrote {', '.join(path.name for path in written)} in {out or name}")
    typer.echo(f"cite: {SETS[name].citation}")


def _print_scores(real: RealSet, form: Format) -> None:
    """Print the kept scores of a set, with its licence and whose it is."""
    from api.cli.asking import knowledge  # noqa: PLC0415 - the published record
    from api.real.scores import beside_standard  # noqa: PLC0415 - of this command

    rows = beside_standard(real.name, knowledge().measurements.nominal)
    emit(rows, tuple(rows[0]), form, title=f"{len(rows)} models on {real.name}, runs left out")
    typer.echo(f"licence: {real.licence}", err=True)
    typer.echo(f"cite: {real.citation}", err=True)
