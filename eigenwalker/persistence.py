"""Models in files: written and read with skops, which runs no code out of a file."""

from collections.abc import Iterable
from pathlib import Path
from zipfile import BadZipFile

from sklearn.base import BaseEstimator

__all__ = ["load_model", "save_model"]

_TRUSTED = frozenset(
    {
        "eigenwalker.model._labels.Coding",
        "eigenwalker.model.linearization.FourierLinearizer",
        "eigenwalker.model.scaling.BlockScaler",
        "eigenwalker.model.discriminant.TraitClassifier",
        "eigenwalker.model.traits.TraitRegressor",
        "eigenwalker.motion.preparer.WalkPreparer",
        "eigenwalker.motion.skeleton.MarkerSet",
        "eigenwalker.motion.skeleton.Skeleton",
        "eigenwalker.motion.walk.JointWalk",
        "eigenwalker.motion.walk.Walk",
    }
)


def save_model(model: BaseEstimator, path: str | Path) -> None:
    """Write a fitted model to a file.

    Parameters
    ----------
    model : estimator
        A Pipeline of `make_eigenwalkers`, or any estimator made of this package's and scikit-learn's parts.
    path : str or Path
        Where to; ``.skops`` is the usual suffix.

    Raises
    ------
    ImportError
        If skops is not installed.
    TypeError
        If the model holds parts that `load_model` would refuse.
    """
    skops = _skops()
    data = skops.dumps(model)
    foreign = _foreign(skops.get_untrusted_types(data=data))
    if foreign:
        raise TypeError(f"cannot save the model: load_model would refuse its {', '.join(foreign)}")
    Path(path).write_bytes(data)


def load_model(path: str | Path) -> BaseEstimator:
    """Read a model that `save_model` wrote.

    Only types of this package and of scikit-learn are built; a file that asks for anything else is refused before
    anything of it runs.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    estimator

    Raises
    ------
    ImportError
        If skops is not installed.
    ValueError
        If the file is not a model, is cut off, or asks for a foreign type.
    """
    skops = _skops()
    data = Path(path).read_bytes()
    try:
        asked = skops.get_untrusted_types(data=data)
    except (BadZipFile, KeyError, ValueError, TypeError, AttributeError) as error:
        raise ValueError(
            f"{path}: expected a model written by save_model, got something else or a part of one: {error}"
        ) from None
    foreign = _foreign(asked)
    if foreign:
        raise ValueError(f"{path}: refused, because the file asks for types that no model needs: {', '.join(foreign)}")
    return skops.loads(data, trusted=asked)


def _foreign(types: Iterable[str]) -> list[str]:
    return sorted(set(types) - _TRUSTED)


def _skops():
    try:
        import skops.io
    except ImportError:
        raise ImportError("saving and loading models needs skops: pip install 'eigenwalker[persist]'") from None
    return skops.io
