"""How often each score was given to each style, and the mean."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd

from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display._estimates import check_columns, draw_estimates, label_rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["ScoreDisplay"]

_TALLEST = 0.55  # of a row, the bar of the largest share
_FLOOR = 0.22  # below the middle of a row, where its bars stand
_BELOW = 0.36  # where its mean is
_TEXT: dict[str, Any] = {"xytext": (0, 1.5), "textcoords": "offset points", "ha": "center", "fontsize": "x-small"}


class ScoreDisplay:
    """Distributions of scores, one style below the other: bars of shares in percent, and below them mean and interval.

    This is Fig. 4 of Tilmanne & Dutoit 2012.

    Parameters
    ----------
    shares : DataFrame
        One row a style, one column a score; rows sum to 1.
    means : DataFrame
        One row a style. Columns: value, low, high.
    xlabel : str
        What the scores are.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> import pandas as pd
    >>> from eigenwalker.display import ScoreDisplay
    >>> shares = pd.DataFrame([[0.5, 0.3, 0.2], [0.0, 0.1, 0.9]], index=["drunk", "manly"])
    >>> means = pd.DataFrame({"value": [0.7, 1.9], "low": [0.3, 1.7], "high": [1.1, 2.0]}, index=["drunk", "manly"])
    >>> [label.get_text() for label in ScoreDisplay.from_frames(shares, means).ax_.get_yticklabels()]
    ['drunk', 'manly']
    """

    def __init__(self, shares: pd.DataFrame, means: pd.DataFrame, *, xlabel: str) -> None:
        self.shares = shares
        self.means = means
        self.xlabel = xlabel

    @classmethod
    def from_frames(
        cls, shares: pd.DataFrame, means: pd.DataFrame, *, xlabel: str = "score", ax: Axes | None = None
    ) -> Self:
        """Draw shares and means.

        Parameters
        ----------
        shares : DataFrame
            One row a style, one column a score, whose names are numbers; rows sum to 1.
        means : DataFrame
            Of the same styles. Columns: value, low, high.
        xlabel : str, default "score"
            What the scores are.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        ScoreDisplay

        Raises
        ------
        TypeError, ValueError
            If they are no such tables, or a style has no mean.
        """
        check_columns(shares, ())
        check_columns(means, ("value", "low", "high"))
        lacking = [str(name) for name in shares.index if name not in means.index]
        if lacking:
            raise ValueError(f"expected a mean of each row of shares, missing: {', '.join(lacking)}")
        return cls(shares, means, xlabel=xlabel).plot(ax=ax)

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
        (ax,) = take_axes(ax, (6.4, 0.9 + 0.54 * len(self.shares)))
        self.ax_, self.figure_ = ax, figure_of(ax)
        scores = self.shares.columns.to_numpy(dtype=np.float64)
        scale = _TALLEST / float(self.shares.max(axis=None))
        for row, shares in enumerate(self.shares.to_numpy(dtype=np.float64)):
            floor = row + _FLOOR
            ax.bar(scores, -scale * shares, 0.7, bottom=floor, color="0.78", edgecolor="black", lw=0.6)
            ax.hlines(floor, scores[0] - 0.45, scores[-1] + 0.45, color="black", lw=0.6)
            for score, share in zip(scores, shares, strict=True):
                ax.annotate(f"{100 * share:.0f}", (score, floor - scale * share), **_TEXT)
        rows = np.arange(len(self.shares))
        draw_estimates(ax, self.means.loc[self.shares.index], rows + _BELOW, marker="D", mfc="black", label="mean")
        label_rows(ax, list(self.shares.index), "styles")
        ax.set_xticks(scores, labels=[str(name) for name in self.shares.columns])
        ax.set_xlabel(self.xlabel)
        self._explain(ax)
        return self

    def _explain(self, ax: Axes) -> None:
        from matplotlib.patches import Patch

        handles = [Patch(facecolor="0.78", edgecolor="black", lw=0.6, label="share of answers (%)"), *ax.lines]
        ax.legend(
            handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize="small"
        )

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)
