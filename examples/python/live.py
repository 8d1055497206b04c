"""A living camera that gives both pictures side by side: live.py SOURCE CALIB, SOURCE as 0, /dev/video0 or a file."""
import sys, time
import cv2, flies

source, calib = sys.argv[1:]
camera = cv2.VideoCapture(int(source) if source.isdigit() else source)
engine, start = None, time.monotonic()
while (frame := camera.read()[1]) is not None:
    gray = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
    left, right = gray[:, : gray.shape[1] // 2], gray[:, gray.shape[1] // 2 :]
    if engine is None:
        calibration = flies.load_calibration(calib, images=(left, right))
        engine = flies.Engine(calibration.camera)
    engine.submit(*calibration.rectify(left, right), time.monotonic() - start)
    for track in engine.wait(engine.snapshot().number, timeout_s=0.5).tracking.tracks:
        print(f"{track.kind} {track.id}: {track.x_m:.1f} m ahead, {track.y_m:.1f} m to the left")
