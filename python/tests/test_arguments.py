"""What Python passes for paths, options and numbers is taken as its own functions take it."""
import os
import pathlib
import shutil
import types

import numpy as np
import pytest

import flies

KINDS_OF_PATH = [str, pathlib.Path, os.fsencode]


@pytest.mark.parametrize("kind", KINDS_OF_PATH)
def test_paths_are_taken_as_open_takes_them(street, paths, pair, kind):
    assert flies.load_calibration(kind(street / "calib.yaml")).camera.width_px == 640
    loaded = flies.load_pair(kind(pathlib.Path(paths[0][0])), kind(pathlib.Path(paths[0][1])))
    assert np.array_equal(loaded[0], pair[0]) and np.array_equal(loaded[1], pair[1])
    assert flies.find_pairs(kind(street / "left"), kind(street / "right")) == paths
    with pytest.raises(flies.InputError, match="right calibration: is not used"):
        flies.load_calibration(street / "calib.yaml", right_path=kind(street / "right.yaml"))


@pytest.mark.parametrize("kind", KINDS_OF_PATH)
def test_a_model_is_a_path_too(camera, street, kind):
    for make in (flies.Detector, flies.Tracker, flies.Engine):
        with pytest.raises(flies.InputError, match="calib.yaml"):
            make(camera, model=kind(street / "calib.yaml"))


def test_what_is_no_path_is_told(street):
    for call in (flies.load_calibration, lambda path: flies.load_pair(path, path), lambda path: flies.find_pairs(path, path)):
        with pytest.raises(TypeError, match="os.PathLike"):
            call(3)
        with pytest.raises(ValueError, match="null byte"):
            call("calib\0.yaml")


def test_names_that_are_not_utf8_go_there_and_back(paths, tmp_path):
    for side, path in zip((b"left", b"right"), paths[0]):
        folder = os.path.join(os.fsencode(tmp_path), side)
        os.mkdir(folder)
        try:
            shutil.copy(path, os.path.join(folder, b"a\xff.png"))
        except OSError:
            pytest.skip("this file system has UTF-8 names only")
    found = flies.find_pairs(tmp_path / "left", tmp_path / "right")
    assert len(found) == 1 and os.fsencode(found[0][0]).endswith(b"a\xff.png")
    assert flies.load_pair(*found[0])[0].shape == (240, 640)
    with pytest.raises(flies.InputError, match=r"b\\xff.png"):
        flies.load_pair(os.fsencode(tmp_path) + b"/b\xff.png", found[0][1])


def test_options_are_any_mapping(pair, camera):
    def count(options):
        return len(flies.Detector(camera, options).process(*pair).flies)

    assert count(types.MappingProxyType({"evolve.flies": 500})) == 500
    assert count({"evolve": types.MappingProxyType({"flies": 500})}) == 500
    for make in (flies.Tracker, flies.Engine):
        make(camera, types.MappingProxyType({"track.gate": 10}))
    with pytest.raises(TypeError, match="Mapping"):
        flies.Detector(camera, [("evolve.flies", 500)])


def test_numbers_of_numpy_are_values(street, camera):
    truth_values = [name for name, value, _, _ in flies.options() if value in ("true", "false")]
    assert truth_values
    for name in truth_values:
        for value in (True, np.bool_(True), np.bool_(False), np.array(False)):
            flies.Tracker(camera, {name: value})
    flies.Detector(camera, {"evolve.flies": np.int64(500), "seed": np.array(3), "classify.threshold_offset": np.float32(0.1)})
    calibration = flies.load_calibration(
        street / "calib.yaml", width_px=np.int64(640), height_px=np.int32(240), images_are_resized=np.bool_(False))
    assert calibration.camera.width_px == 640
    with pytest.raises(flies.InputError, match="cameras: cannot be chosen"):
        flies.load_calibration(street / "calib.yaml", cameras=np.array([0, 1]))
