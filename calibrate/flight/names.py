"""Names and comments that C, C++ and Python take, whatever a file, path or column is called."""

from __future__ import annotations

import keyword
import re
import sys
import textwrap
from collections.abc import Mapping

#: Of C and C++.
_KEYWORDS = (
    "auto,bool,break,case,catch,char,class,const,continue,default,delete,do,double,"
    "else,enum,explicit,export,extern,false,float,for,friend,goto,if,inline,int,"
    "long,mutable,namespace,new,operator,private,protected,public,register,restrict,"
    "return,short,signed,sizeof,static,struct,switch,template,this,throw,true,"
    "typedef,typename,union,unsigned,using,virtual,void,volatile,while"
)
#: Names that mean something else to a compiler, to Python's imports or to Windows.
_TAKEN = (
    frozenset(keyword.kwlist)
    | frozenset(keyword.softkwlist)
    | sys.stdlib_module_names
    | frozenset({"numpy", "con", "prn", "aux", "nul", "main"})
    | frozenset(f"{port}{number}" for port in ("com", "lpt") for number in range(10))
    | frozenset(_KEYWORDS.split(","))
)


def c_name(text: str) -> str:
    """Return an identifier made of a name: of C, C++ and Python, and no keyword or module there.

    Examples
    --------
    >>> c_name("Sun sensor 2"), c_name("2nd"), c_name("if"), c_name("numpy")
    ('sun_sensor_2', 'sensor_2nd', 'sensor_if', 'sensor_numpy')
    """
    word = re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_") or "sensor"
    return word if word[0].isalpha() and word not in _TAKEN else f"sensor_{word}"


def comment(text: str) -> str:
    r"""Return text that ends no comment and starts no escape: ASCII, on one line.

    Examples
    --------
    >>> print(comment("C:\\Users\\x */ a\nb"))
    C:\Users\x * / a b
    """
    one_line = re.sub(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]+", " ", text)
    plain = one_line.encode("ascii", "backslashreplace").decode("ascii")
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")


def comment_lines(said: Mapping[str, str], start: str) -> str:
    """Return lines of a comment, each with the same start; what is empty is left out."""
    lines = []
    for key, value in said.items():
        if value:
            lines += textwrap.wrap(
                comment(f"{key}: {value}"), 97, initial_indent=start,
                subsequent_indent=f"{start}    ", break_on_hyphens=False,
            )  # fmt: skip
    return "\n".join(lines)
