"""Obstacles and pedestrians from a stereo pair, in metres.

    import flies

    calibration = flies.load_calibration("calib.yaml")
    detector = flies.Detector(calibration.camera)
    left, right = flies.load_pair("left.png", "right.png")      # uint8, shape (height, width)
    if calibration.is_raw:
        left, right = calibration.rectify(left, right)
    found = detector.process(left, right)
    for obstacle in found.obstacles:                            # nearest first
        print(obstacle.x_m, obstacle.y_m, obstacle.width_m)

Images are numpy arrays of uint8, grey, shape (height, width); they are not copied. Positions are in the vehicle frame:
x forward, y left, z up, metres, origin on the ground below the left camera. A unit ends every name that has one:
`_m`, `_px`, `_s`, `_ms`, `_rad`, `_mps` (metres a second).

- A pair alone: `Detector`. Results as objects (`found.obstacles`, `found.pedestrians`) and as arrays
  (`found.obstacle_array`, `found.scan.ranges_m`, `found.flies`).
- A sequence: `Tracker.process(left, right, time_s)` gives tracks with identity and velocity.
- A living camera: `Engine.submit(left, right, time_s)` returns at once, `Engine.wait(number)` gives results.

What is wrong with an input raises `InputError`, a ValueError, in one line. Work is done without the interpreter's lock.
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
