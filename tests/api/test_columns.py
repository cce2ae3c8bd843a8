"""Fixed columns of tables: what is written is what the list says, whatever the rows hold."""

import csv
import io

from api.schema.claims import ClaimRow
from api.schema.scores import LeaderboardRow, Score
from api.schema.studies import AttributeValue
from api.schema.table import columns_of, csv_of


def test_csv_survives_its_own_delimiters_and_leaves_out_what_is_no_column():
    rows = [
        {"a": 'x, "y"\nz', "b": {"c": 1.5, "d": None}, "e": ["p", "q"], "f": True, "g": 1},
        {"a": "", "b": {"c": float("nan")}, "e": [], "f": False},
    ]
    text = csv_of(("f", "a", "b_c", "b_d", "e"), rows)
    assert list(csv.DictReader(io.StringIO(text, newline=""))) == [
        {"f": "true", "a": 'x, "y"\nz', "b_c": "1.5", "b_d": "", "e": "p; q"},
        {"f": "false", "a": "", "b_c": "", "b_d": "", "e": ""},
    ]


def test_a_mapping_that_is_a_column_is_json_in_its_cell():
    text = csv_of(("n", "by"), [{"n": 1, "by": {"nominal": 0.5, "hot": None}}])
    assert text == 'n,by\n1,"{""nominal"": 0.5, ""hot"": null}"\n'


def test_published_headers_stay_as_they_are():
    """Programs read them by name and by place."""
    heads = {
        AttributeValue: "attribute,value,basis,source,source_name,note,role,name_in_study,nearest",
        Score: "dataset,condition,extractor,model,status,reason,rms_deg,rms_all_answers_deg,"
        "aligned_deg,bound_deg,bound_unit_deg,availability,false_detection_rate",
        LeaderboardRow: "rank,group,tied,dataset,condition,extractor,model,status,"
        "reason,rms_deg,rms_all_answers_deg",
        ClaimRow: "id,section,section_name,study,statement,verdict,trials,explanation",
    }
    for model, head in heads.items():
        assert ",".join(columns_of(model)).startswith(head)
