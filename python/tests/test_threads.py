"""Other threads run while the library works."""
import signal
import threading
import time

import numpy as np
import pytest

import flies


def test_interpreter_goes_on_while_the_engine_waits(camera):
    engine = flies.Engine(camera)
    waiting = threading.Thread(target=lambda: engine.wait(0, timeout_s=1.0))
    waiting.start()
    start = time.monotonic()
    while time.monotonic() - start < 0.2:
        pass
    assert waiting.is_alive()  # were the lock held, the loop would have begun after the wait
    waiting.join()


def test_ctrl_c_ends_a_wait(camera):
    engine = flies.Engine(camera)
    main = threading.get_ident()
    threading.Timer(0.2, lambda: signal.pthread_kill(main, signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        engine.wait(0, timeout_s=20.0)
    assert time.monotonic() - start < 10.0


def test_a_wait_takes_its_time(camera):
    engine = flies.Engine(camera)
    for timeout_s in (0.0, 0.01, 0.17):
        start = time.monotonic()
        assert engine.wait(0, timeout_s=timeout_s).number == 0
        assert time.monotonic() - start >= timeout_s


SLOW = {"evolve.flies": 200000, "evolve.generations": 20}


def goes_on_during(work):
    """Whether this thread runs while `work` does in another one: it could not if that held the interpreter's lock."""
    seen = []
    worker = threading.Thread(target=work)
    worker.start()
    while worker.is_alive():
        seen.append(time.monotonic())
        time.sleep(0.001)
    worker.join()
    return len(seen) > 20 and max(np.diff(seen)) < 0.5 * (seen[-1] - seen[0])


def test_interpreter_goes_on_while_a_pair_is_processed(pair, camera):
    detector = flies.Detector(camera, SLOW)
    assert goes_on_during(lambda: detector.process(*pair))


def test_interpreter_goes_on_while_an_engine_ends(pair, camera):
    engines = [flies.Engine(camera, SLOW)]
    engines[0].submit(*pair, time_s=0.0)
    time.sleep(0.02)  # its thread has begun with the pair, for whose end the engine waits
    assert goes_on_during(engines.clear)


def test_one_detector_serves_threads_one_after_the_other(pair, camera):
    detector = flies.Detector(camera)
    counts = []
    workers = [threading.Thread(target=lambda: counts.append(len(detector.process(*pair).obstacles))) for _ in range(8)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(counts) == 8 and min(counts) > 3
