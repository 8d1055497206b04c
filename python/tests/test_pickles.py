"""Results go through pickles, as processes exchange them; what cannot says so under its own name."""
import copy
import math
import pickle
import re

import numpy as np
import pytest

import flies


@pytest.fixture(scope="module")
def tracking(pair, camera):
    anybody = {"classify": {"threshold_offset": -3, "one_stage_threshold_offset": -3}}
    tracker = flies.Tracker(camera, anybody, preset="paper")
    return [tracker.process(*pair, 0.1 * i) for i in range(4)][-1]


def check_same(one, other):
    """All that Python sees of both is the same."""
    assert type(one) is type(other)
    if type(one).__module__ == "flies":
        for name in dir(type(one)):
            if not name.startswith("_") and not callable(getattr(one, name)):
                check_same(getattr(one, name), getattr(other, name))
    elif isinstance(one, np.ndarray):
        assert one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    elif isinstance(one, list):
        assert len(one) == len(other)
        for a, b in zip(one, other):
            check_same(a, b)
    else:
        assert one == other or (math.isnan(one) and math.isnan(other))


PICKLED = [lambda thing, protocol=protocol: pickle.loads(pickle.dumps(thing, protocol))
           for protocol in range(pickle.HIGHEST_PROTOCOL + 1)]


@pytest.mark.parametrize("copied", PICKLED + [copy.copy, copy.deepcopy])
def test_results_and_cameras_can_be_copied(tracking, camera, copied):
    found = tracking.detection
    assert tracking.tracks and found.obstacles and found.pedestrians and tracking.ego.is_known
    for thing in (tracking, found, found.scan, found.obstacles[0], found.pedestrians[0], found.obstacles[0].box,
                  tracking.ego, tracking.tracks[0], camera):
        check_same(copied(thing), thing)
    again = copied(tracking)
    assert np.array_equal(again.detection.scan.free_space(), found.scan.free_space())


def test_errors_can_be_pickled():
    error = pickle.loads(pickle.dumps(flies.InputError("calib.yaml: fx_px: is missing")))
    assert isinstance(error, flies.InputError) and str(error) == "calib.yaml: fx_px: is missing"


def test_what_cannot_be_pickled_says_so(street, camera):
    calibration = flies.load_calibration(street / "calib.yaml")
    engine = flies.Engine(camera)
    for thing in (calibration, engine.snapshot()):
        assert copy.copy(thing) is thing and copy.deepcopy([thing])[0] is thing
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            with pytest.raises(TypeError, match=f"^a flies.{type(thing).__name__} cannot be pickled: pickle its"):
                pickle.dumps(thing, protocol)
    for thing in (flies.Detector(camera), flies.Tracker(camera), engine):
        for act in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match=f"^a flies.{type(thing).__name__} cannot be copied or pickled: make another"):
                act(thing)


CLASSES = sorted((thing for thing in vars(flies).values() if isinstance(thing, type) and thing is not flies.InputError),
                 key=lambda one: one.__name__)


@pytest.mark.parametrize("made", CLASSES, ids=lambda one: one.__name__)
def test_what_was_never_made_raises(made):
    class Unmade(made):
        def __init__(self):
            pass

    with pytest.raises(TypeError, match="__init__"):
        Unmade()
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        with pytest.raises(TypeError):
            pickle.dumps(made.__new__(made), protocol)
    for act in (copy.copy, copy.deepcopy, lambda one: one.__reduce__(), lambda one: type(one).__mro__[-2]()):
        if made in (flies.Calibration, flies.Snapshot) and act in (copy.copy, copy.deepcopy):
            continue  # these are their own copies
        with pytest.raises(TypeError):
            act(made.__new__(made))


@pytest.mark.parametrize("garbage", [None, (), 1, "abc", [1.0], {"a": 1}, (None,) * 6, ("x",) * 10, tuple(range(14)),
                                     (math.nan,) * 11, (10**400,) * 11, ([1.0] * 3,) * 10], ids=repr)
@pytest.mark.parametrize("made", [one for one in CLASSES if hasattr(one, "__setstate__")], ids=lambda one: one.__name__)
def test_garbage_is_no_state(made, garbage):
    with pytest.raises((TypeError, ValueError, RuntimeError)):
        made.__new__(made).__setstate__(garbage)


def test_a_pickle_of_another_version_is_refused(tracking):
    for thing in (tracking, tracking.detection, tracking.detection.scan, tracking.tracks[0], tracking.ego):
        state = thing.__getstate__()
        with pytest.raises(ValueError, match="another version"):
            type(thing).__new__(type(thing)).__setstate__(state[:-1])


def test_names_are_those_of_the_package(camera):
    for name in set(flies.__all__) - {"__version__"}:
        thing = getattr(flies, name)
        assert thing.__module__ == "flies", name
        documented = [thing] + [value for value in vars(thing).values() if callable(value)] if isinstance(thing, type) else [thing]
        assert not any("_flies" in (item.__doc__ or "") for item in documented), name
    with pytest.raises(TypeError) as told:
        flies.Detector(camera).process(1)
    assert "_flies" not in str(told.value) and re.search("flies.Detector", str(told.value))
