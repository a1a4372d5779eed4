"""Scores of shuffled labels, and that of the given ones among them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from eigenwalker.display._canvas import figure_of, take_axes, to_png, write_number
from eigenwalker.model.permutation import PermutationResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["PermutationDisplay"]

_N_BINS = 40
_TIE = 1e-12  # scores that differ less are equal but for their rounding, as for `permutation_test`


class PermutationDisplay:
    """Histogram of the scores of shuffled labels, those at least as good as the given labels dark.

    Parameters
    ----------
    score : float
        With the labels as they are.
    p_value : float
        Share of shuffled labels, the given ones counted in, that are predicted at least as well.
    null : ndarray of shape (n_permutations,)
        Scores with shuffled labels.
    score_name : str
        What the score is.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display import PermutationDisplay
    >>> from eigenwalker.model import PermutationResult
    >>> result = PermutationResult(0.8, 0.5, np.array([0.4, 0.5, 0.9]))
    >>> PermutationDisplay.from_result(result).ax_.get_title(loc="left")
    'accuracy 0.80, p = 0.5, 3 shuffles'
    """

    def __init__(self, score: float, p_value: float, null: NDArray[np.float64], *, score_name: str) -> None:
        self.score = score
        self.p_value = p_value
        self.null = null
        self.score_name = score_name

    @classmethod
    def from_result(
        cls,
        result: PermutationResult,
        *,
        score_name: str = "accuracy",
        trait: int | None = None,
        ax: Axes | None = None,
    ) -> Self:
        """Draw the result of a permutation test.

        Parameters
        ----------
        result : PermutationResult
            From `permutation_test`.
        score_name : str, default "accuracy"
            What the score is, as `permutation_test` was told.
        trait : int, default None
            Position of the trait, for a result with several; None is the only one.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        PermutationDisplay

        Raises
        ------
        ValueError
            If there are several traits and none is chosen, or there are fewer, or the trait has no score.
        """
        scores, p_values = np.atleast_1d(result.score), np.atleast_1d(result.p_value)
        n_traits = len(scores)
        if trait is None and n_traits > 1:
            raise ValueError(f"the result has {n_traits} traits; choose one, trait=0 to {n_traits - 1}")
        column = 0 if trait is None else trait
        if not 0 <= column < n_traits:
            raise ValueError(f"trait must be a position from 0 to {n_traits - 1}, got {trait}")
        if not np.isfinite(scores[column]):
            raise ValueError(f"expected a score to draw, got {scores[column]}; do all labelled persons have one label?")
        null = result.null.reshape(-1, n_traits)[:, column]  # (n_permutations,) or (n_permutations, n_traits)
        return cls(float(scores[column]), float(p_values[column]), null, score_name=score_name).plot(ax=ax)

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
        (ax,) = take_axes(ax, (5.2, 3.4))
        self.ax_, self.figure_ = ax, figure_of(ax)
        as_good = self.null >= self.score - _TIE
        chance = float(self.null.mean())
        ax.hist(
            [self.null[~as_good], self.null[as_good]],
            bins=_bin_edges(self.null),
            stacked=True,
            color=["0.75", "0.25"],
            label=["shuffled labels", "of these as good or better"],
        )
        ax.axvline(chance, color="black", lw=1.0, ls=":", label=f"their mean, {write_number(chance, '.2f')}")
        ax.axvline(self.score, color="black", lw=1.6, label=f"given labels, {write_number(self.score, '.2f')}")
        ax.set(xlabel=self.score_name, ylabel="number of shuffles")
        ax.set_title(self._title(), loc="left", fontsize="medium")
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(frameon=False, fontsize="small")
        return self

    def _title(self) -> str:
        score, n_permutations = write_number(self.score, ".2f"), len(self.null)
        return f"{self.score_name} {score}, {_write_p(self.p_value, n_permutations)}, {n_permutations} shuffles"

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _bin_edges(null: NDArray[np.float64]) -> list[float]:
    """Return edges of the bins: one bin a value where these are few and evenly spaced, as accuracies are."""
    low, high = float(null.min()), float(null.max())
    steps = np.diff(np.unique(null))
    steps = steps[steps > _TIE]
    step = float(steps.min()) if len(steps) else 1.0
    n_values = round((high - low) / step) + 1
    if n_values <= 1.5 * _N_BINS:
        return (low + step * (np.arange(n_values + 1) - 0.5)).tolist()
    return np.histogram_bin_edges(null, _N_BINS).tolist()


def _write_p(p_value: float, n_permutations: int) -> str:
    """Return p as papers write it; no smaller one can be had than one in all shuffles and the given labels."""
    n_labels = n_permutations + 1
    if p_value * n_labels < 1.5:
        return f"p ≤ 1/{n_labels}"
    return f"p = {p_value:.2g}"
