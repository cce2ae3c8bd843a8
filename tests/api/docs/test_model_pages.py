"""Pages of the models' categories: every model on its page, pictures of what they leave."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from algorithms.angles import sun_from_angles
from api.docs import documentation, field_plots, limits, model_pages
from api.docs.field_plots import PlottedPipeline
from api.docs.knowledge import knowledge
from benchmark.error_budget.record import RECORD as ERROR_BUDGET

SHOWN = PlottedPipeline("ccd-slit", "ppe", "slit")


def test_every_category_with_a_model_has_a_page_and_every_model_a_line_on_one():
    listed = knowledge().catalogue.implementations("model")
    texts = [
        (model_pages.DIRECTORY / model_pages.page_of(category)).read_text("utf-8")
        for category in model_pages.categories()
    ]
    # filters that the survey has no model value for stand in the page of filters
    filters = (model_pages.DIRECTORY / "filters.md").read_text("utf-8")
    for model in listed:
        if model.taxonomy == "None":
            assert f"`{model.name}`" in filters, model.name
        else:
            assert sum(f"| `{model.name}` |" in text for text in texts), model.name


def test_a_category_without_a_page_starts_from_prose_or_a_bare_frame(tmp_path):
    page = model_pages.text_of("models/neural-network.md", tmp_path)
    assert "Section 5.6 “Artificial neural network”" in page
    frame = model_pages.text_of("models/other-things.md", tmp_path)
    assert frame.startswith("# Other things models\n")
    parts = {name: lambda: "(made)" for name in ("models", "measured", "picture")}
    for text in (page, frame):
        assert documentation.renew_parts("page", text, parts).count("(made)") == 3


def test_an_example_that_fails_is_named(tmp_path):
    page = tmp_path / "models" / "lut.md"
    page.parent.mkdir()
    page.write_text("```python\nprint(1 / 0)\n```\n")
    with pytest.raises(RuntimeError, match=r"models/lut\.md fails: ZeroDivisionError"):
        model_pages.output("models/lut.md", tmp_path)
    page.write_text("```python\na = 2\n```\nand\n```python\nprint(a)\n```\n")
    assert model_pages.output("models/lut.md", tmp_path) == "```text\n2\n```"


def test_the_plane_keeps_the_angle_off_the_axis_and_the_side():
    vectors = np.array([[0, 0, 1.0], [1, 0, 0], [0, -1, 0], [0, np.sqrt(0.5), np.sqrt(0.5)]])
    found = field_plots.on_plane(vectors)
    np.testing.assert_allclose(found, [[0, 0], [90, 0], [0, -90], [0, 45]], atol=1e-12)


@pytest.fixture
def tilted(monkeypatch):
    """Answers that all lie a tenth of a degree towards y, and none for one pose."""
    steps = np.arange(-20.0, 21.0, 10.0)
    angles = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    sun = sun_from_angles(angles)
    given = sun_from_angles(angles + np.array([0.1, 0.0]))
    given[3] = np.nan
    monkeypatch.setattr(field_plots, "residuals", lambda _: (sun, {"as_is": given, "perfect": sun}))


def test_a_picture_draws_every_answer_and_is_the_same_every_time(tilted):
    drawn = field_plots.picture(SHOWN)
    assert drawn == field_plots.picture(SHOWN)
    root = ET.fromstring(drawn)
    texts = [one.text for one in root.iter("{http://www.w3.org/2000/svg}text")]
    assert f"as it is: {field_plots.rms_deg(SHOWN)['as_is']:.2g} deg rms" in texts
    assert "0.1 deg " in texts  # the bar
    longest = max(root.iter("{http://www.w3.org/2000/svg}path"), key=lambda one: len(one.get("d")))
    assert longest.get("d").count("M") >= 24


def test_the_error_said_is_that_of_the_answers(tilted):
    said = field_plots.rms_deg(SHOWN)
    assert said["as_is"] == pytest.approx(0.1, rel=0.05)  # alpha turns less off beta = 0
    assert said["perfect"] == pytest.approx(0.0, abs=1e-12)


def test_the_limits_name_the_error_source_of_every_pipeline_that_is_not_near_its_bound():
    best_pipelines = [line.split(" | ") for line in limits.best_pipelines().splitlines()[2:]]
    sentences = limits.sentences()
    assert len(best_pipelines) == len(ERROR_BUDGET.read())
    for row in best_pipelines:
        name, far = row[0].split("[")[1].split("]")[0], float(row[5]) > limits.NEAR
        assert (f"- `{name}`: " in sentences) == far, name


def test_chains_stand_beside_their_models_alone():
    rows = [line.split(" | ") for line in model_pages.gains("Physics-Informed").splitlines()[2:]]
    chains = [m.name for m in model_pages._of("Physics-Informed") if " + " in m.name]
    assert [row[0].strip("|` ") for row in rows] == chains
    # glass over a wide field is nearly all that the drawing's projection gets wrong
    gain = next(row for row in rows if row[0] == "| `optical + spm`")
    assert float(gain[2]) > 10
