"""The viewer as a widget of a notebook, with anywidget."""

from collections.abc import Callable, Mapping
from typing import Any

from eigenwalker.display.viewer.page import markup, script, style

__all__ = ["make_widget"]


def make_widget(
    contents: Mapping[str, Any], alphas: Mapping[str, float], check: Callable[[Mapping[str, float]], dict[str, float]]
) -> Any:
    """Return a widget that shows a viewer, and whose `alphas` are those of its sliders, both ways.

    Parameters
    ----------
    contents : mapping
        From `model_contents` or `walk_contents`, with title, note and state.
    alphas : mapping of str to float
        Where traits are held at first.
    check : callable
        Returns new alphas as they are kept, or raises.

    Returns
    -------
    anywidget.AnyWidget

    Raises
    ------
    ImportError
        If anywidget is not installed.
    """
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise ImportError(
            'the widget needs anywidget: pip install "eigenwalker[notebook]"; without it a notebook shows the page'
        ) from None

    class ViewerWidget(anywidget.AnyWidget):
        _esm = script("widget.js")
        _css = style()
        _markup = traitlets.Unicode(markup()).tag(sync=True)
        _contents = traitlets.Dict().tag(sync=True)
        alphas = traitlets.Dict().tag(sync=True)

        @traitlets.validate("alphas")
        def _check(self, proposal: dict[str, Any]) -> dict[str, float]:
            return check(proposal["value"])

    return ViewerWidget(_contents=dict(contents), alphas=dict(alphas))
