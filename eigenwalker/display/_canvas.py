"""What displays draw on: axes that are given, or those of a new figure that pyplot knows nothing of."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["figure_of", "take_axes", "take_grid", "to_png", "write_number"]


def take_axes(
    ax: Axes | Sequence[Axes] | None, figsize: tuple[float, float], widths: Sequence[float] = (1.0,)
) -> list[Axes]:
    """Return the axes to draw on, one a panel.

    Parameters
    ----------
    ax : matplotlib Axes or sequence of Axes, default None
        What the caller gave. None makes a new figure with panels side by side.
    figsize : (float, float)
        Width and height of a new figure, in inches.
    widths : sequence of float, default (1.0,)
        Relative widths of its panels.

    Returns
    -------
    list of Axes

    Raises
    ------
    ValueError
        If the number of given axes is another one.
    """
    from matplotlib.figure import Figure

    if ax is None:
        figure = Figure(figsize=figsize, layout="constrained")
        return list(figure.subplots(1, len(widths), squeeze=False, width_ratios=list(widths))[0])
    given = list(np.ravel(np.asarray(ax, dtype=object)))
    if len(given) != len(widths):
        raise ValueError(f"ax must be {len(widths)} axes, one a panel, got {len(given)}")
    return given


def take_grid(ax: Axes | Sequence[Axes] | None, n_panels: int, n_columns: int, size: tuple[float, float]) -> list[Axes]:
    """Return the axes to draw on, one a panel, row by row.

    Parameters
    ----------
    ax : matplotlib Axes or sequence of Axes, default None
        What the caller gave. None makes a new figure, with places that no panel needs left empty.
    n_panels, n_columns : int
        How many panels, and how many of them in a row of a new figure.
    size : (float, float)
        Width and height of a panel of a new figure, in inches.

    Returns
    -------
    list of Axes

    Raises
    ------
    ValueError
        If the number of given axes is another one.
    """
    from matplotlib.figure import Figure

    if ax is not None:
        return take_axes(ax, size, [1.0] * n_panels)
    n_columns = min(n_columns, n_panels)
    n_rows = -(-n_panels // n_columns)
    figure = Figure(figsize=(size[0] * n_columns, size[1] * n_rows), layout="constrained")
    return [figure.add_subplot(n_rows, n_columns, place + 1) for place in range(n_panels)]


def figure_of(ax: Axes) -> Figure:
    """Return the figure that axes live on."""
    figure = ax.get_figure(root=True)
    assert figure is not None  # axes live on a figure
    return figure


def to_png(figure: Figure) -> bytes:
    """Return a figure as a notebook shows it."""
    picture = BytesIO()
    figure.savefig(picture, format="png", dpi=90)
    return picture.getvalue()


def write_number(value: float, spec: str) -> str:
    """Return a number as `format` does, but with the minus that matplotlib writes along axes, as long as a plus."""
    return format(value, spec).replace("-", "\N{MINUS SIGN}")
