"""Runs: against the reference, options, endings, threads."""

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import headland
from conftest import GROUND, GUARD, STONE


def test_train_against_the_reference(train, root):
    """The numbers of validation/reference/paper_train.json, made by a second derivation and another integrator."""
    values = json.loads((root / "validation" / "reference" / "paper_train.json").read_text())["values"]
    result = train.build().run(at=[float(v["t"]) for v in values], tolerance=1e-12)
    assert result.status == "done" and result.reason is None
    np.testing.assert_array_equal(result.t, [v["t"] for v in values])
    for row, value in enumerate(values):
        for name in "x_A1", "y_A1", "v", "power":
            assert result[name][row] == pytest.approx(float(value[name]), rel=1e-10, abs=1e-10), name
        for name in "theta", "v_C", "omega", "psi":
            for k, text in enumerate(value[name], 1):
                assert result[f"{name}[{k}]"][row] == pytest.approx(float(text), rel=1e-10, abs=1e-11), (name, k)


def test_result(train):
    result = train.build().run(until=3, points=6, tolerance=1e-9)
    assert result.t.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]
    assert result.data.shape == (7, len(result.columns)) and len(result) == 7
    assert result.data.dtype == np.float64 and result.data.flags.c_contiguous
    assert dict(zip(result.columns, result.units))["v"] == "m/s"
    assert result["v"].base is not None  # a view
    np.testing.assert_array_equal(result["v"], result.data[:, result.columns.index("v")])
    np.testing.assert_array_equal(result["t"], result.t)
    with pytest.raises(KeyError, match="'psi\\[1\\]'"):
        result["psi1"]
    assert result.summary["status"] == "done" and result.summary["method"] == "dop853"
    assert result.summary["energy_balance"] < 1e-8
    assert result.summary["versions"]["headland"] == headland.__version__
    assert repr(result) == "<headland.Result: 7 times, 17 columns, done at t = 3 s>"


def test_options(stone):
    model = stone.build()
    assert model.run(at=0.5).t.tolist() == [0.5]
    assert model.run(at=np.array([0.5])).t.tolist() == [0.5]
    assert model.run(at=np.array([1.0, 0.25]), until=2).t.tolist() == [0.25, 1.0]
    assert model.run(at=[1.0, 0.25], until=2).summary["t_end"] == 2.0
    assert model.run(until=1, balance=False).summary["energy_balance"] is None
    assert model.run(until=1, max_step=0.01).summary["steps"] >= 100
    for method in set(headland.methods) | {"auto"}:
        z = model.run(at=[1.0], method=method, tolerance=1e-10)["z"][0]
        assert z == pytest.approx(20 - 9.81 / 2, rel=1e-8), method


def test_wrong_options(stone):
    model = stone.build()
    with pytest.raises(headland.SolveError, match="no method `euler`"):
        model.run(method="euler")
    with pytest.raises(headland.SolveError, match="tol"):
        model.run(tolerance=-1.0)
    with pytest.raises(headland.RunError, match="starts at 0") as caught:
        model.run(until=-1.0)
    assert caught.value.result is None
    with pytest.raises(headland.RunError, match="outside the run"):
        model.run(at=[3.0], until=2.0)
    with pytest.raises(ValueError, match="until is inf"):
        model.run(until=float("inf"))
    with pytest.raises(ValueError, match="at is NaN"):
        model.run(at=[float("nan")])
    with pytest.raises(ValueError, match="points is 0"):
        model.run(points=0)
    with pytest.raises(TypeError):
        model.run(15)


def test_stopped_by_an_event():
    result = headland.Scene.parse(STONE + GROUND).build().run()
    assert result.status == "stopped" and "ground" in result.reason
    assert result.t[-1] == pytest.approx((2 * 20 / 9.81) ** 0.5, rel=1e-9)
    assert result["z"][-1] == pytest.approx(0, abs=1e-8)


def test_a_failed_run_keeps_what_was_computed():
    model = headland.Scene.parse(STONE + GUARD).build()
    with pytest.warns(headland.RunWarning, match="the net is there"):
        with pytest.raises(headland.RunError, match="fell below 5") as caught:
            model.run()
    result = caught.value.result
    assert result.status == "failed" and result.reason == str(caught.value)
    assert len(result) > 10
    assert result["z"][-1] == pytest.approx(5, abs=1e-6)


def test_derivation_errors_have_places():
    text = STONE.replace('"1 kg"', '"0 kg"')
    with pytest.raises(headland.DeriveError, match="singular") as caught:
        headland.Scene.parse(text, name="stone.toml").build().run()
    assert caught.value.diagnostic.file == "stone.toml"
    assert caught.value.diagnostic.line == 1 + text.splitlines().index('z = "m"')


def test_determinism(train):
    model = train.build()
    first = model.run(until=5)
    model.equations().text("c")
    for again in model.run(until=5), train.build().run(until=5):
        np.testing.assert_array_equal(first.data, again.data)
        assert first.summary["rhs"] == again.summary["rhs"]


def test_threads(train):
    model = train.build()
    expected = model.run(until=5).data
    with ThreadPoolExecutor(4) as pool:
        for result in pool.map(lambda _: model.run(until=5), range(12)):
            np.testing.assert_array_equal(result.data, expected)


def test_the_interpreter_is_let_go(train):
    """While a long run is under way, this thread goes on."""
    model = train.build()
    runs = threading.Thread(target=lambda: model.run(until=20, max_step=2e-4, points=1))
    begun = time.perf_counter()
    runs.start()
    turns, longest, last = 0, 0.0, begun
    while runs.is_alive():
        time.sleep(0.001)
        now = time.perf_counter()
        turns, longest, last = turns + 1, max(longest, now - last), now
    took = last - begun
    assert took > 0.1, "the run is too short to say anything"
    assert turns > 20 and longest < 0.5 * took, (turns, longest, took)


INTERRUPTED = """
import sys, headland
model = headland.Scene.load(sys.argv[1]).build()
print("ready", flush=True)
try:
    model.run(until=1e6, max_step=1e-3, points=10**6)
except KeyboardInterrupt as error:
    assert isinstance(error, headland.Interrupted)
    result = error.result
    assert result.status == "stopped" and result.reason == "interrupted"
    assert len(result) > 1 and result.t[-1] == result.summary["t_end"]
    print("kept", len(result), str(error))
"""


@pytest.mark.skipif(os.name != "posix", reason="sends a signal")
def test_ctrl_c_keeps_what_was_computed(root):
    scene = root / "models" / "paper_train.toml"
    command = [sys.executable, "-c", INTERRUPTED, str(scene)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 0, err
    assert re.match(r"kept \d+ interrupted at t = ", out), out + err


@pytest.mark.skipif(os.name != "posix", reason="sends a signal")
def test_a_handler_of_ones_own(train):
    """What a signal's handler raises comes through, with the result."""

    class Enough(Exception):
        pass

    def handler(_signal, _frame):
        raise Enough

    model = train.build()
    old = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Enough) as caught:
            model.run(until=1e6, max_step=1e-3)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)
    assert caught.value.result.status == "stopped"


def test_warnings_can_be_silenced_or_raised():
    model = headland.Scene.parse(STONE + GUARD.replace('stop_below = "5 m"\n', "")).build()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", headland.RunWarning)
        assert "below 10" in model.run(until=2).summary["log"][0]["message"]
    with warnings.catch_warnings():
        warnings.simplefilter("error", headland.RunWarning)
        with pytest.raises(headland.RunWarning):
            model.run(until=2)


def test_results_and_errors_go_to_other_processes(train):
    result = train.build().run(until=1, points=4)
    again = pickle.loads(pickle.dumps(result))
    np.testing.assert_array_equal(again.data, result.data)
    assert again.columns == result.columns and again.summary == result.summary
    place = headland.Diagnostic("a.toml", 3, 4, "no")
    for error in (
        headland.SceneError("no", [place]),
        headland.DeriveError("no", place),
        headland.RunError("no", result),
        headland.Interrupted("no", result),
    ):
        other = pickle.loads(pickle.dumps(error))
        assert type(other) is type(error) and str(other) == "no"
        assert vars(other).keys() == vars(error).keys()


def test_to_pandas(train):
    pandas = pytest.importorskip("pandas")
    result = train.build().run(until=1, points=4)
    frame = result.to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == result.columns and frame.index.name == "t"
    np.testing.assert_array_equal(frame["v"], result["v"])
    assert frame.attrs["units"]["v"] == "m/s"


def test_pandas_is_not_imported():
    code = "import sys, headland; sys.exit('pandas' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
