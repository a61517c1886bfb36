"""M, F, q', u' and the Jacobian: against each other, differences, a run; vectors of states; text."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import headland
from conftest import STONE, pendulums


def scenes(root):
    models = root / "models"
    names = ["paper_train", "chaplygin_sleigh", "double_pendulum", "snakeboard", "pendulum_prescribed_pivot", "road_train"]
    loaded = [headland.Scene.load(models / f"{name}.toml") for name in names]
    return [*loaded, pendulums(3), pendulums(10)]  # the last is solved by numbers


def states(eq, count, seed=7):
    """The start, and states about it."""
    random = np.random.default_rng(seed)
    t, q, u = eq.state0
    t = t + random.uniform(0, 2, count)
    q = q + random.uniform(-0.2, 0.2, (count, len(q)))
    u = u + random.uniform(-0.2, 0.2, (count, len(u)))
    return t, q, u


def test_consistency(root):
    for scene in scenes(root):
        eq = scene.build().equations()
        t, q, u = states(eq, 5)
        nq, nu = len(eq.names.q), len(eq.names.u)
        mass, force, a = eq.mass(t, q, u), eq.force(t, q, u), eq.acceleration(t, q, u)
        assert mass.shape == (5, nu, nu) and force.shape == a.shape == (5, nu)
        assert eq.rates(t, q, u).shape == (5, nq)
        np.testing.assert_array_equal(mass, np.swapaxes(mass, 1, 2))
        assert (np.linalg.eigvalsh(mass) > 0).all(), scene.title
        for m, f, x in zip(mass, force, a):
            np.testing.assert_allclose(m @ x, f, atol=1e-11 * (np.abs(m) @ np.abs(x) + np.abs(f)).max())


def test_jacobian_against_differences(root):
    for scene in scenes(root):
        eq = scene.build().equations()
        nq = len(eq.names.q)
        t, q, u = states(eq, 4)
        exact = eq.jacobian(t, q, u)
        y = np.concatenate([q, u], axis=1)

        def rate(y):
            return np.concatenate([eq.rates(t, y[:, :nq], y[:, nq:]), eq.acceleration(t, y[:, :nq], y[:, nq:])], axis=1)

        for j in range(y.shape[1]):
            h = 1e-3 * max(1.0, np.abs(y[:, j]).max())
            step = h * np.eye(y.shape[1])[j]
            # central differences of sixth order
            found = 45 * (rate(y + step) - rate(y - step))
            found += -9 * (rate(y + 2 * step) - rate(y - 2 * step)) + rate(y + 3 * step) - rate(y - 3 * step)
            found /= 60 * h
            size = np.abs(exact).max(axis=2) + np.abs(rate(y)) + 1
            assert (np.abs(found - exact[:, :, j]) / size).max() < 1e-8, (scene.title, j)


def test_one_state_and_many(root):
    for scene in scenes(root):
        eq = scene.build().equations()
        t, q, u = states(eq, 70)  # also beyond the number from which the interpreter is let go
        for f in eq.mass, eq.force, eq.acceleration, eq.rates, eq.jacobian:
            many = f(t, q, u)
            for p in 0, 1, 69:
                one = f(t[p], q[p], u[p])
                assert one.shape == many.shape[1:]
                np.testing.assert_array_equal(one, many[p], err_msg=f"{scene.title} {f}")


def test_arguments(train):
    eq = train.build().equations()
    t, q, u = eq.state0
    expected = eq.rates(t, q, u)
    np.testing.assert_array_equal(eq.rates(0, q.tolist(), [18]), expected)
    np.testing.assert_array_equal(eq.rates(np.float32(0), tuple(q), np.array([18])), expected)
    np.testing.assert_array_equal(eq.rates(*eq.state0), expected)
    # what has no axis of points goes with every point
    np.testing.assert_array_equal(eq.rates(t, np.tile(q, (3, 1)), u), np.tile(expected, (3, 1)))
    assert eq.rates([0, 1, 2], q, u).shape == (3, 5)
    assert eq.rates(np.array([0.0]), q, u).shape == (1, 5)
    assert eq.rates(np.array(0.0), q, u).shape == (5,)
    assert eq.mass(t, q[None], u).shape == (1, 1, 1)
    assert eq.mass(t, np.zeros((0, 5)), u).shape == (0, 1, 1)
    # arrays that are not contiguous
    wide = np.tile(q, (4, 2))
    np.testing.assert_array_equal(eq.rates(t, np.asfortranarray(wide[:, :5]), u), np.tile(expected, (4, 1)))
    np.testing.assert_array_equal(eq.rates(t, np.repeat(q, 2)[::2], u), expected)
    np.testing.assert_array_equal(eq.rates(np.zeros(8)[::2], wide[:, 5:], u), np.tile(expected, (4, 1)))


def test_wrong_arguments(train):
    eq = train.build().equations()
    t, q, u = eq.state0
    with pytest.raises(ValueError, match=r"`q` has the shape \[4\]; expected \[5\].*x_A1, y_A1"):
        eq.mass(t, q[:4], u)
    with pytest.raises(ValueError, match="`u` has the shape"):
        eq.mass(t, q, 18.0)
    with pytest.raises(ValueError, match="`q` has 3 points but `u` has 2"):
        eq.mass(t, np.tile(q, (3, 1)), np.tile(u, (2, 1)))
    with pytest.raises(ValueError, match="`t` has the shape"):
        eq.mass(np.zeros((2, 2)), q, u)
    with pytest.raises(ValueError, match="`q` cannot be read"):
        eq.mass(t, ["a"] * 5, u)
    with pytest.raises(ValueError, match="algorithm is `fast`"):
        train.build().equations("fast")
    with pytest.raises(ValueError, match="form is `pdf`"):
        eq.text("pdf")


def test_an_own_integrator_meets_the_run(root):
    model = headland.Scene.load(root / "models" / "double_pendulum.toml").build()
    eq = model.equations()
    t, q, u = eq.state0
    n, h = len(q), 2.5e-4

    def rate(t, y):
        return np.concatenate([eq.rates(t, y[:n], y[n:]), eq.acceleration(t, y[:n], y[n:])])

    y = np.concatenate([q, u])
    for _ in range(2000):
        k1 = rate(t, y)
        k2 = rate(t + h / 2, y + h / 2 * k1)
        k3 = rate(t + h / 2, y + h / 2 * k2)
        k4 = rate(t + h, y + h * k3)
        t, y = t + h, y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    result = model.run(at=[0.5], tolerance=1e-12)
    for name, value in zip(eq.names.q, y):
        assert result[name][0] == pytest.approx(value, abs=1e-9)


def test_algorithms_agree(root):
    model = headland.Scene.load(root / "models" / "snakeboard.toml").build()
    direct, combine = model.equations("direct"), model.equations(algorithm="combine")
    assert (direct.algorithm, combine.algorithm) == ("direct", "combine")
    assert direct.names == combine.names
    t, q, u = states(direct, 4)
    np.testing.assert_allclose(direct.acceleration(t, q, u), combine.acceleration(t, q, u), rtol=1e-10, atol=1e-12)
    with pytest.raises(headland.DeriveError, match="combine"):
        headland.Scene.load(root / "models" / "paper_train.toml").build().equations("combine")


def test_names_and_start(train):
    eq = train.build().equations()
    assert eq.names.q == ["x_A1", "y_A1", "theta[1]", "theta[2]", "theta[3]"]
    assert eq.names == headland.Names(eq.names.q, ["v"])
    assert eq.state0.t == 0.0 and eq.state0.u.tolist() == [18.0]
    assert eq.freedom.startswith("1 degree of freedom")
    eq.state0.u[0] = 3.0  # a copy
    assert eq.state0.u.tolist() == [18.0]


def test_start_that_is_not_determined():
    eq = headland.Scene.parse(STONE.replace("\"z'\" = 0\n", "")).build().equations()
    assert eq.acceleration(0, [20], [0]).tolist() == [-9.81]
    with pytest.raises(headland.DeriveError, match="too few initial values"):
        eq.state0


def test_text(train):
    eq = train.build().equations()
    assert "v' = " in eq.text()
    assert r"\begin{align*}" in eq.text("latex")
    assert "headland_rhs" in eq.text(form="c")
    assert eq.text("c") == train.build().equations().text("c")


def test_threads_share_equations():
    eq = pendulums(10).build().equations()
    t, q, u = states(eq, 200)
    expected = eq.acceleration(t, q, u)
    jacobian = eq.jacobian(t[:20], q[:20], u[:20])
    fresh = pendulums(10).build().equations()
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(lambda _: fresh.jacobian(t[:20], q[:20], u[:20]), range(8)):
            np.testing.assert_array_equal(found, jacobian)
        for found in pool.map(lambda _: fresh.acceleration(t, q, u), range(16)):
            np.testing.assert_array_equal(found, expected)
