"""Facts of the page's files that need no browser: what they refer to and how readable they are."""

import re
from pathlib import Path

import pytest

from api.schema.requirements import Requirements
from tests.api.conftest import Client

PAGE = Path(__file__).parents[3] / "api" / "static"
#: Not the library, whose addresses the content security policy keeps it from.
MODULES = sorted(path for path in PAGE.glob("*.js") if path.name != "plotly.min.js")
STYLES = sorted(PAGE.glob("styles/*.css"))
READABLE = 4.5  # WCAG 2.2, 1.4.3, level AA


def test_every_module_imports_files_and_names_that_exist() -> None:
    imported = 0
    for module in MODULES:
        text = module.read_text(encoding="utf-8")
        for names, source in re.findall(r"import \{([^}]*)\} from \"\./([\w.]+)\"", text):
            exported = (PAGE / source).read_text(encoding="utf-8")
            for name in (part.strip() for part in names.split(",")):
                pattern = rf"export (?:async )?(?:function|class|const) {name}\b"
                assert re.search(pattern, exported), f"{module.name}: {name} from {source}"
                rest = text.replace(names, "", 1)
                assert re.search(rf"\b{name}\b", rest), f"{module.name}: {name} is not used"
                imported += 1
    assert imported > 5


def test_the_form_asks_for_all_that_the_service_takes(atlas: Client) -> None:
    form = atlas.get("/").text.partition("<main")[2]
    fields = re.findall(r'<(?:input|select)\b[^>]*\bname="([\w-]+)"', form)
    of_the_page = {"limit", "calibrations", "include", "cursor"}
    assert set(fields) == Requirements.model_fields.keys() - of_the_page


def test_nothing_is_loaded_from_elsewhere() -> None:
    for path in [*MODULES, *STYLES]:
        text = path.read_text(encoding="utf-8")
        # SVG's name is no address to load.
        known = {"http://www.w3.org"}
        assert set(re.findall(r"https?://[\w.]+", text)) <= known, path.name
        assert "innerHTML" not in text, path.name
        assert "@import" not in text, path.name


def _tokens(selector: str) -> dict[str, str]:
    text = (PAGE / "styles" / "base.css").read_text(encoding="utf-8")
    block = re.search(rf"^{re.escape(selector)} \{{(.*?)^\}}", text, re.MULTILINE | re.DOTALL)
    assert block is not None
    return dict(re.findall(r"(--[\w-]+): (#[0-9a-f]{6});", block.group(1)))


def _luminance(colour: str) -> float:
    channels = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _contrast(a: str, b: str) -> float:
    lighter, darker = sorted((_luminance(a), _luminance(b)), reverse=True)
    return (lighter + 0.05) / (darker + 0.05)


@pytest.mark.parametrize("scheme", [":root", ':root[data-theme="dark"]'])
@pytest.mark.parametrize(
    ("text", "grounds"),
    [
        ("--text", ["--ground", "--surface", "--sunken"]),
        ("--muted", ["--ground", "--surface", "--sunken"]),
        ("--link", ["--ground", "--surface", "--sunken"]),
        ("--on-sun", ["--sun"]),
        ("--bad", ["--surface", "--bad-ground"]),
        ("--good", ["--good-ground"]),
    ],
)
def test_text_has_contrast_on_every_surface(scheme: str, text: str, grounds: list[str]) -> None:
    tokens = _tokens(":root") | _tokens(scheme)
    for ground in grounds:
        assert _contrast(tokens[text], tokens[ground]) >= READABLE, (text, ground)


@pytest.mark.parametrize("scheme", [":root", ':root[data-theme="dark"]'])
def test_borders_of_controls_and_marks_of_charts_stand_out(scheme: str) -> None:
    tokens = _tokens(":root") | _tokens(scheme)
    for mark in ("--line-strong", "--node", "--link"):
        assert _contrast(tokens[mark], tokens["--surface"]) >= 3.0, mark  # WCAG 1.4.11
