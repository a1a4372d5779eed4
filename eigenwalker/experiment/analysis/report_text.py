"""Estimates in words and in tables of plain text, as reports print them."""

from collections.abc import Iterable, Mapping

import numpy as np
import pandas as pd

__all__ = ["estimate_cell", "interval_words", "percent_cell", "report_text", "text_table"]


def interval_words(trials: pd.DataFrame, level: float) -> str:
    """Return what intervals are, of answers with or without the columns participant and walk.

    Examples
    --------
    >>> interval_words(pd.DataFrame({"answer": ["real"], "participant": [1]}), 0.95)
    'Intervals of 95%: answers of one participant are taken to be alike.'
    """
    known = {"participant": "answers of one participant", "walk": "answers about one walk"}
    alike = " and ".join(words for column, words in known.items() if column in trials)
    fixed = "; those of single styles are about the walks that were shown" if "walk" in trials else ""
    return f"Intervals of {level:.0%}: {alike or 'no answers'} are taken to be alike{fixed}."


def estimate_cell(found: Iterable[float], *, digits: int = 2) -> str:
    """Return value, low and high as ``2.91 [2.80, 3.02]``; a dash where there is no value.

    Examples
    --------
    >>> estimate_cell((2.914, 2.8, 3.02))
    '2.91 [2.80, 3.02]'
    """
    value, low, high = (float(part) for part in found)
    if np.isnan(value):
        return "-"
    spec = f"z.{digits}f"  # z: no minus before a zero
    ends = "" if np.isnan(low) else f" [{low:{spec}}, {high:{spec}}]"
    return f"{value:{spec}}{ends}"


def percent_cell(found: Iterable[float]) -> str:
    """Return a share and its interval in percent.

    Examples
    --------
    >>> percent_cell((0.6545, 0.5931, 0.7111))
    '65.5 [59.3, 71.1]'
    """
    return estimate_cell((100 * part for part in found), digits=1)


def text_table(rows: Mapping[str, Mapping[str, str]]) -> str:
    """Return a table of plain text: one line a row, columns as wide as they need, missing cells with a dash.

    Examples
    --------
    >>> print(text_table({"original": {"n": "246"}, "synthetic": {"n": "254", "real": "50.4"}}))
               n    real
    original   246  -
    synthetic  254  50.4
    """
    cells = pd.DataFrame.from_dict(rows, orient="index").reindex(rows).fillna("-")
    head = ["", *map(str, cells.columns)]
    lines = [head, *([str(name), *map(str, row)] for name, row in zip(cells.index, cells.to_numpy(), strict=True))]
    widths = [max(len(line[at]) for line in lines) for at in range(len(head))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )


def report_text(title: str, *parts: str) -> str:
    """Return a title and what stands below it, with an empty line between the parts."""
    return "\n\n".join([title, *(part for part in parts if part)])
