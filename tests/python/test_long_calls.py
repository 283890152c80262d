"""Long calls: they report, other threads run meanwhile, and Ctrl-C or an exception ends them with nothing left behind."""

import os
import signal
import threading
import time

import lodestone
import pytest


@pytest.fixture(scope="module")
def large():
    return lodestone.generate("sphere", triangles=600000)


def test_progress(large):
    calls = []
    thread = threading.get_ident()

    def progress(step, share):
        calls.append((step, share))
        assert threading.get_ident() == thread

    lodestone.build(large, threads=1, progress=progress)
    assert {"welding", "building"} >= {step for step, _ in calls} and "building" in dict(calls)
    shares = [share for step, share in calls if step == "building"]
    assert shares == sorted(shares) and 0 <= shares[0] and shares[-1] <= 1 and len(shares) > 2


def test_other_threads_run(large):
    ticks, done = [], threading.Event()
    small = lodestone.generate("terrain", triangles=100000)
    hierarchy = lodestone.build(small)

    def tick():
        while not done.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        for work in (lambda: lodestone.build(large), lambda: lodestone.verify(hierarchy),
                     lambda: lodestone.compare(small, small)):
            # A thread that had to wait for the interpreter would never tick in the middle of a call. On a busy machine it
            # may wait for a processor, so that several calls are tried.
            for _ in range(10):
                ticks.clear()
                begin = time.monotonic()
                work()
                length = time.monotonic() - begin
                within = [t for t in ticks if 0.1 * length < t - begin < 0.9 * length]
                if len(within) > 2:
                    break
            else:
                pytest.fail(f"{len(within)} ticks in {length} s")
    finally:
        done.set()
        thread.join()


def test_ctrl_c(large):
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    begin = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            lodestone.build(large)
    assert time.monotonic() - begin < 5
    # And the next call knows nothing of it.
    assert lodestone.build(large, cell_triangles=100000).finest >= 1


def shares_of(step, work):
    """Of a call; they must grow from 0 on."""
    calls = []
    work(lambda *call: calls.append(call))
    shares = [share for name, share in calls if name == step]
    assert shares == sorted(shares) and 0 <= shares[0] and shares[-1] <= 1
    return shares


class Stop(Exception):
    pass


def stop(step, share):
    raise Stop(step)


def test_exceptions_of_the_callback(large, tmp_path):
    with pytest.raises(Stop, match="building|welding"):
        lodestone.build(large, progress=stop)
    hierarchy = lodestone.build(large)
    camera = lodestone.camera_path(hierarchy, "orbit", frames=1)[0]

    def on_frame(index, picture):
        raise Stop("frame")

    with pytest.raises(Stop, match="frame"):
        lodestone.fly(hierarchy, [camera] * 50, size=(64, 48), on_frame=on_frame)
    # A file that is written appears complete or not at all.
    (tmp_path / "a.lode").write_bytes(b"older")
    with pytest.raises(Stop, match="writing"):
        for _ in range(100):
            hierarchy.save(tmp_path / "a.lode", progress=stop)
    assert [file.name for file in tmp_path.iterdir()] == ["a.lode"]


@pytest.fixture(scope="module")
def text_files(large, tmp_path_factory):
    """A mesh as OBJ and as ASCII PLY, some ten megabytes each."""
    folder = tmp_path_factory.mktemp("text")
    large.save(folder / "a.obj")
    points = "".join(f"{x} {y} {z}\n" for x, y, z in large.positions.tolist())
    faces = "".join(f"3 {a} {b} {c}\n" for a, b, c in large.triangles.tolist())
    (folder / "a.ply").write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(large.positions)}\nproperty double x\nproperty double y\n"
        f"property double z\nelement face {len(large.triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
        + points + faces)
    return [folder / "a.obj", folder / "a.ply"]


def test_text_files_report_and_stop(text_files, large):
    def stop_midway(step, share):
        if share > 0:
            raise Stop(step)

    for file in text_files:
        assert shares_of("reading", lambda progress: lodestone.read(file, progress=progress))[-1] > 0.5
        begin = time.process_time()
        lodestone.read(file)
        whole, begin = time.process_time() - begin, time.process_time()
        with pytest.raises(Stop, match="reading"):
            lodestone.read(file, progress=stop_midway)
        assert time.process_time() - begin < 0.7 * whole + 0.1
        with pytest.raises(Stop, match="reading"):
            lodestone.build(file, progress=stop_midway)
        assert len(lodestone.read(file).triangles) == len(large.triangles)


def test_generate_reports_and_stops():
    def generate(progress=None):
        return lodestone.generate("terrain", triangles=3000000, threads=1, progress=progress)

    assert len(shares_of("generating", generate)) > 1
    begin = time.monotonic()
    with pytest.raises(Stop, match="generating"):
        generate(stop)
    assert time.monotonic() - begin < 5
    one, four = (lodestone.generate("torus", triangles=200000, threads=n) for n in (1, 4))
    assert (one.positions == four.positions).all() and (one.triangles == four.triangles).all()


def test_verify_reports_and_stops(large):
    hierarchy = lodestone.build(large)
    shares = shares_of("verifying", lambda progress: lodestone.verify(hierarchy, progress=progress))
    assert len(shares) > 2 and shares[-1] == 1
    begin = time.process_time()
    lodestone.verify(hierarchy)
    whole, begin = time.process_time() - begin, time.process_time()
    with pytest.raises(Stop, match="verifying"):
        lodestone.verify(hierarchy, progress=stop)
    assert time.process_time() - begin < 0.9 * whole


def test_calls_in_several_threads(tmp_path):
    made = {}

    def work(seed):
        made[seed] = lodestone.build(lodestone.generate("torus", triangles=20000, seed=seed), threads=2)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for seed, hierarchy in made.items():
        assert lodestone.verify(hierarchy, input=lodestone.generate("torus", triangles=20000, seed=seed))["valid"]
