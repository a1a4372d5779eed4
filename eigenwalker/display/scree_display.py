"""How much of the variance each Eigenwalker holds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator
from sklearn.pipeline import Pipeline

from eigenwalker.display._canvas import figure_of, take_axes, to_png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["ScreeDisplay"]

_NOTHING = 5e-4  # share of the variance that would be written as 0.0%


class ScreeDisplay:
    """Share of the variance that each Eigenwalker holds, and all up to it; what they leave out is a hatched bar.

    Parameters
    ----------
    shares : array-like of shape (n_components,)
        Share of each Eigenwalker in the variance of the training walkers.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> from eigenwalker.display import ScreeDisplay
    >>> ScreeDisplay([0.5, 0.3, 0.1]).plot().ax_.get_title(loc="left")
    '3 Eigenwalkers hold 90.0% of the variance'
    """

    def __init__(self, shares: ArrayLike) -> None:
        self.shares = shares

    @classmethod
    def from_estimator(cls, model: Pipeline | BaseEstimator, *, ax: Axes | None = None) -> Self:
        """Draw the shares of a model's Eigenwalkers.

        Parameters
        ----------
        model : Pipeline or PCA
            Fitted; a Pipeline with a PCA among its steps, from `make_eigenwalkers`, or a PCA itself.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        ScreeDisplay

        Raises
        ------
        ValueError
            If there is no fitted PCA.
        """
        steps = [step for _, step in model.steps] if isinstance(model, Pipeline) else [model]
        shares = [step.explained_variance_ratio_ for step in steps if hasattr(step, "explained_variance_ratio_")]
        if not shares:
            kinds = ", ".join(type(step).__name__ for step in steps)
            raise ValueError(f"model must be a fitted PCA or have one among its steps, got {kinds}; call fit first")
        return cls(shares[-1]).plot(ax=ax)

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
        from matplotlib.ticker import MaxNLocator, PercentFormatter

        shares = np.asarray(self.shares, dtype=np.float64)
        total, numbers = float(shares.sum()), np.arange(1, len(shares) + 1)
        (ax,) = take_axes(ax, (max(4.5, 0.28 * len(shares) + 2.0), 3.6))
        self.ax_, self.figure_ = ax, figure_of(ax)
        ax.bar(numbers, shares, color="0.65", label="each Eigenwalker")
        if 1 - total > _NOTHING:
            label = f"left out, {1 - total:.1%}"
            ax.bar(len(shares) + 1, 1 - total, color="white", edgecolor="0.4", hatch="////", label=label)
        ax.plot(numbers, np.cumsum(shares), color="black", marker="o", ms=3.5, lw=1.0, label="cumulative")
        ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
        ax.yaxis.set_major_formatter(PercentFormatter(1.0))
        ax.set(xlabel="Eigenwalker", ylabel="share of the variance", ylim=(0, 1.05), xlim=(0.3, len(shares) + 1.7))
        ax.set_title(f"{len(shares)} Eigenwalkers hold {total:.1%} of the variance", loc="left", fontsize="medium")
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(loc="center right", frameon=False, fontsize="small")
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)
