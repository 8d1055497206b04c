import os
import subprocess

import pytest

import flies


@pytest.fixture(scope="session")
def street(tmp_path_factory):
    """A folder with left/, right/ and calib.yaml: two pairs of a small painted street."""
    folder = tmp_path_factory.mktemp("street")
    command = [os.environ["FLIES_BINARY"], "synth", str(folder), "--seed", "1", "--frames", "2", "--force"]
    command += ["--width_px", "640", "--height_px", "240", "--focal_px", "400"]
    subprocess.run(command, check=True, capture_output=True)
    return folder


@pytest.fixture(scope="session")
def paths(street):
    return flies.find_pairs(str(street / "left"), str(street / "right"))


@pytest.fixture(scope="session")
def pair(paths):
    return flies.load_pair(*paths[0])


@pytest.fixture(scope="session")
def camera(street):
    return flies.load_calibration(str(street / "calib.yaml")).camera
