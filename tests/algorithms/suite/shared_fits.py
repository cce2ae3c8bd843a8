"""Fits that many checks begin with, each made once in a process.

A fit is deterministic, which a check of its own holds every implementation to; so what another
check reads of a fit to the whole calibration it need not make anew. What a fit does to its inputs
and to the model is written down while it is made.
"""

from __future__ import annotations

import copy
import dataclasses
import hashlib
import json
import pickle
from dataclasses import dataclass
from typing import Any

import numpy as np

from algorithms.contract import Floats, parameters


@dataclass(frozen=True)
class Witnessed:
    """A fit to the whole calibration, and what was seen while it was made.

    Attributes
    ----------
    returned : what `fit` returned
    model : the model it was called of
    answers : (N, 3) what it then answers to what it learnt
    attributes : public names of the model before the fit and after it
    documents : its parameters as JSON before the fit, and after it and the answers
    given : copies of features, Suns and context that `fit` and `predict` were handed
    """

    returned: Any
    model: Any
    answers: Floats
    attributes: tuple[frozenset[str], frozenset[str]]
    documents: tuple[str, str]
    given: Any


#: By class, parameters and content of the calibration.
_FITS: dict[tuple[Any, ...], Witnessed] = {}


def witnessed(model: Any, cal: Any) -> Witnessed:
    """Return the fit of a model like this one to `cal`; to look at, not to change."""
    key = _key(model, cal)
    if key not in _FITS:
        fresh = type(model)(**parameters(model))
        given = copy.deepcopy(cal)
        before, said = _public(fresh), _document(fresh)
        returned = fresh.fit(given.features, given.sun, given.context)
        after = _public(fresh)
        answers = fresh.predict(given.features, given.context)
        _FITS[key] = Witnessed(
            returned, fresh, answers, (before, after), (said, _document(fresh)), given
        )
    return _FITS[key]


def learnt(model: Any, cal: Any) -> tuple[Any, Floats]:
    """Return a model like this one fitted to `cal`, and its answers (N, 3): the caller's own."""
    seen = witnessed(model, cal)
    return copy.deepcopy(seen.model), seen.answers.copy()


def learnt_again(model: Any, cal: Any) -> Floats:
    """Return the answers (N, 3) of a second fit: of a pickled copy that had learnt half before.

    Where they are those of the first to the last bit, fits are deterministic, they forget what
    was learnt before, and pickling lost nothing of what a fit reads.
    """
    again = pickle.loads(pickle.dumps(type(model)(**parameters(model))))
    half = cal.of(slice(None, None, 2))
    again.fit(half.features, half.sun, half.context)
    again.fit(cal.features, cal.sun, cal.context)
    return again.predict(cal.features, cal.context)


def _public(model: Any) -> frozenset[str]:
    return frozenset(
        field.name for field in dataclasses.fields(model) if hasattr(model, field.name)
    )


def _document(model: Any) -> str:
    return json.dumps(parameters(model), allow_nan=False)


def _key(model: Any, cal: Any) -> tuple[Any, ...]:
    return type(model), json.dumps(parameters(model)), _content(cal)


def _content(cal: Any) -> bytes:
    state = hashlib.blake2b(digest_size=16)
    for name, array in [("", cal.features), ("", cal.sun), *sorted(cal.context.items())]:
        state.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        state.update(np.ascontiguousarray(array).tobytes())
    return state.digest()
