"""``eigenwalker view``: a page of a model, of recordings, or of both."""

import json
import re

import pytest

from eigenwalker import make_eigenwalkers, make_walkers, save_model, write_walk


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a model and three recordings."""
    folder = tmp_path_factory.mktemp("recordings")
    walkers = make_walkers(20, random_state=0)
    for walk in walkers.data[:3]:
        write_walk(walk, folder / f"{walk.name}.csv")
    save_model(make_eigenwalkers(n_components=5).fit(walkers.data, walkers.target["happy"]), folder / "happy.skops")
    return folder


def _contents(page):
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="contents">(.*?)</script>', text)[1])


def test_a_model(run, folder, tmp_path):
    page = tmp_path / "walker.html"
    status, out, _ = run("view", folder / "happy.skops", "-o", page)
    assert (status, out) == (0, f"wrote {page}: open it in a browser\n")
    contents = _contents(page)
    assert (contents["title"], contents["names"]) == ("Walkers: happy", [])


def test_a_model_and_recordings_to_load(run, folder, tmp_path):
    page = tmp_path / "walker.html"
    files = sorted(folder.glob("*.csv"))
    assert run("view", folder / "happy.skops", *files, "--out", page, "--title", "Three of us")[0] == 0
    contents = _contents(page)
    assert contents["names"] == [file.stem for file in files]
    assert contents["title"] == "Three of us"
    assert contents["n_components"] == 5


def test_recordings_without_a_model(run, folder, tmp_path):
    page = tmp_path / "walks.html"
    assert run("view", *sorted(folder.glob("*.csv")), "-o", page)[0] == 0
    contents = _contents(page)
    assert (contents["kind"], contents["traits"]) == ("walks", [])
    assert len(contents["state"]["walkers"]) == 3


def test_bad_recordings_are_refused_or_left_out(run, folder, tmp_path):
    broken = tmp_path / "broken.csv"
    broken.write_text("time,head_x\n0,1\n")
    files = [*sorted(folder.glob("*.csv")), broken]
    status, _, err = run("view", *files, "-o", tmp_path / "walks.html")
    assert status == 1
    assert "1 of 4 recordings were refused; mend them, or leave them out with --skip-bad" in err
    status, out, _ = run("view", *files, "-o", tmp_path / "walks.html", "--skip-bad")
    assert status == 0
    assert "broken.csv" in out
    assert len(_contents(tmp_path / "walks.html")["names"]) == 3


def test_wrong_requests_are_refused(run, folder, tmp_path):
    model = folder / "happy.skops"
    (tmp_path / "other.skops").write_bytes(b"no model")
    cases = {
        "--out must end in .html, got walker.png": [model, "-o", "walker.png"],
        "expected a model written by save_model": [tmp_path / "other.skops", "-o", tmp_path / "w.html"],
        "expected at most one model, and recordings that end in .amc, .bvh": [model, model, "-o", tmp_path / "w.html"],
        "no.skops": [tmp_path / "no.skops", "-o", tmp_path / "w.html"],
    }
    for message, request in cases.items():
        status, _, err = run("view", *request)
        assert status == 1
        assert message in err
