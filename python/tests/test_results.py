"""What comes out of a pair and of a sequence is what the program says."""
import json
import os
import subprocess

import numpy as np
import pytest

import flies


def program_line(street, *words):
    command = [os.environ["FLIES_BINARY"], *words, "--calib", "calib.yaml", "--json", "-"]
    done = subprocess.run(command, cwd=street, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_obstacles_are_those_of_the_program(street, pair, camera):
    found = flies.Detector(camera).process(*pair)
    line = program_line(street, "detect", "left/000000.png", "right/000000.png", "--self-rectify", "off")[0]
    assert len(found.obstacles) == len(line["obstacles"]) > 3
    for obstacle, expected in zip(found.obstacles, line["obstacles"]):
        for name in ("x_m", "y_m", "range_m", "range_sd_m", "width_m", "depth_m", "height_m"):
            assert getattr(obstacle, name) == pytest.approx(expected[name], abs=0.0006)
        assert obstacle.box.u_px == pytest.approx(expected["box"]["u_px"], abs=0.006)
    assert len(found.pedestrians) == len(line["pedestrians"])


def test_arrays_hold_what_the_objects_say(pair, camera):
    found = flies.Detector(camera).process(*pair)
    array = found.obstacle_array
    assert array.shape == (len(found.obstacles),)
    assert [o.x_m for o in found.obstacles] == array["x_m"].tolist()
    assert [o.box.height_px for o in found.obstacles] == array["height_px"].tolist()
    assert [p.probability for p in found.pedestrians] == found.pedestrian_array["probability"].tolist()
    assert found.flies.dtype == np.float32 and found.flies.shape[1] == 4
    assert set(found.stage_ms) == {"road", "evolve", "scan", "concentrate", "propose", "classify"}
    assert found.road_found and abs(found.road[0]) < 0.3


# What is a field of another name in an array.
BOX = {"u_px", "v_px", "width_px", "height_px"}
OTHER_FIELDS = {"box": BOX, "kind": {"is_person"}}


def attributes_of(thing):
    return [name for name in dir(type(thing)) if not name.startswith("_")]


def check_rows(array, things):
    """Every attribute of the objects is a field, and says the same."""
    assert len(array) == len(things) > 0
    expected = set().union(*(OTHER_FIELDS.get(name, {name}) for name in attributes_of(things[0])))
    assert set(array.dtype.names) == expected
    for name in array.dtype.names:
        if name == "is_person":
            values = [thing.kind == "person" for thing in things]
        elif name == "obstacle":
            values = [-1 if thing.obstacle is None else thing.obstacle for thing in things]
        else:
            values = [getattr(thing.box if name in BOX else thing, name) for thing in things]
        assert np.array_equal(array[name], np.array(values)), name


def test_arrays_have_a_field_for_every_attribute(pair, camera):
    anybody = {"classify": {"threshold_offset": -3, "one_stage_threshold_offset": -3}}
    tracker = flies.Tracker(camera, anybody, preset="paper")
    trackings = [tracker.process(*pair, 0.1 * i) for i in range(4)]
    found = trackings[-1].detection
    check_rows(found.obstacle_array, found.obstacles)
    check_rows(found.pedestrian_array, found.pedestrians)
    check_rows(trackings[-1].track_array, trackings[-1].tracks)
    assert (found.obstacle_array["range_sd_m"] > 0).all() and (found.pedestrian_array["range_sd_m"] > 0).all()
    assert {found.obstacle_array.dtype[i] for i in range(len(found.obstacle_array.dtype))} == {np.dtype(np.float64)}


def test_people_have_the_obstacle_that_they_are_in_the_program(street, pair, camera):
    unsure = {"classify": {"threshold_offset": -3, "one_stage_threshold_offset": -3}}
    found = flies.Detector(camera, unsure).process(*pair)
    words = [f"--classify.{name}={value}" for name, value in unsure["classify"].items()]
    line = program_line(street, "detect", "left/000000.png", "right/000000.png", "--self-rectify", "off", *words)[0]
    expected = [person["obstacle"] for person in line["pedestrians"]]
    assert [person.obstacle for person in found.pedestrians] == expected
    assert any(index is not None for index in expected), "the street shows nobody who is an obstacle"
    assert found.pedestrian_array["obstacle"].dtype == np.int64


def test_scan_is_borrowed_and_outlives_its_detection(pair, camera):
    scan = flies.Detector(camera).process(*pair).scan
    ranges, states = scan.ranges_m, scan.states
    size = len(scan)
    before = ranges.copy()
    del scan
    assert ranges.shape == states.shape == (size,)
    assert np.array_equal(ranges, before, equal_nan=True)
    assert np.isfinite(ranges[states == flies.Scan.OBSTACLE]).all()
    assert np.isnan(ranges[states != flies.Scan.OBSTACLE]).all()
    assert (states == flies.Scan.OBSTACLE).any() and (states == flies.Scan.FREE).any()
    with pytest.raises(ValueError):
        ranges[0] = 1.0


def test_scan_says_what_can_be_written_to(pair, camera):
    scan = flies.Detector(camera).process(*pair).scan
    for name in ("ranges_m", "free_m", "confidence"):
        assert not getattr(scan, name).flags.writeable, name
    for values in (scan.angles_rad, scan.states, scan.free_space()):
        before = values.copy()
        values[...] = 0  # a copy
        assert values.flags.writeable and before.any()
    assert scan.angles_rad.any() and scan.states.any() and scan.free_space().any()


def test_free_space_starts_at_the_camera(pair, camera):
    polygon = flies.Detector(camera).process(*pair).scan.free_space()
    assert polygon.shape[0] > 10 and polygon.shape[1] == 2
    assert polygon[0].tolist() == [0.0, 0.0]


def test_tracker_follows_a_standing_camera(pair, camera):
    tracker = flies.Tracker(camera)
    trackings = [tracker.process(*pair, 0.1 * i) for i in range(4)]
    assert not trackings[0].ego.is_known and trackings[-1].ego.is_known
    assert abs(trackings[-1].ego.vx_mps) < 0.05
    last = trackings[-1]
    assert last.time_s == pytest.approx(0.3)
    assert max(track.sightings for track in last.tracks) == 4
    array = last.track_array
    assert array["id"].tolist() == [t.id for t in last.tracks]
    assert array["is_person"].tolist() == [t.kind == "person" for t in last.tracks]
    covariance = last.tracks[0].covariance
    assert covariance.shape == (4, 4) and np.allclose(covariance, covariance.T)


def test_engine_gives_the_newest_result(pair, camera):
    engine = flies.Engine(camera)
    assert engine.snapshot().number == 0
    snapshot = engine.snapshot()
    for i in range(3):
        engine.submit(*pair, 0.1 * i)
        snapshot = engine.wait(snapshot.number, timeout_s=20.0)
    assert snapshot.number == snapshot.submitted == 3 and snapshot.dropped == 0
    assert snapshot.error == "" and snapshot.latency_ms > 0 and snapshot.age_s > 0
    tracking = snapshot.tracking
    del snapshot, engine
    assert tracking.tracks and tracking.detection.obstacles


def test_nothing_has_an_age_until_a_pair_could_be_used(pair, camera):
    engine = flies.Engine(camera)
    assert np.isnan(engine.snapshot().age_s)
    engine.submit(pair[0], pair[0], 0.0)  # one picture twice
    refused = engine.wait(0, timeout_s=20.0)
    assert refused.number == 1 and "identical" in refused.error and np.isnan(refused.age_s)
    engine.submit(*pair, 0.1)
    assert 0 < engine.wait(1, timeout_s=20.0).age_s < 20.0


def test_options_are_used(pair, camera):
    few = flies.Detector(camera, {"evolve": {"flies": 500}})
    assert few.process(*pair).flies.shape == (500, 4)
    nobody = flies.Detector(camera, model="")
    assert nobody.process(*pair).pedestrians == []


def test_options_are_listed_with_their_values():
    options = {name: (value, allowed, meaning) for name, value, allowed, meaning in flies.options()}
    assert options["seed"][0] == "1"
    assert "track.gate" in options and "ego.corners" in options
    paper = {name: value for name, value, _, _ in flies.options("paper")}
    assert paper["evolve.flies"] == "3000"


def test_paper_has_the_people_model_that_belongs_to_it(pair, camera):
    unsure = {"classify": {"threshold_offset": -3, "one_stage_threshold_offset": -3}}  # so that somebody is reported

    def people(**choice):
        found = flies.Detector(camera, unsure, preset="paper", **choice).process(*pair)
        return found.pedestrian_array.tolist()

    assert len(people()) > 0
    assert people() == people(model="flies-48x96-linear")
    assert people() != people(model="flies-48x96-network")
