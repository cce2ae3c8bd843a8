"""Examples in the docs, made by running them: HTTP answers and the help of commands."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator, Mapping
from typing import Any
from urllib.parse import quote

from typer.testing import CliRunner

from api.cli.command_line import COMMANDS, app, load
from api.server.app import create_app
from api.service.problems import MEDIA_TYPE
from api.web.negotiation import CSV, JSON
from registry.taxonomy import ATTRIBUTES

LONGEST_LIST = 1
LONGEST_OBJECT = 10
LONGEST_TEXT = 160
DEEPEST = 3
TIMES = ("latency_us", "time_ratio")
#: Parameters of every table or list, described once at the head of the page.
COMMON_PARAMETERS = frozenset(
    {"format", "safe", "limit", "cursor", "sort", "fields", "edition"}
    | {*ATTRIBUTES, *(f"exclude_{name}" for name in ATTRIBUTES)}
)
REFUSED = "/v1/studies?detectr=CMOS"
_SERVED = "http://127.0.0.1:8000"
_FEW = 6  # words that are listed; of more, as many and how many there are


def command_line() -> str:
    """Return the help of `sunatlas` and of every command below it."""
    shown = [("sunatlas", ["--help"])]
    for name in COMMANDS:
        below = getattr(load(name), "commands", {})
        shown.append((f"sunatlas {name}", [name, "--help"]))
        shown += [(f"sunatlas {name} {sub}", [name, sub, "--help"]) for sub in below]
    runner = CliRunner(env={"COLUMNS": "88", "TERMINAL_WIDTH": "88"})
    parts = []
    for title, arguments in shown:
        text = runner.invoke(app, arguments, prog_name="sunatlas").stdout
        trimmed = "\n".join(line.rstrip() for line in _own_options(text).strip().splitlines())
        parts.append(f"## {title}\n\n```text\n{trimmed}\n```")
    return "\n\n".join(parts)


#: Options of most commands, described once at the head of the page.
COMMON = (
    *("--safe", "-h, --help", "--format <table|json|csv>", "--store <dir>", "--scheduler"),
    *("--workers", "--suite", "--data <path>", "--edition", "--condition"),
    *(f"--{start}{name} " for name in ATTRIBUTES for start in ("", "exclude-")),
)


def _own_options(text: str) -> str:
    """Return a help without the options that most commands have."""
    kept: list[str] = []
    left_out = False
    for line in text.splitlines():
        option = line.strip()
        if line.startswith("  ") and option.startswith("-"):
            left_out = option.startswith(COMMON)
        elif not line.startswith("    "):
            left_out = False
        if not left_out:
            kept.append(line)
    return "\n".join(kept).replace("Options:\n\n", "").removesuffix("Options:")


def target(path: str, operation: Mapping[str, Any]) -> tuple[str, Any]:
    """Return the path with query, and the JSON body (None for none), of an operation's example."""
    query = []
    for parameter in operation.get("parameters", ()):
        if "example" not in parameter:
            continue
        given = parameter["example"]
        if parameter["in"] == "path":
            path = path.replace(f"{{{parameter['name']}}}", quote(str(given), safe=""))
        elif parameter["in"] == "query":
            values = given if isinstance(given, list) else [given]
            query += [f"{parameter['name']}={quote(str(value), safe='')}" for value in values]
    content = operation.get("requestBody", {}).get("content", {})
    body = content.get(JSON, {}).get("example")
    return path + ("?" + "&".join(query) if query else ""), body


def _words(schema: Mapping[str, Any]) -> tuple[list[str], int, str]:
    """Return some words that a parameter takes, how many there are, and else what it takes."""
    if schema.get("type") == "array":
        some, count, said = _words(schema["items"])
        return some, count, f"{said}; repeatable" if said else "repeatable"
    if "enum" in schema:
        return list(schema["enum"][:_FEW]), len(schema["enum"]), ""
    default = f", {schema['default']} by default" if "default" in schema else ""
    limits = [
        f"{said} {schema[key]:g}"
        for key, said in (("minimum", "from"), ("exclusiveMinimum", "above"), ("maximum", "to"))
        if key in schema
    ]
    return [], 0, " ".join([str(schema.get("type", "any")), *limits]) + default


def http_examples() -> str:
    """Return every endpoint with its parameters and the answer to its example."""
    service = create_app()
    parts = []
    for path, operations in service.openapi()["paths"].items():
        for method, operation in operations.items():
            parts.append(_operation(service, path, method, operation))
    refused = _ask(service, "GET", REFUSED)
    parts.append(
        "## Errors\n\nProblem documents (RFC 9457) with the nearest valid value:\n\n"
        + _exchange(f"GET {REFUSED}", None, refused)
    )
    return "\n\n".join(parts)


def _operation(service: Any, path: str, method: str, operation: Mapping[str, Any]) -> str:
    form = operation.get("requestBody", {}).get("content", {}).get("multipart/form-data")
    if form is not None:
        return _form(method, path, operation, form)
    address, body = target(path, operation)
    answer = _ask(service, method.upper(), address, body)
    said = operation.get("description") or operation.get("summary", "") + "."
    lines = [f"## {method.upper()} {path}", "", said, ""]
    rows = [
        parameter
        for parameter in operation.get("parameters", ())
        if parameter["in"] in {"path", "query"} and parameter["name"] not in COMMON_PARAMETERS
    ]
    if rows:
        lines += [f"- `{p['name']}` ({_takes(p['schema'])}): {p.get('description')}" for p in rows]
        lines.append("")
    lines.append(_exchange(f"{method.upper()} {address}", body, answer))
    return "\n".join(lines)


def _form(method: str, path: str, operation: Mapping[str, Any], form: Mapping[str, Any]) -> str:
    """Return an endpoint that takes a form with files: its fields, and a command that sends one."""
    lines = [f"## {method.upper()} {path}", "", f"{operation['summary']}.", ""]
    lines += [operation["description"], "", "| field | what it does |", "|---|---|"]
    fields = form["schema"]["properties"].items()
    lines += [f"| `{name}` | {field['description']} |" for name, field in fields]
    answers = ", ".join(f"`{kind}`" for kind in operation["responses"]["200"]["content"])
    lines += ["", f"Answers: {answers}.", ""]
    lines += ["<!-- not run: needs a file; tests/api/http/test_http_calibrations.py sends one -->"]
    asked = "-F answer=zip -o sensor.zip " if "answer" in dict(fields) else ""
    lines += ["```sh", f"curl -F file=@bench.csv {asked}{_SERVED}{path}", "```"]
    return "\n".join(lines)


def _ask(service: Any, method: str, target: str, body: Any = None) -> tuple[int, str, str]:
    import httpx  # noqa: PLC0415 - needed to write the docs, not to run the service

    async def exchange() -> tuple[int, str, str]:
        transport = httpx.ASGITransport(service)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
            options = {} if body is None else {"json": body}
            answer = await client.request(method, target, **options)
            return answer.status_code, answer.headers["content-type"], answer.text

    return asyncio.run(exchange())


def _exchange(request: str, body: Any, answer: tuple[int, str, str]) -> str:
    status, media_type, text = answer
    if not media_type.startswith((JSON, MEDIA_TYPE, CSV)):
        return f"```http\n{request}\n```\n\n{status}, `{media_type}`."
    asked = "" if body is None else f"\n\n{json.dumps(body, ensure_ascii=False)}"
    if "json" in media_type:
        shown = "\n".join(_pretty(_shorten(json.loads(text))))
    else:
        shown = text.strip()[:LONGEST_TEXT]
    return f"```http\n{request}{asked}\n```\n\n{status}, `{media_type}`:\n\n```json\n{shown}\n```"


def _shorten(value: Any, depth: int = 0) -> Any:
    """Cut long lists, saying how much was left out, and what lies deep."""
    if depth >= DEEPEST and len(json.dumps(value)) > LONGEST_TEXT // 2:
        return "…"
    if isinstance(value, dict):
        # Times change with every measuring; the docs should not.
        kept = {
            name: "…" if name in TIMES and member is not None else _shorten(member, depth + 1)
            for name, member in list(value.items())[:LONGEST_OBJECT]
        }
        left = len(value) - len(kept)
        return {**kept, "…": f"{left} more"} if left else kept
    if isinstance(value, list):
        items = [_shorten(member, depth + 1) for member in value[:LONGEST_LIST]]
        left = len(value) - len(items)
        return [*items, f"… {left} more"] if left else items
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        return value[:LONGEST_TEXT] + "…"
    return value


def _pretty(value: Any, indent: str = "", name: str = "", comma: str = "") -> Iterator[str]:
    """Write JSON with what fits on a line on one line."""
    flat = json.dumps(value, ensure_ascii=False)
    if len(indent) + len(name) + len(flat) < 100 or not isinstance(value, dict | list):
        yield f"{indent}{name}{flat}{comma}"
        return
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    yield f"{indent}{name}{opening}"
    if isinstance(value, dict):
        members = [
            (f"{json.dumps(key, ensure_ascii=False)}: ", member) for key, member in value.items()
        ]
    else:
        members = [("", member) for member in value]
    for number, (key, member) in enumerate(members, start=1):
        yield from _pretty(member, indent + "  ", key, "," if number < len(members) else "")
    yield f"{indent}{closing}{comma}"


def _takes(schema: Mapping[str, Any]) -> str:
    """Say in words what a parameter's schema takes."""
    some, count, said = _words(schema)
    listed = ", ".join(f"`{word}`" for word in some)
    if count > len(some):
        listed = f"one of {count} values, such as `{some[0]}`"
    return "; ".join(part for part in (listed, said) if part)
