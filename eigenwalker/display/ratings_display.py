"""Mean ratings of walkers, sorted, one panel a trait."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Self

import numpy as np
import pandas as pd

from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display._estimates import check_columns, draw_estimates, label_rows, row_height

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["RatingsDisplay"]


class RatingsDisplay:
    """Mean ratings of walkers with intervals, the highest at the top, one panel a trait.

    The ratings of Troje 2002, section 4: happy or sad, and nervous or relaxed, on six points. Forty walkers have room
    for their names, more have none.

    Parameters
    ----------
    means, low, high : DataFrame
        One row a walker, one column a trait; means may be missing.
    poles : dict of str to (str, str)
        Words at the lower and the upper end of a trait's scale.
    scale : (float, float)
        The lowest and the highest rating.

    Attributes
    ----------
    axes_ : list of matplotlib Axes
        What was drawn on, one a trait.
    figure_ : matplotlib Figure
        The figure they belong to.

    Examples
    --------
    >>> import pandas as pd
    >>> from eigenwalker.display import RatingsDisplay
    >>> means = pd.DataFrame({"happy": [2.0, 4.5]}, index=["anna", "ben"])
    >>> display = RatingsDisplay.from_frames(means, means - 0.5, means + 0.5, poles={"happy": ("sad", "happy")})
    >>> display.axes_[0].get_xlabel()
    'mean rating, 1 sad to 6 happy'
    """

    def __init__(
        self,
        means: pd.DataFrame,
        low: pd.DataFrame,
        high: pd.DataFrame,
        *,
        poles: Mapping[str, tuple[str, str]],
        scale: tuple[float, float],
    ) -> None:
        self.means = means
        self.low = low
        self.high = high
        self.poles = dict(poles)
        self.scale = scale

    @classmethod
    def from_frames(
        cls,
        means: pd.DataFrame,
        low: pd.DataFrame | None = None,
        high: pd.DataFrame | None = None,
        *,
        poles: Mapping[str, tuple[str, str]] | None = None,
        scale: tuple[float, float] = (1.0, 6.0),
        ax: Axes | Sequence[Axes] | None = None,
    ) -> Self:
        """Draw ratings.

        Parameters
        ----------
        means : DataFrame
            One row a walker, one column a trait. A walker without a rating of a trait is not in its panel.
        low, high : DataFrame, default None
            The ends of the intervals, with the same rows and columns. None draws none.
        poles : mapping of str to (str, str), default None
            Words at the lower and the upper end of a trait's scale. None, or a trait that is not in it, has none.
        scale : (float, float), default (1.0, 6.0)
            The lowest and the highest rating there can be.
        ax : sequence of matplotlib Axes, default None
            Where to draw, one a trait. None makes a new figure.

        Returns
        -------
        RatingsDisplay

        Raises
        ------
        TypeError, ValueError
            If there are no means, one end of intervals alone, or other rows or columns.
        """
        check_columns(means, ())
        if (low is None) != (high is None):
            raise ValueError("expected both low and high, or none of them, got one")
        ends = [means * np.nan if end is None else end for end in (low, high)]
        for end in ends:
            check_columns(end, list(means.columns))
            if not end.index.equals(means.index):
                raise ValueError("expected intervals of the walkers that have means, in the same order, got others")
        return cls(means, *ends, poles=poles or {}, scale=scale).plot(ax=ax)

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : sequence of matplotlib Axes, default None
            Where to draw, one a trait.

        Returns
        -------
        self
        """
        traits = list(self.means.columns)
        self.axes_ = take_axes(ax, (4.2 * len(traits), row_height(len(self.means), 0.2)), [1.0] * len(traits))
        self.figure_ = figure_of(self.axes_[0])
        for panel, trait in zip(self.axes_, traits, strict=True):
            self._draw_trait(panel, trait)
        return self

    def _draw_trait(self, ax: Axes, trait: str) -> None:
        rows = pd.DataFrame({"value": self.means[trait], "low": self.low[trait], "high": self.high[trait]})
        rows = rows.dropna(subset="value").sort_values("value", ascending=False, kind="stable")
        size = 4.0 if len(rows) <= 60 else 3.0
        draw_estimates(ax, rows, np.arange(len(rows)), marker="o", mfc="black", ms=size)
        average = float(rows["value"].mean())
        ax.axvline(average, color="0.35", lw=1.0, ls="--", zorder=1, label=f"mean of walkers, {average:.2f}")
        label_rows(ax, list(rows.index), "walkers, sorted by their ratings")
        least, most = self.scale
        low, high = (f" {word}" for word in self.poles.get(trait, ("", "")))
        ax.set_xlabel(f"mean rating, {least:g}{low.rstrip()} to {most:g}{high.rstrip()}")
        margin = 0.03 * (most - least)
        ax.set_xlim(least - margin, most + margin)
        ax.set_title(str(trait), loc="left", fontsize="medium")
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderpad=0.0, frameon=False, fontsize="small")

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)
