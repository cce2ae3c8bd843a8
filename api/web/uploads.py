"""Forms with files (multipart/form-data, RFC 7578), read within bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from email.message import Message

from fastapi import Request

from api.service.problems import Problem, Violation
from calibrate.uploaded import LARGEST, Upload

#: Bytes of a body: those of the files, a config, and what separates them.
LARGEST_BODY = LARGEST + 100_000
#: Bytes of a body too long that are read and thrown away, so that the sender hears the refusal.
_LARGEST_READ = 4 * LARGEST
_MOST_PARTS = 40


@dataclass(frozen=True)
class Form:
    """Fields and files of a form.

    Attributes
    ----------
    fields : mapping of str to str
    files : tuple of Upload
        In the order of the form; fields for files that were left empty are none.
    """

    fields: Mapping[str, str]
    files: tuple[Upload, ...]


async def read_form(request: Request) -> Form:
    """Return the form that a request sends.

    Raises
    ------
    Problem
        415 where it is none, 413 where it is too long, 400 where it cannot be read.
    """
    stated = request.headers.get("content-type", "")
    media = Message()
    media["Content-Type"] = stated
    boundary = media.get_param("boundary")
    if media.get_content_type() != "multipart/form-data" or not isinstance(boundary, str):
        error = Violation("Content-Type", stated or None, "multipart/form-data with a boundary")
        headers = {"Accept": "multipart/form-data"}
        raise Problem(415, "unsupported-media-type", errors=[error], headers=headers)
    if request.headers.get("content-encoding", "identity").strip().lower() not in {"", "identity"}:
        error = Violation("Content-Encoding", request.headers["content-encoding"], "identity")
        raise Problem(415, "unsupported-media-type", errors=[error])
    body = await _read(request)
    try:
        return _parsed(body, boundary.encode("ascii"))
    except (ValueError, LookupError) as error:
        wrong = Violation("body", None, f"a form of RFC 7578 ({error})")
        raise Problem(400, "malformed-form", errors=[wrong]) from error


async def _read(request: Request) -> bytes:
    chunks, length = [], 0
    async for chunk in request.stream():
        length += len(chunk)
        if length > _LARGEST_READ:
            break
        if length <= LARGEST_BODY:
            chunks.append(chunk)
        else:
            chunks.clear()
    if length > LARGEST_BODY:
        error = Violation("body", f"{length} bytes or more", f"at most {LARGEST_BODY} bytes")
        raise Problem(413, "content-too-large", errors=[error])
    return b"".join(chunks)


def _parsed(body: bytes, boundary: bytes) -> Form:
    first, *parts = (b"\r\n" + body).split(b"\r\n--" + boundary, _MOST_PARTS + 2)
    if first or not parts or not parts[-1].startswith(b"--"):
        raise ValueError("expected parts between boundaries, and an end")
    if len(parts) > _MOST_PARTS + 1:
        raise ValueError(f"expected at most {_MOST_PARTS} parts")
    fields: dict[str, str] = {}
    files: list[Upload] = []
    for part in parts[:-1]:
        head, separator, content = part.partition(b"\r\n\r\n")
        if not separator:
            raise ValueError("a part without a head")
        name, file = _named(head)
        if file is None:
            if name in fields:
                raise ValueError(f"field {name[:40]} stands twice")
            fields[name] = content.decode("utf-8")
        elif file or content:
            files.append(Upload(file, content))
    return Form(fields, tuple(files))


def _named(head: bytes) -> tuple[str, str | None]:
    """Return the name of a part and of its file, None for a field."""
    for line in head.decode("utf-8").split("\r\n"):
        key, _, value = line.partition(":")
        if key.strip().lower() == "content-disposition":
            stated = Message()
            stated["Content-Disposition"] = value.strip()
            name = stated.get_param("name", header="Content-Disposition")
            file = stated.get_param("filename", header="Content-Disposition")
            if isinstance(name, str):
                return name, file if file is None or isinstance(file, str) else "file"
    raise ValueError("a part without a name")
