"""Reading, changing, building: values, units, errors with their places."""

import copy
from decimal import Decimal

import numpy as np
import pytest

import headland
from conftest import STONE


def test_load(train, root):
    assert train.title == "Train of n bogies, the article's example"
    assert train.name == str(root / "models" / "paper_train.toml")
    model = train.build()
    assert model.coordinates == ["x_A1", "y_A1", "theta[1]", "theta[2]", "theta[3]"]
    assert model.columns[:3] == ["x_A1", "y_A1", "v"]
    assert model.parameters["l[2]"] == 6.0
    assert model.warnings == []
    assert headland.Scene.load(str(root / "models" / "paper_train.toml")).title == train.title


def test_no_such_file():
    with pytest.raises(FileNotFoundError):
        headland.Scene.load("nothing.toml")


def test_set_numbers_quantities_arrays_expressions(train):
    train["v0"] = 4  # still m/s
    train.set("v_ref", "36 km/h")
    train["l"] = [4, 6.5]
    for name in "a", "b", "theta0":
        train[name] = np.zeros(2)
    train["m"] = ("8 t", "12 t")
    train["J"] = np.array([20000, 60000])
    train["F_B"] = [np.float32(3000), Decimal("3400")]
    train["l[2]"] = np.float64(0.1)
    train["gamma"] = "0.1*sin(2*pi*t/5)"
    train["run.until"] = "2 min"
    parameters = train.build().parameters
    assert parameters["v0"] == 4.0
    assert parameters["v_ref"] == pytest.approx(10.0, rel=1e-15)
    assert [parameters["l[1]"], parameters["l[2]"]] == [4.0, 0.1]
    assert "l[3]" not in parameters
    assert [parameters["m[1]"], parameters["m[2]"]] == [8000.0, 12000.0]
    assert parameters["F_B[2]"] == 3400.0
    result = train.build().run(points=4)
    assert result.t[-1] == 120.0
    assert "theta[2]" in result and "theta[3]" not in result


def test_numbers_keep_their_digits(train):
    train["v0"] = 0.1 + 0.2
    assert train.build().parameters["v0"] == 0.1 + 0.2


@pytest.mark.parametrize("value", [7, 7.0, "7", np.float32(7), np.int64(7), np.array(7.0), Decimal(7)])
def test_all_kinds_of_numbers(train, value):
    train["v0"] = value
    assert train.build().parameters["v0"] == 7.0


def test_get(train):
    assert train["v0"] == "18 m/s"
    assert train["l"] == ["4 m", "6 m", "6 m"]
    assert train["run.tolerance"] == 1e-9
    train["v0"] = "17 m/s"
    assert train["v0"] == "17 m/s"
    with pytest.raises(KeyError, match="v1"):
        train["v1"]


@pytest.mark.parametrize("make", [headland.Scene.copy, copy.copy, copy.deepcopy])
def test_copy(train, make):
    other = make(train)
    other["v0"] = 3
    assert train["v0"] == "18 m/s"
    assert other["v0"] != "18 m/s"


def test_wrong_values(train):
    with pytest.raises(TypeError, match="`v0` is set to .* not to object"):
        train["v0"] = object()
    with pytest.raises(TypeError, match="dict"):
        train["v0"] = {}
    with pytest.raises(ValueError, match="no finite number"):
        train["v0"] = float("nan")
    with pytest.raises(ValueError, match="no finite number"):
        train["l"] = [1.0, np.inf]


def test_unknown_name(train):
    with pytest.raises(headland.SceneError, match="nothing named `v1`") as caught:
        train["v1"] = 3
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.setting == "v1=3.0"
    assert (diagnostic.line, diagnostic.column) == (None, None)
    assert "--set" not in str(caught.value)


def test_all_errors_with_places():
    text = STONE.replace('z = "20 m"', 'z = "20 kg"').replace('"-9.81 N"', '"-weigth"')
    with pytest.raises(headland.SceneError) as caught:
        headland.Scene.parse(text, name="stone.toml").build()
    error = caught.value
    assert isinstance(error, headland.Error)
    lines = text.splitlines()
    places = [(d.file, lines[d.line - 1][d.column - 1 :]) for d in error.diagnostics]
    assert places == [("stone.toml", 'weigth"'), ("stone.toml", '20 kg"')], str(error)
    assert "unknown" in error.diagnostics[0].message or "weigth" in error.diagnostics[0].message
    assert "stone.toml:11:" in str(error) and "^^^^" in str(error)


def test_no_toml():
    with pytest.raises(headland.SceneError) as caught:
        headland.Scene.parse("title = \n", name="half.toml")
    assert caught.value.diagnostics[0].file == "half.toml"
    assert caught.value.diagnostics[0].line == 1


def test_setting_that_does_not_fit(train):
    train["F_B"] = ["3000 N", "3400 kg", "3200 N"]
    with pytest.raises(headland.SceneError) as caught:
        train.build()
    assert "a mass [kg]" in str(caught.value)
