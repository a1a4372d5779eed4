"""A model of trait axes, named on the command line."""

from pathlib import Path

from sklearn.pipeline import Pipeline

from eigenwalker.persistence import load_model

__all__ = ["load_trait_model"]


def load_trait_model(path: Path) -> Pipeline:
    """Return a model that `eigenwalker fit` saved, or raise a ValueError that says what the file holds instead."""
    model = load_model(path)
    if not isinstance(model, Pipeline):
        kind = type(model).__name__
        use = "; make walks of it in Python, load_model(path).synthesize(12)" if kind == "GaitHSMM" else ""
        raise ValueError(f"{path}: expected a model of trait axes, from eigenwalker fit, got a {kind}{use}")
    return model
