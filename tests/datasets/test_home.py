from pathlib import Path

from eigenwalker.datasets import clear_data_home, get_data_home


def test_the_home_is_the_users_choice(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    for unset in ("EIGENWALKER_DATA", None):
        if unset:
            monkeypatch.setenv(unset, "")
        else:
            monkeypatch.delenv("EIGENWALKER_DATA")
        assert get_data_home() == tmp_path / "eigenwalker_data"
    monkeypatch.setenv("EIGENWALKER_DATA", "~/elsewhere")
    assert get_data_home() == tmp_path / "elsewhere"
    assert get_data_home("~/third/one") == tmp_path / "third" / "one"
    assert all(Path(tmp_path, name).is_dir() for name in ("eigenwalker_data", "elsewhere", "third/one"))


def test_clearing_deletes_data_sets_only(tmp_path):
    home = get_data_home(tmp_path / "home")
    for path in ("bandai_walks/data/a.bvh", "kinect_gait/Data/1.txt", "cmu_walks/x.part", "thesis.txt"):
        (home / path).parent.mkdir(parents=True, exist_ok=True)
        (home / path).write_text("")
    clear_data_home(home)
    assert [path.name for path in home.iterdir()] == ["thesis.txt"]
    (home / "thesis.txt").unlink()
    clear_data_home(home)
    assert not home.exists()
    clear_data_home(home)
    assert not home.exists()
