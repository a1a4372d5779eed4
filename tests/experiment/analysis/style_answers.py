"""Answers of simulated people in the form that studies have: of known chances, with people and styles that differ."""

import numpy as np
import pandas as pd

__all__ = ["STYLES", "paper_naturalness", "style_answers"]

STYLES = ("afraid", "cool", "heavy", "sad")
_COLUMNS = ["study", "participant", "session", "trial", "task", "part", "stimulus", "kind", "style", "condition"]
_LEVELS = ("nothing in common", "very different", "different", "slightly different", "identical")


def paper_naturalness():
    """Return the answers of Fig. 5 of Tilmanne, Moinet & Dutoit 2012, of nobody knows whom and about which walks."""
    counts = {"original": (161, 79, 6), "synthetic": (128, 109, 17)}
    words = ("real", "synthetic", "don't know")
    rows = [(kind, word) for kind, row in counts.items() for word, n in zip(words, row, strict=True) for _ in range(n)]
    return pd.DataFrame(rows, columns=["kind", "answer"]).assign(task="naturalness", style="")


def style_answers(task, n_participants=20, *, seed=0, difference=0.15):
    """Return answers to all stimuli: each style in two kinds and two conditions, and the average walk."""
    random = np.random.default_rng(seed)
    pair = task in ("pair", "resemblance")
    shown = [
        (f"{style}_{kind}_{condition}", kind, style, condition)
        for style in STYLES
        for kind in (("synthetic",) if pair else ("original", "synthetic"))
        for condition in ("displacement", "static")
    ]
    if not pair:
        shown += [
            (f"average_{condition}", "synthetic", "average walk", condition) for condition in ("displacement", "static")
        ]
    rows = []
    for participant in range(1, n_participants + 1):
        for trial, at in enumerate(random.permutation(len(shown)), 1):
            row = ("0123456789ab", participant, 1, trial, task, "main", *shown[at])
            rows.append((*row, _answer(task, shown[at], difference, random)))
    return pd.DataFrame(rows, columns=[*_COLUMNS, "answer"])


def _answer(task, shown, difference, random):
    _, kind, style, _ = shown
    chance = 0.7 - difference * (kind == "synthetic")
    if task == "naturalness":
        return str(random.choice(["real", "synthetic", "don't know"], p=[chance, 0.95 - chance, 0.05]))
    if task == "recognition":
        right = random.random() < chance - 0.1 * (style == "cool")
        return style if right else str(random.choice([*STYLES, "don't know"]))
    score = random.binomial(4, 0.5 + 0.1 * STYLES.index(style))
    return _LEVELS[score] if task == "resemblance" else str(score)
