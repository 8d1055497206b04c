"""Faults raise InputError with the text that the program prints."""
import os
import subprocess

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
    ],
)
def test_options_are_checked(camera, options, words):
    with pytest.raises(flies.InputError) as told:
        flies.Detector(camera, options)
    assert str(told.value).startswith(words)


def test_options_of_following_belong_to_trackers(camera):
    flies.Tracker(camera, {"track.gate": 10, "ego": {"corners": 300}})
    with pytest.raises(flies.InputError, match="track.gat: unknown option; the nearest known one is 'track.gate'"):
        flies.Tracker(camera, {"track.gat": 10})
    with pytest.raises(flies.InputError, match="track.gate: unknown option"):
        flies.Detector(camera, {"track.gate": 10})


def test_preset_model_and_camera_are_checked(camera):
    with pytest.raises(flies.InputError, match="default\\|paper"):
        flies.Detector(camera, preset="papr")
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
