"""Stubs, documentation and examples keep up with the module."""
import ast
import os
import pathlib
import re
import runpy
import sys

import pytest

import flies

ROOT = pathlib.Path(os.environ["FLIES_SOURCE_DIR"])


def stub_names():
    tree = ast.parse((ROOT / "python/flies/__init__.pyi").read_text())
    names = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            members = [m.name if isinstance(m, ast.FunctionDef) else m.target.id for m in node.body
                       if isinstance(m, (ast.FunctionDef, ast.AnnAssign))]
            names[node.name] = set(members) - {"__init__"}
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = set()
    return names


def module_names():
    names = {}
    for name in flies.__all__:
        thing = getattr(flies, name)
        if isinstance(thing, type):
            names[name] = {m for m in vars(thing) if not m.startswith("_") or m == "__len__"}
        elif callable(thing):
            names[name] = set()
    return names


def test_stubs_name_what_there_is():
    stubs, module = stub_names(), module_names()
    stubs["InputError"] = module["InputError"] = set()
    assert stubs == module


def test_everything_is_documented():
    assert "x forward, y left" in flies.__doc__
    for name, members in module_names().items():
        thing = getattr(flies, name)
        assert thing.__doc__, name
        for member in members - {"__len__"}:
            if not member.isupper() and name != "InputError":
                assert vars(thing)[member].__doc__, f"{name}.{member}"


def test_version_is_that_of_the_project():
    version = re.search(r"project\(flies VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert flies.__version__ == version


def run_example(monkeypatch, name, *arguments):
    path = ROOT / "examples/python" / name
    monkeypatch.setattr(sys, "argv", [str(path), *map(str, arguments)])
    runpy.run_path(str(path), run_name="__main__")


def test_example_folder_draws(street, tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "found.png"
    run_example(monkeypatch, "folder.py", street / "left", street / "right", street / "calib.yaml", picture)
    assert re.search(r"[1-9][0-9]* obstacles", capsys.readouterr().out)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_example_live_follows(street, pair, tmp_path, monkeypatch, capsys):
    cv2 = pytest.importorskip("cv2", reason="needs python3-opencv")
    import numpy as np

    film = str(tmp_path / "both.avi")
    both = np.concatenate(pair, axis=1)
    writer = cv2.VideoWriter(film, cv2.VideoWriter_fourcc(*"MJPG"), 10, (both.shape[1], both.shape[0]))
    for _ in range(3):
        writer.write(cv2.cvtColor(both, cv2.COLOR_GRAY2BGR))
    writer.release()
    run_example(monkeypatch, "live.py", film, street / "calib.yaml")
    assert re.search(r"(other|person) [1-9][0-9]*: [0-9.]+ m ahead", capsys.readouterr().out)
