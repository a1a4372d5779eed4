"""Models in files: written and read with skops, which runs no code out of a file."""

import io
import json
import platform
import tomllib
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any
from zipfile import ZIP_STORED, ZipFile

import numpy as np
import sklearn
from sklearn.base import BaseEstimator
from sklearn.exceptions import InconsistentVersionWarning

from eigenwalker._whole_files import write_whole
from eigenwalker.hsmm import GaitHSMM, StyleClassifier
from eigenwalker.hsmm.context_trees import ContextTree, Question, Split
from eigenwalker.model import BlockScaler, FourierLinearizer, TraitClassifier, TraitRegressor
from eigenwalker.model._labels import Coding
from eigenwalker.motion import JointWalk, MarkerSet, Skeleton, Walk, WalkPreparer

__all__ = ["describe_model", "load_model", "save_model"]

_ESTIMATORS = (
    *(BlockScaler, FourierLinearizer, GaitHSMM, StyleClassifier, TraitClassifier, TraitRegressor),
    WalkPreparer,
)
_HELD = (Coding, ContextTree, JointWalk, MarkerSet, Question, Skeleton, Split, Walk)  # by fitted estimators
# Of parts that come after this one, by name: skops imports what a file asks for.
_LATER = ("eigenwalker.experiment.judging.style_judge.JudgedFeatures",)
_TRUSTED = frozenset(f"{part.__module__}.{part.__name__}" for part in (*_ESTIMATORS, *_HELD)) | set(_LATER)
# What models are made of. skops' other nodes call what they hold, unpack archives, or set a random state past its end.
_NODES = frozenset(
    f"{kind}Node" for kind in ("Dict", "Function", "Json", "List", "NdArray", "Object", "Set", "Slice", "Tuple", "Type")
)
_SIZED = ("bytes_", "void")  # numpy's types that, called with a number, are so many bytes
_FORMAT, _STAMP, _SCHEMA = 1, "eigenwalker.json", "schema.json"
_LARGEST = {_STAMP: 2**12, _SCHEMA: 2**24, "file": 2**30}  # bytes; a usual model has 60,000, nearly all of it schema


class _RefusalError(ValueError):
    """Why a file is refused, in words for the user."""


def save_model(model: BaseEstimator, path: str | Path) -> None:
    """Write a model to a file, as a whole or not at all: an interrupted call leaves what was there before.

    Parameters
    ----------
    model : estimator
        A Pipeline of `make_eigenwalkers`, or another estimator made of this package's parts and of those of
        scikit-learn that hold words, numbers and arrays. One that is not fitted carries its settings.
    path : str or Path
        Where to; ``.skops`` is the usual suffix.

    Raises
    ------
    ImportError, TypeError
        If skops is not installed; if the model holds parts that `load_model` would refuse.
    """
    skops = _skops()
    try:
        _check_model(model)
        data = _finish(skops.dumps(model))
        foreign = _asked(data, skops) - _TRUSTED
    except (TypeError, ValueError) as error:
        raise TypeError(f"cannot save the model: {error}") from None
    if foreign:
        raise TypeError(f"cannot save the model: load_model would refuse its {', '.join(sorted(foreign))}")
    write_whole(Path(path).resolve(), data)  # a link keeps its place


def load_model(path: str | Path) -> BaseEstimator:
    """Read a model that `save_model` wrote.

    Only types of this package and those of scikit-learn that skops trusts are built; a file that asks for anything
    else is refused before anything of it runs. What a stranger's model says of a walk is still the stranger's word.

    Parameters
    ----------
    path : str or Path
        The file, of at most 1 GiB.

    Returns
    -------
    estimator
        With a warning, if another version of scikit-learn wrote it.

    Raises
    ------
    FileNotFoundError, ImportError
        If there is no such file; if skops is not installed.
    ValueError
        If the file is not a model, is damaged, has a newer format, or asks for a foreign type.
    """
    skops = _skops()
    data = _read(Path(path))
    with _name_file(path):
        stamp = _read_stamp(data)
        model = _build(data, stamp, skops)
    if stamp["scikit-learn"] != sklearn.__version__:
        warnings.warn(
            f"{path}: written with scikit-learn {stamp['scikit-learn']}, read with {sklearn.__version__}, where it may "
            f"give other results; fit it anew, or pip install scikit-learn=={stamp['scikit-learn']}",
            stacklevel=2,
        )
    return model


def describe_model(path: str | Path) -> dict[str, str]:
    """Return what wrote a model's file, by its own account, without building anything of it.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    dict of str to str
        The number of the "format", and the releases of "eigenwalker", "scikit-learn", "numpy" and "python".

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, or if `save_model` did not write it.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker import make_eigenwalkers, save_model
    >>> from eigenwalker.persistence import describe_model
    >>> with TemporaryDirectory() as folder:
    ...     save_model(make_eigenwalkers(n_components=5), f"{folder}/settings.skops")
    ...     describe_model(f"{folder}/settings.skops")["format"]
    '1'
    """
    data = _read(Path(path))
    with _name_file(path):
        return _read_stamp(data)


@contextmanager
def _name_file(path: str | Path) -> Iterator[None]:
    """Turn whatever is wrong with what is in a file into one error that names it."""
    try:
        yield
    except _RefusalError as error:
        raise ValueError(f"{path}: {error}") from None
    except Exception as error:  # zipfile, json, skops and numpy raise nearly every kind for bytes that are not theirs
        raise ValueError(
            f"{path}: expected a model written by save_model, got something else or a part of one, "
            f"{type(error).__name__}: {_plain(str(error))}; get the file again"
        ) from None


def _check_model(model: object) -> None:
    """Raise unless it is an estimator, and one that keeps no cache: `fit` would load the pickles that are in it."""
    if not isinstance(model, BaseEstimator):
        raise _RefusalError(f"expected an estimator, got {type(model).__name__}")
    for name, value in model.get_params().items():
        if name.split("__")[-1] == "memory" and value is not None:
            raise _RefusalError(
                f"expected {_plain(name)}=None, got a cache, out of which fit would load pickles; set it"
            )


def _make_stamp() -> dict[str, str]:
    releases = {"eigenwalker": _release(), "scikit-learn": sklearn.__version__, "numpy": np.__version__}
    return {"format": str(_FORMAT), **releases, "python": platform.python_version()}


def _release() -> str:
    """Return the version of this package: of the source folder it runs from, else of what is installed."""
    project = Path(__file__).parents[1] / "pyproject.toml"
    described = tomllib.loads(project.read_text(encoding="utf-8")).get("project", {}) if project.is_file() else {}
    if described.get("name") == "eigenwalker":
        return described["version"]
    try:
        return version("eigenwalker")
    except PackageNotFoundError:
        return "unknown"


def _finish(data: bytes) -> bytes:
    """Return skops' archive with the stamp, and with a tidy schema."""
    finished = io.BytesIO()
    with ZipFile(io.BytesIO(data)) as written, ZipFile(finished, "w") as archive:
        archive.writestr(_STAMP, json.dumps(_make_stamp()))
        archive.writestr(_SCHEMA, json.dumps(json.loads(written.read(_SCHEMA), object_hook=_tidy)))
        for name in set(written.namelist()) - {_SCHEMA}:
            archive.writestr(name, written.read(name))
    return finished.getvalue()


def _tidy(part: dict[str, Any]) -> dict[str, Any]:
    """Drop a node's address, and write the key False as "": skops reads it by bool(), and bool("false") is True."""
    part.pop("__id__", None)
    if part.get("__loader__") == "DictNode":
        kinds = [kind["__class__"] for kind in part["key_types"]["content"]]
        entries = zip(part["content"].items(), kinds, strict=True)
        part["content"] = {"" if (key, kind) == ("false", "bool") else key: value for (key, value), kind in entries}
    return part


def _read(path: Path) -> bytes:
    n_bytes = path.stat().st_size
    if n_bytes > _LARGEST["file"] or not path.is_file():
        got = f"{n_bytes:,} bytes" if path.is_file() else "a folder or a device"
        raise ValueError(f"{path}: expected a model, a file of at most {_LARGEST['file']:,} bytes, got {got}")
    return path.read_bytes()


def _sizes(archive: ZipFile, n_bytes: int) -> dict[str, int]:
    """Return how many bytes each entry has, or raise if that is more than there can be."""
    entries = archive.infolist()
    claimed = sum(entry.file_size for entry in entries)
    if claimed > n_bytes or any(entry.compress_type != ZIP_STORED for entry in entries):
        raise _RefusalError(f"expected a model without compression, got {n_bytes:,} bytes that unpack to {claimed:,}")
    sizes = {entry.filename: entry.file_size for entry in entries}
    for name in {_STAMP, _SCHEMA} & set(sizes):
        if sizes[name] > _LARGEST[name]:
            raise _RefusalError(f"expected {name} of at most {_LARGEST[name]:,} bytes, got {sizes[name]:,}")
    return sizes


def _read_stamp(data: bytes) -> dict[str, str]:
    """Return the stamp, of which these entries are in every format."""
    with ZipFile(io.BytesIO(data)) as archive:
        if _STAMP not in _sizes(archive, len(data)):
            raise _RefusalError(
                f"expected a model written by save_model, got an archive without its stamp, {_STAMP}; if skops wrote "
                "it, read it with skops.io.load, and save it with save_model"
            )
        stamp = json.loads(archive.read(_STAMP))
    return {"format": str(int(stamp["format"]))} | {key: _plain(stamp[key]) for key in list(_make_stamp())[1:]}


def _build(data: bytes, stamp: dict[str, str], skops: Any) -> BaseEstimator:
    if not 1 <= int(stamp["format"]) <= _FORMAT:
        raise _RefusalError(
            f"expected a model of format {_FORMAT}, got format {stamp['format']}, written by eigenwalker "
            f"{stamp['eigenwalker']}; this is {_release()}, update it"
        )
    asked = _asked(data, skops)
    if asked - _TRUSTED:
        foreign = _plain(", ".join(sorted(asked - _TRUSTED)))
        raise _RefusalError(f"refused, because the file asks for types that no model needs: {foreign}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InconsistentVersionWarning)  # one for each part; `load_model` says it once
        model = skops.loads(data, trusted=sorted(asked & _TRUSTED))
    _check_model(model)
    return model


def _asked(data: bytes, skops: Any) -> set[str]:
    """Return the types that a file asks for beyond those that skops trusts, and the nodes that no model needs."""
    parts: Any = []
    with ZipFile(io.BytesIO(data)) as archive:
        sizes = _sizes(archive, len(data))
        json.loads(archive.read(_SCHEMA), object_hook=lambda part: parts.append(part) or part)
    n_read = sum(sizes.get(str(part.get("file")), 0) for part in parts)
    if n_read > _LARGEST["file"]:
        raise _RefusalError(f"expected arrays of at most {_LARGEST['file']:,} bytes, got {n_read:,}")
    if any("__id__" in part for part in parts):  # by which few nodes could stand for 2^n, or for one within itself
        raise _RefusalError("expected a schema of save_model, without addresses, got one with them")
    refused = {
        f"{part['__module__']}.{part['__class__']} ({part['__loader__']})"
        for part in parts
        if "__loader__" in part and (part["__loader__"] not in _NODES or part["__class__"] in _SIZED)
    }
    return refused or set(skops.get_untrusted_types(data=data))


def _plain(text: str) -> str:
    """Return text out of a file as a part of an error: not long, and nothing that a terminal would obey."""
    return "".join(filter(str.isprintable, " ".join(text.split())))[:300]


def _skops() -> Any:
    try:
        import skops.io
    except ImportError:
        raise ImportError("saving and loading models needs skops: pip install 'eigenwalker[persist]'") from None
    return skops.io
