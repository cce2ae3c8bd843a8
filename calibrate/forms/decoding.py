"""Bytes of a text file as text: UTF-8, UTF-16, or what charset-normalizer finds."""

from __future__ import annotations

import codecs

from calibrate.forms.refused import TableError

#: Marks at the start of a file and what they say; longer ones first.
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
#: Of bytes that are no UTF-8: one byte a letter, as instruments' software writes them.
_OTHERS = ["cp1252", "mac_roman", "cp850"]
_WITHOUT_MARK = ["utf_16_le", "utf_16_be"]
#: Signs of units, by which encodings that all fit are told apart.
_SIGNS = "°µαβθφ"
_SAMPLED = 50_000


def decoded(data: bytes, source: str, encoding: str | None = None) -> tuple[str, str]:
    """Return a file's text and the name of its encoding.

    Parameters
    ----------
    data : bytes
        Of the file.
    source : str
        Its name, for messages.
    encoding : str, optional
        As the reader states it; found otherwise.

    Raises
    ------
    TableError
        If the bytes are no text of that encoding, or hold null characters.
    """
    name = encoding or _encoding(data)
    try:
        text = data.decode(name)
    except (UnicodeDecodeError, UnicodeError, LookupError) as error:
        at = error.start if isinstance(error, UnicodeDecodeError) else 0
        row = data.count(b"\n", 0, at) + 1
        raise TableError(f"{source}, row {row}: expected {name} text ({error})"[:200]) from None
    if "\x00" in text:
        row = text.count("\n", 0, text.index("\x00")) + 1
        raise TableError(f"{source}, row {row}: a null character")
    return text.removeprefix("\ufeff"), name.removesuffix("-sig")


def _encoding(data: bytes) -> str:
    from charset_normalizer import from_bytes  # noqa: PLC0415 - for a file that is no UTF-8

    marked = next((name for mark, name in _MARKS if data.startswith(mark)), None)
    if marked is not None:
        return marked
    if b"\x00" in data and (found := from_bytes(data[:_SAMPLED], cp_isolation=_WITHOUT_MARK)):
        best = found.best()
        if best is not None:
            return best.encoding.replace("_", "-")
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        pass
    else:
        return "utf-8"
    matches = [one.encoding for one in from_bytes(data[:_SAMPLED], cp_isolation=_OTHERS)]
    known = [name for name in _OTHERS if name in matches] or ["cp1252"]
    text = {name: data[:_SAMPLED].decode(name, errors="replace") for name in known}
    return max(known, key=lambda name: sum(text[name].count(sign) for sign in _SIGNS))
