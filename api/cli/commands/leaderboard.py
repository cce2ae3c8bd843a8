"""`sunatlas leaderboard`: the published results shown, brought up to date or checked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

import typer

from api.cli.boards import architectures_text, overview_text
from api.cli.measuring import AVAILABLE_WORKERS, ManyWorkersOption
from api.cli.options import Asked, asked_by, complete
from api.cli.table_output import Format, FormatOption, emit, emit_answer, line_width, prose, say
from api.cli.wrong_call import WrongCallError, given
from api.schema import words
from api.schema.boards import OverviewQuery
from api.schema.scores import LeaderboardRow
from api.schema.table import columns_of
from benchmark.contract import UnknownNameError
from benchmark.metrics.rings import EDGES_DEG
from benchmark.results.store import PUBLISHED

app = typer.Typer(add_completion=False, rich_markup_mode=None)
COLUMNS = (
    *("rank", "group", "dataset", "condition", "extractor", "model", "own_error_deg", "low_deg"),
    *(
        "high_deg",
        "on_bench_deg",
        "over_bound",
        "over_bound_unit",
        "availability",
        "false_detection_rate",
    ),
    *("best_of_extractor", "studies"),
)
FIELD_COLUMNS = (
    *("rank", "dataset", "condition", "extractor", "model", "field_deg", "field_rms_deg"),
    *("own_error_deg", "availability", "false_detection_rate"),
)
WIDEST_COLUMNS = (
    *("rank", "dataset", "condition", "extractor", "model", "widest_field_deg", "half_fov_deg"),
    *("own_error_deg", "availability", "false_detection_rate"),
)
_OF_CHECK = frozenset({"--check", "--stored", "--workers", "--format", "--safe"})
DIFFERENCES = ("file", "cell", "committed", "measured")

Row = Mapping[str, Any]


@app.callback(invoke_without_command=True)
@asked_by(OverviewQuery, "detector", "mask")
def leaderboard(
    context: typer.Context,
    *,
    overview: Annotated[
        bool,
        typer.Option(
            "--overview", help="Count how often each extractor and model is near the bound."
        ),
    ] = False,
    asked: Asked,
    each: Annotated[
        bool, typer.Option("--each", help="Show the best pipelines of each data set.")
    ] = False,
    dataset: Annotated[
        list[str] | None,
        typer.Option(
            autocompletion=complete(words.DatasetName),
            help="Show all pipelines of this data set; may be repeated.",
        ),
    ] = None,
    condition: Annotated[
        list[str] | None,
        typer.Option(
            autocompletion=complete(words.Condition), help="Only this condition; may be repeated."
        ),
    ] = None,
    field: Annotated[
        int | None,
        typer.Option(
            help="Rank by the error within this angle of the boresight, degrees: one of "
            f"{', '.join(map(str, EDGES_DEG[1:]))}."
        ),
    ] = None,
    max_error: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            help="Rank by the field of view within which the error is at most this, degrees.",
        ),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Measure everything again and compare; write nothing.")
    ] = False,
    stored: Annotated[
        bool,
        typer.Option("--stored", help="With --check: compare stored results, measure nothing."),
    ] = False,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show the leaderboard, update it or check it.

    Without options: the best pipeline of each architecture with its own error and unit 0's ratio to
    the Cramer-Rao bound. --overview counts how often each extractor and model is near the bound.
    --dataset lists all pipelines of a data set; --each lists the best of every data set. --field
    uses the error within an angle of the boresight, so that data sets with different fields of view
    can be compared. --max-error compares them by field of view. --check measures all published
    numbers again; a difference is printed with file and cell, and the exit code is 1.
    """
    if context.invoked_subcommand is not None:
        _require_no_options(context)
        return
    listing = each or dataset or condition or field is not None or max_error is not None
    _refuse_beside_check(given(context), check=check)
    if each and dataset:
        raise WrongCallError("--each shows the best of every data set, --dataset all of one")
    if overview and listing:
        raise WrongCallError("--overview counts over data sets: it does not list them")
    if asked and listing:
        raise WrongCallError("--detector and --mask narrow architectures and --overview alone")
    if check:
        _check(workers, form, stored_only=stored)
    elif stored:
        raise WrongCallError("--stored goes with --check")
    elif field is not None and max_error is not None:
        raise WrongCallError("--field and --max-error are two questions; ask one at a time")
    elif overview:
        _overview(asked, form)
    elif not listing:
        _architectures(asked, form)
    else:
        _show(dataset or [], condition or [], field, max_error, form)


def _refuse_beside_check(options: list[str], *, check: bool) -> None:
    """Refuse options that the check, or anything else, would pass over in silence."""
    if not check and "--workers" in options:
        raise WrongCallError("--workers goes with --check: nothing else here is measured")
    narrowing = [name for name in options if name not in _OF_CHECK]
    if check and narrowing:
        raise WrongCallError(
            f"--check takes all that is published: leave out {', '.join(narrowing)}; "
            "`sunatlas verify` measures a part"
        )
    if check and {"--workers", "--stored"}.issubset(options):
        raise WrongCallError("--stored measures nothing: leave out --workers")


def _require_no_options(context: typer.Context) -> None:
    """Refuse options before a command, which would be passed over in silence."""
    if options := given(context):
        raise WrongCallError(
            f"{', '.join(options)} before `{context.invoked_subcommand}`: options of a command "
            "stand behind it"
        )


@app.command()
def update(workers: ManyWorkersOption = AVAILABLE_WORKERS) -> None:
    """Measure cells with changed code or data, and write the published results.

    Data that changed without a new version of their data set are refused, with the data sets named.
    """
    from benchmark.leaderboard import study_record  # noqa: PLC0415 - slow
    from benchmark.leaderboard import update as updating  # noqa: PLC0415 - slow

    for summary in (updating.update(PUBLISHED, workers), study_record.update(workers=workers)):
        for cell, reason in summary.failed:
            typer.echo(f"failed: {cell}: {reason}", err=True)
        for warning in summary.warnings:
            typer.echo(f"warning: {warning}", err=True)
        typer.echo(
            f"{summary.planned} cells, {summary.computed} measured in {summary.seconds:.1f} s, "
            f"{summary.already_stored} stored before; in {summary.store}",
            err=True,
        )


@app.command()
def times(
    *,
    again: Annotated[
        bool,
        typer.Option("--again", help="Forget all times and measure them anew on this machine."),
    ] = False,
) -> None:
    """Measure the running times of pipelines that have none, and publish them.

    First condition of each data set, one thread, best of several, as a multiple of a reference loop
    that is timed in between. They are written to times.csv data set by data set, the machine to
    times_machine.json: an interrupted call is continued by the next one, without --again.
    """
    from benchmark.results.times import TIMES, read_times  # noqa: PLC0415 - slow
    from benchmark.running import times as running_times  # noqa: PLC0415 - slow

    timed = running_times.update(PUBLISHED, again=again)
    found = read_times(PUBLISHED)
    on = found.machine.processor if found.machine else "no machine"
    typer.echo(
        f"{timed} timed now, {len(found.rows) - timed} before, of {on}; in {PUBLISHED / TIMES}",
        err=True,
    )


def _check(workers: int, form: Format, *, stored_only: bool) -> None:
    from benchmark.leaderboard import check as checking  # noqa: PLC0415 - slow
    from benchmark.leaderboard import study_record  # noqa: PLC0415 - slow

    found = [
        *checking.check(PUBLISHED, workers, stored_only=stored_only),
        *study_record.check(workers=workers, stored_only=stored_only),
    ]
    rows = [{name: getattr(difference, name) for name in DIFFERENCES} for difference in found]
    if rows or form is not Format.TABLE:
        emit(rows, DIFFERENCES, form, title=f"{len(rows)} differences")
    if found:
        typer.echo(f"sunatlas: {len(found)} differences, the first: {found[0]}", err=True)
        raise typer.Exit(1)
    how = (
        "the files agree with each other and the code"
        if stored_only
        else "everything was measured again"
    )
    typer.echo(f"every published number holds: {how}", err=True)


def _architectures(query: Asked, form: Format) -> None:
    """Print the best pipeline of each architecture, as the service answers it."""
    from api.cli.asking import ask, knowledge  # noqa: PLC0415 - slow; measuring does without it
    from api.schema.parameters import LARGEST_PAGE  # noqa: PLC0415
    from api.service.leaderboard import architectures  # noqa: PLC0415

    answer = ask(architectures, {**query, "limit": LARGEST_PAGE})
    rows = answer.rows()
    if not rows:
        raise WrongCallError("nothing is published of such architectures")
    if form is Format.TABLE:
        record = knowledge().measurements.record
        line = f"Record: version {record['version']}, sha256 {record['sha256']}"
        typer.echo(architectures_text(rows, line_width()), nl=False)
        if (heights := answer.document["height_order"]) and heights["sentence"]:
            typer.echo("\n".join(prose(heights["sentence"], line_width())), err=True)
        typer.echo(line, err=True)
    else:
        emit_answer(answer, form, ())


def _overview(query: Asked, form: Format) -> None:
    """Print how near the bound each part comes, as the service answers it."""
    from api.cli.asking import ask  # noqa: PLC0415 - as above
    from api.service.leaderboard import overview  # noqa: PLC0415

    answer = ask(overview, query)
    rows = answer.rows()
    if not rows:
        raise WrongCallError("nothing is published of such architectures")
    if form is Format.TABLE:
        typer.echo(overview_text(answer.document, line_width()), nl=False)
    else:
        emit_answer(answer, form, ())


def _show(
    datasets: list[str],
    conditions: list[str],
    field: int | None,
    max_error: float | None,
    form: Format,
) -> None:
    from api.cli.asking import knowledge  # noqa: PLC0415 - slow; measuring does without it

    measurements = knowledge().measurements
    _require("dataset", datasets, words.datasets())
    _require("condition", conditions, words.conditions())
    first = {
        board["name"]: board["conditions"][0] for board in measurements.leaderboard["datasets"]
    }
    rows, columns, judged = _judge(measurements.board_rows(), field, max_error)
    chosen = [
        row
        for row in rows
        if (row["dataset"] in datasets if datasets else row["rank"] == 1)
        and (
            row["condition"] in (conditions or [first[row["dataset"]]])
            or (datasets and not conditions)
        )
    ]
    if judged == "field_rms_deg":
        chosen.sort(key=lambda row: (row[judged] is None, row[judged] or 0.0))
    elif judged == "widest_field_deg":
        chosen.sort(key=lambda row: (-(row[judged] or 0), row["own_error_deg"] or 0.0))
    title = ", ".join(datasets) if datasets else "Best of each data set"
    document = {"items": chosen, "total": len(chosen)}
    if form is Format.TABLE:
        _print_boards(chosen, columns, title, divided=bool(datasets))
    else:
        emit(chosen, columns_of(LeaderboardRow), form, document=document)
    if not chosen:
        typer.echo("sunatlas: no pipeline has such an error there", err=True)
        raise typer.Exit(1)


def _print_boards(rows: list[Row], columns: tuple[str, ...], title: str, *, divided: bool) -> None:
    """Print rows for people: how many studies used a pipeline, and a table of the best alone."""
    # The order says which are the best of their extractor.
    shown = [name for name in columns if name != "best_of_extractor"]
    counted = [{**row, "studies": len(row["studies"]) or None} for row in rows]
    if not divided:
        emit(counted, shown, Format.TABLE, title=title)
        return
    for best, named in ((True, "the best of each extractor"), (False, "the others")):
        part = [row for row in counted if row["best_of_extractor"] is best]
        if part:
            emit(part, shown, Format.TABLE, title=f"{title}: {named}")


def _judge(
    rows: Iterable[Row], field: int | None, max_error: float | None
) -> tuple[Iterable[Row], tuple[str, ...], str]:
    """Rank rows as asked; return them with the columns to show and the one they are judged by."""
    if field is not None:
        if field not in EDGES_DEG[1:]:
            edges = ", ".join(map(str, EDGES_DEG[1:]))
            raise WrongCallError(f"--field: no {field}; expected one of {edges}")
        from benchmark.leaderboard.board import at_field  # noqa: PLC0415 - slow

        return at_field(rows, field), FIELD_COLUMNS, "field_rms_deg"
    if max_error is not None:
        from benchmark.leaderboard.board import within_error  # noqa: PLC0415 - slow

        return within_error(rows, max_error), WIDEST_COLUMNS, "widest_field_deg"
    return rows, COLUMNS, "rank"


def _require(what: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Raise UnknownNameError for a name that is not among the known ones."""
    there = tuple(known)
    for name in names:
        if name not in there:
            raise UnknownNameError(what, name, there)


#: Columns of the estimates; `low` to `high` is the 95 % interval.
FINDINGS = ("finding", "estimate", "kind", "value", "low", "high", "n", "of")
#: As `benchmark.leaderboard.findings.KEYS`, which takes seconds to import.
NAMES = ("methods", "constants", "benches", "sources", "poses")


@app.command()
def findings(
    finding: Annotated[
        str | None, typer.Argument(help=f"Finding whose pairs to print: {', '.join(NAMES)}.")
    ] = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show what the published record shows, with 95 % intervals; or the pairs of one finding.

    Each finding compares pairs: two methods on the same samples, or one method under two
    calibrations. JSON and CSV list its estimates: medians with intervals by order statistics,
    shares with those of Clopper and Pearson. With a name, the pairs are printed.
    """
    if finding is not None and finding not in NAMES:
        raise WrongCallError(f"no finding {finding!r}; expected one of {', '.join(NAMES)}")
    from api.cli.asking import knowledge  # noqa: PLC0415 - slow
    from api.service import leaderboard  # noqa: PLC0415 - as above

    every = {one.key: one for one in leaderboard.findings(knowledge())}
    if finding is not None:
        pairs = every[finding].pairs
        emit(pairs, tuple(pairs[0]), form, title=every[finding].title)
    elif form is Format.TABLE:
        for place, one in enumerate(every.values(), start=1):
            say(f"{place}. {one.title} {one.details} Pairs: `{one.command}`", "   ")
    else:
        rows = [{"finding": one.key, **e.row()} for one in every.values() for e in one.estimates]
        emit(rows, FINDINGS, form)
