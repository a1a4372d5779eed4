"""A score against a number that is to be chosen, of Eigenwalkers, of harmonics, of persons."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Self

import pandas as pd

from eigenwalker._validation import check_choice
from eigenwalker.display._canvas import figure_of, take_axes, to_png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["CurveDisplay"]

_LINES = ("-", "--", ":", "-.")
_MARKERS = ("o", "s", "^", "D", "v")
_GRAYS = ("0", "0.45")


class CurveDisplay:
    """Curves of a score, one a trait, told apart without color, with the chosen number marked.

    Parameters
    ----------
    curve : DataFrame
        Index: the numbers to choose from; one column a trait.
    chosen : int, default None
        The number that was chosen; None marks none.
    xlabel, ylabel : str
        What the numbers are, and what the score is.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> import pandas as pd
    >>> from eigenwalker.display import CurveDisplay
    >>> curve = pd.DataFrame({"gender": [0.6, 0.8, 0.7]}, index=[1, 2, 3])
    >>> CurveDisplay.from_frame(curve, chosen=2).ax_.get_xlabel()
    'number of Eigenwalkers'
    """

    def __init__(self, curve: pd.DataFrame, *, chosen: int | None = None, xlabel: str, ylabel: str) -> None:
        self.curve = curve
        self.chosen = chosen
        self.xlabel = xlabel
        self.ylabel = ylabel

    @classmethod
    def from_frame(
        cls,
        curve: pd.DataFrame,
        *,
        chosen: int | None = None,
        xlabel: str = "number of Eigenwalkers",
        ylabel: str = "score",
        ax: Axes | None = None,
    ) -> Self:
        """Draw curves.

        Parameters
        ----------
        curve : DataFrame
            Index: the numbers to choose from; one column a trait. A missing value leaves a gap.
        chosen : int, default None
            The number that was chosen, one of the index. None marks none.
        xlabel : str, default "number of Eigenwalkers"
            What the numbers are.
        ylabel : str, default "score"
            What the score is.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        CurveDisplay

        Raises
        ------
        ValueError
            If the chosen number is not among those of the curve.
        """
        if chosen is not None:
            check_choice(chosen, curve.index.tolist(), name="chosen")
        return cls(curve, chosen=chosen, xlabel=xlabel, ylabel=ylabel).plot(ax=ax)

    def plot(self, ax: Axes | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : matplotlib Axes, default None
            Where to draw.

        Returns
        -------
        self
        """
        from matplotlib.ticker import MaxNLocator

        (ax,) = take_axes(ax, (5.6, 3.4))
        self.ax_, self.figure_ = ax, figure_of(ax)
        styles = zip(cycle(_LINES), cycle(_MARKERS), cycle(_GRAYS), strict=False)
        for (trait, scores), (line, marker, gray) in zip(self.curve.items(), styles, strict=False):
            ax.plot(scores.index, scores, ls=line, marker=marker, ms=4, color=gray, lw=1.2, label=str(trait))
        if self.chosen is not None:
            ax.axvline(self.chosen, color="0.75", lw=5, zorder=0, label=f"chosen, {self.chosen}")
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
        ax.set(xlabel=self.xlabel, ylabel=self.ylabel)
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize="small")
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)
