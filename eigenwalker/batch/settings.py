"""What a data set was made with: written down by the first run, and checked by every later one."""

import hashlib
import json
import reprlib
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, fields, is_dataclass
from functools import partial
from os import replace
from pathlib import Path
from typing import Any

import numpy as np

from eigenwalker.io.npz import read_npz, write_npz
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.motion.preparer import WalkPreparer
from eigenwalker.motion.template import one_frame
from eigenwalker.motion.walk import JointWalk, Walk
from eigenwalker.persistence import _release

__all__ = ["Settings", "check_same", "describe", "describe_call", "read_settings", "write_settings"]

_FORMAT = 1
_FILE, _TEMPLATE = "_settings.json", "_template.npz"  # readers of data sets pass over names with a line in front
_LARGEST = 64  # numbers of an array that are written out


@dataclass(frozen=True)
class Settings:
    """What a data set was made with, out of its folder.

    Parameters
    ----------
    described : dict
        Sections of settings, each a dictionary; what `describe_call` returned, with the channels found.
    template : Walk or JointWalk
        One frame of the walk whose channels all others must have.
    mark : str
        A word that is another one for other settings. Each part of the data set carries it.
    """

    described: dict[str, dict[str, Any]]
    template: Walk | JointWalk
    mark: str

    @property
    def linearizer(self) -> FourierLinearizer:
        """The linearizer of the first run, fitted to the template."""
        return FourierLinearizer(**self.described["linearizer"]).fit([self.template])

    @property
    def joints(self) -> tuple[str, ...] | None:
        """Joints that have channels; None for markers."""
        joints = self.described["walks"].get("joints")
        return None if joints is None else tuple(joints)


def describe_call(
    linearizer: FourierLinearizer,
    preparer: WalkPreparer | None,
    read: Callable[..., Any],
) -> dict[str, dict[str, Any]]:
    """Return what settles the rows, in types that JSON keeps. What fitted estimators know of walks is among it."""
    walks = _describe_walks(linearizer.template_) if hasattr(linearizer, "template_") else {}
    if preparer is not None and hasattr(preparer, "joints_"):
        walks["joints"] = preparer.joints_
    return {
        "program": {"format": _FORMAT, "eigenwalker": _release()},
        "linearizer": describe(linearizer.get_params(deep=False)),
        "preparation": {"preparer": None} if preparer is None else describe(preparer.get_params(deep=False)),
        "reading": {"read": describe(read)},
        "walks": describe(walks),
    }


def _describe_walks(template: Walk | JointWalk) -> dict[str, Any]:
    upright = isinstance(template, JointWalk) and template.skeleton.upright
    return {"kind": type(template).__name__, "channels": template.channel_names, "upright": upright}


def describe(value: Any) -> Any:
    """Return a setting in types that JSON keeps: equal for equal settings, and readable.

    Functions are known by their names, and long arrays by a hash.

    Examples
    --------
    >>> describe({"limits": (0.5, np.float64(1.5)), "reader": partial(sorted, reverse=True)})
    {'limits': [0.5, 1.5], 'reader': {'function': 'builtins.sorted', 'arguments': [], 'reverse': True}}
    """
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.ndarray):
        return value.tolist() if value.size <= _LARGEST else f"{value.shape} {_digest(value.tobytes())}"
    if isinstance(value, Mapping):
        return {str(key): describe(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [describe(item) for item in value]
    if isinstance(value, Set):
        return sorted(map(str, value))
    if isinstance(value, partial):
        return {"function": describe(value.func), "arguments": describe(value.args), **describe(value.keywords)}
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: describe(getattr(value, field.name)) for field in fields(value)}
    if hasattr(value, "__qualname__"):
        return f"{value.__module__}.{value.__qualname__}"
    held = describe(vars(value)) if hasattr(value, "__dict__") else {"value": repr(value)}
    return {"kind": type(value).__qualname__, **held}


def check_same(settings: Settings, described: Mapping[str, Mapping[str, Any]], folder: Path) -> None:
    """Raise a ValueError that lists all settings in which a call differs from the first one."""
    faults = []
    for section, given in described.items():
        first = settings.described[section]
        # Of walks only what fitted estimators know is settled.
        names = given if section == "walks" else {**first, **given}
        for name in names:
            faults += _differences(f"{section}, {name}", first.get(name), given.get(name))
    if faults:
        raise ValueError(
            f"{folder}: expected the settings with which its first rows were made, got others; choose another folder, "
            f"or take these back:{''.join(faults)}"
        )


def _differences(what: str, first: Any, given: Any) -> list[str]:
    """Return a line for each value that differs, of mappings each of theirs."""
    if json.dumps(first) == json.dumps(given):  # in which NaN is NaN
        return []
    if isinstance(first, Mapping) and isinstance(given, Mapping):
        names = {**first, **given}
        return [line for name in names for line in _differences(f"{what}, {name}", first.get(name), given.get(name))]
    return [f"\n  {what}: {_short(first)} in the first run, {_short(given)} now"]


def _short(value: Any) -> str:
    shown = reprlib.Repr()
    shown.maxstring = shown.maxother = 80
    return shown.repr(value)


def write_settings(
    folder: Path, described: Mapping[str, Mapping[str, Any]], walk: Any, joints: Sequence[str] | None
) -> Settings:
    """Write down what a data set is made with, the channels of its first walk among it, and return it."""
    walks = describe({**_describe_walks(walk), "joints": joints})
    text = json.dumps({**described, "walks": walks}, indent=1)
    write_npz(one_frame(walk), folder / _TEMPLATE)
    part = folder / f".{_FILE}.tmp"
    part.write_text(text, encoding="utf-8")
    replace(part, folder / _FILE)  # last, so that a folder with settings has a template
    return _read(folder, text)


def read_settings(folder: Path) -> Settings | None:
    """Return what the data set in a folder was made with, or None if the folder is free for one.

    Raises
    ------
    ValueError
        If the folder has other things in it, or settings that cannot be read.
    """
    try:
        text = (folder / _FILE).read_text(encoding="utf-8")
    except FileNotFoundError:
        others = sorted(path.name for path in folder.glob("*") if not path.name.startswith((".", "_")))
        if others:
            raise ValueError(
                f"{folder}: expected a new folder or one that linearize_files has written, got one without "
                f"{_FILE} that holds {', '.join(others[:5])}; choose another one"
            ) from None
        return None
    return _read(folder, text)


def _read(folder: Path, text: str) -> Settings:
    try:
        described = json.loads(text)
        if described["program"]["format"] != _FORMAT:
            raise ValueError(f"format {described['program']['format']} is not {_FORMAT}; update the package")
        return Settings(described, read_npz(folder / _TEMPLATE), _digest(text.encode()))
    except (KeyError, TypeError, ValueError, OSError) as error:
        raise ValueError(
            f"{folder}: expected the settings that linearize_files wrote in {_FILE} and {_TEMPLATE}, got others, "
            f"{type(error).__name__}: {error}; make the data set anew in another folder"
        ) from None


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
