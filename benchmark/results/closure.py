"""What code a result depends on: the functions, classes and constants reached, digested.

From entries, definitions are followed that a definition names: in its own module, through
imports (those in functions, stars and re-exports too) and as attributes of imported modules. A
class counts whole, with its bases, decorators and defaults; so does a name's every assignment. Of
a module that is imported on the way, statements count that do something when it is: calls, loops,
``with``, assignments to parts of things, decorators other than those that do nothing but to what
they decorate. A module is taken whole where it is used as a value (``getattr(module, name)``),
asked for a name that it does not visibly define, or reads its own ``globals()``.

Nothing is imported to find out. Not followed are modules found at run time
(`importlib.import_module` of a computed name, `pkgutil`), what ``__init_subclass__`` collects, and
classes that only a text names (``cast("Sensor", it)``): objects handed in have digests of their
own. Packages that a module merely lies in count by what they do, not by what they import.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import ClassVar, Self

from benchmark.results.analyses import Analyses
from benchmark.results.definitions import ClosureError, Definitions
from benchmark.results.syntax import EVERYTHING, IMPORTED, LOADED

FIRST_PARTY = ("files", "survey_data", "algorithms", "registry", "calibrate", "benchmark", "api")

#: What is done when a module is imported, with all that it imports; by the module itself.
_RUN, _RUN_ALONE = "", "^"

#: Module, and a name in it, `EVERYTHING` or one of the above.
_Node = tuple[str, str]
_Stamp = tuple[int, int] | None


def reachable_definitions(*entries: str) -> tuple[str, ...]:
    """Return every definition that entries reach, as ``module:name``, sorted.

    Parameters and errors as `Sources.digest`.
    """
    found = Sources.as_they_are().walk(entries)
    return tuple(sorted(f"{module}:{name}" for module, name in found if name.isidentifier()))


def closure_digest(*entries: str) -> str:
    """Digest (32 hexadecimal digits) of the code that entries reach; see `Sources.digest`."""
    return Sources.as_they_are().digest(*entries)


class Sources:
    """Source files, each read once; `is_outdated` says whether one has changed since.

    Parameters
    ----------
    analyses
        What is known of files already.
    """

    _last: ClassVar[Sources | None] = None

    def __init__(self, analyses: Analyses | None = None) -> None:
        self._analyses = analyses or Analyses.of_user()
        self._roots = set(FIRST_PARTY)
        self._paths: dict[str, Path | None] = {}
        self._definitions: dict[str, Definitions] = {}
        self._edges: dict[_Node, tuple[_Node, ...]] = {}
        self._lines: dict[_Node, str] = {}
        self._digests: dict[tuple[str, ...], str] = {}
        self._seen: dict[Path, _Stamp] = {}
        self._search_path = tuple(sys.path)
        self._beside: dict[frozenset[str], Sources] = {}

    @classmethod
    def as_they_are(cls) -> Self:
        """Return the sources of the last call, or new ones if `is_outdated`."""
        last = cls._last
        if not isinstance(last, cls) or last.is_outdated():
            cls._last = last = cls()
        return last

    def is_outdated(self) -> bool:
        """Return whether a file that was read, its directory or `sys.path` has changed."""
        moved = self._search_path != tuple(sys.path)
        return moved or any(_stamp(path) != then for path, then in self._seen.items())

    def _with_packages_of(self, entries: Sequence[str]) -> Sources:
        """Return these sources with the top-level packages of entries as first party."""
        packages = frozenset(entry.partition(":")[0].partition(".")[0] for entry in entries)
        more = packages - self._roots
        if not more:
            return self
        if more not in self._beside:
            made = self._beside[more] = Sources(self._analyses)
            made._roots |= more
            made._paths, made._definitions = self._paths, self._definitions
            made._lines, made._seen = self._lines, self._seen
        return self._beside[more]

    def digest(self, *entries: str) -> str:
        """Digest (32 hexadecimal digits) of the code that entries reach.

        Parameters
        ----------
        entries
            ``package.module:name``, or ``package.module`` for all of it, as is a name that the
            module does not define. Their top-level packages are first party, so that a plug-in
            kept elsewhere is digested too.

        Raises
        ------
        ClosureError
            When a module of `entries` has no source file, or one that is reached cannot be parsed.
        """
        if entries not in self._digests:
            lines = sorted(filter(None, map(self._spelt, self.walk(entries))))
            self._digests[entries] = hashlib.sha256("\n".join(lines).encode()).hexdigest()[:32]
        return self._digests[entries]

    def walk(self, entries: Sequence[str]) -> set[_Node]:
        """Return all that entries reach."""
        known = self._with_packages_of(entries)
        if known is not self:
            return known.walk(entries)
        waiting: list[_Node] = []
        for entry in entries:
            module, _, qualified = entry.partition(":")
            if self._path(module) is None:
                raise ClosureError(f"no source file found for module {module!r}")
            name = qualified.partition(".")[0]
            waiting += self._used(module, name) if name else ()
            if not name or not self._defines(module, name, set()):
                waiting.append((module, EVERYTHING))
        found: set[_Node] = set()
        while waiting:
            node = waiting.pop()
            if node not in found:
                found.add(node)
                waiting += self._followed(node)
        return found

    def _path(self, module: str) -> Path | None:
        if module not in self._paths:
            found = self._paths[module] = module_path(module)
            for one in () if found is None else _directories(module, found):
                self._seen.setdefault(one, _stamp(one))
        return self._paths[module]

    def _of(self, module: str) -> Definitions:
        if module not in self._definitions:
            path = self._path(module)
            if path is None:
                raise ClosureError(f"no source file found for module {module!r}")
            self._seen[path] = _stamp(path)
            self._definitions[module] = self._analyses.of(path)
        return self._definitions[module]

    def _spelt(self, node: _Node) -> str:
        """Spell a node's own code, and to what a name of it is bound by imports."""
        if node not in self._lines:
            module, name = node
            known = self._of(module)
            numbers = known.effects if name == _RUN_ALONE else known.names.get(name, ())
            said = [known.statements[number].digest for number in numbers]
            said += (self._absolute(module, target) for target in known.bound.get(name, ()))
            self._lines[node] = f"{module}:{name} {' '.join(said)}" if said else ""
        return self._lines[node]

    def _followed(self, node: _Node) -> tuple[_Node, ...]:
        if node not in self._edges:
            self._edges[node] = tuple(dict.fromkeys(self._follow(*node)))
        return self._edges[node]

    def _follow(self, module: str, name: str) -> Iterator[_Node]:
        known = self._of(module)
        if name == EVERYTHING:
            yield from self._all(module)
        elif name == _RUN:
            yield module, _RUN_ALONE
            parts = module.split(".")
            for end in range(1, len(parts)):
                if self._path(above := ".".join(parts[:end])) is not None:
                    yield above, _RUN_ALONE
            for target in known.imports:
                yield from self._loaded(module, target)
        else:
            alone = name == _RUN_ALONE
            if not alone:
                yield module, _RUN
            for number in known.effects if alone else known.names.get(name, ()):
                for use in known.statements[number].uses:
                    yield from self._used(module, use)

    def _all(self, module: str) -> Iterator[_Node]:
        """Yield everything that a module has, but for what is in modules that it imports."""
        known = self._of(module)
        yield module, _RUN
        yield from ((module, one) for one in known.names)
        for one, targets in known.bound.items():
            yield module, one
            for target in targets:
                if self._path(self._absolute(module, target)) is None:
                    yield from self._used(module, target)
        for star in known.stars:
            yield from self._used(module, f"{star}.{EVERYTHING}")

    def _used(self, module: str, use: str, asked: frozenset[str] = frozenset()) -> Iterator[_Node]:
        """Yield what a use in a module reaches; `asked` modules took everything of it."""
        if use.startswith(LOADED):
            yield from self._loaded(module, use.removeprefix(LOADED))
        elif use.startswith(IMPORTED):
            yield from self._taken(self._absolute(module, use))
        elif use == EVERYTHING:
            yield module, EVERYTHING
        else:
            root, dot, rest = use.partition(".")
            known = self._of(module)
            if root in known.names or root in known.bound:
                yield module, root
                for target in known.bound.get(root, ()):
                    yield from self._used(module, f"{target}{dot}{rest}")
                return
            for star in known.stars:
                other = self._absolute(module, star)
                if self._is_ours(other) and self._defines(other, root, {*asked, module}):
                    yield module, _RUN
                    yield from self._used(other, use, asked | {module})
            # else a built-in one

    def _taken(self, name: str) -> Iterator[_Node]:
        """Yield what ``package.module.name.attribute`` reaches."""
        module = self._module_of(name)
        if module is None:
            return
        rest = name[len(module) + 1 :]
        package, _, last = module.rpartition(".")
        if package and self._path(package) and self._hides(package, last):
            yield from self._used(package, last)
        first = rest.partition(".")[0]
        if first.startswith("__") and first.endswith("__"):
            yield module, _RUN
        elif first and self._defines(module, first, set()):
            yield from self._used(module, rest)
        else:
            yield module, EVERYTHING

    def _hides(self, package: str, name: str) -> bool:
        """Say whether a package binds a name of one of its modules to something else."""
        known, module = self._of(package), f"{package}.{name}"
        targets = (self._absolute(package, target) for target in known.bound.get(name, ()))
        return name in known.names or any(f"{one}.".find(f"{module}.") != 0 for one in targets)

    def _loaded(self, module: str, target: str) -> Iterator[_Node]:
        other = self._module_of(self._absolute(module, target))
        if other is not None:
            yield other, _RUN

    def _module_of(self, name: str) -> str | None:
        """Return the longest beginning of a dotted name that is a module of ours."""
        while name and self._is_ours(name):
            if self._path(name) is not None:
                return name
            name = name.rpartition(".")[0]
        return None

    def _is_ours(self, name: str) -> bool:
        return name.partition(".")[0] in self._roots

    def _defines(self, module: str, name: str, asked: set[str]) -> bool:
        if module in asked or self._path(module) is None:
            return False
        asked.add(module)
        known = self._of(module)
        if name in known.names or name in known.bound:
            return True
        stars = (self._absolute(module, star) for star in known.stars)
        return any(self._is_ours(star) and self._defines(star, name, asked) for star in stars)

    def _absolute(self, module: str, target: str) -> str:
        """Return the dotted name of an import's target as seen from a module."""
        name = target.removeprefix(IMPORTED)
        bare = name.lstrip(".")
        if level := len(name) - len(bare):
            path = self._path(module)
            is_package = path is not None and path.name == "__init__.py"
            parts = module.split(".")
            above = parts[: len(parts) - level + is_package]
            return ".".join([*above, bare] if bare else above)
        return name


def _directories(module: str, path: Path) -> Sequence[Path]:
    """Return a module's directory and those above it in its package: new modules change them."""
    return path.parents[: module.count(".") + (path.name == "__init__.py")]


def _stamp(path: Path) -> _Stamp:
    """Return size and time of the last change of a file or directory; None if it is missing."""
    try:
        status = path.stat()
    except FileNotFoundError:
        return None
    return status.st_size, status.st_mtime_ns


def module_path(name: str) -> Path | None:
    """Source file of a module, found without importing it; None where there is none."""
    top, *rest = name.split(".")
    for root in _package_directories(top):
        base = "/".join([root, *rest])
        for candidate in (f"{base}/__init__.py", f"{base}.py"):
            if os.path.isfile(candidate):  # noqa: PTH113 - asked for 20 000 times a record
                return _path(candidate)
    return None


def _package_directories(top: str) -> list[str]:
    spec = importlib.util.find_spec(top)
    if spec is None:
        return []
    if spec.submodule_search_locations is not None:
        return list(spec.submodule_search_locations)
    return [spec.origin.removesuffix(".py")] if spec.origin else []


@lru_cache(maxsize=1024)
def _path(name: str) -> Path:
    return Path(name)
