"""``eigenwalker demo``: the whole job on synthetic walkers."""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline
from tqdm import tqdm

from eigenwalker.datasets import make_walkers
from eigenwalker.display.plotting import StickFigureDisplay
from eigenwalker.display.walker_view import view
from eigenwalker.io.table import write_csv
from eigenwalker.model.eigenwalkers import make_eigenwalkers, settings_of
from eigenwalker.model.generation import walk_along_axis
from eigenwalker.model.inference import loo_matrix, permutation_test
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.preparation import prepare_walks

HELP = "run the main job on synthetic walkers"
DESCRIPTION = (
    "Learn gender, weight and mood axes from 80 synthetic walkers, and write pictures, a walk, and a page of walkers "
    "that move, with sliders."
)

_NOTE = "(synthetic: says nothing about people)"
_PAGE_NOTE = "Synthetic walkers: they say nothing about people."
_POLES = {
    "gender": ("female", "male"),
    "weight": ("light", "heavy"),
    "happy": ("sad", "happy"),
    "nervous": ("relaxed", "nervous"),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "--out", type=Path, default=Path("eigenwalker-demo"), metavar="DIR", help="folder for the results"
    )


def run(options: argparse.Namespace) -> None:
    """Make walkers, learn their traits, print, draw and write."""
    options.out.mkdir(parents=True, exist_ok=True)
    with tqdm(total=5, desc="making 80 walkers", delay=2, bar_format="{desc}: {n_fmt}/{total_fmt} [{elapsed}]") as bar:
        walkers = make_walkers(80, random_state=0)
        _next(bar, "preparing them")
        walks = prepare_walks(walkers.data)
        _next(bar, "finding Eigenwalkers")
        traits = walkers.target[list(_POLES)]
        model = make_eigenwalkers(trait=TraitRegressor(poles=_POLES)).fit(walks, traits)
        vectors = model["linearizer"].transform(walks)
        _next(bar, "leaving out one walker at a time")
        matrix = loo_matrix(vectors, **settings_of(model))
        _next(bar, "drawing")
        _draw(model, options.out)
        view(model, walks, note=_PAGE_NOTE).save(options.out / "walker.html")
        bar.update()
    _print_results(model, matrix, traits)
    example = walk_along_axis(model, "gender", [2.0])[0]
    write_csv(example, options.out / "gender_plus_2.csv")
    print(
        f"pictures, a walk and a page are in {options.out}/: open walker.html, where walkers move, and average.png, "
        "gender.png, weight.png, happy.png, nervous.png"
    )


def _next(bar: tqdm, description: str) -> None:
    bar.update()
    bar.set_description(description)


def _print_results(model: Pipeline, matrix: NDArray[np.float64], traits: pd.DataFrame) -> None:
    codes = model["trait"].encode(traits)
    variance = model["eigenwalkers"].explained_variance_ratio_.sum()
    print(f"15 Eigenwalkers hold {variance:.0%} of the variance of 80 walkers {_NOTE}")
    gender = permutation_test(matrix, codes[:, 0], n_permutations=10_000, random_state=0)
    print(
        f"gender of a walker left out is told with accuracy {gender.score:.0%}, "
        f"permutation p = {gender.p_value:.4f} {_NOTE}"
    )
    for column, trait in enumerate(traits.columns[1:], start=1):
        correlation = np.corrcoef(codes[:, column], matrix @ codes[:, column])[0, 1]
        print(f"{trait} of a walker left out: predicted and true correlate with r = {correlation:.2f} {_NOTE}")


def _draw(model: Pipeline, folder: Path) -> None:
    from matplotlib.figure import Figure

    average = [replace(walk, name="average walker") for walk in walk_along_axis(model, "gender", [0.0])]
    pictures = {"average": average, **{trait: walk_along_axis(model, trait, [-2, 0, 2]) for trait in _POLES}}
    for name, walks in pictures.items():
        figure = Figure(figsize=(12, 0.6 + 2.3 * len(walks)), layout="constrained")
        for ax, seen in zip(figure.subplots(1, 2), ("frontal", "half-profile"), strict=True):
            StickFigureDisplay.from_walks(walks, view=seen, ax=ax)
            ax.set_title(seen)
        words = "" if name == "average" else f": {_POLES[name][0]} (-) to {_POLES[name][1]} (+)"
        figure.suptitle(f"{name}{words} {_NOTE}")
        figure.savefig(folder / f"{name}.png", dpi=110)
