"""`sunatlas calibrate`: from a turntable file to a calibrated sensor, a report and flight code."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from api.cli.wrong_call import WrongCallError, only_beside

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command()
def calibrate(
    context: typer.Context,
    *,
    files: Annotated[
        list[Path],
        typer.Argument(
            help="CSV, Parquet, NumPy or Excel file, or a directory of pictures with one; several "
            "are runs of one sensor."
        ),
    ],
    config: Annotated[
        Path | None,
        typer.Option(
            help="Configuration with the meaning of the columns; by default guessed from their "
            "names."
        ),
    ] = None,
    init: Annotated[
        Path | None,
        typer.Option(
            help="Write a commented configuration, guessed from the header, to this file and stop."
        ),
    ] = None,
    onto: Annotated[
        Path | None,
        typer.Option(
            help="Correct this calibration (JSON of an earlier run) with a few new poses instead "
            "of fitting a new one: by gains, offsets, a scale or a turn, if poses left out show "
            "that it is better. The files are read by its settings; of the other options, only "
            "--out, --name and --require go with it."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Output directory for report, JSON and code.")] = Path(
        "calibration"
    ),
    name: Annotated[
        str, typer.Option(help="Prefix of file names and C identifiers.")
    ] = "sun_sensor",
    certificate: Annotated[
        Path | None,
        typer.Option(
            help="Also write a digital calibration certificate (DCC, PTB's XML schema 3.1.2), to "
            "this file; the configuration's section [certificate] says who calibrated what."
        ),
    ] = None,
    require: Annotated[
        list[str] | None,
        typer.Option(
            help="Largest error allowed, such as 0.1deg@3sigma,60deg: limit in deg, arcmin, "
            "arcsec or mrad; share of directions (1sigma, 2sigma, 3sigma, a percentage, or rms); "
            "largest off-axis angle, half of the field of view (all poses without it). May be "
            "repeated."
        ),
    ] = None,
    factory: Annotated[
        Path | None,
        typer.Option(
            help="Compare with the factory's calibration: a table of readings and directions, or "
            "a JSON of an earlier run."
        ),
    ] = None,
    apply: Annotated[
        bool,
        typer.Option(
            "--apply", help="Apply corrections of conventions that were clearly detected."
        ),
    ] = False,
    thorough: Annotated[
        bool, typer.Option("--thorough", help="Include neural networks (takes minutes).")
    ] = False,
    model: Annotated[
        list[str] | None,
        typer.Option(help="Only this model, such as polynomial-2d; may be repeated."),
    ] = None,
) -> int:
    """Calibrate your own sensor from a turntable file.

    Reads the file, detects its conventions and wrong poses, and compares all applicable models by
    cross-validation. Writes a report (HTML), the calibration (JSON), a Python module and C99 code:
    all files or none, even if it is killed. The exit code is 0 if the verdict is "good" (with
    --onto, if the correction explains the poses) and every requirement is met, otherwise 3.
    """
    from benchmark.progress import terminal_progress  # noqa: PLC0415 - Rich, where it is shown
    from calibrate.calibration import calibrate as run  # noqa: PLC0415 - SciPy
    from calibrate.flight.names import c_name  # noqa: PLC0415 - as above
    from calibrate.products import write_products  # noqa: PLC0415 - as above
    from calibrate.report.page import Asked, outcomes  # noqa: PLC0415 - as above
    from calibrate.settings import read_settings  # noqa: PLC0415 - as above
    from calibrate.sources import table_in  # noqa: PLC0415 - as above
    from calibrate.table import read_table  # noqa: PLC0415 - as above
    from calibrate.template import template_of  # noqa: PLC0415 - as above
    from files.atomic import replace_file  # noqa: PLC0415 - as above

    if onto is not None:
        only_beside(context, "--onto", "--out", "--name", "--require")
        return _correct(files, onto, out, name, _checked(require or [], out))
    if init is not None:
        only_beside(context, "--init")
        if len(files) > 1:
            raise WrongCallError(f"--init describes one file; got {len(files)}")
        table = read_table(table_in(files[0]) if files[0].is_dir() else files[0])
        replace_file(init, template_of(table))
        typer.echo(
            f"wrote {init}; correct it and run: sunatlas calibrate {files[0]} --config {init}"
        )
        return 0
    requirements = _checked(require or [], out)
    settings = None if config is None else read_settings(config)
    command = shlex.join(["sunatlas", *sys.argv[1:]])
    with terminal_progress("calibrating") as report:
        found = run(
            files,
            settings,
            apply=apply,
            thorough=thorough,
            models=model,
            progress=lambda step, done, total: report(done, total, step),
        )
        to = f"{c_name(name)}_certificate.xml" if certificate is not None else ""
        beside = certificate is not None and certificate.resolve().parent == out.resolve()
        if certificate is not None and beside:
            to = certificate.name
        asked = Asked(requirements, _compared(found, files, factory), to)
        code: list[str] = []
        written = write_products(found, out, name, command, asked, tell=code.append)
        if certificate is not None and not beside:
            replace_file(certificate, (out / to).read_bytes())
    _print(found, code, written, out)
    met = outcomes(found, asked)
    for one in met:
        typer.echo(f"requirement {one.requirement.text}: {one.word} - {one.sentence}")
    if certificate is not None:
        typer.echo(f"wrote {certificate}")
    good = found.verdict.word == "good" and all(one.word == "met" for one in met)
    return 0 if good else 3


def _checked(stated: list[str], out: Path) -> tuple[Any, ...]:
    """Return requirements; one that is none, and a place that cannot be written, end the call."""
    from calibrate.report.requirement import RequirementError, requirement  # noqa: PLC0415 - SciPy
    from files.atomic import UnreplaceableError, require_replaceable_directory  # noqa: PLC0415 - as above

    try:
        require_replaceable_directory(out)
    except UnreplaceableError as error:
        raise WrongCallError(f"--out: {error}") from None
    try:
        return tuple(requirement(text) for text in stated)
    except RequirementError as error:
        raise WrongCallError(f"--require: {error}") from None


def _compared(found: Any, files: list[Path], factory: Path | None) -> Any:
    """Return the comparison with a factory's calibration; None without one."""
    from calibrate.report.factory import compared_with  # noqa: PLC0415 - SciPy
    from calibrate.sources import read_sources  # noqa: PLC0415 - as above

    if factory is None:
        return None
    return compared_with(factory, found, read_sources(files, found.settings).tables)


def _correct(
    files: list[Path], onto: Path, out: Path, name: str, requirements: tuple[Any, ...]
) -> int:
    """Write an old calibration with the correction that a few new poses show, and its code."""
    from calibrate.documents import load  # noqa: PLC0415 - SciPy
    from calibrate.products import corrected_products, write_set  # noqa: PLC0415 - as above
    from calibrate.recalibration import recalibrate  # noqa: PLC0415 - as above

    old = load(onto)
    found = recalibrate(files, old)
    typer.echo(found.sentence())
    command = shlex.join(["sunatlas", *sys.argv[1:]])
    code: list[str] = []
    texts, outcomes = corrected_products(
        old, found, files, name, command, requirements, tell=code.append
    )
    written = write_set(texts, out, name)
    for sentence in code:
        typer.echo(f"code: {sentence}")
    typer.echo(f"wrote {', '.join(path.name for path in written)} in {out}")
    for one in outcomes:
        typer.echo(f"requirement {one.requirement.text}: {one.word} - {one.sentence}")
    return 0 if found.explained and all(one.word == "met" for one in outcomes) else 3


def _print(found: Any, code: list[str], written: list[Path], out: Path) -> None:
    verdict = found.verdict
    typer.echo(f"verdict: {verdict.word} - {verdict.reason}")
    typer.echo(
        f"model: {found.chosen.name}, {found.chosen.rms_deg:.3g} deg RMS on samples left out"
    )
    for one in found.findings:
        done = (
            "applied" if one in found.applied else ("--apply would change it" if one.change else "")
        )
        typer.echo(f"found: {one.found}" + (f" ({done})" if done else ""))
    for note in found.notes:
        typer.echo(f"read: {note}")
    counts: dict[str, int] = {}
    for one in found.excluded:
        counts[one.reason] = counts.get(one.reason, 0) + 1
    for reason, count in {**found.readings.dropped, **counts}.items():
        typer.echo(f"left out: {count} rows: {reason}")
    for sentence in code:
        typer.echo(f"code: {sentence}")
    typer.echo(f"wrote {', '.join(path.name for path in written)} in {out}")
