"""The page of a study as one file: markup, style, scripts, jsPsych and contents, under a policy of its own."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

__all__ = ["study_page"]

_HERE = "eigenwalker.experiment.running.study_page"
_VIEWER = "eigenwalker.display.viewer"
_LIBRARIES = ("vendored/jspsych.js", "vendored/html-button-response.js")
# In the order of their imports.
_MODULES = (
    (_VIEWER, "walker.js"),
    (_VIEWER, "stage.js"),
    *((_HERE, f"{name}.js") for name in ("timing", "motion", "figure", "movie", "storage", "journal", "answers")),
    *((_HERE, f"{name}.js") for name in ("calibration", "trial", "screens", "timeline", "jatos_run", "study")),
)
_ENTRY = (_HERE, "page.js")
_IMPORT = re.compile(r"^import [^;]*;\n", flags=re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:class|const|function) (\w+))", flags=re.MULTILINE)
_COMMENT = ("//", "/*", "* ", "*/")
_FORMAT = 1
# jatos.js loads scripts, workers and pictures of its own, some of them as inline scripts, and opens a web socket.
_JATOS_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; worker-src 'self' blob:; "
    "connect-src 'self' ws: wss:; img-src 'self' data:; media-src 'self'"
)


def study_page(contents: Mapping[str, Any], *, jatos: bool = False) -> str:
    """Return a page that runs a study from its first screen to its last.

    It makes no request but for movies beside it: its policy allows this very style and these scripts, by their hashes,
    and no others. Each answer is stored in the browser when its trial ends, and all can be downloaded as one CSV file.

    Parameters
    ----------
    contents : mapping
        From `page_contents`.
    jatos : bool, default False
        Whether the page is for JATOS: it loads ``jatos.js`` from the server, sends each answer to it, and its policy
        allows what comes from this server.

    Returns
    -------
    str
        HTML.

    Raises
    ------
    ValueError
        If the contents are of another format.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment.running.page_contents import page_contents
    >>> from eigenwalker.experiment import RatingTask, make_study
    >>> from eigenwalker.experiment.running.study_page import study_page
    >>> walkers = make_walkers(3, random_state=0).data
    >>> study = make_study(RatingTask(("sad", "happy")), walks=walkers, n_participants=1, random_state=0)
    >>> page = study_page(page_contents(study))
    >>> page[:15], page.count("<script")
    ('<!DOCTYPE html>', 4)
    """
    if contents.get("format") != _FORMAT:
        raise ValueError(
            f"expected contents of format {_FORMAT}, as page_contents makes them, got {contents.get('format')!r}"
        )
    css, javascript = "\n".join(_lines(_HERE, "study.css")), _script()
    libraries = [_read(_HERE, name).partition("\n//# sourceMappingURL")[0] for name in _LIBRARIES]
    allowed = " ".join(_digest(text) for text in (*libraries, javascript))
    policy = (
        f"default-src 'none'; script-src {allowed}; style-src {_digest(css)}; img-src data:; media-src 'self' file:"
    )
    return Template(_read(_HERE, "page.html")).substitute(
        policy=_JATOS_POLICY if jatos else policy,
        title=escape(str(contents["title"])),
        server='<script src="jatos.js"></script>\n' if jatos else "",
        style=css,
        markup="\n".join(_lines(_HERE, "study.html")),
        contents=json.dumps(contents, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"),
        libraries="\n".join(f"<script>{library}</script>" for library in libraries),
        script=javascript,
    )


def _script() -> str:
    """Return all modules as one, each in a scope of its own that only its exports leave, and the entry behind them."""
    scopes = [_scoped(_code(*module)) for module in _MODULES]
    return "\n".join([*scopes, _IMPORT.sub("", _code(*_ENTRY))])


def _scoped(code: str) -> str:
    """Return a module without its imports, its exports as constants."""
    names = ", ".join(_EXPORT.findall(code))
    body = _EXPORT.sub("", _IMPORT.sub("", code))
    return f"const {{ {names} }} = (() => {{\n{body}return {{ {names} }};\n}})();"


def _code(package: str, name: str) -> str:
    return "\n".join(_lines(package, name)) + "\n"


def _lines(package: str, name: str) -> list[str]:
    """Return the lines of a file without comments and indentation, which are for those who read the file."""
    lines = [line.strip() for line in _read(package, name).splitlines()]
    return [line for line in lines if line and not f"{line} ".startswith(_COMMENT)]


def _read(package: str, name: str) -> str:
    return (files(package) / name).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
