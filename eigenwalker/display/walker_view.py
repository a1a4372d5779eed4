"""Moving walkers with sliders, as a page and in a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from sklearn.base import BaseEstimator
from sklearn.pipeline import Pipeline

from eigenwalker._validation import check_walks
from eigenwalker.display.body import check_drawable
from eigenwalker.display.viewer.contents import check_alphas, model_contents, take_axes, walk_contents
from eigenwalker.display.viewer.page import page
from eigenwalker.display.viewer.widget import make_widget
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["WalkerView", "view"]

_MOST_WALKERS = 12  # on the stage at once, as in controls.js
_HEIGHT = 680  # of the page in a notebook, in pixels

Alphas = Mapping[str, float]


def view(
    model_or_walks: Pipeline | Sequence[Walk],
    walks: Sequence[Walk] | None = None,
    *,
    alphas: Alphas | Sequence[Alphas] = (),
    title: str | None = None,
    note: str = "",
    n_harmonics: int = 4,
) -> WalkerView:
    """Return moving walkers with sliders along the trait axes of a model, or recorded walks side by side.

    Parameters
    ----------
    model_or_walks : Pipeline or list of Walk
        A fitted model, from `make_eigenwalkers` or with the same kinds of steps, or prepared walks to be seen
        without sliders.
    walks : list of Walk, default None
        With a model: prepared walks that can be loaded in place of the average walker. They are shown as their
        Eigenwalkers show them; what these leave out does not go into the page.
    alphas : mapping of str to float, or sequence of these, default ()
        Where traits are held at first, ``{"happy": 2.0}``; with several mappings there are as many walkers side by
        side. Empty is the average walker.
    title : str, default None
        Of the page. None names the traits.
    note : str, default ""
        A line under the title, such as where the recordings come from.
    n_harmonics : int, default 4
        Of walks that are shown without a model; a model has its own.

    Returns
    -------
    WalkerView
        It shows itself in a notebook; ``save("walker.html")`` writes a page.

    Raises
    ------
    TypeError, ValueError, NotFittedError
        If the model has no trait axes or is not fitted; if walks are no marker walks; if a trait is unknown or an alpha
        beyond its slider.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import view
    >>> from eigenwalker.model import make_eigenwalkers
    >>> walkers = make_walkers(24, random_state=0)
    >>> model = make_eigenwalkers(n_components=5).fit(walkers.data, walkers.target["happy"])
    >>> shown = view(model, walkers.data, alphas={"happy": 2.0})
    >>> shown.save("walker.html")  # doctest: +SKIP
    >>> shown.alphas
    {'happy': 2.0}
    """
    axes = None
    if isinstance(model_or_walks, BaseEstimator):
        axes = take_axes(model_or_walks)
        loaded = None if walks is None else check_walks(walks, kind=(Walk, JointWalk))
        contents = model_contents(model_or_walks, loaded)
        named = ", ".join(axes.trait_names_)
    else:
        contents = walk_contents(_take_recorded(model_or_walks, walks), n_harmonics)
        named = f"{len(contents['names'])} walks"
    held = [alphas] if isinstance(alphas, Mapping) else list(alphas)
    if len(held) > _MOST_WALKERS:
        raise ValueError(f"alphas must be of at most {_MOST_WALKERS} walkers, got {len(held)}")
    contents |= {"title": f"Walkers: {named}" if title is None else title, "note": note}
    return WalkerView(contents, held, axes)


class WalkerView:
    """Moving walkers with sliders.

    Made by `view`. A notebook shows it as a widget if anywidget is installed, else as a page in a frame; as a
    widget its `alphas` follow the sliders, and the sliders follow them.

    Parameters
    ----------
    contents : dict
        What the page is told.
    alphas : list of mapping
        Held alphas of each walker on the stage; none is one walker of which nothing is held, or all recorded walks.
    axes : TraitRegressor, default None
        The trait axes of the model, if there is one.
    """

    def __init__(self, contents: dict[str, Any], alphas: Sequence[Alphas], axes: TraitRegressor | None = None) -> None:
        self._contents = contents
        self._axes = axes
        self._held = [self._check(held) for held in alphas] or [{}]
        self._shown: Any = None

    @property
    def alphas(self) -> dict[str, float]:
        """Alphas of the traits that are held; other traits go along.

        Of the walker whose sliders are shown, at first the leftmost one. ``walk_at(model, view.alphas)`` is the walk
        that the page shows, if it starts from the average walker.
        """
        return dict(self._held[0] if self._shown is None else self._shown.alphas)

    @alphas.setter
    def alphas(self, alphas: Alphas) -> None:
        checked = self._check(alphas)
        if self._shown is None:
            self._held[0] = checked
        else:
            self._shown.alphas = checked

    def save(self, path: str | Path) -> None:
        """Write a page that needs no other file and makes no request.

        Parameters
        ----------
        path : str or Path
            Where to.
        """
        Path(path).write_text(page(self._told()), encoding="utf-8", newline="\n")

    def widget(self) -> Any:
        """Return the widget, always the same one.

        Returns
        -------
        anywidget.AnyWidget
            With the trait `alphas`.

        Raises
        ------
        ImportError
            If anywidget is not installed.
        """
        if self._shown is None:
            self._shown = make_widget(self._told(), self.alphas, self._check)
        return self._shown

    def _check(self, alphas: Alphas) -> dict[str, float]:
        checked = check_alphas(alphas, self._contents["traits"])
        if checked and self._axes is not None:
            self._axes.step([list(checked.values())], list(checked))  # raises where not all of them can be had
        return checked

    def _told(self) -> dict[str, Any]:
        """Return the contents with the walkers that are on the stage at first."""
        held = [self.alphas, *self._held[1:]]
        walkers: list[dict[str, Any]] = [{"walker": None, "alphas": alphas} for alphas in held]
        if self._contents["kind"] == "walks":
            walkers = [{"walker": number} for number in range(len(self._contents["names"]))]
        return self._contents | {"state": {"walkers": walkers[:_MOST_WALKERS]}}

    def _repr_html_(self) -> str:
        """Show the page in a frame, where there are no widgets."""
        return (
            f'<iframe srcdoc="{escape(page(self._told()))}" sandbox="allow-scripts allow-downloads" '
            f'title="{escape(self._contents["title"])}" style="width: 100%; height: {_HEIGHT}px; border: 0"></iframe>'
        )

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any] | tuple[dict[str, Any], dict[str, Any]]:
        """Show the widget if there can be one, else the page; front ends without widgets take the page as well."""
        shown: dict[str, Any] = {"text/html": self._repr_html_(), "text/plain": repr(self)}
        if find_spec("anywidget") is None:
            return shown
        bundle, metadata = self.widget()._repr_mimebundle_()
        return shown | bundle, metadata


def _take_recorded(walks: object, others: object) -> list[Walk]:
    """Return walks that are to be shown without a model, if they have a body to draw."""
    if others is not None:
        raise TypeError(
            "walks to load need a model, view(model, walks); walks alone are given as one list, view(walks)"
        )
    taken = check_walks(walks, kind=(Walk, JointWalk))
    for walk in taken:
        check_drawable(walk)
    return taken
