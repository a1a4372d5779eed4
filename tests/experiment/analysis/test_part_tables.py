"""Tables of parts: rows stay in order, and parts can be looked up."""

import pandas as pd

from eigenwalker.experiment.analysis.part_tables import rows_of_parts, stack_parts


def test_parts_are_looked_up_whatever_their_order():
    """Pandas warns where an index is not sorted, and warnings are errors here."""
    table = pd.DataFrame({"n": [1, 2]}, index=pd.Index(["real", "don't know"], name="answer"))
    parts = {("style", "sad"): table, ("style", "average walk"): table + 2, ("all", "all walks"): table[:1] + 4}
    stacked = stack_parts(parts)
    for name, part in parts.items():
        pd.testing.assert_frame_equal(stacked.loc[name], part)
    assert stacked.index.names == ["by", "group", "answer"]
    assert stacked.loc["style"].index.get_level_values("group").unique().tolist() == ["sad", "average walk"]


def test_rows_keep_their_order():
    table = rows_of_parts({("style", "b"): {"n": 1}, ("style", "a"): {"n": 2}}, ["n"])
    assert table.index.tolist() == [("style", "b"), ("style", "a")]
    assert table.loc["style", "n"].to_dict() == {"b": 1, "a": 2}


def test_there_may_be_no_rows():
    assert rows_of_parts({}, ["n"]).shape == (0, 1)
