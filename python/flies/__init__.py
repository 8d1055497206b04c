"""Obstacles and pedestrians from a stereo pair, in metres.

    import flies

    left, right = flies.load_pair("left.png", "right.png")      # uint8, shape (height, width)
    calibration = flies.load_calibration("calib.yaml", width_px=left.shape[1], height_px=left.shape[0])
    if calibration.is_raw:
        left, right = calibration.rectify(left, right)
    detector = flies.Detector(calibration.camera)
    found = detector.process(left, right)
    for obstacle in found.obstacles:                            # nearest first
        print(obstacle.x_m, obstacle.y_m, obstacle.width_m)

Images are numpy arrays of uint8, grey, shape (height, width); but for `Engine.submit` and `rectify` nothing copies them.
Positions are in the vehicle frame:
x forward, y left, z up, metres, origin on the ground below the left camera. A unit ends every name that has one:
`_m`, `_px`, `_s`, `_ms`, `_rad`, `_mps` (metres a second), `_rps` (radians a second).

- A pair alone: `Detector`. Results as objects (`found.obstacles`, `found.pedestrians`) and as arrays
  (`found.obstacle_array`, `found.scan.ranges_m`, `found.flies`).
- A sequence: `Tracker.process(left, right, time_s)` gives tracks with identity and velocity.
- A living camera: `Engine.submit(left, right, time_s)` returns at once, `Engine.wait(number)` gives what is newer than
  result `number`.

What is wrong with an input raises `InputError`, a ValueError, in one line. Work is done without the interpreter's lock.
Results and cameras can be pickled and copied.
"""

from ._flies import (
    Calibration,
    Detection,
    Detector,
    EgoMotion,
    Engine,
    ImageBox,
    InputError,
    Obstacle,
    Pedestrian,
    Scan,
    Snapshot,
    StereoCamera,
    Track,
    Tracker,
    Tracking,
    __version__,
    find_pairs,
    load_calibration,
    load_pair,
    options,
)

__all__ = [
    "Calibration",
    "Detection",
    "Detector",
    "EgoMotion",
    "Engine",
    "ImageBox",
    "InputError",
    "Obstacle",
    "Pedestrian",
    "Scan",
    "Snapshot",
    "StereoCamera",
    "Track",
    "Tracker",
    "Tracking",
    "__version__",
    "find_pairs",
    "load_calibration",
    "load_pair",
    "options",
]
