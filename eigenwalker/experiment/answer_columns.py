"""The columns of designs and of answers: one row a trial, the same ones on the page, in files and in analyses."""

from typing import NamedTuple

__all__ = ["ANSWER_COLUMNS", "DESIGN_COLUMNS", "RESPONSE_COLUMNS", "Column"]


class Column(NamedTuple):
    """What a column holds.

    Parameters
    ----------
    kind : {"int", "float", "str"}
        Of its values. Empty cells are allowed in "float", as NaN, and in "str".
    description : str
        For people, and for the description of a data set.
    unit : str, default ""
        Of a number that has one.
    """

    kind: str
    description: str
    unit: str = ""


DESIGN_COLUMNS = {
    "participant": Column("int", "number of the participant, from 1"),
    "session": Column("int", "number of the run of trials between two breaks, from 1"),
    "trial": Column("int", "number of the trial in its session, from 1"),
    "task": Column("str", "rating, pair, naturalness, recognition or resemblance"),
    "part": Column("str", "practice, main or attention"),
    "trait": Column("str", "what is rated; empty in other tasks"),
    "stimulus": Column("str", "name of the walk that is judged; of pairs the synthetic one"),
    "reference": Column("str", "name of the original walk of a pair"),
    "left": Column("str", "what stands on the left: the pole at the leftmost button, or the walk of a pair"),
    "view": Column("float", "azimuth of the observer: 0 in front of the walker, 90 at its right side", "degrees"),
    "kind": Column("str", "whether the walk that is judged is original or synthetic"),
    "style": Column("str", "style of the walk that is judged"),
    "condition": Column("str", "static, or displacement over the floor"),
    "expected": Column("str", "the answer that an attention trial asks for"),
}
"""The columns of a design, in order."""

RESPONSE_COLUMNS = {
    "answer": Column("str", "the answer; of a rating its number, counted towards the second pole on whatever side"),
    "value": Column("float", "the answer as a number: 1 to n of ratings, 0 to 4 of pairs and of resemblance"),
    "response_time_s": Column("float", "from the first frame of the walk to the answer", "seconds"),
    "replays": Column("int", "how often a walk was played again"),
    "frames_drawn": Column("int", "frames that were drawn, of all plays"),
    "frames_dropped": Column("int", "refreshes of the screen for which no frame came"),
    "shown_s": Column("float", "how long the last play was on the screen", "seconds"),
    "shown_error_s": Column("float", "how much longer that was than it should be", "seconds"),
    "refresh_hz": Column("float", "refreshes of the screen, as measured", "hertz"),
    "pixels_per_degree": Column("float", "CSS pixels in a degree of visual angle; empty where it was not asked"),
    "pixel_ratio": Column("float", "pixels of the screen in a CSS pixel"),
    "visit": Column("int", "how often the page had been opened when the answer came, from 1"),
    "answered_at": Column("str", "time of the answer: UTC, ISO 8601"),
}
"""What an answer adds to its row of the design, in order."""

ANSWER_COLUMNS = {"study": Column("str", "which study: 12 hexadecimal digits"), **DESIGN_COLUMNS, **RESPONSE_COLUMNS}
"""The columns of answers, in order."""
