"""A small bundle, an archive of each kind, and the way from one into the other."""

from __future__ import annotations

import pickle
import shutil
import ssl
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fcntl import LOCK_EX, flock
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from api.deposit import verification
from api.deposit.archives import sealed
from api.deposit.archives.contract import PublishedRecord
from api.deposit.archives.depositions import DepositionsArchive
from api.deposit.archives.publishing import publish
from api.deposit.archives.records import RecordsArchive
from api.deposit.archives.server import Token, server_at
from api.deposit.archives.transport import Transport
from api.deposit.archives.uploading import UploadResult, upload
from api.deposit.bundle import Bundle, build
from benchmark.datasets.checksums import contents, sha256
from tests.api.deposit import small_bundle
from tests.api.deposit.standins.depositions import Depositions
from tests.api.deposit.standins.records import Records
from tests.api.deposit.standins.replies import Reply
from tests.api.deposit.standins.server import TOKEN, Fault, StandIn

#: Requests of each step of an upload, as the two interfaces name them.
STEPS: dict[str, dict[str, Callable[[str, str], bool]]] = {
    "records": {
        "create": lambda method, path: (method, path) == ("POST", "/api/records"),
        "list": lambda method, path: method == "GET" and path.endswith("/draft/files"),
        "declare": lambda method, path: method == "POST" and path.endswith("/draft/files"),
        "send": lambda method, path: method == "PUT" and path.endswith("/content"),
        "commit": lambda method, path: method == "POST" and path.endswith("/commit"),
        "describe": lambda method, path: method == "PUT" and path.endswith("/draft"),
        "delete": lambda method, path: method == "DELETE",
        "version": lambda method, path: method == "POST" and path.endswith("/versions"),
        "import": lambda method, path: path.endswith("/files-import"),
        "publish": lambda method, path: path.endswith("/actions/publish"),
    },
    "legacy": {
        "create": lambda method, path: (method, path) == ("POST", "/api/deposit/depositions"),
        "list": lambda method, path: method == "GET" and path.endswith("/files"),
        "send": lambda method, path: method == "PUT" and "/api/files/" in path,
        "describe": lambda method, path: method == "PUT" and "/depositions/" in path,
        "delete": lambda method, path: method == "DELETE",
        "version": lambda method, path: path.endswith("/actions/newversion"),
        "publish": lambda method, path: path.endswith("/actions/publish"),
    },
}


def each(*steps: str) -> pytest.MarkDecorator:
    """Run a test for each of the steps that an interface has, in each interface.

    Those of the older interface are left to the slow run.
    """
    pairs = [
        pytest.param(api, step, marks=pytest.mark.slow if api == "legacy" else ())
        for api, known in STEPS.items()
        for step in steps
        if step in known
    ]
    return pytest.mark.parametrize(("journey", "step"), pairs, indirect=["journey"])


def only(api: str) -> pytest.MarkDecorator:
    """Run a test with one interface."""
    return pytest.mark.parametrize("journey", [api], indirect=True)


@dataclass
class Journey:
    """A bundle, an archive that takes it, and how long the client waited."""

    api: str
    bundle: Path
    archive: StandIn
    pauses: list[float] = field(default_factory=list)
    timeout: float = 20.0

    def fails(self, kind: int | str | Reply, step: str, times: int = 1, **headers: str) -> Fault:
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        fault = Fault(kind, STEPS[self.api][step], times, named)
        self.archive.faults.append(fault)
        return fault

    def _client(self) -> Any:
        transport = Transport(
            server_at(self.archive.address),
            Token(TOKEN),
            sleep=self.pauses.append,
            timeout=self.timeout,
        )
        return transport, (RecordsArchive if self.api == "records" else DepositionsArchive)

    def upload(self, **options: Any) -> UploadResult:
        transport, kind = self._client()
        with transport:
            return upload(kind(transport), self.archive.address, self.bundle, **options)

    def publish(self, identifier: str) -> PublishedRecord:
        transport, kind = self._client()
        with transport:
            return publish(kind(transport), identifier, self.bundle)

    def sent(self) -> dict[str, int]:
        """How often each file was sent, by name."""
        found: dict[str, int] = {}
        for asked in self.archive.asked:
            if STEPS[self.api]["send"](asked.method, asked.path):
                name = asked.path.removesuffix("/content").rpartition("/")[2]
                found[name] = found.get(name, 0) + 1
        return found

    def wanted(self) -> dict[str, bytes]:
        """What the archive is to hold, read from the bundle by hand."""
        return {
            "sun-sensor-atlas-0.1.0.zip": self.bundle.with_name("bundle.zip").read_bytes(),
            "README.md": (self.bundle / "README.md").read_bytes(),
            "sun-sensor-atlas.sqlite": (self.bundle / "sun-sensor-atlas.sqlite").read_bytes(),
            "studies.bib": (self.bundle / "bibliography" / "studies.bib").read_bytes(),
            "studies.ris": (self.bundle / "bibliography" / "studies.ris").read_bytes(),
        }


#: Data sets whose samples go into the bundles of tests: one of frames, one of currents.
FRAMES = ("cmos-single-aperture", "pd-slit")


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Bundle:
    """A bundle with every table, and samples of two data sets; nobody changes it.

    It takes seconds to build: what one worker has built is there for all.
    """
    run = tmp_path_factory.getbasetemp()
    place = (run if worker_id == "master" else run.parent) / "deposit"
    place.mkdir(exist_ok=True)
    kept = place / "bundle.pickle"
    with (place / "lock").open("w") as lock:
        flock(lock, LOCK_EX)
        if not kept.exists():
            made = build(place / "bundle", frames=FRAMES)
            kept.write_bytes(pickle.dumps(made))
        return pickle.loads(kept.read_bytes())  # type: ignore[no-any-return]


@pytest.fixture
def bundle(built: Bundle, tmp_path: Path) -> Path:
    """A bundle of one's own."""
    return Path(shutil.copytree(built.directory, tmp_path / "bundle"))


@pytest.fixture(scope="session", autouse=True)
def _certificates_are_read_once() -> Iterator[None]:
    """Each client would read all authorities anew, which takes longer than what it then does."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ssl, "create_default_context", cache(ssl.create_default_context))
        yield


@pytest.fixture(scope="session", autouse=True)
def _same_bundles_are_verified_once() -> Iterator[None]:
    """Most tests send the same small bundle, and more than once."""
    sound = set()

    def verify(directory: Path) -> list[tuple[str, str]]:
        key = tuple((name, sha256(directory / name)) for name in contents(directory))
        wrong = [] if key in sound else verification.verify(directory)
        if not wrong:
            sound.add(key)
        return wrong

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sealed, "verify", verify)
        yield


@pytest.fixture(params=["records", "legacy"])
def journey(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Journey]:
    bundle = small_bundle.make(tmp_path / "bundle")
    with Records() if request.param == "records" else Depositions() as archive:
        yield Journey(request.param, bundle, archive)
