"""The command line, as a user meets it."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from eigenwalker import TROJE15, MarkerSet, load_model, make_walkers, read_walk, write_walk


@pytest.fixture(scope="module")
def files(data_dir):
    folder = data_dir / "bandai2"
    return [path for style in ("masculine", "feminine") for path in sorted(folder.glob(f"*walk_{style}_*.bvh"))[:10]]


PATTERN = r"walk_(?P<style>[a-z]+)_"


def test_demo(run, tmp_path):
    status, out, _ = run("demo", "--out", tmp_path / "demo")
    assert status == 0
    results = out.splitlines()[:-1]
    assert len(results) == 5
    assert all(line.endswith("(synthetic: says nothing about people)") for line in results)
    assert "permutation p = " in out
    names = {path.name for path in (tmp_path / "demo").iterdir()}
    pictures = {"average.png", "gender.png", "weight.png", "happy.png", "nervous.png"}
    assert names == pictures | {"gender_plus_2.csv", "walker.html"}
    table = pd.read_csv(tmp_path / "demo" / "gender_plus_2.csv")
    assert table.shape[1] == 46
    assert table["head_z"].gt(1.2).all()


def test_fit_and_walk(run, files, tmp_path):
    model, table, picture = tmp_path / "m.skops", tmp_path / "walk.csv", tmp_path / "walk.png"
    status, out, _ = run(
        "fit", *files, "--label-pattern", PATTERN, "--trait", "style", "--components", 5, "--out", model
    )
    assert status == 0
    assert "recordings: 20, refused: 0" in out
    assert "style, leaving out one recording at a time: accuracy" in out
    assert "frequency and speed alone: accuracy" in out
    assert "p =" not in out
    status, out, _ = run("walk", model, "--alpha", "style=2", "--base", files[0], "--out", table)
    assert status == 0
    assert f"wrote {table}: style +2" in out
    columns = pd.read_csv(table)
    assert np.isclose(np.diff(columns["time"]), 1 / 120).all()
    assert run("walk", model, "--alpha", "style=-1", "--out", picture)[0] == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    for ending in (".mat", ".npz", ".trc", ".tsv", "_motion.tsv"):
        written = tmp_path / f"happy{ending}"
        assert run("walk", model, "--alpha", "style=1", "--out", written)[0] == 0
        assert read_walk(written).n_frames > 1000
    assert load_model(model)["trait"].poles_ == {"style": ("feminine", "masculine")}


def test_labels_from_a_table(run, files, tmp_path):
    rng = np.random.default_rng(0)
    labels = pd.DataFrame(
        {
            "file": [path.name for path in files],
            "person": np.repeat(["a", "b", "c", "d"], 5),
            "mood": rng.normal(size=20),
        }
    )
    labels.loc[3, "mood"] = np.nan
    labels = labels.sample(frac=1, random_state=0)
    labels.to_csv(tmp_path / "labels.csv", index=False)
    arguments = ["--labels", tmp_path / "labels.csv", "--trait", "mood", "--group", "person", "--components", 3]
    status, out, _ = run("fit", *files, *arguments, "--out", tmp_path / "m.skops")
    assert status == 0
    assert "mood, leaving out one person at a time: r = " in out
    assert "over 19 walks" in out
    assert "taken for another person" not in out


def _table(tmp_path, files, **columns):
    pd.DataFrame({"file": [path.stem for path in files]} | columns).to_csv(tmp_path / "labels.csv", index=False)
    return ["--labels", tmp_path / "labels.csv", "--out", tmp_path / "m.skops"]


def test_wrong_labels_are_refused(run, files, tmp_path):
    few = files[:3]
    out = ["--out", tmp_path / "m.skops"]
    cases = {
        "does not match 3 of 3 files": [*few, "--label-pattern", "(run)", "--trait", "style", *out],
        "has no group for mood; write": [*few, "--label-pattern", PATTERN, "--trait", "mood", *out],
        "is not a regular expression": [*few, "--label-pattern", "(", "--trait", "style", *out],
        "mood not found, it has file, style": [*few, "--trait", "mood", *_table(tmp_path, few, style=list("aba"))],
    }
    for message, arguments in cases.items():
        status, _, err = run("fit", *arguments)
        assert status == 1
        assert message in err


def test_labels_and_files_must_match(run, files, tmp_path):
    listed = [*files[:3], files[0]]
    arguments = [*files[1:5], "--trait", "style", *_table(tmp_path, listed, style=list("abab"))]
    status, _, err = run("fit", *arguments)
    assert status == 1
    assert f"2 files without a row in the table: {files[3].stem}, {files[4].stem}" in err
    assert f"1 rows without a file: {files[0].stem}" in err
    assert f"1 files with more than one row: {files[0].stem}" in err


def test_one_class_only_is_refused(run, files, tmp_path):
    arguments = ["--label-pattern", PATTERN, "--trait", "style", "--components", 2, "--out", tmp_path / "m.skops"]
    status, _, err = run("fit", *files[:8], *arguments)
    assert status == 1
    assert "trait 'style': expected two classes, got one class only, 'masculine'" in err


def test_too_few_recordings_are_refused(run, files, tmp_path):
    arguments = ["--label-pattern", PATTERN, "--trait", "style", "--out", tmp_path / "m.skops"]
    status, _, err = run("fit", *files[6:14], *arguments)
    assert status == 1
    assert "15 Eigenwalkers and a trait need more than 17 walks" in err
    assert "fewer --components" in err


def test_bad_recordings_are_counted_by_label(run, files, tmp_path):
    broken = tmp_path / "walk_masculine_broken.bvh"
    broken.write_bytes(files[0].read_bytes()[:50_000])
    arguments = ["--label-pattern", PATTERN, "--trait", "style", "--components", 3, "--out", tmp_path / "m.skops"]
    status, out, err = run("fit", *files, broken, *arguments)
    assert status == 1
    assert "style masculine: 1 of 11 refused" in out
    assert "style feminine: 0 of 10 refused" in out
    assert "1 of 21 recordings were refused; mend them, or leave them out with --skip-bad" in err
    assert f"{broken}, line" in err
    status, out, _ = run("fit", *files, broken, *arguments, "--skip-bad")
    assert status == 0
    assert "recordings: 21, refused: 1" in out


def test_wrong_unit_is_refused_with_advice(run, files, tmp_path):
    arguments = ["--label-pattern", PATTERN, "--trait", "style", "--out", tmp_path / "m.skops", "--unit", "m"]
    status, _, err = run("fit", *files[:2], *arguments)
    assert status == 1
    assert "legs are 80.1 m long with unit='m'" in err
    assert "unit='cm'" in err


def test_wrong_requests_for_a_walk_are_refused(run, files, tmp_path):
    model = tmp_path / "m.skops"
    arguments = ["--label-pattern", PATTERN, "--trait", "style", "--components", 5, "--out", model]
    assert run("fit", *files, *arguments)[0] == 0
    cases = {
        "trait must be one of 'style', got 'mood'": [model, "--alpha", "mood=2", "--out", tmp_path / "w.csv"],
        "--alpha must be TRAIT=NUMBER, such as gender=2, got 'style'": [model, "--alpha", "style", "--out", "w.csv"],
        "--out must end in .bvh, .c3d, .csv, .mat, .npz, .png, .trc, .tsv, _motion.tsv, got w.fbx": [
            model,
            "--alpha",
            "style=1",
            "--out",
            "w.fbx",
        ],
        "expected a model written by save_model": [files[0], "--alpha", "style=1", "--out", tmp_path / "w.csv"],
        "no.skops": [tmp_path / "no.skops", "--alpha", "style=1", "--out", tmp_path / "w.csv"],
    }
    for message, request in cases.items():
        status, _, err = run("walk", *request)
        assert status == 1
        assert message in err


PLACES = {name: name.upper() for name in TROJE15.names} | {"left_knee": {"LKNE": 0.5, "LKNM": 0.5}}


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    """Return recordings with markers that a laboratory has names of its own for."""
    folder = tmp_path_factory.mktemp("laboratory")
    walkers = make_walkers(8, random_state=0)
    names = [name.upper() for name in TROJE15.names] + ["LKNE", "LKNM"]
    knee = TROJE15.index("left_knee")
    for number, walk in enumerate(walkers.data):
        sides = walk.positions[:, [knee, knee]] + [[0.0, 0.05, 0.0], [0.0, -0.05, 0.0]]
        kept = [place for place in range(17) if place != knee]
        positions = np.concatenate((walk.positions, sides), axis=1)[:, kept]
        marked = replace(walk, positions=positions, marker_set=MarkerSet(tuple(names[place] for place in kept)))
        write_walk(marked, folder / f"walk_{'ab'[number % 2]}_{number}.csv")
    return sorted(folder.glob("*.csv"))


def test_markers_of_a_laboratory(run, laboratory, tmp_path):
    places, model = tmp_path / "map.json", tmp_path / "m.skops"
    places.write_text(json.dumps(PLACES))
    arguments = ["--label-pattern", r"walk_(?P<kind>[ab])_", "--trait", "kind", "--components", 2, "--out", model]
    status, _, err = run("fit", *laboratory, *arguments)
    assert status == 1
    assert "8 of 8 recordings were refused" in err
    assert "no known rig (bandai, " in err
    assert "fits the names HEAD, CLAVICLE" in err
    status, out, _ = run("fit", *laboratory, *arguments, "--markers", places)
    assert status == 0
    assert "recordings: 8, refused: 0" in out
    request = ["walk", model, "--alpha", "kind=1", "--base", laboratory[0], "--out", tmp_path / "walk.csv"]
    assert run(*request)[0] == 1
    assert run(*request, "--markers", places)[0] == 0
    assert read_walk(tmp_path / "walk.csv").marker_set is TROJE15


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        ("{head: HEAD}", ["map.json: expected a JSON file of markers, got other text: Expecting property name"]),
        (b"\xff\xfe\x00", ["map.json: expected a JSON file of markers, got other text"]),
        ('["HEAD"]', ['map.json: expected a JSON dictionary such as {"head": "HEAD", ', "}, ...}, got list"]),
        (
            json.dumps({"head": "HEAD", "nose": "NOSE", "pelvis": 3, "left_hip": {"LASI": 0.7}}),
            [
                "map.json: the map of markers must place all 15 markers; it lacks clavicle, left_shoulder",
                "not nose",
                "does not for pelvis",
                "must sum to one, but not for left_hip",
            ],
        ),
        (
            json.dumps(PLACES | {"head": "SKULL", "pelvis": "SACR"}),
            ["rig 'map' needs SACR, SKULL; found HEAD, CLAVICLE", "LKNE, LKNM"],
        ),
    ],
)
def test_wrong_maps_of_markers_are_refused(run, laboratory, tmp_path, text, messages):
    places = tmp_path / "map.json"
    places.write_bytes(text if isinstance(text, bytes) else text.encode())
    arguments = ["--label-pattern", r"walk_(?P<kind>[ab])_", "--trait", "kind", "--out", tmp_path / "m.skops"]
    status, _, err = run("fit", *laboratory, *arguments, "--markers", places)
    assert status == 1
    for message in messages:
        assert message in err
    status, _, err = run("fit", *laboratory, *arguments, "--markers", tmp_path / "none.json")
    assert status == 1
    assert "none.json" in err
