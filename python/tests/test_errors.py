"""Faults raise InputError with the text that the program prints."""
import os
import subprocess
import types

import numpy as np
import pytest

import flies


def program_says(*words):
    done = subprocess.run([os.environ["FLIES_BINARY"], *words], capture_output=True, text=True)
    assert done.returncode == 2
    return done.stderr.strip().removeprefix("flies: ")


def test_same_text_as_the_program(tmp_path):
    calib = tmp_path / "calib.yaml"
    calib.write_text("fx_px: 0\n")
    with pytest.raises(flies.InputError) as told:
        flies.load_calibration(str(calib))
    assert str(told.value) == program_says("calib", str(calib))


def properties_of(made):
    return [name for name in dir(made) if isinstance(getattr(made, name), property)]


CLASSES = [c for c in vars(flies).values() if isinstance(c, type) and properties_of(c)]


@pytest.mark.parametrize("made", CLASSES, ids=lambda made: made.__name__)
def test_objects_without_init_hold_nothing(made):
    empty = made.__new__(made)
    for name in properties_of(made):
        # pybind11 itself refuses what is asked of the owner of an object rather than of the object.
        with pytest.raises((TypeError, RuntimeError), match="__init__ was not called|non-held to held"):
            getattr(empty, name)
    with pytest.raises(TypeError, match="__init__ was not called"):
        repr(empty)


def test_empty_objects_do_nothing(pair):
    assert len(CLASSES) > 10
    empty = [made.__new__(made) for made in (flies.Engine, flies.Detector, flies.Tracker)]
    for ask in (lambda: empty[0].wait(1), lambda: empty[0].submit(*pair, 0), lambda: empty[1].process(*pair),
                lambda: empty[2].process(*pair, 0.1)):
        with pytest.raises(TypeError, match="__init__ was not called"):
            ask()
    with pytest.raises(TypeError, match="__init__ was not called"):
        flies.Detector(flies.StereoCamera.__new__(flies.StereoCamera))


def test_is_a_value_error():
    assert issubclass(flies.InputError, ValueError)
    assert flies.InputError.__module__ == "flies"


def test_missing_file_is_named(paths):
    with pytest.raises(flies.InputError, match="^absent.png: "):
        flies.load_pair("absent.png", paths[0][1])


@pytest.mark.parametrize(
    "options, words",
    [
        ({"evolve.fliess": 1}, "options: evolve.fliess: unknown option; the nearest known one is 'evolve.flies'"),
        ({"evolve": {"flies": -1}}, "options: evolve.flies: found"),
        ({"evolve.flies": 0.5}, "options: evolve.flies: found"),
        ({"evolve.flies": None}, "options: evolve.flies: found None"),
        ({1: 2}, "options: found the key 1"),
        ({"evolve.flies": 3000, "evolve": {"flies": 4000}}, "options: evolve.flies: is given twice, as 3000 and as 4000"),
        ({"no_such": 1}, "options: no_such: unknown option"),
        ({"evolve.flies": np.bool_(True)}, "options: evolve.flies: found"),
        ({"evolve": types.MappingProxyType({"fliess": 1})}, "options: evolve.fliess: unknown option"),
    ],
)
def test_options_are_checked(camera, options, words):
    with pytest.raises(flies.InputError) as told:
        flies.Detector(camera, options)
    assert str(told.value).startswith(words)


def test_options_that_hold_themselves_are_refused(camera):
    options = {}
    options["evolve"] = options
    with pytest.raises(flies.InputError, match="nested too deeply"):
        flies.Detector(camera, options)


def test_arrays_that_hold_themselves_are_refused(camera):
    array = np.empty((), dtype=object)
    array[()] = array
    with pytest.raises(flies.InputError, match="^options: evolve.flies: found an array in an array, expected"):
        flies.Detector(camera, {"evolve.flies": array})
    flies.Detector(camera, {"evolve.flies": np.array(700)})


def test_sizes_are_checked(street):
    calib = street / "calib.yaml"

    def refused(words, **size):
        with pytest.raises(flies.InputError) as told:
            flies.load_calibration(calib, **size)
        assert str(told.value).startswith(f"{calib}: {words}")

    refused("image size: found -5 x 3 px", width_px=-5, height_px=3)
    refused("image size: found 1242 x 0 px, expected", width_px=1242)
    refused("image size: found 0 x 375 px, expected", height_px=375)
    refused("image size: found 2000000000 x 375 px, expected", width_px=2000000000, height_px=375)
    refused("calibrated size: found 640 x 0 px, expected", calibrated_size_px=(640, 0))
    refused("calibrated size: found 3 numbers, expected two", calibrated_size_px=(640, 240, 1))
    refused("cameras: found 1 numbers, expected two", cameras=[0])
    padded = np.pad(np.random.default_rng(1).integers(0, 255, (240, 640), np.uint8), ((0, 160), (0, 0)))
    refused("image size: the calibration is for 640 x 240 px, the images have 640 x 400 px", images=(padded, padded))
    numbers = {"fx_px": 400, "fy_px": 400, "cx_px": 320, "cy_px": 120, "baseline_m": 0.5}
    for size in ({"width_px": 640}, {"height_px": 240}, {"width_px": -5, "height_px": 3}):
        with pytest.raises(flies.InputError, match="camera: .*image size"):
            flies.StereoCamera(**numbers, **size)
    assert flies.StereoCamera(**numbers).width_px == 0


def test_rectify_refuses_images_of_another_size(street, pair, tmp_path):
    calibration = flies.load_calibration(street / "calib.yaml")
    assert not calibration.is_raw
    left, right = calibration.rectify(*pair)
    assert np.array_equal(left, pair[0]) and np.array_equal(right, pair[1]) and left is not pair[0]
    with pytest.raises(flies.InputError, match="calibration: image size: .* 640 x 240 px, the images have 640 x 200"):
        calibration.rectify(pair[0][:200], pair[1][:200])
    raw = tmp_path / "raw.yml"
    matrix = "!!opencv-matrix {{ rows: {}, cols: {}, dt: d, data: [{}] }}"
    raw.write_text("%YAML:1.0\n---\nimage_width: 640\nimage_height: 240\n" + "".join(
        f"{name}: {matrix.format(rows, cols, numbers)}\n" for name, rows, cols, numbers in [
            ("M1", 3, 3, "400,0,320,0,400,120,0,0,1"), ("D1", 1, 5, "-0.1,0,0,0,0"),
            ("M2", 3, 3, "400,0,320,0,400,120,0,0,1"), ("D2", 1, 5, "-0.1,0,0,0,0"),
            ("R", 3, 3, "1,0,0,0,1,0,0,0,1"), ("T", 3, 1, "-0.5,0,0")]))
    calibration = flies.load_calibration(raw)
    assert calibration.is_raw and calibration.rectify(*pair)[0].shape == pair[0].shape
    with pytest.raises(flies.InputError, match="image size: .* 640 x 240 px, the images have 640 x 200"):
        calibration.rectify(pair[0][:200], pair[1][:200])


def test_options_of_following_belong_to_trackers(camera):
    flies.Tracker(camera, {"track.gate": 10, "ego": {"corners": 300}})
    with pytest.raises(flies.InputError, match="track.gat: unknown option; the nearest known one is 'track.gate'"):
        flies.Tracker(camera, {"track.gat": 10})
    with pytest.raises(flies.InputError, match="track.gate: unknown option"):
        flies.Detector(camera, {"track.gate": 10})


def test_preset_model_and_camera_are_checked(camera):
    for ask in (lambda: flies.Detector(camera, preset="papr"), lambda: flies.options("papr")):
        with pytest.raises(flies.InputError, match="^arguments: preset: found 'papr', expected default\\|paper"):
            ask()
    with pytest.raises(flies.InputError, match="no-model"):
        flies.Detector(camera, model="no-model")
    with pytest.raises(flies.InputError, match="camera: baseline"):
        flies.StereoCamera(500, 500, 320, 120, baseline_m=-0.5)


def test_time_must_advance(pair, camera):
    tracker = flies.Tracker(camera)
    tracker.process(*pair, 1.0)
    with pytest.raises(flies.InputError, match="time"):
        tracker.process(*pair, 1.0)
    engine = flies.Engine(camera)
    engine.submit(*pair, 1.0)
    with pytest.raises(flies.InputError, match="time"):
        engine.submit(*pair, 0.5)
    with pytest.raises(flies.InputError, match="timeout_s"):
        engine.wait(0, timeout_s=-1)
    with pytest.raises(flies.InputError, match="wait: after: found -1"):
        engine.wait(-1)
