"""Jinja: the environment of all pages, and what every template can use."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from algorithms.display_names import display_name
from api import addresses
from api.pages import numbers, terms
from api.pages.methods import mark_up
from api.pages.sensor_drawings import sensor
from api.web.static_files import page_address


@cache
def environment() -> Environment:
    """Return the environment; text is escaped, and a name that is not given is an error."""
    made = Environment(
        loader=PackageLoader("api.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.globals.update(
        navigation=addresses.NAVIGATION,
        sensor=sensor,
        glossary=terms.glossary(),
        static=page_address(),
        **vars_of(addresses.GIVEN),
    )
    made.filters.update(
        mark_up=mark_up, display_name=display_name, **vars_of(numbers.GIVEN), **vars_of(terms.GIVEN)
    )
    return made


def vars_of(functions: tuple[Any, ...]) -> dict[str, Any]:
    """Return functions by name."""
    return {function.__name__: function for function in functions}


def render(template: str, context: Mapping[str, Any]) -> str:
    """Return a page as HTML.

    Parameters
    ----------
    template : file name in `templates/`
    context : by name; `path` and `query` are what was asked for
    """
    section, part = addresses.place_of(context["path"])
    return environment().get_template(template).render(section=section, part=part, **context)
