"""A page of walkers as one file: markup, style, script and contents, under a policy that lets nothing else in."""

import base64
import hashlib
import json
import re
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

__all__ = ["markup", "page", "script", "style"]

_MODULES = ("walker.js", "stage.js", "controls.js", "viewer.js")
_COMMENT = ("//", "/*", "* ", "*/")


def page(contents: Mapping[str, Any]) -> str:
    """Return a page that makes no request: its policy allows this very style and script, by their hashes, and no other.

    Parameters
    ----------
    contents : mapping
        From `model_contents` or `walk_contents`, with title, note and state.

    Returns
    -------
    str
        HTML.
    """
    css, javascript = style(), script("page.js")
    policy = f"default-src 'none'; script-src {_digest(javascript)}; style-src {_digest(css)}; img-src data:"
    return Template(_read("page.html")).substitute(
        policy=policy,
        title=escape(str(contents["title"])),
        style=css,
        markup=markup(),
        contents=_as_text(contents),
        script=javascript,
    )


def markup() -> str:
    """Return the elements that the script fills."""
    return "\n".join(_lines("viewer.html"))


def style() -> str:
    """Return the style sheet; all of it is about elements within ``.eigenwalker``."""
    return "\n".join(_lines("viewer.css"))


def script(entry: str) -> str:
    """Return the modules of the viewer and an entry, page.js or widget.js, as one module.

    They need no bundler: nothing in them has the same name, so that it is enough to put them one after the other,
    without what they import from each other. Comments stay at home.
    """
    lines = [line for name in (*_MODULES, entry) for line in _lines(name) if not line.startswith("import ")]
    return "\n".join(re.sub(r"^export (?!default)", "", line) for line in lines)


def _lines(name: str) -> list[str]:
    """Return the lines of a file without comments and indentation, which are for those who read the file."""
    lines = [line.strip() for line in _read(name).splitlines()]
    return [line for line in lines if line and not f"{line} ".startswith(_COMMENT)]


def _read(name: str) -> str:
    return (files("eigenwalker.display.viewer") / name).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _as_text(contents: Mapping[str, Any]) -> str:
    """Return JSON in which nothing can end the element that it stands in."""
    return json.dumps(contents, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
